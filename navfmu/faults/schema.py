"""What may stand in a fault file; which type of fault takes what, ``fault.TYPES`` says."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import ConfigDict

from navfmu.faults.fault import PARAMETERS, TYPES
from navfmu.files.schema import Field, Number, Table, Texts

Value = Number | bool | str | list[Number | bool | str]
Time = Number | str


def _by_type(schema: dict[str, Any]) -> None:
    """Say in the JSON schema which entries each type of fault takes."""
    schema["allOf"] = [
        {
            "if": {"properties": {"type": {"const": kind.name}}, "required": ["type"]},
            "then": {
                "properties": {name: False for name in PARAMETERS if name not in kind.required + kind.optional},
                "required": list(kind.required),
            },
        }
        for kind in TYPES.values()
    ]


class FaultEntry(Table):
    """One fault: what fails, how, and when."""

    model_config = ConfigDict(json_schema_extra=_by_type)
    noun: ClassVar[str] = "fault"

    id: str = Field(description="name of the fault, unique in the file; also names its noise")
    target: str | Texts = Field(
        description="component.signal, an array for all its elements, or the bundle of a dropout; "
        "a list fails together, of one cause"
    )
    type: str = Field(
        description="; ".join(f"{kind.name} ({kind.target}): {kind.effect}" for kind in TYPES.values()),
        json_schema_extra={"enum": list(TYPES)},
    )
    start: Time = Field(0.0, description='when it begins: s, or a text such as "5 min"')
    duration: Time | None = Field(None, description="how long it lasts; default: to the end")
    value: Value | None = Field(
        None, description='value or bias in the target\'s unit, or a text such as "0.5 nmi"; or one for each element'
    )
    rate: Value | None = Field(None, description="drift in the target's unit per s, or one for each element")
    sigma: Value | None = Field(None, description="standard deviation of noise, or one for each element")
    period: Time | None = Field(None, description="time between two new numbers of noise")
    stream: int | None = Field(None, description="number of the noise stream; default: made from the id")
    fmea: str = Field("", description="row of the failure modes and effects analysis")
    description: str = Field("", description="what happens, in words")

    def parameters(self) -> dict[str, Any]:
        """What its type takes: the entries that are given and that not every fault has."""
        return {name: getattr(self, name) for name in PARAMETERS if getattr(self, name) is not None}


class FaultFile(Table):
    """A fault file of navfmu: what fails in a run."""

    description: str = Field("", description="what the faults are about")
    fault: list[FaultEntry] = Field([], description="the faults; on one signal they act in this order")
