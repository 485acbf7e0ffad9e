"""What Allan deviations should be, and how far those of a sample are from it."""

from __future__ import annotations

import allantools
import numpy as np

CORRELATED = 2.0
"""Successive differences of cluster means are correlated, and 1 + 2 sum rho^2 is how many of them count as one.

White noise in the rate has rho = -1/2 (1.5), white noise in the angle -2/3 and 1/6 (1.94), a random walk 1/4 (1.13).
"""


def deviation(rates: np.ndarray, period: float, spans: np.ndarray) -> np.ndarray:
    """Allan deviations of the columns, root mean square over them, at averaging times of ``spans`` samples."""
    found = [
        allantools.adev(column, rate=1.0 / period, data_type="freq", taus=np.asarray(spans) * period)
        for column in rates.T
    ]
    for times, *_ in found:
        np.testing.assert_allclose(times, np.asarray(spans) * period)
    return np.sqrt(np.mean([values**2 for _, values, *_ in found], axis=0))


def spread(samples: int, axes: int, spans: np.ndarray) -> np.ndarray:
    """Standard deviation of the logarithm of such a deviation, whatever the noise: M clusters, axes of their own."""
    clusters = axes * (samples / np.asarray(spans) - 1.0)
    return np.sqrt(CORRELATED / (2.0 * clusters))


def gauss_markov(time: np.ndarray, sigma: float, correlation_time: float) -> np.ndarray:
    """Allan deviation of a first-order Gauss-Markov process, IEEE Std 952, (C.17)."""
    x = np.asarray(time) / correlation_time
    return sigma * np.sqrt(2.0 / x * (1.0 - (3.0 - 4.0 * np.exp(-x) + np.exp(-2.0 * x)) / (2.0 * x)))
