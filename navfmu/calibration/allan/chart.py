"""The Allan variance of samples at rest over averaging time, thesis section C.2 and IEEE Std 952, annex C."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FEWEST = 4.0
"""Pairs of neighbouring averages that the longest averaging time must have."""


@dataclass(frozen=True)
class Chart:
    """Allan variances of the axes of a sensor.

    ``time`` (levels,) s, each twice the one before, from the sampling ``period`` on; ``variance`` (levels, axes), of
    overlapping averages; ``pairs`` (levels,), how many pairs of averages there are that do not overlap, ``count``
    (levels,) of those that do.
    """

    period: float
    time: np.ndarray
    variance: np.ndarray
    pairs: np.ndarray
    count: np.ndarray

    @property
    def deviation(self) -> np.ndarray:
        """Allan deviations, (levels, axes)."""
        return np.sqrt(self.variance)

    @property
    def spread(self) -> np.ndarray:
        """One standard deviation of the logarithm of the deviations, (levels,)."""
        return np.sqrt(0.5 / self.pairs)

    def beyond(self, shortest: float) -> Chart:
        """The part at averaging times of ``shortest`` s and more."""
        kept = self.time >= shortest * (1.0 - 1e-9)
        return Chart(self.period, self.time[kept], self.variance[kept], self.pairs[kept], self.count[kept])


def chart(stretches: Sequence[np.ndarray], period: float) -> Chart:
    """Chart of stretches of samples (n, axes), each of which counts as often as it has pairs of averages."""
    sums = [np.cumsum(np.vstack([np.zeros(len(x.T)), x - x.mean(axis=0)]), axis=0) for x in stretches]
    lengths = np.array([len(x) for x in stretches])
    rows, span = [], 1
    while (pairs := float(np.sum(lengths[lengths >= 2 * span]) / (2 * span))) >= FEWEST:
        total, count = 0.0, 0
        for angle in sums:
            second = angle[2 * span :] - 2.0 * angle[span : len(angle) - span] + angle[: max(0, len(angle) - 2 * span)]
            total, count = total + np.sum(second**2, axis=0), count + len(second)
        rows.append((span * period, total / (2.0 * span**2 * count), pairs, count))
        span *= 2
    return Chart(period, *map(np.array, zip(*rows, strict=True)))
