"""Clock of a receiver: two states driven by white noise, and an oscillator that feels acceleration.

R. G. Brown and P. Y. C. Hwang, Introduction to Random Signals and Applied Kalman Filtering, model of receiver clocks:
d bias/dt = drift + w_f, d drift/dt = w_g with spectral densities S_f = h_0 / 2 and S_g = 2 pi^2 h_-2 of Allan's
coefficients. Acceleration a changes the frequency by S a: AGARD CP-298 (1981), Dyment and Liang.
"""

from __future__ import annotations

import numpy as np

H0 = 2e-19
"""h_0 of a temperature compensated crystal oscillator, s."""
H2 = 2e-20
"""h_-2 of it, 1/s."""


def densities(h0, h2):
    """Spectral densities of the noise of frequency (s) and of its rate (1/s)."""
    return 0.5 * h0, 2.0 * np.pi * np.pi * h2


def covariance(densities, period):
    """Covariance (2, 2) of what bias (s) and drift (s/s) gain by chance in ``period``, exact."""
    frequency, rate = densities
    both = 0.5 * rate * period * period
    return np.array([[frequency * period + rate * period**3 / 3.0, both], [both, rate * period]])


def advance(bias, drift, felt, covariance, period, normal):
    """Bias and drift one period later; ``felt`` is the frequency by acceleration, ``normal`` (2,)."""
    rate = covariance[1, 1]
    slope = np.where(rate > 0.0, covariance[0, 1] / np.where(rate > 0.0, rate, 1.0), 0.0)
    change = np.sqrt(rate) * normal[0]
    alone = np.sqrt(np.maximum(covariance[0, 0] - slope * covariance[0, 1], 0.0)) * normal[1]
    return bias + period * (drift + felt) + slope * change + alone, drift + change
