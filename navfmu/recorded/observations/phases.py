"""Doppler of carrier phases, for files that have none."""

from __future__ import annotations

import numpy as np

FARTHEST = 60.0
"""s between epochs of which phases are compared."""
FASTEST = 6.3e4
"""Hz, 12 km/s: more is a clock that jumps by a millisecond."""


def doppler(time: np.ndarray, phase: np.ndarray, lost: np.ndarray) -> np.ndarray:
    """Return Doppler, Hz, NaN where a phase before or behind is missing or was lost: (n, satellites).

    It is the slope of the parabola through three phases (cycles), less their third derivative times the product of the
    intervals over 6: 8 mm/s for a station with an epoch every 30 s; an aircraft that begins to turn at 1 g in a second
    is off by 1.6 m/s with an epoch a second.
    """
    step = np.diff(time)[:, None]
    rate = np.diff(phase, axis=0) / step
    rate = np.where(lost[1:] | (step > FARTHEST) | (np.abs(rate) > FASTEST), np.nan, rate)
    found = np.full(phase.shape, np.nan)
    before, behind = step[:-1], step[1:]
    found[1:-1] = -(rate[:-1] * behind + rate[1:] * before) / (before + behind)
    return found
