"""One run of a campaign, how it ended, and what it says about each requirement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.campaign.definition import Campaign
from navfmu.campaign.finding import Finding
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.runs import Answer, Run
from navfmu.engine.monitor import Observed


@dataclass(frozen=True)
class Judged:
    """One run, how it ended, and its findings by requirement."""

    run: Run
    answer: Answer
    findings: dict[str, Finding]
    remarks: tuple[str, ...] = ()  # on the campaign itself, where they concern this run

    @property
    def notes(self) -> tuple[str, ...]:
        """What the run noted, and what the campaign has to say of it."""
        return *self.answer.notes, *self.remarks

    @property
    def error(self) -> str | None:
        """Why there are no findings."""
        return self.answer.error

    @property
    def onset(self) -> float | None:
        """When the first of its faults began to act (s); None where none did."""
        return min((begin for spans in self.answer.acted.values() for begin, _ in spans), default=None)

    def latency(self, finding: Finding) -> float | None:
        """How long after the first onset a requirement was first violated (s); None where it was not, or before."""
        violated = finding.violated_from
        return None if self.onset is None or violated is None or violated < self.onset else violated - self.onset

    def holds(self, requirement: Requirement) -> bool:
        """Whether the run is as the requirement expects it; one that ended with an error is not."""
        finding = self.findings.get(requirement.id)
        return finding is not None and finding.held != requirement.expect_violated


def read_series(file: Path, signals: Sequence[str]) -> dict[str, np.ndarray]:
    """Columns of a recording."""
    from pyarrow import parquet

    data = parquet.ParquetFile(file)
    names = [name for name in ("time", *dict.fromkeys(signals)) if name in data.schema_arrow.names]
    table = data.read(columns=names)
    return {name: table[name].to_numpy() for name in names}


def judge_run(campaign: Campaign, run: Run, answer: Answer) -> Judged:
    """Judge a run by what was seen in it."""
    if answer.error is not None:
        return Judged(run, answer, {})
    asked = [r for r in campaign.requirements if r.id in answer.observed]
    found = {r.id: r.question.judge(r, Observed.restored(answer.observed[r.id])) for r in asked}
    return Judged(run, answer, {name: finding for name, finding in found.items() if finding is not None})
