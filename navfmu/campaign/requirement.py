"""Requirements: a bound on a value, for a share of the time of each run or a quantile of the runs; counts of events."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from navfmu.engine.monitor import Monitor, Observed
from navfmu.expressions.program import Program

MAIN = "main"  # name of the main system among the variants


@dataclass(frozen=True)
class Requirement:
    """``least <= signal <= most`` from ``start`` to ``end`` (s), while ``when`` holds.

    ``signal`` is an expression, and ``program`` what was compiled from it. Being outside for no longer than
    ``tolerance`` (s) at a time does not count.

    * With ``percent`` p: a run holds when this is so for at least p percent of its communication points in that time;
      the requirement holds when at least ``runs`` percent of the runs do (or, with ``expect_violated``, do not).
    * With ``events``: a run holds when the expression becomes true at most ``most`` times.
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
    events: bool = False
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
    def monitor(self) -> Monitor:
        """What is asked at every communication point of a run."""
        bounds = {} if self.events or self.truth else {"least": self.least, "most": self.most}
        return Monitor(
            self.id,
            f"not ({self.signal})" if self.events else self.signal,
            **{name: bound for name, bound in bounds.items() if bound is not None},
            begin=self.start,
            end=self.end,
            when=self.when,
            tolerance=self.tolerance,
        )

    @property
    def truth(self) -> bool:
        """Whether the expression itself says what is required."""
        return not self.events and self.most is None and self.least is None

    def applies(self, variant: str, case: str) -> bool:
        """Whether it is asked of this variant in this case."""
        return (self.variants is None or variant in self.variants) and (self.cases is None or case in self.cases)

    @property
    def sentence(self) -> str:
        """The requirement in words: "evaluation.horizontal_error <= 926 m for 95 % of the time from 300 s"."""
        unit = f" {self.unit}" if self.unit and self.unit != "1" else ""
        low = f"{self.least:g}{unit} <= " if self.least is not None else ""
        high = f" <= {self.most:g}{unit}" if self.most is not None else ""
        when = f" from {self.start:g} s" if self.start > 0 else ""
        when += f" to {self.end:g} s" if math.isfinite(self.end) else ""
        when += f" while {self.when}" if self.when else ""
        if self.quantile is not None:
            return f"{low}{self.signal}{high} at every time{when}, {100 * self.quantile:g}th percentile of the runs"
        wrong = "VIOLATED as expected: " if self.expect_violated else ""
        many = "" if self.runs == 100 else f", in {self.runs:g} % of the runs"
        if self.events:
            lasting = f" for more than {self.tolerance:g} s" if self.tolerance else ""
            return f"{wrong}{self.signal}{lasting} at most {self.most:g} times{when}{many}"
        share = "always" if self.percent == 100 else f"for {self.percent:g} % of the time"
        share += f", but for {self.tolerance:g} s at a time" if self.tolerance else ""
        return f"{wrong}{low}{self.signal}{high} {share}{when}{many}"

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


@dataclass(frozen=True)
class Finding:
    """What one run says about one requirement."""

    held: bool
    percent: float  # of the points inside the bound
    worst: float  # NaN where none of the points was reached
    worst_time: float
    first_violation: float | None  # s
    missing: int = 0  # points that an early end of the run has left out

    @property
    def reached(self) -> bool:
        """Whether the run came as far as the first point."""
        return not (self.missing and math.isnan(self.worst))

    def row(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "held": self.held,
            "percent": self.percent,
            "worst": self.worst,
            "worst_time": self.worst_time,
            "first_violation": self.first_violation,
            "missing": self.missing,
        }


def enough(percent: float, needed: float) -> bool:
    """Whether a share reaches the one that is needed, but for rounding; both in percent, ``needed`` above 0."""
    return percent >= needed * (1.0 - 1e-12)


def judge(requirement: Requirement, seen: Observed) -> Finding | None:
    """What a run says that was asked ``requirement.monitor``; None where no point was asked.

    Points that a run did not reach speak against the requirement: they are outside of its bound, or inside, where it
    should be violated.
    """
    total = seen.points + seen.missing
    if not total:
        return None
    outside = seen.outside + (0 if requirement.expect_violated else seen.missing)
    percent = 100.0 * (total - outside) / total
    needed = 100.0 if requirement.percent is None else requirement.percent
    held = enough(percent, needed)
    if requirement.events:
        held = seen.episodes <= requirement.most and (requirement.expect_violated or not seen.missing)
    first = seen.first_outside
    return Finding(
        held=held,
        percent=percent,
        worst=float(seen.episodes) if requirement.events else seen.worst,
        worst_time=first if requirement.events else seen.worst_time,
        first_violation=None if math.isnan(first) else first,
        missing=seen.missing,
    )


def wilson(count: int, total: int) -> tuple[float, float]:
    """95 % confidence interval (Wilson) of a share, in percent."""
    if total == 0:
        return 0.0, 100.0
    from scipy.stats import binomtest

    interval = binomtest(count, total).proportion_ci(method="wilson")
    return 100 * interval.low, 100 * interval.high
