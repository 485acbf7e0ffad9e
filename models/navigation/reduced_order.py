"""The DME-aided dead reckoning filter of reduced order, thesis section 6.5: position and wind alone (6.54),

    [dp_n, dp_e, dV_NS, dV_EW]

with F and H of the full order less the rows and columns of what is left out (:mod:`models.navigation.full_order`). What
heading, airspeed and the biases of the ranges do goes into wind and position, and nothing in the filter says so.
"""

from __future__ import annotations

import numpy as np

from models.navigation import navigator

STATES = 4


def velocity(errors, airspeed, heading, wind):
    """North and east velocity over ground, m/s, (6.22), (6.23): ``errors`` is what is to be added to a forecast of the
    wind."""
    return navigator.air_velocity(airspeed, heading) + wind + errors


def velocity_rows():
    """Derivatives of :func:`velocity` by the wind, shape (2, 2)."""
    return np.eye(2)


def fix_rows():
    """H of a fix: position and velocity (north, east), and altitude, of which it has no state, shape (5, 4)."""
    return np.concatenate([np.eye(STATES), np.zeros((1, STATES))])


def range_rows(north, east):
    """H of slant ranges by their direction cosines, shape (stations, 4)."""
    return np.concatenate([np.stack([north, east], -1), np.zeros((len(north), 2))], -1)
