"""Requirements: a bound on a signal, for a share of the time of each run, or for a quantile of the runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

MAIN = "main"  # name of the main system among the variants


@dataclass(frozen=True)
class Requirement:
    """``least <= signal <= most`` from ``start`` to ``end`` (s).

    * With ``percent`` p: a run holds when this is so for at least p percent of its recorded points in that time; the
      requirement holds when at least ``runs`` percent of the runs do (or, with ``expect_violated``, do not).
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
    expect_violated: bool = False
    severity: str = ""
    description: str = ""
    variants: tuple[str, ...] | None = None
    cases: tuple[str, ...] | None = None

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
        if self.quantile is not None:
            return f"{low}{self.signal}{high} at every time{when}, {100 * self.quantile:g}th percentile of the runs"
        share = "always" if self.percent == 100 else f"for {self.percent:g} % of the time"
        many = "" if self.runs == 100 else f", in {self.runs:g} % of the runs"
        wrong = "VIOLATED as expected: " if self.expect_violated else ""
        return f"{wrong}{low}{self.signal}{high} {share}{when}{many}"

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


def judge(requirement: Requirement, time: np.ndarray, values: np.ndarray) -> Finding | None:
    """One run against one requirement; None when no point lies in its time.

    ``time`` (s) has all points that were to be recorded, ``values`` fewer where the run has ended early. The others
    speak against the requirement: they are outside of its bound, or inside, where it should be violated.
    """
    window = requirement.window(time)
    if not window.any():
        return None
    time, values = time[window], np.asarray(values, np.float64)[window[: len(values)]]
    excess = requirement.excess(values)
    outside = np.full(len(time), not requirement.expect_violated)
    outside[: len(values)] = excess > 0.0
    percent = 100.0 * float(np.count_nonzero(~outside)) / len(time)
    worst = int(np.argmax(excess)) if len(values) else 0
    needed = 100.0 if requirement.percent is None else requirement.percent
    return Finding(
        held=enough(percent, needed),
        percent=percent,
        worst=float(values[worst]) if len(values) else math.nan,
        worst_time=float(time[worst]),
        first_violation=float(time[np.argmax(excess > 0.0)]) if (excess > 0.0).any() else None,
        missing=len(time) - len(values),
    )


@cache
def wilson(count: int, total: int) -> tuple[float, float]:
    """95 % confidence interval (Wilson) of a share, in percent."""
    if total == 0:
        return 0.0, 100.0
    from scipy.stats import binomtest

    interval = binomtest(count, total).proportion_ci(method="wilson")
    return 100 * interval.low, 100 * interval.high
