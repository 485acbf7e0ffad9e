"""Berman-Powell wind model, thesis section 3.8, p. 66.

The horizontal wind along the flight is a mean plus, on each axis, a first-order Gauss-Markov process of 5 m/s and
400 s (3.36), (3.37). Its time is the *travelling time* since the last observation, (3.35),

    t_r = sqrt(t_N^2 + t_E^2 + t_D^2 + dt^2),   t_N = dp_N / V_N and so on,

which for an aircraft in steady flight is a multiple of time: each axis on which it moves adds dt^2, so t_r = dt at rest
(in the text's own analyses, which use the correlation time as time), sqrt(3) dt in level flight and 2 dt in a climb.
"""

from __future__ import annotations

import numpy as np


def travelling_time(displacement, velocity, elapsed):
    """t_r of (3.35), s, from the displacement (m) and the velocity (m/s) in n; an axis at rest adds nothing."""
    moving = np.abs(velocity) > 0.0
    per_axis = np.where(moving, displacement / np.where(moving, velocity, 1.0), 0.0)
    return np.sqrt(np.sum(per_axis * per_axis) + elapsed * elapsed)
