"""Doppler radar: velocity over the surface in body axes, and how a sea deceives it.

AGARD CP-298, P1 (velocity every 1 / 7.5 s, a scale factor as a state of the filter) and the relative navigation there
(water motion). "Doppler correction for surface movement", Journal of Navigation: by trials over the sea the surface
moves at 3 kn in a wind of 10 kn, 4 in 18, 5 in 30 and 6 in 50 kn or more, downwind, beside a correction of 1 percent.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import KNOT

WIND = np.array([0.0, 10.0, 18.0, 30.0, 50.0]) * KNOT
MOVEMENT = np.array([0.0, 3.0, 4.0, 5.0, 6.0]) * KNOT
"""Speed of the surface of a sea in such winds, m/s."""
SEA_BIAS = 0.01
"""By how much a sea shortens what is measured: it scatters the steeper part of a beam more, which shifts less."""


def surface(wind_n):
    """Velocity in n at which a sea's surface moves, m/s: along the horizontal wind."""
    speed = np.sqrt(wind_n[0] * wind_n[0] + wind_n[1] * wind_n[1])
    share = np.interp(speed, WIND, MOVEMENT) / np.maximum(speed, 1e-9)
    return np.array([share * wind_n[0], share * wind_n[1], 0.0 * speed])


def measured(velocity_b, mounting, scale_factor, bias, fluctuation):
    """Velocity shown, m/s: in the antenna's axes, with scale factor, bias and fluctuation."""
    return (1.0 + scale_factor) * (mounting @ velocity_b) + bias + fluctuation
