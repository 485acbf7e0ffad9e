"""The circle that holds a share of a normal error in two axes: exactly, and by the sums of sigmas that papers use.

CEP = 0.589 (s1 + s2), 99 %: 1.52 (s1 + s2) (AGARD-CP-298, paper 25). The sum with equal sigmas is exact, which is
where both factors come from: sqrt(2 ln 2)/2 and sqrt(2 ln 100)/2. Where one sigma is 0, the circle of the other is
0.674 and 2.576 of it: the first sum is 13 % too small, the second 41 %.
"""

from __future__ import annotations

import numpy as np

from navfmu.report.statistics.radial import beyond

FACTORS = {0.5: 0.589, 0.99: 1.52}
"""By share of the errors: the radius over the sum of both sigmas, as printed."""


def principal(covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sigmas along the axes of the ellipse, the longer first, (...), of packed covariances (..., 3): xx, xy, yy."""
    first, both, second = np.moveaxis(np.asarray(covariance, float), -1, 0)
    middle, half = 0.5 * (first + second), np.hypot(0.5 * (first - second), both)
    return np.sqrt(np.maximum(middle + half, 0.0)), np.sqrt(np.maximum(middle - half, 0.0))


def radius(covariance: np.ndarray, share: float) -> np.ndarray:
    """Radius (...) of the circle around 0 that holds this share of a normal error with the packed covariance (..., 3).

    Bisection of the probability, which is that of :func:`navfmu.report.statistics.radial.beyond`: the mean over the
    direction of a Rayleigh distribution.
    """
    long, short = principal(covariance)
    flat = np.where(long > 0.0, short / np.where(long > 0.0, long, 1.0), 1.0)
    low, high = np.zeros_like(flat), np.full_like(flat, np.sqrt(-2.0 * np.log1p(-share)))
    for _ in range(48):
        middle = 0.5 * (low + high)
        outside = beyond(middle, np.ones_like(flat), flat) > 1.0 - share
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    return long * 0.5 * (low + high)


def printed(covariance: np.ndarray, share: float) -> np.ndarray:
    """The same radius (...) as ``FACTORS`` has it, of the sigmas along the axes of the packed covariance (..., 3)."""
    first, _, second = np.moveaxis(np.asarray(covariance, float), -1, 0)
    return FACTORS[share] * (np.sqrt(first) + np.sqrt(second))
