"""What a campaign found: a finding for each run and requirement, and a verdict for each cell of the matrix."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from navfmu.campaign.finding import Finding, enough
from navfmu.campaign.judged import Judged, judge_run, read_series
from navfmu.campaign.question import told
from navfmu.campaign.remarks import SAME, remarks
from navfmu.campaign.requirement import Requirement, wilson
from navfmu.campaign.threshold import Threshold

if TYPE_CHECKING:
    from navfmu.campaign.case import Case
    from navfmu.campaign.definition import Campaign
    from navfmu.campaign.runs import Answer, Run


@dataclass(frozen=True)
class Cell:
    """A requirement, asked of a variant in a case."""

    requirement: Requirement
    variant: str
    case: str
    passed: bool
    held: int  # runs that hold (or are violated, where that is expected)
    total: int
    sentence: str
    worst: Judged | None
    distinct: int  # runs that can differ: 1 where the seed changes nothing

    @property
    def verdict(self) -> str:
        """In a word: "holds", "violated", or "no answer" where it could be asked in no run."""
        return "holds" if self.passed else "violated" if self.total else "no answer"

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the share of runs that hold, in percent: from those that can differ."""
        return wilson(self.held * self.distinct // max(self.total, 1), self.distinct)

    @property
    def rank(self) -> tuple[bool, float, float]:
        """Sorts the worst first: violated, by the share of runs that hold, by the time the worst run is inside."""
        finding = None if self.worst is None else self.worst.findings.get(self.requirement.id)
        return self.passed, self.held / max(self.total, 1), 0.0 if finding is None else finding.percent


@dataclass(frozen=True)
class Outcome:
    """A judged campaign. ``folder`` holds the recordings."""

    campaign: Campaign
    folder: Path
    runs: list[Judged]
    cells: list[Cell]
    mended: tuple[str, ...] = ()  # files of earlier runs that were damaged, and so flown again
    thresholds: tuple[Threshold, ...] = ()  # of searches, whose runs are not among ``runs``

    @property
    def passed(self) -> bool:
        """Whether every requirement holds everywhere, every run ended well, every number is one, every fault acted."""
        ended_well = not any(j.error or j.answer.not_finite for j in self.every)
        return ended_well and not self.idle and all(cell.passed for cell in self.cells)

    @functools.cached_property
    def every(self) -> list[Judged]:
        """All runs, those of searches last."""
        return [*self.runs, *(probe for threshold in self.thresholds for probe in threshold.probes)]

    @property
    def notes(self) -> dict[str, int]:
        """What the runs noted, each sentence with the number of runs that did, and remarks on the campaign."""
        return dict(Counter(note for judged in self.every for note in judged.answer.notes)) | self.remarks

    @property
    def remarks(self) -> dict[str, int]:
        """What is to be said of the campaign itself, each sentence with the number of runs that it concerns."""
        return dict(Counter(remark for judged in self.every for remark in judged.remarks))

    @property
    def idle(self) -> dict[tuple[str, str, str, str], list[int]]:
        """Faults that changed nothing: (variant, case, fault, why), with the seeds."""
        found: dict[tuple[str, str, str, str], list[int]] = {}
        for judged in self.runs:
            for fault, why in judged.answer.idle.items():
                found.setdefault((judged.run.variant, judged.run.case.name, fault, why), []).append(judged.run.seed)
        for threshold in self.thresholds:
            sought = threshold.sought
            for fault, why in threshold.idle.items():
                found.setdefault((sought.variant, sought.search.case.name, fault, why), []).append(sought.seed)
        return found

    @property
    def report(self) -> Path:
        """The report's file."""
        return self.folder / "report.html"

    def of(self, variant: str, case: str) -> list[Judged]:
        """The runs of a variant in a case."""
        return self._groups.get((variant, case), [])

    @functools.cached_property
    def _groups(self) -> dict[tuple[str, str], list[Judged]]:
        return grouped(self.runs)

    def series(self, judged: Judged, signals: Sequence[str]) -> dict[str, np.ndarray]:
        """Recorded signals of a run, with "time"; those it does not have are left out."""
        return read_series(judged.run.recording(self.folder), signals)

    def table(self) -> list[dict[str, Any]]:
        """One row for each run and requirement."""
        rows = []
        for judged in self.every:
            head = {"variant": judged.run.variant, "case": judged.run.case.name}
            head |= self.campaign.columns(judged.run.case) | {"seed": judged.run.seed, "first_onset": judged.onset}
            tail = {
                "error": judged.error or "",
                "not_finite": " ".join(judged.answer.not_finite),
                "idle": " | ".join(f"{fault} {why}" for fault, why in judged.answer.idle.items()),
                "notes": " | ".join(judged.notes),
                "recording": f"runs/{judged.answer.recording}" if judged.answer.recording else "",
            }
            for requirement, finding in judged.findings.items():
                latency = {"latency": judged.latency(finding)}
                rows.append(head | {"requirement": requirement} | finding.row() | latency | tail)
            if not judged.findings:
                nothing = dict.fromkeys(field.name for field in fields(Finding))
                rows.append(head | {"requirement": ""} | nothing | {"latency": None} | tail)
        return rows


def evaluate(
    campaign: Campaign,
    runs: list[Run],
    answers: dict[str, Answer],
    folder: Path,
    mended: tuple[str, ...] = (),
    thresholds: Sequence[Threshold] = (),
) -> Outcome:
    """Judge the kept recordings; requirements may have changed since they were made."""
    judged = remarked(campaign, [judge_run(campaign, run, answers[run.key]) for run in runs])
    found = [replace(one, probes=tuple(remarked(campaign, list(one.probes)))) for one in thresholds]
    groups, cells = grouped(judged), []
    for variant in campaign.systems:
        for case in campaign.cases:
            group = groups[variant, case.name]
            for requirement in campaign.requirements:
                if requirement.applies(variant, case):
                    cells.append(_cell(requirement, variant, case, group, folder))
    return Outcome(campaign, folder, judged, cells, mended, tuple(found))


def remarked(campaign: Campaign, judged: list[Judged]) -> list[Judged]:
    """The runs with what is to be said of the campaign itself."""
    said = remarks(campaign, [one.run for one in judged])
    return [replace(one, remarks=sentences) for one, sentences in zip(judged, said, strict=True)]


def grouped(runs: Sequence[Judged]) -> dict[tuple[str, str], list[Judged]]:
    """The runs of each variant and case."""
    groups: dict[tuple[str, str], list[Judged]] = {}
    for judged in runs:
        groups.setdefault((judged.run.variant, judged.run.case.name), []).append(judged)
    return groups


def _cell(requirement: Requirement, variant: str, case: Case, group: list[Judged], folder: Path) -> Cell:
    if requirement.quantile is not None:
        return _quantile_cell(requirement, variant, case, group, folder)
    found = [(j, j.findings[requirement.id]) for j in group if requirement.id in j.findings]
    held = sum(finding.held != requirement.expect_violated for j, finding in found if not j.answer.idle)
    question = requirement.question
    counted = group
    if question.of_faults:  # a run that has ended in time, or without its fault, says nothing
        counted = [j for j in group if j.error is not None or requirement.id in j.findings]
    total = len(counted)
    passed = total > 0 and enough(100.0 * held / total, requirement.runs)
    worst = max(found, key=lambda pair: question.badness(requirement, pair[1]), default=(None, None))
    what = "violated, as expected, in" if requirement.expect_violated else "held in"
    sentence = f"{what} {held} of {total} runs"
    finding = worst[1]
    if finding is not None and (requirement.unit or finding.first_violation is not None or finding.missing):
        seen = question.at_worst(requirement, finding), question.share(finding), question.first(finding)
        sentence += f"; worst: {', '.join(filter(None, (f'seed {worst[0].run.seed}', *seen)))}"
    never = sum(j.error is None for j in group) - len(found)
    silent = "it could not be asked" if question.of_faults else "it was never asked, which counts as not held"
    sentence += f"; in {never} {silent}" if never else ""
    sentence += _ends(group, sum(finding.missing > 0 for _, finding in found))
    return Cell(requirement, variant, case.name, passed, held, total, sentence, worst[0], _distinct(counted))


def _ends(group: list[Judged], early: int) -> str:
    """What to say of runs that are not whole: "; 1 ended with an error; 2 ended before all points were reached"."""
    failed, idle = sum(j.error is not None for j in group), sum(bool(j.answer.idle) for j in group)
    sentence = f"; {failed} ended with an error" if failed else ""
    sentence += "; all are one run, and the interval is that of one" if _distinct(group) < len(group) else ""
    sentence += f"; in {idle} a fault changed nothing, which counts as not held" if idle else ""
    return sentence + (f"; {early} ended before all points were reached" if early else "")


def _distinct(group: list[Judged]) -> int:
    """The number of runs that can differ."""
    return 1 if any(SAME in judged.remarks for judged in group) else len(group)


def _quantile_cell(requirement: Requirement, variant: str, case: Case, group: list[Judged], folder: Path) -> Cell:
    """A quantile over the runs at every time."""
    good = [j for j in group if j.error is None]
    rows = [read_series(j.run.recording(folder), requirement.signals) for j in good]
    if not rows:
        sentence = "every run ended with an error"
        return Cell(requirement, variant, case.name, False, 0, len(group), sentence, None, _distinct(group))
    points = good[0].run.experiment.points  # of one step: that of the case
    window = requirement.window(points)
    values = np.full((len(rows), len(points)), np.nan)  # a run that ended early is outside from then on
    for number, row in enumerate(rows):
        values[number, : len(row["time"])] = requirement.values(row)
    found = judge_quantile(requirement, points[window], values[:, window])
    passed = found.passed and len(good) == len(group) and not any(j.answer.idle for j in group)
    early = sum(j.findings[requirement.id].missing > 0 for j in good)
    sentence = found.sentence + _ends(group, early)
    worst, distinct = good[found.most_wrong], _distinct(group)
    return Cell(requirement, variant, case.name, passed, found.held, len(group), sentence, worst, distinct)


@dataclass(frozen=True)
class QuantileFinding:
    """What all runs together say about a requirement on a quantile."""

    passed: bool
    held: int  # runs inside at the worst time
    sentence: str
    most_wrong: int  # run


def judge_quantile(requirement: Requirement, time: np.ndarray, values: np.ndarray) -> QuantileFinding:
    """A quantile over the runs at every time; ``values`` has the shape (runs, times). NaN counts as outside."""
    # the order statistic at or beyond the quantile: nothing between two runs is made up
    none = np.isnan(values)
    upper = np.quantile(np.where(none, np.inf, values), requirement.quantile, axis=0, method="higher")
    lower = -np.quantile(np.where(none, np.inf, -values), requirement.quantile, axis=0, method="higher")
    high = upper - requirement.most if requirement.most is not None else np.full(upper.shape, -np.inf)
    low = requirement.least - lower if requirement.least is not None else np.full(lower.shape, -np.inf)
    excess = np.maximum(high, low)
    worst = int(np.argmax(excess))
    inside = (values <= (np.inf if requirement.most is None else requirement.most)) & (
        values >= (-np.inf if requirement.least is None else requirement.least)
    )
    held = int(np.count_nonzero(inside[:, worst]))
    above = requirement.least is None or (requirement.most is not None and not low[worst] > high[worst])
    share = requirement.quantile if above else 1.0 - requirement.quantile
    extreme = float((upper if above else lower)[worst])
    at_worst = f"at worst {told(requirement, extreme)}" if np.isfinite(extreme) else "is no number"
    passed = bool(np.all(excess <= 0.0))
    sentence = (
        f"{100 * share:.6g}th percentile of {len(values)} runs {at_worst} "
        f"at t = {time[worst]:.9g} s, where {held} of {len(values)} runs are inside"
    )
    most_wrong = int(np.argmax(requirement.excess(values[:, worst])))
    return QuantileFinding(passed, held, sentence, most_wrong)
