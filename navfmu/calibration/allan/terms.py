"""Error terms that an Allan chart tells apart, thesis Table C.1 and IEEE Std 952, annex C."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import numpy as np

EARLY = 0.1
"""T / tau below which the variance of a Gauss-Markov process is summed as a series: the closed form loses digits."""
_SERIES = [(-1.0) ** k * (4.0 - 2.0**k) / factorial(k) for k in range(3, 12)]


@dataclass(frozen=True)
class Term:
    """``variance(time, correlation_time)`` is the Allan variance of a term whose coefficient is 1, s and s.

    ``spectrum(frequency, period, correlation_time)`` is that of samples taken every ``period`` s, over the frequency in
    cycles a sample, on both sides of 0; a ramp has none. ``slope`` is that of the deviation in a chart with logarithmic
    axes, ``symbol`` the coefficient.
    """

    name: str
    symbol: str
    slope: float
    variance: Callable[[np.ndarray, float], np.ndarray]
    spectrum: Callable[[np.ndarray, float, float], np.ndarray]
    timed: bool = False

    def __str__(self) -> str:
        return self.name


def gauss_markov(time: np.ndarray, correlation_time: float) -> np.ndarray:
    """Allan variance of a first-order Gauss-Markov process of unit variance, exact at all times."""
    x = np.asarray(time, dtype=float) / correlation_time
    late = np.maximum(x, EARLY)
    closed = 2.0 / late * (1.0 - (3.0 - 4.0 * np.exp(-late) + np.exp(-2.0 * late)) / (2.0 * late))
    early = np.minimum(x, EARLY)
    series = sum(c * early ** (k + 1) for k, c in enumerate(_SERIES))
    return np.where(x < EARLY, series, closed)


def _markov_spectrum(frequency: np.ndarray, period: float, correlation_time: float) -> np.ndarray:
    phi = np.exp(-period / correlation_time)
    return -np.expm1(-2.0 * period / correlation_time) / ((1.0 - phi) ** 2 + 4.0 * phi * _half(frequency))


def _half(frequency: np.ndarray) -> np.ndarray:
    return np.sin(np.pi * frequency) ** 2


QUANTISATION = Term(
    "quantisation", "Q", -1.0, lambda time, _: 3.0 / time**2, lambda f, period, _: 4.0 * _half(f) / period**2
)
"""Whole pulses of an angle; Q is the size of one over sqrt(12)."""
WHITE = Term("white noise", "N", -0.5, lambda time, _: 1.0 / time, lambda f, period, _: np.ones_like(f) / period)
"""Angle random walk N per root second, N = sigma_w / sqrt(f_s) of thesis (B.10)."""
FLICKER = Term(
    "flicker",
    "B",
    0.0,
    lambda time, _: 2.0 * np.log(2.0) / np.pi * np.ones_like(time),
    lambda f, period, _: 0.5 / (np.pi * f),
)
"""Bias instability; the floor is 0.664 B."""
RANDOM_WALK = Term(
    "rate random walk", "K", 0.5, lambda time, _: time / 3.0, lambda f, period, _: 0.25 * period / _half(f)
)
RAMP = Term("ramp", "R", 1.0, lambda time, _: 0.5 * time**2, lambda f, period, _: np.zeros_like(f))
GAUSS_MARKOV = Term("Gauss-Markov", "sigma", 0.5, gauss_markov, _markov_spectrum, timed=True)
"""Of a time constant; its slope is +1/2 where it is young, T far below the time constant."""
TERMS = (QUANTISATION, WHITE, FLICKER, RANDOM_WALK, RAMP, GAUSS_MARKOV)
