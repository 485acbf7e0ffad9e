"""How an aircraft is seen from a station: distance, elevation and azimuth, and what terrain hides.

Vectors from each station to the aircraft are given in e, m, shape (3, stations): ``dme.line_of_sight``.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import EARTH_RADIUS, RADIO_EARTH_RADIUS


def in_n(latitude, longitude, vectors):
    """North, east and up components of ``vectors`` (in e) at a place or at a place for each, arrays of their number."""
    return turned(sines(latitude, longitude), vectors)


def sines(latitude, longitude):
    """Sine and cosine of ``latitude``, sine and cosine of ``longitude``: what ``turned`` needs of a place."""
    return np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)


def turned(of_place, vectors):
    """``in_n`` at a place, or at a place for each, whose ``sines`` are known."""
    sin_lat, cos_lat, sin_lon, cos_lon = of_place
    outward = cos_lon * vectors[0] + sin_lon * vectors[1]
    north = cos_lat * vectors[2] - sin_lat * outward
    east = cos_lon * vectors[1] - sin_lon * vectors[0]
    return north, east, cos_lat * outward + sin_lat * vectors[2]


def is_above(up, distance, angle):
    """Whether an aircraft that is ``up`` m over the level of a station at ``distance`` m is higher than ``angle``,
    rad, -pi/2 to pi/2. None is higher than pi/2."""
    return up > distance * np.sin(angle) * (1.0 + 1.0e-12)


def azimuth(north, east):
    """Direction from north over east, 0 to 2 pi, rad."""
    angle = np.arctan2(east, north)
    return np.where(angle < 0.0, angle + 2.0 * np.pi, angle)


def bending(distance):
    """Angle in rad by which rays, bent as over an earth of 4/3 radius, arrive from above the straight line.

    Over a sphere of radius R an aircraft at height h and ``distance`` d is h / d - d / (2 R) above the level; so it is
    d (1 / R - 3 / (4 R)) / 2.
    """
    return distance * (1.0 / EARTH_RADIUS - 1.0 / RADIO_EARTH_RADIUS) / 2.0
