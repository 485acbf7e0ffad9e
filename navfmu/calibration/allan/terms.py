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
    """``variance(time, period, correlation_time)`` is the Allan variance of a term whose coefficient is 1, all in s.

    It is that of samples taken every ``period``: averages of a random walk over few of them vary more than those of all
    that is between. Flicker noise, of which samples have no finite variance, is that of averages.
    ``spectrum(frequency, period, correlation_time)`` is that of the samples, over the frequency in cycles a sample, on
    both sides of 0; a ramp has none. ``slope`` is that of the deviation in a chart with logarithmic axes, ``symbol``
    the coefficient.
    """

    name: str
    symbol: str
    slope: float
    variance: Callable[[np.ndarray, float, float], np.ndarray]
    spectrum: Callable[[np.ndarray, float, float], np.ndarray]
    timed: bool = False

    def __str__(self) -> str:
        return self.name


def gauss_markov(time: np.ndarray, correlation_time: float) -> np.ndarray:
    """Allan variance of a first-order Gauss-Markov process of unit variance, of averages of all of it; exact."""
    x = np.asarray(time, dtype=float) / correlation_time
    late = np.maximum(x, EARLY)
    closed = 2.0 / late * (1.0 - (3.0 - 4.0 * np.exp(-late) + np.exp(-2.0 * late)) / (2.0 * late))
    early = np.minimum(x, EARLY)
    series = sum(c * early ** (k + 1) for k, c in enumerate(_SERIES))
    return np.where(x < EARLY, series, closed)


def gauss_markov_samples(time: np.ndarray, period: float, correlation_time: float) -> np.ndarray:
    """The same of averages of samples, exact.

    With a = period / tau, n samples of the covariance exp(-a |j - k|) have, for g(x) = 2x - 3 + 4 e^-x - e^-2x,

        (g(n a) + 2n (sinh a - a)) / (2n sinh(a / 2))^2,

    and the process itself has g(x) / x^2.
    """
    a = period / correlation_time
    n = np.asarray(time, dtype=float) / period
    beyond = np.sinh(a) - a if a > EARLY else a**3 / 6.0 * (1.0 + a**2 / 20.0 * (1.0 + a**2 / 42.0))
    between = (n * a) ** 2 * gauss_markov(time, correlation_time)
    return (between + 2.0 * n * beyond) / (2.0 * n * np.sinh(0.5 * a)) ** 2


def _markov_spectrum(frequency: np.ndarray, period: float, correlation_time: float) -> np.ndarray:
    phi = np.exp(-period / correlation_time)
    return -np.expm1(-2.0 * period / correlation_time) / ((1.0 - phi) ** 2 + 4.0 * phi * _half(frequency))


def _half(frequency: np.ndarray) -> np.ndarray:
    return np.sin(np.pi * frequency) ** 2


QUANTISATION = Term(
    "quantisation", "Q", -1.0, lambda time, *_: 3.0 / time**2, lambda f, period, _: 4.0 * _half(f) / period**2
)
"""Whole pulses of an angle; Q is the size of one over sqrt(12)."""
WHITE = Term("white noise", "N", -0.5, lambda time, *_: 1.0 / time, lambda f, period, _: np.ones_like(f) / period)
"""Angle random walk N per root second, N = sigma_w / sqrt(f_s) of thesis (B.10)."""
FLICKER = Term(
    "flicker",
    "B",
    0.0,
    lambda time, *_: 2.0 * np.log(2.0) / np.pi * np.ones_like(time),
    lambda f, period, _: 0.5 / (np.pi * f),
)
"""Bias instability; the floor is 0.664 B."""
RANDOM_WALK = Term(
    "rate random walk",
    "K",
    0.5,
    lambda time, period, _: time / 3.0 + period**2 / (6.0 * time),
    lambda f, period, _: 0.25 * period / _half(f),
)
RAMP = Term("ramp", "R", 1.0, lambda time, *_: 0.5 * time**2, lambda f, period, _: np.zeros_like(f))
GAUSS_MARKOV = Term("Gauss-Markov", "sigma", 0.5, gauss_markov_samples, _markov_spectrum, timed=True)
"""Of a time constant; its slope is +1/2 where it is young, T far below the time constant."""
TERMS = (QUANTISATION, WHITE, FLICKER, RANDOM_WALK, RAMP, GAUSS_MARKOV)
