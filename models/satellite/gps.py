"""GPS/WAAS receiver with three-antenna attitude: white errors, thesis section 3.10 (p. 72)."""

from __future__ import annotations

import numpy as np

from models.attitude import attitude
from models.earth import earth

HORIZONTAL_SIGMA = 2.0
"""Standard deviation of north and of east position, m, thesis section 3.10."""
VERTICAL_SIGMA = 5.0
"""Standard deviation of altitude, m, thesis section 3.10."""
VELOCITY_SIGMA = 0.1
"""Standard deviation of each component of velocity, m/s; the thesis gives none, this is usual for Doppler velocity."""
ATTITUDE_SIGMA = np.radians(0.25)
"""Standard deviation of roll, pitch and heading, rad, thesis section 3.10 and Table 4.2."""


def displaced(latitude, longitude, altitude, north, east):
    """Latitude and longitude (rad) of a point ``north`` and ``east`` metres from another.

    The longitude goes on from the other's, which may be beyond the date line; at a pole it is within a turn of it.
    """
    north_south, east_west = earth.radii(latitude)
    return (
        latitude + north / (north_south + altitude),
        longitude + attitude.wrap(east / ((east_west + altitude) * np.cos(latitude))),
    )


def fix(latitude, longitude, altitude, velocity_n, sigmas, normal, offset_n=(0.0, 0.0, 0.0), rate_n=0.0):
    """A position and velocity fix; ``sigmas`` = (horizontal m, vertical m, velocity m/s), ``normal`` has 6 elements.

    False signals are those of a place that is off by ``offset_n``, n, m, and goes on by ``rate_n``, m/s.
    """
    horizontal, vertical, velocity = sigmas
    north, east, down = offset_n
    measured_latitude, measured_longitude = displaced(
        latitude, longitude, altitude, horizontal * normal[0] + north, horizontal * normal[1] + east
    )
    return (
        measured_latitude,
        measured_longitude,
        altitude + vertical * normal[2] - down,
        velocity_n + velocity * normal[3:6] + rate_n,
    )


def angles(roll, pitch, heading, sigma, normal):
    """Attitude of the three-antenna system: roll, pitch, heading in [-pi, pi), rad."""
    return roll + sigma * normal[0], pitch + sigma * normal[1], attitude.wrap(heading + sigma * normal[2])
