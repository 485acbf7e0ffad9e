"""What an axis can vary: an entry of a fault, a parameter of the system, the step."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from navfmu.campaign.case import Case
from navfmu.errors import NavfmuError, nearest
from navfmu.faults import Fault
from navfmu.fmi.seconds import seconds

WRITTEN = "'fault.ID.ENTRY', 'parameter.COMPONENT.NAME' or 'step'"
_FAULT = re.compile(r"fault\.(?P<fault>.+)\.(?P<entry>[^.\[\]]+)(?:\[(?P<element>\d+)\])?", re.DOTALL)
_PARAMETER = re.compile(r"parameter\.(?P<name>[^.]+\..+)", re.DOTALL)
_NAMES = ("id", "target", "type", "fmea", "description", "file")  # entries of a fault that are no values of it


class Varied(Protocol):
    """A place in a case at which a value can be laid."""

    @property
    def name(self) -> str:
        """It as people call it."""

    def is_in(self, case: Case) -> bool:
        """Whether the case has it."""

    def laid(self, case: Case, value: Any) -> Case:
        """The case with another value there."""

    def is_quoted(self, sentence: str) -> bool:
        """Whether a sentence about a plan speaks of it."""


@dataclass(frozen=True)
class FaultEntry:
    """An entry of a fault, or one element of an entry that is a list (counted from 1)."""

    fault: str
    entry: str
    element: int | None = None

    @property
    def name(self) -> str:
        return f"{self.fault}.{self.entry}" + ("" if self.element is None else f"[{self.element}]")

    def is_in(self, case: Case) -> bool:
        return any(fault.id == self.fault for fault in case.faults)

    def laid(self, case: Case, value: Any) -> Case:
        return replace(case, faults=tuple(self._laid(f, value) if f.id == self.fault else f for f in case.faults))

    def _laid(self, fault: Fault, value: Any) -> Fault:
        entries = fault.describe()
        entries.pop("file", None)  # it is not in that file any more
        if self.element is not None:
            there = entries.get(self.entry)
            if not isinstance(there, list) or not 1 <= self.element <= len(there):
                has = f"has {len(there)} elements" if isinstance(there, list) else "is no list"
                raise NavfmuError(f"fault '{self.fault}': '{self.entry}' {has}: there is no element {self.element}")
            value = [*there[: self.element - 1], value, *there[self.element :]]
        return replace(Fault.of(entries | {self.entry: value}), where=fault.where, lines=fault.lines)

    def is_quoted(self, sentence: str) -> bool:
        return f"fault '{self.fault}'" in sentence


@dataclass(frozen=True)
class Parameter:
    """A parameter, by "component.parameter"."""

    name: str

    def is_in(self, case: Case) -> bool:
        return True

    def laid(self, case: Case, value: Any) -> Case:
        others = {name: given for name, given in case.parameters.items() if name != self.name}
        return replace(case, parameters=others | {self.name: value})  # the last one holds

    def is_quoted(self, sentence: str) -> bool:
        return f"parameter '{self.name}'" in sentence


@dataclass(frozen=True)
class Step:
    """The communication step size, s."""

    name: str = "step"

    def is_in(self, case: Case) -> bool:
        return True

    def laid(self, case: Case, value: Any) -> Case:
        return replace(case, step=seconds(value, "the step"))

    def is_quoted(self, sentence: str) -> bool:
        return " step " in sentence


def varied_of(text: str, faults: Iterable[str]) -> Varied:
    """What a text such as "fault.gps_drift.rate" names; ``faults`` are the ids of those that there are."""
    if text == "step":
        return Step()
    if found := _PARAMETER.fullmatch(text):
        return Parameter(found["name"])
    found = _FAULT.fullmatch(text)
    if found is None:
        hint = f"; did you mean 'parameter.{text}'?" if re.fullmatch(r"(?!fault\.|parameter\.)[^.]+\..+", text) else ""
        raise NavfmuError(f"is '{text}', expected {WRITTEN}{hint}")
    if found["fault"] not in (known := list(dict.fromkeys(faults))):
        have = nearest(found["fault"], known) or (f" (there are: {', '.join(known)})" if known else " (none has any)")
        raise NavfmuError(f"is '{text}': no case of this axis has a fault '{found['fault']}'{have}")
    if found["entry"] in _NAMES:
        raise NavfmuError(f"is '{text}': '{found['entry']}' of a fault is no value that can vary")
    return FaultEntry(found["fault"], found["entry"], None if found["element"] is None else int(found["element"]))
