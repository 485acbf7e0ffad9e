"""One fault, and the table of fault types."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import Any

from navfmu.errors import NavfmuError, nearest


@dataclass(frozen=True)
class FaultType:
    """What a type of fault acts on and which parameters it takes."""

    name: str
    target: str
    required: tuple[str, ...]
    optional: tuple[str, ...]
    effect: str


TYPES: dict[str, FaultType] = {
    entry.name: entry
    for entry in (
        FaultType("bias", "Real output", ("value",), (), "value + bias"),
        FaultType("drift", "Real output", ("rate",), (), "value + rate * (t - start)"),
        FaultType("stuck", "output", (), ("value",), "the given value, or the last one that left before the start"),
        FaultType("dropout", "output bundle", (), (), "valid is false; sequence and values are held"),
        FaultType(
            "noise",
            "Real output",
            ("sigma", "period"),
            ("stream",),
            "value + sigma * (normal number drawn anew every period)",
        ),
        FaultType("input", "unconnected input", (), ("value",), "the input has the value (a Boolean input: true)"),
        FaultType("parameter", "tunable parameter", ("value",), (), "the parameter has the value"),
    )
}

PARAMETERS = tuple(dict.fromkeys(name for kind in TYPES.values() for name in kind.required + kind.optional))
COMMON = ("id", "fmea", "target", "type", "start", "duration", "description")


@dataclass(frozen=True)
class Fault:
    """A fault of one target during start <= t < start + duration (s), counted in communication points.

    ``target`` is "component.signal", "component.array" (all its elements) or, for a dropout, "component.bundle".
    Parameters are in the SI unit of the target; a list gives one value for each element of an array.
    """

    id: str
    target: str
    type: str
    start: float = 0.0
    duration: float = math.inf
    parameters: dict[str, Any] = field(default_factory=dict)
    fmea: str = ""
    description: str = ""
    where: str = ""  # "faults.toml, line 12", for messages
    file: str = ""  # as the command line takes it, where the fault is from one

    def __post_init__(self) -> None:
        if not self.id or not isinstance(self.id, str):
            raise self.error("'id' must be a text that is not empty", "id")
        if not isinstance(self.target, str) or "." not in self.target:
            raise self.error(f"'target' must be written component.signal, not {self.target!r}", "target")
        if self.type not in TYPES:
            known = ", ".join(TYPES)
            raise self.error(f"unknown type {self.type!r}{nearest(str(self.type), TYPES)} (types: {known})", "type")
        if not is_number(self.start) or self.start < 0 or not math.isfinite(self.start):
            raise self.error(f"'start' must be a time in s, 0 or later, not {self.start!r}", "start")
        if not is_number(self.duration) or not self.duration > 0:
            raise self.error(f"'duration' must be a positive time in s, not {self.duration!r}", "duration")
        kind = TYPES[self.type]
        allowed = kind.required + kind.optional
        for name in self.parameters:
            if name not in allowed:
                takes = ", ".join(allowed) or "no parameters"
                hint = "" if name in PARAMETERS else nearest(name, (*allowed, *COMMON))
                raise self.error(f"type '{self.type}' has no parameter '{name}'{hint} (it takes {takes})", name)
        for name in kind.required:
            if name not in self.parameters:
                raise self.error(f"type '{self.type}' needs the parameter '{name}'", "type")
        for name in ("period",):
            value = self.parameters.get(name)
            if value is not None and not (is_number(value) and 0 < value < math.inf):
                raise self.error(f"'{name}' must be a positive time in s, not {value!r}", name)
        stream = self.parameters.get("stream", 0)
        if isinstance(stream, bool) or not isinstance(stream, int) or not 0 <= stream < 2**31:
            raise self.error(f"'stream' must be a whole number from 0 to 2147483647, not {stream!r}", "stream")

    def describe(self) -> dict[str, Any]:
        """The fault as plain data; what is not limited (its duration) or empty is left out."""
        entries: dict[str, Any] = {"id": self.id, "target": self.target, "type": self.type, "start": self.start}
        if self.duration != math.inf:
            entries["duration"] = self.duration
        for name in ("fmea", "description", "file"):
            if getattr(self, name):
                entries[name] = getattr(self, name)
        values = {key: value.tolist() if hasattr(value, "tolist") else value for key, value in self.parameters.items()}
        return entries | values

    @classmethod
    def of(cls, description: Mapping[str, Any]) -> Fault:
        """The fault of a description."""
        own = {name: description[name] for name in (*COMMON, "file") if name in description}
        return cls(**own, parameters={name: value for name, value in description.items() if name not in own})

    def inline(self) -> str:
        """The fault as the option ``--fault`` takes it: the inside of a TOML table."""
        return ", ".join(f"{key} = {_toml(value)}" for key, value in self.describe().items())

    def error(self, sentence: str, key: str = "") -> FaultError:
        """The sentence with the fault's id and place in its file."""
        return FaultError(self.id if isinstance(self.id, str) else "", self.where, sentence, key)


class FaultError(NavfmuError):
    """A fault that cannot be; remembers the key at which the file went wrong."""

    def __init__(self, fault: str, where: str, sentence: str, key: str) -> None:
        name = f"fault '{fault}'" if fault else "a fault"
        super().__init__(f"{where}: {name}: {sentence}" if where else f"{name}: {sentence}")
        self.fault, self.sentence, self.key = fault, sentence, key


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_toml(item) for item in value)}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)


def is_number(value: object) -> bool:
    """True for a real number, also one of NumPy, that is not a Boolean and not NaN."""
    return isinstance(value, Real) and not isinstance(value, bool) and not math.isnan(value)
