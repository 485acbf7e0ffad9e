"""What a campaign is: a system's variants, the cases that are done to them, seeds and requirements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.campaign.axis import Axis
from navfmu.campaign.case import Case
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.search import Search
from navfmu.system.system import System


@dataclass(frozen=True)
class Campaign:
    """A campaign file, checked against its system."""

    name: str
    path: Path
    description: str
    system: Path
    systems: dict[str, System]  # by variant
    cases: tuple[Case, ...]
    seeds: tuple[int, ...]
    stop: float
    step: float
    algorithm: str
    parameters: dict[str, Any]
    record: tuple[str, ...]
    record_period: float | None
    requirements: tuple[Requirement, ...]
    axes: tuple[Axis, ...] = ()
    searches: tuple[Search, ...] = ()

    @property
    def size(self) -> int:
        """How many runs it has; with searches, at most."""
        cases = len(self.cases) + sum(search.most for search in self.searches)
        return len(self.systems) * cases * len(self.seeds)

    def searched(self, search: Search, variant: str) -> bool:
        """Whether a variant is searched: one that the requirement is asked of."""
        requirement = next(r for r in self.requirements if r.id == search.requirement)
        return requirement.applies(variant, search.case)

    @property
    def steps(self) -> tuple[float, ...]:
        """The step sizes of its runs, s."""
        cases = *self.cases, *(search.case for search in self.searches)
        return tuple(sorted({self.step if case.step is None else case.step for case in cases}))

    def columns(self, case: Case) -> dict[str, float | str | bool | None]:
        """What a table says of a case beside its name: the value of each axis, None where it does not vary it."""
        return {axis.heading: case.values.get(axis.name) for axis in self.axes}
