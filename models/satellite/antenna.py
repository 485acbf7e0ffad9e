"""Gain of an antenna on the roof of an aircraft, over azimuth and elevation in the axes of the body.

A patch: 3 dBi upwards, -5 dBi along its plane, as is usual. What comes from below is behind the airframe, which takes 1
dB a degree, as far as 30 dB: so a bank hides satellites (RTO MP-43, Sabatini, has a matrix of what is masked).
"""

from __future__ import annotations

import numpy as np

from models.satellite.signal_power import LEAST_GAIN

HORIZON = -5.0
HIDDEN = 30.0
"""dB that the airframe takes at most."""
AZIMUTHS = np.array([-np.pi, np.pi])
ELEVATIONS = np.radians([-90.0, -30.0, 0.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0])


def gain(elevation):
    """dBi at an elevation above the plane of the antenna, rad."""
    above = HORIZON + (LEAST_GAIN - HORIZON) * np.sin(np.maximum(elevation, 0.0))
    return above - np.clip(-np.degrees(elevation), 0.0, HIDDEN)


PATCH = np.tile(gain(ELEVATIONS), (len(AZIMUTHS), 1))
"""Of AZIMUTHS and ELEVATIONS."""


def direction(unit_n, c_nb):
    """Azimuth from forward over right, and elevation above the plane of the wings, of rows of unit vectors, rad."""
    unit_b = unit_n @ c_nb
    return np.arctan2(unit_b[:, 1], unit_b[:, 0]), np.arcsin(np.clip(-unit_b[:, 2], -1.0, 1.0))
