"""The nominal constellation of 24 satellites in six planes.

Global Positioning System Standard Positioning Service Performance Standard, October 2001, table 3-1: right ascension of
the ascending node and argument of latitude of each slot at the epoch 1993-07-01, 0 h UTC, when the Greenwich hour angle
is 18 h 36 min 14.4 s. All orbits are circles with an inclination of 55 degrees and a semi-major axis of 26 559.7 km.
The argument of latitude of D3 is 35.156 degrees; copies with 35.136 are about.
"""

from __future__ import annotations

import numpy as np

from models.earth.earth import EQUATORIAL_RADIUS
from models.satellite.ephemeris import Ephemeris
from models.satellite.orbit import EARTH_RATE, GRAVITATION
from models.satellite.selection import place

PLANES = {"A": 272.847, "B": 332.847, "C": 32.847, "D": 92.847, "E": 152.847, "F": 212.847}
"""Right ascension of the ascending node of each plane, degrees."""
LATITUDES = {
    "A": (268.126, 161.786, 11.676, 41.806),
    "B": (80.956, 173.336, 309.976, 204.376),
    "C": (111.876, 11.796, 339.666, 241.556),
    "D": (135.226, 265.446, 35.156, 167.356),
    "E": (197.046, 302.596, 66.066, 333.686),
    "F": (238.886, 345.226, 105.206, 135.346),
}
"""Argument of latitude of slots 1 to 4 of each plane, degrees."""
NAMES = tuple(f"{plane}{number + 1}" for plane in PLANES for number in range(4))
EPOCH = (703, 4 * 86400.0 + 9.0)
"""GPS week and second of the epoch: GPS time was 9 s ahead of UTC."""
FOREVER = 1e12
"""s: the rows hold at any time."""
HOUR_ANGLE = 15.0 * (18.0 + 36.0 / 60.0 + 14.4 / 3600.0)
"""Greenwich at the epoch, degrees."""
SEMI_MAJOR_AXIS = 26_559_700.0
INCLINATION = np.radians(55.0)
J2 = 1.08262668e-3
"""Second zonal harmonic of the earth's field, WGS-84."""
NODE_RATE = (
    -1.5 * J2 * np.sqrt(GRAVITATION / SEMI_MAJOR_AXIS**3) * (EQUATORIAL_RADIUS / SEMI_MAJOR_AXIS) ** 2
    * np.cos(INCLINATION)
)  # fmt: skip
"""Of a circular orbit about the oblate earth, rad/s: the planes turn to the west, all alike."""


def constellation() -> np.ndarray:
    """Rows of a table of orbits (24, columns), satellites 1 to 24 in the order of NAMES; at any time their clocks are
    right, they are healthy, and the rows hold."""
    week, second = EPOCH
    prn = np.arange(1.0, 25.0)
    node = np.radians(np.repeat(list(PLANES.values()), 4) - HOUR_ANGLE) + EARTH_RATE * second
    return Ephemeris(
        place=place(prn, week, second),
        prn=prn,
        toe_week=float(week),
        toe=second,
        semi_major_axis=SEMI_MAJOR_AXIS,
        eccentricity=0.0,
        inclination=INCLINATION,
        node=np.mod(node + np.pi, 2.0 * np.pi) - np.pi,
        perigee=0.0,
        mean_anomaly=np.radians(np.concatenate(list(LATITUDES.values()))),
        node_rate=NODE_RATE,
        toc_week=float(week),
        toc=second,
        limit=FOREVER,
    ).rows()
