"""What was injected in one case of a campaign, what was seen, and which signs came up, from its runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evidence.failures.lines import Line, Lines
from navfmu.campaign.case import Case
from navfmu.campaign.outcome import Judged, Outcome
from navfmu.campaign.requirement import MAIN, Requirement
from navfmu.faults import Fault

FROM = 900.0
"""Time from which errors are looked at, s: that at which nearly all failures begin."""
AXES = ("north", "east")
SIGNALS = [f"evaluation.{a}_error" for a in AXES] + [f"navigator.{a}_sigma" for a in AXES]
LIMIT = 3.0
"""How many of its own sigmas an error may have."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """What one run says. Times are in s; errors are those at the recorded points from ``FROM`` on."""

    seed: int
    harmed: bool  # because of the failure the bound or the claim is not kept for as long as is asked
    signs: Mapping[str, float]  # those that came up because of the failure, and when, counted from the onset
    time: np.ndarray
    error: np.ndarray  # m, horizontal
    normalised: np.ndarray  # sum of the squares of north and east error over their sigmas
    inside: np.ndarray

    def first(self, among: Sequence[str]) -> float:
        """When the first of some signs came up; infinity: none did."""
        return min((time for sign, time in self.signs.items() if sign in among), default=np.inf)

    def misled(self, onset: float) -> float:
        """How long the error was outside of the claim with no sign having come up, s."""
        step = self.time[1] - self.time[0]
        unseen = self.time < onset + self.first(list(self.signs))
        return float(step * np.count_nonzero(~self.inside & unseen & (self.time >= onset)))


@dataclass(frozen=True, eq=False)
class Injection:
    """A case, the faults that are its own, and its runs."""

    case: Case
    variant: str
    faults: tuple[Fault, ...]
    reference: str  # the case with which it is compared
    lines: tuple[str, ...]
    onset: float  # s
    sightings: tuple[Sighting, ...]
    failed: int  # runs that ended with an error
    asked: tuple[str, ...]  # signs that are looked for
    own: tuple[str, ...]  # those of them that look at the navigator alone

    @property
    def name(self) -> str:
        """The id of its fault, or the name of its case; and the variant that is flown, unless it is the base system."""
        name = self.faults[0].id if len(self.faults) == 1 else self.case.name
        return name if self.variant == MAIN else f"{name} ({self.variant})"

    @property
    def words(self) -> str:
        """What happens."""
        return ", ".join(fault.description for fault in self.faults) or self.case.description

    @property
    def runs(self) -> int:
        """How many there are that ended well."""
        return len(self.sightings)

    @property
    def noticed(self) -> int:
        """Runs in which any sign came up."""
        return sum(bool(each.signs) for each in self.sightings)

    def showing(self, sign: str) -> int:
        """Runs in which a sign came up."""
        return sum(sign in each.signs for each in self.sightings)

    @property
    def noticed_itself(self) -> int:
        """Runs in which one came up that looks at the navigator alone."""
        return sum(np.isfinite(each.first(self.own)) for each in self.sightings)

    @property
    def harmed(self) -> int:
        """Runs in which the bound or the claim was not kept."""
        return sum(each.harmed for each in self.sightings)

    @property
    def harmed_unseen(self) -> int:
        """Those of them in which no sign came up."""
        return sum(each.harmed and not each.signs for each in self.sightings)

    @cached_property
    def delays(self) -> np.ndarray:
        """Times from the onset to the first sign, s, of the runs with one."""
        return np.array(sorted(each.first(list(each.signs)) for each in self.sightings if each.signs))

    @cached_property
    def misled(self) -> np.ndarray:
        """How long each run was outside of its claim with no sign, s."""
        return np.array([each.misled(self.onset) for each in self.sightings])

    @property
    def firsts(self) -> list[str]:
        """Signs that came up first in a run, the most frequent ones first."""
        first = [min(each.signs, key=each.signs.__getitem__) for each in self.sightings if each.signs]
        return sorted(dict.fromkeys(first), key=lambda sign: -first.count(sign))

    @cached_property
    def error(self) -> np.ndarray:
        """All errors of all runs, m; infinite where there is no number."""
        every = np.concatenate([each.error for each in self.sightings])
        return np.where(np.isnan(every), np.inf, every)

    @property
    def percentile(self) -> float:
        """95 % of the errors are up to this, m."""
        return float(np.quantile(self.error, 0.95, method="higher"))

    @property
    def largest(self) -> float:
        """The largest error, m."""
        return float(np.max(self.error))

    @property
    def inside(self) -> float:
        """Share of the points inside of the claim, percent."""
        return float(100.0 * np.mean(np.concatenate([each.inside for each in self.sightings])))

    @property
    def nees(self) -> float:
        """Mean normalised squared error: 2 for an honest filter."""
        return float(np.mean(np.concatenate([each.normalised for each in self.sightings])))


def signs_of(requirements: Sequence[Requirement]) -> dict[str, Requirement]:
    """The requirements that are signs: they count how often something comes up."""
    return {requirement.id: requirement for requirement in requirements if requirement.kind == "events"}


def itself(sign: Requirement) -> bool:
    """Whether a sign looks at outputs of the navigator alone."""
    return all(signal.startswith("navigator.") for signal in sign.signals)


def injections(outcome: Outcome, lines: Lines) -> list[Injection]:
    """Every case of the campaign; the references come first."""
    named = {case.name: case for case in outcome.campaign.cases}
    references = [named[name] for name in lines.references if name in named]
    others = [case for case in named.values() if case not in references]
    return [_injection(outcome, lines, case, references) for case in (*references, *others)]


def _injection(outcome: Outcome, lines: Lines, case: Case, references: Sequence[Case]) -> Injection:
    """A sign counts if the flight without the failure, with the same seed, does not show it; and so does harm."""
    (variant,) = outcome.campaign.systems
    reference = reference_of(case, references)
    common = {fault.id for fault in reference.faults}
    own = tuple(fault for fault in case.faults if fault.id not in common)
    signs = {n: s for n, s in signs_of(outcome.campaign.requirements).items() if s.applies(variant, case)}
    first = min(sign.start for sign in signs.values())
    onset = max(min((fault.start for fault in own), default=0.0), first)
    every = [judged for judged in outcome.of(variant, case.name) if judged.error is None]
    twins = {} if case is reference else {j.run.seed: j for j in outcome.of(variant, reference.name)}
    return Injection(
        case,
        variant,
        own,
        reference.name,
        tuple(line.number for line in lines.line if _belongs(line, case, own)),
        onset,
        tuple(_sighting(outcome, judged, twins.get(judged.run.seed), signs, onset) for judged in every),
        len(outcome.of(variant, case.name)) - len(every),
        tuple(signs),
        tuple(name for name, sign in signs.items() if itself(sign)),
    )


def reference_of(case: Case, references: Sequence[Case]) -> Case:
    """The one of the references with which a case has most faults and parameters in common, and that has no others."""
    return max((each for each in references if _within(each, case)), key=_count)


def _within(reference: Case, case: Case) -> bool:
    faults = {fault.id for fault in reference.faults} <= {fault.id for fault in case.faults}
    return faults and all(case.parameters.get(name) == value for name, value in reference.parameters.items())


def _count(case: Case) -> int:
    return len(case.faults) + len(case.parameters)


def _belongs(line: Line, case: Case, own: Sequence[Fault]) -> bool:
    return case.name in line.cases or any(fault.fmea == line.number for fault in own)


def _came(judged: Judged, signs: Mapping[str, Requirement]) -> dict[str, float]:
    """Which signs came up in a run, and when (s): once they have lasted for longer than is tolerated."""
    found = {}
    for name, sign in signs.items():
        finding = judged.findings.get(name)
        if finding is not None and finding.first_violation is not None:
            found[name] = finding.first_violation + sign.tolerance
    return found


def _harmed(judged: Judged, signs: Mapping[str, Requirement]) -> bool:
    """Whether the bound or the claim is not kept: what is asked beside the signs."""
    return not all(finding.held for name, finding in judged.findings.items() if name not in signs)


def _sighting(
    outcome: Outcome, judged: Judged, twin: Judged | None, signs: Mapping[str, Requirement], onset: float
) -> Sighting:
    anyway = {} if twin is None else _came(twin, signs)
    series = outcome.series(judged, SIGNALS)
    late = series["time"] >= FROM
    errors = np.array([series[f"evaluation.{axis}_error"][late] for axis in AXES])
    sigmas = np.array([series[f"navigator.{axis}_sigma"][late] for axis in AXES])
    return Sighting(
        judged.run.seed,
        _harmed(judged, signs) and not (twin is not None and _harmed(twin, signs)),
        {sign: time - onset for sign, time in _came(judged, signs).items() if sign not in anyway},
        series["time"][late],
        np.hypot(*errors),
        np.sum((errors / sigmas) ** 2, axis=0),
        np.all(np.abs(errors) <= LIMIT * sigmas, axis=0),
    )
