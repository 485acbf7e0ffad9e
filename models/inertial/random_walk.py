"""Rate random walk: the integral of white noise, db/dt = w with the spectral density K^2 (thesis section C.3.1).

Its Allan deviation is K sqrt(T / 3), slope +1/2 of thesis Table C.1. K is told as the standard deviation of the change
in an hour, K sqrt(3600 s): the number of a data sheet in (deg/h)/sqrt(h). It has no stationary distribution; it starts
at 0, for what it did before turn-on is null shift.
"""

from __future__ import annotations

import numpy as np

HOUR = 3600.0
"""s."""


def advance(value, hourly_sigma, period, normal):
    """Value one period later."""
    return value + hourly_sigma * np.sqrt(period / HOUR) * normal
