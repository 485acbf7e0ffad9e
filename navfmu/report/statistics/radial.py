"""The length of an error in two axes over many runs: how great it is, and what the estimator's covariance predicts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator

from navfmu.files.schema import Field
from navfmu.report.finite import remark
from navfmu.report.kind import Statistic as Base
from navfmu.report.kind import pair, same_unit
from navfmu.report.pictures.sigma import Axis
from navfmu.report.scene import Bound, Recorded, whole, words

SIGMAS = 3


class Statistic(Base):
    """Median, 95th percentile, time beyond a requirement's limit, the share that the covariance predicts."""

    kind: Literal["radial"]
    error: str = Field(description="the signal of the length of the error")
    axes: Annotated[list[Axis], AfterValidator(pair)] = Field(description="its two components and their sigmas")

    def needs(self) -> list[str]:
        return [self.error, *(axis.error for axis in self.axes), *(axis.sigma for axis in self.axes)]

    def check(self, units: Mapping[str, str]) -> None:
        same_unit(units, *self.needs())

    def asked(self) -> str:
        return self.error

    def heading(self) -> str:
        return f"{words(self.error).capitalize()} over all runs"

    def explanation(self) -> str:
        return (
            "Median and 95th percentile are taken over the runs at each time; shown is the worst time. 'Predicted' is "
            "the share of time beyond the limit that the filter's own covariance gives; an honest filter predicts what "
            "happens."
        )

    def row(self, runs: Sequence[Recorded], bounds: Sequence[Bound]) -> dict[str, Any] | None:
        bound = _asked(bounds)
        if bound is None:
            return None
        runs = whole(runs)  # what is no number is beyond every limit, and so is what was not reached
        window = bound.window(runs[0].time)
        time, limit = runs[0].time[window], bound.most
        error, _, _, first_sigma, second_sigma = (
            np.stack([run[name][window] for run in runs]) for name in self.needs()
        )
        error = np.where(np.isfinite(error), error, np.inf)
        median, high = np.quantile(error, (0.5, 0.95), axis=0, method="higher")  # runs that were flown, none in between
        both = [np.logical_and(*(axis.inside(run, SIGMAS)[window] for axis in self.axes)) for run in runs]
        return {
            "runs": len(runs),
            "limit": limit,
            "median": float(median.max()),
            "median_time": float(time[median.argmax()]),
            "high": float(high.max()),
            "high_time": float(time[high.argmax()]),
            "above": 100 * float(np.mean(error > limit)),
            "predicted": 100 * float(np.mean(beyond(limit, first_sigma, second_sigma))),
            "ever": int(np.count_nonzero((error > limit).any(axis=1))),
            "inside": 100 * float(np.mean(both)),
        }

    def remark(self, runs: Sequence[Recorded], bounds: Sequence[Bound]) -> str:
        bound = _asked(bounds)
        if bound is None:
            return ""
        points = (run[name][bound.window(run.time)] for run in runs for name in self.needs())
        missing = remark(points)
        said = [f"error and sigmas {missing}"] if missing else []
        window = bound.window(max((run.points for run in runs), key=len))
        ended = sum(bool(window[len(run.time) :].any()) for run in runs)
        said += [f"{ended} of {len(runs)} runs ended early"] if ended else []
        return f"{' and '.join(said)}: what is missing counts as beyond the limit and outside" if said else ""

    def table(self, rows: Sequence[Mapping[str, Any]], unit: str) -> tuple[list[str], list[list[str]]]:
        headings = [
            "runs", f"median, {unit}", "at s", f"95th percentile, {unit}", "at s", f"limit, {unit}", "time beyond, %",
            "predicted, %", "runs ever beyond", f"inside {SIGMAS} sigma, %",
        ]  # fmt: skip
        cells = [
            [
                str(r["runs"]), _number(r["median"]), f"{r['median_time']:g}", _number(r["high"]),
                f"{r['high_time']:g}", _number(r["limit"]), f"{r['above']:.1f}", f"{r['predicted']:.1f}",
                f"{r['ever']} of {r['runs']}", f"{r['inside']:.1f}",
            ]
            for r in rows
        ]  # fmt: skip
        return headings, cells


def beyond(limit: float, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Probability that the length of an error exceeds ``limit``; its components are independent normal numbers with
    the standard deviations ``first`` and ``second``. Sigmas that are not finite promise nothing: 1.

    With the components s1 r cos(a), s2 r sin(a), the angle a is uniform and r^2/2 exponential, so that the probability
    is the mean over a of exp(-limit^2 / (2 (s1^2 cos^2 a + s2^2 sin^2 a))), periodic and smooth in a: equal steps do.
    """
    first, second = (np.where(np.isfinite(sigma), sigma, np.inf) for sigma in (first, second))
    total = np.zeros(np.shape(first))
    angles = (np.arange(64) + 0.5) * (np.pi / 2 / 64)
    for angle in angles:
        variance = (first * np.cos(angle)) ** 2 + (second * np.sin(angle)) ** 2
        total += np.exp(-0.5 * limit**2 / np.maximum(variance, 1e-12))
    return total / len(angles)


def _asked(bounds: Sequence[Bound]) -> Bound | None:
    """The longest of the upper bounds, among equals the loosest."""
    upper = (bound for bound in bounds if bound.most is not None)
    return max(upper, key=lambda bound: (bound.end - bound.start, bound.most), default=None)


def _number(value: float) -> str:
    if not math.isfinite(value):
        return "not finite"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
