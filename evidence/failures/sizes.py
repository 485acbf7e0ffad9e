"""Failures in several sizes: from which on one does harm, and from which on it is noticed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from evidence.failures.injection import Injection, injections
from evidence.failures.lines import Lines
from navfmu.campaign import Campaign, Outcome
from navfmu.campaign.case import Case
from navfmu.faults import Fault
from navfmu.files.schema import Field, Number, Table, validated
from navfmu.files.toml import Document

TIMES = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0]
MAGNITUDES = ("value", "rate", "sigma")
"""Entries of a fault that are its size."""


class Size(Table):
    """A failure that is flown in several sizes."""

    failure: str = Field(min_length=1, description="id of its fault or name of its case")
    parameter: str = Field("", description="parameter of the case that is its size; default: what its fault has")
    base: Number | list[Number] | None = Field(None, description="value of the parameter where the case has none")
    unit: str = Field(min_length=1, description="unit in which sizes are told")
    one: Number = Field(1.0, description="how much one of that unit is of what the failure is written in")
    times: list[Number] = Field(TIMES, description="what the size as injected is multiplied with")


class Sizes(Table):
    """The file."""

    seeds: int = Field(ge=1, description="of the campaign's seeds how many are flown")
    size: list[Size] = Field(description="the failures")


def load_sizes(path: Path) -> Sizes:
    """The sizes of a file."""
    return validated(Document.read(path, "file of sizes of failures"), Sizes)


def scaled(value: Any, times: float) -> Any:
    """A value of a fault or a parameter, a number, a text with a unit or a list of these, so many times as large."""
    if isinstance(value, str):
        number, _, unit = value.partition(" ")
        return f"{float(number) * times!r} {unit}"
    return [scaled(each, times) for each in value] if isinstance(value, list | tuple) else value * times


def told(value: Any, one: float) -> str:
    """The size of such a value: that of its largest element, without its unit."""
    if isinstance(value, list | tuple):
        return max((told(each, one) for each in value), key=lambda text: abs(float(text)))
    number = float(value.partition(" ")[0]) if isinstance(value, str) else value
    return f"{abs(number) / one:.4g}"


def _fault(fault: Fault, times: float) -> Fault:
    parameters = {n: scaled(v, times) if n in MAGNITUDES else v for n, v in fault.parameters.items()}
    return Fault(
        fault.id, fault.target, fault.type, fault.start, fault.duration, parameters, fault.fmea, fault.description
    )


@dataclass(frozen=True)
class Sized:
    """A failure of a campaign, and the cases in which it has its sizes."""

    size: Size
    case: Case
    own: tuple[str, ...]  # ids of its faults

    @property
    def base(self) -> Any:
        """Its size as injected."""
        if self.size.parameter:
            return self.case.parameters.get(self.size.parameter, self.size.base)
        (fault,) = (fault for fault in self.case.faults if fault.id in self.own)
        return next(fault.parameters[name] for name in MAGNITUDES if name in fault.parameters)

    @property
    def told(self) -> list[str]:
        """Its sizes, in their unit."""
        return [told(scaled(self.base, times), self.size.one) for times in self.size.times]

    @property
    def cases(self) -> list[Case]:
        """What is flown."""
        return [self._at(times) for times in self.size.times]

    def _at(self, times: float) -> Case:
        name, size = f"{self.case.name} x {times:g}", self.size.parameter
        if size:
            return replace(self.case, name=name, parameters={**self.case.parameters, size: scaled(self.base, times)})
        faults = tuple(_fault(f, times) if f.id in self.own else f for f in self.case.faults)
        return replace(self.case, name=name, faults=faults)


def sized(outcome: Outcome, lines: Lines, sizes: Sizes) -> list[Sized]:
    """Those failures of a campaign that was flown which are flown in sizes."""
    named = {each.name: each for each in injections(outcome, lines)}
    return [
        Sized(size, named[size.failure].case, tuple(fault.id for fault in named[size.failure].faults))
        for size in sizes.size
        if size.failure in named
    ]


def campaign_of(campaign: Campaign, lines: Lines, found: Sequence[Sized], seeds: int) -> Campaign:
    """The flights: those without a failure, and each failure in each size, with the first seeds."""
    references = [case for case in campaign.cases if case.name in lines.references]
    cases = (*references, *(case for each in found for case in each.cases))
    return replace(campaign, cases=cases, seeds=campaign.seeds[:seeds])


def row(each: Sized, found: Sequence[Injection]) -> list[str]:
    """Failure, sizes, flights, those with harm, with a sign, with harm and no sign; and from where on most of them."""
    flown = [next(i for i in found if i.case.name == case.name) for case in each.cases]
    unit = each.size.unit
    harmed, noticed = [i.harmed for i in flown], [i.noticed for i in flown]

    def most(counts: Sequence[int]) -> str:
        return next((f"{t} {unit}" for t, n, i in zip(each.told, counts, flown, strict=True) if 2 * n > i.runs), "-")

    return [
        each.size.failure,
        f"{', '.join(each.told)} {unit}",
        f"{flown[0].runs}",
        *(", ".join(map(str, counts)) for counts in (harmed, noticed, [i.harmed_unseen for i in flown])),
        most(harmed),
        most(noticed),
    ]
