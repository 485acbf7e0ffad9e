"""Requirements: a bound on a value, for a share of the time of each run or a quantile of the runs; counts of events."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from navfmu.campaign.case import Case
from navfmu.campaign.question import QUESTIONS, Question
from navfmu.engine.monitor import Monitor
from navfmu.expressions.program import Program

MAIN = "main"  # name of the main system among the variants


@dataclass(frozen=True)
class Requirement:
    """``least <= signal <= most`` from ``start`` to ``end`` (s), while ``when`` holds.

    ``signal`` is an expression, and ``program`` what was compiled from it. Being outside for no longer than
    ``tolerance`` (s) at a time does not count.

    * With ``percent`` p: a run holds when this is so for at least p percent of its communication points in that time;
      the requirement holds when at least ``runs`` percent of the runs do (or, with ``expect_violated``, do not).
    * Of the kind "events": a run holds when the expression becomes true at most ``most`` times.
    * Of the kind "detects": when it becomes true within ``most`` s of the first onset of the ``fault`` (of any).
    * Of the kind "recovers": when it is true from ``most`` s after the end of the ``fault`` on.
    * With ``quantile`` q: at every recorded time the q-quantile over the runs must lie within the bound.
    """

    id: str
    signal: str
    most: float | None
    least: float | None
    unit: str
    percent: float | None
    quantile: float | None
    runs: float
    start: float
    end: float
    program: Program = field(compare=False)
    when: str = ""
    tolerance: float = 0.0
    kind: str = "signal"  # one of QUESTIONS
    fault: str = ""
    expect_violated: bool = False
    severity: str = ""
    description: str = ""
    variants: tuple[str, ...] | None = None
    cases: tuple[str, ...] | None = None

    @property
    def signals(self) -> list[str]:
        """The signals that it looks at."""
        return [str(source) for source in self.program.sources]

    @property
    def question(self) -> Question:
        """What kind of requirement it is."""
        return QUESTIONS[self.kind]

    @property
    def monitor(self) -> Monitor:
        """What is asked at every communication point of a run."""
        return self.question.monitor(self)

    @property
    def truth(self) -> bool:
        """Whether the expression itself says what is required."""
        return self.kind == "signal" and self.most is None and self.least is None

    def applies(self, variant: str, case: Case) -> bool:
        """Whether it is asked of this variant in this case."""
        if self.question.of_faults and not any(self.fault in ("", fault.id) for fault in case.faults):
            return False
        return (self.variants is None or variant in self.variants) and (
            self.cases is None or case.written in self.cases
        )

    @property
    def sentence(self) -> str:
        """The requirement in words: "evaluation.horizontal_error <= 926 m for 95 % of the time from 300 s"."""
        many = "" if self.runs == 100 else f", in {self.runs:g} % of the runs"
        return ("VIOLATED as expected: " if self.expect_violated else "") + self.question.sentence(self) + many

    def values(self, series: Mapping[str, np.ndarray]) -> np.ndarray:
        """The value at every recorded point, from the columns of a recording."""
        columns = [series[name] for name in self.signals]
        return np.broadcast_to(self.program.value(columns, series["time"]), series["time"].shape)

    def window(self, time: np.ndarray) -> np.ndarray:
        """Which recorded points count."""
        return (time >= self.start - 1e-9) & (time <= self.end + 1e-9)

    def excess(self, values: np.ndarray) -> np.ndarray:
        """How far values lie outside the bound (positive) or inside it (negative); NaN counts as outside."""
        excess = np.full(values.shape, -math.inf)
        if self.most is not None:
            excess = np.maximum(excess, values - self.most)
        if self.least is not None:
            excess = np.maximum(excess, self.least - values)
        return np.where(np.isnan(values), math.inf, excess)


def wilson(count: int, total: int) -> tuple[float, float]:
    """95 % confidence interval (Wilson) of a share, in percent."""
    if total == 0:
        return 0.0, 100.0
    from scipy.stats import binomtest

    interval = binomtest(count, total).proportion_ci(method="wilson")
    return 100 * interval.low, 100 * interval.high
