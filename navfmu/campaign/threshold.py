"""What a search has found: the value at which a requirement begins to be violated, between two runs that show it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from navfmu.campaign.axis import texts
from navfmu.campaign.definition import Campaign
from navfmu.campaign.judged import Judged
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.runs import Run, runs_with
from navfmu.campaign.search import Bracket, Search


@dataclass(frozen=True)
class Sought:
    """A search in one variant with one seed."""

    campaign: Campaign
    search: Search
    variant: str
    seed: int

    def found(self, judge: Callable[[Run], Judged]) -> Threshold:
        """Search; ``judge`` flies a run, or finds it flown already."""
        requirement = next(r for r in self.campaign.requirements if r.id == self.search.requirement)
        probes: list[Judged] = []

        def holds(value: float) -> bool:
            run = next(runs_with(self.campaign, self.variant, self.search.at(value), [self.seed]))
            probes.append(judge(run))
            return probes[-1].holds(requirement)

        return Threshold(self, requirement, self.search.bracket(holds), tuple(probes))


@dataclass(frozen=True)
class Threshold:
    """The bracket of a search, and its runs."""

    sought: Sought
    requirement: Requirement
    bracket: Bracket
    probes: tuple[Judged, ...]

    @property
    def sentence(self) -> str:
        """What was found, in words."""
        axis, span = self.sought.search.axis, self.sought.search.span
        holds, violated = self.bracket.holds_at, self.bracket.violated_at
        if holds is not None and violated is not None:
            one, other = texts(axis, [holds, violated], 9)
            return f"holds at {axis.name} = {one}, is violated at {other}{self._silent}{self._unharmed(holds)}"
        what = "holds" if violated is None else "is violated"
        ends = " and at ".join(texts(axis, [span.low, span.high], 9))
        unharmed = self._unharmed(span.low, span.high) if violated is None else ""
        return f"{what} at both ends, {axis.name} = {ends}: nothing between them was looked at{self._silent}{unharmed}"

    @property
    def _silent(self) -> str:
        """What to say of runs that say nothing."""
        asked = [self.requirement.id in probe.findings or probe.error is not None for probe in self.probes]
        never = asked.count(False)
        return f"; in {never} of its {len(asked)} runs it could not be asked, which counts as violated" if never else ""

    def _unharmed(self, *values: float) -> str:
        """What to say of values at which it holds without a fault that does anything."""
        names = {self.sought.search.at(value).name: value for value in values}
        return "".join(
            f"; at {self.sought.search.axis.text(names[probe.run.case.name], 9)} fault '{fault}' {why}"
            for probe in self.probes
            if probe.run.case.name in names
            for fault, why in probe.answer.idle.items()
        )

    @property
    def idle(self) -> dict[str, str]:
        """Faults that changed nothing in any run, and why; at one end of a search a fault may."""
        every = [probe.answer.idle for probe in self.probes]
        return {name: why for name, why in every[-1].items() if all(name in idle for idle in every)}

    def row(self) -> dict[str, Any]:
        """As plain data."""
        sought = self.sought
        case, axis = sought.search.case, sought.search.axis
        values = sought.campaign.columns(case)
        values.pop(axis.heading)
        return {
            "variant": sought.variant,
            "case": case.name,
            **values,
            "seed": sought.seed,
            "requirement": self.requirement.id,
            "axis": axis.name,
            "unit": axis.unit,
            "holds_at": self.bracket.holds_at,
            "violated_at": self.bracket.violated_at,
            "tolerance": axis.goal.tolerance,
            "runs": len(self.probes),
            "runs_with_error": sum(probe.error is not None for probe in self.probes),
            "seen": self.sentence,
        }


def sought_in(campaign: Campaign) -> list[Sought]:
    """All searches of a campaign, in the order of its file."""
    return [
        Sought(campaign, search, variant, seed)
        for variant in campaign.systems
        for search in campaign.searches
        if campaign.searched(search, variant)
        for seed in campaign.seeds
    ]
