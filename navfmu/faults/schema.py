"""What may stand in a fault file; which type of fault takes what, ``types.TYPES`` says."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import ConfigDict, create_model

from navfmu.faults.fault import PARAMETERS, TIMES
from navfmu.faults.types import TIMING, TYPES
from navfmu.files.schema import Field, Number, Table, Texts

Value = Number | bool | str | list[Number | bool | str]
Time = Number | str
KINDS = {  # by the sort of a parameter, how it may be written; the others are values, or lists of them
    "time": Time,
    "delay": Time,
    "stream": int,
    "order": list[int],
    "unit": str,
    "not finite": Number | str,
    "positive": Number,
    "text": str,
    "expression": str,
}
LIMITS: dict[str, dict[str, Any]] = {  # what a schema says of numbers and texts of a sort
    "time": {"exclusiveMinimum": 0},
    "delay": {"minimum": 0},
    "positive": {"exclusiveMinimum": 0},
    "unit": {"minLength": 1},
    "text": {"minLength": 1},
    "expression": {"minLength": 1},
}


def _rules(schema: dict[str, Any]) -> None:
    """Say in the JSON schema which entries each type of fault takes, and which times go together."""
    _by_type(schema)
    for timing in TIMING:
        name = timing.parameter.name
        if timing.needs:
            beside = {"anyOf": [{"required": [other]} for other in timing.needs]}
            schema["allOf"].append({"if": {"required": [name]}, "then": beside})
        schema["allOf"] += [{"not": {"required": [name, other]}} for other in timing.excludes]


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


def _words(name: str) -> str:
    """What a parameter is, for each type that takes it."""
    said: dict[str, list[str]] = {}
    for kind in TYPES.values():
        for parameter in kind.parameters:
            if parameter.name == name:
                said.setdefault(parameter.words, []).append(kind.name)
    return "; ".join(f"{', '.join(kinds)}: {words}" for words, kinds in said.items())


class _Entry(Table):
    """One fault: what fails, how, and when."""

    model_config = ConfigDict(json_schema_extra=_rules)
    noun: ClassVar[str] = "fault"

    id: str = Field(description="name of the fault, unique in the file; also names its random numbers")
    target: str | Texts = Field(
        description="component.signal, an array for all its elements, a bundle for all its members; of a lost step the "
        "component; a list fails together, of one cause"
    )
    type: str = Field(
        description="; ".join(f"{kind.name} ({kind.target}): {kind.effect}" for kind in TYPES.values()),
        json_schema_extra={"enum": list(TYPES)},
    )
    start: Time = Field(
        0.0, description='when it begins: s, or a text such as "5 min"', json_schema_extra=LIMITS["delay"]
    )
    duration: Time | None = Field(
        None, description="how long it lasts; default: to the end", json_schema_extra=LIMITS["time"]
    )
    fmea: str = Field("", description="row of the failure modes and effects analysis")
    description: str = Field("", description="what happens, in words")

    def parameters(self) -> dict[str, Any]:
        """What its type and its times take: the entries that are given and that not every fault has."""
        return {name: getattr(self, name) for name in PARAMETERS | TIMES if getattr(self, name) is not None}


FaultEntry = create_model(
    "FaultEntry",
    __base__=_Entry,
    __doc__=_Entry.__doc__,
    **{
        name: (
            KINDS.get(parameter.sort, Value) | None,
            Field(None, description=_words(name) or parameter.words, json_schema_extra=LIMITS.get(parameter.sort)),
        )
        for name, parameter in (PARAMETERS | TIMES).items()
    },
)


class FaultFile(Table):
    """A fault file of navfmu: what fails in a run."""

    description: str = Field("", description="what the faults are about")
    fault: list[FaultEntry] = Field([], description="the faults; on one signal they act in this order")  # type: ignore[valid-type]
