"""The line of sight from a receiver to satellites.

Satellites are given in e as e is when their signals leave. While these travel e turns, by 130 m at the equator; all
that is received at one moment is put into e of that moment (Sagnac effect, IS-GPS-200, 20.3.3.4.3.3.2). Satellites are
rows: positions have shape (satellites, 3).
"""

from __future__ import annotations

import numpy as np

from models.satellite.orbit import EARTH_RATE
from navfmu.constants import SPEED_OF_LIGHT


def turned(vector_e, travel):
    """Rows of ``vector_e`` in e of ``travel`` seconds later, exact to 1e-14 for 0.1 s."""
    angle = EARTH_RATE * travel
    cosine, sine = 1.0 - 0.5 * angle * angle, angle - angle * angle * angle / 6.0
    x, y = vector_e[:, 0], vector_e[:, 1]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, vector_e[:, 2]], axis=1)


def travel_time(position_e, satellite_e):
    """Time from each satellite to the receiver, s; that e turns meanwhile changes it by 0.5 us at most."""
    line = satellite_e - position_e
    return np.sqrt(np.sum(line * line, axis=1)) / SPEED_OF_LIGHT


def ranges(position_e, satellite_e):
    """Distances at reception, m, and unit vectors from the receiver to the satellites in e of reception.

    The travel time is taken before e has turned, which is a fraction of a millimetre.
    """
    line = turned(satellite_e, travel_time(position_e, satellite_e)) - position_e
    distance = np.sqrt(np.sum(line * line, axis=1))
    return distance, line * (1.0 / distance)[:, None]


def range_rates(unit_e, position_e, velocity_e, satellite_velocity_e):
    """Rates of the distances of a receiver at ``position_e``, m/s, exact to 0.01 mm/s.

    ``satellite_velocity_e`` has been turned into e of reception. The signal of a satellite that goes away left ever
    earlier, so the way that it goes itself, with respect to inertial space, is less by the rate over the speed of
    light: some mm/s.
    """
    away = np.sum(unit_e * satellite_velocity_e, axis=1)
    turning = EARTH_RATE * (unit_e[:, 1] * position_e[0] - unit_e[:, 0] * position_e[1])
    own = np.sum(unit_e * velocity_e, axis=1)
    return (away - own) / (1.0 + (away + turning) / SPEED_OF_LIGHT)


def sky(unit_n):
    """Sine of the elevation, and sine and cosine of the azimuth (from north over east), of unit vectors in n.

    Straight above there is no azimuth, and both are zero.
    """
    north, east = unit_n[:, 0], unit_n[:, 1]
    along = 1.0 / np.maximum(np.sqrt(north * north + east * east), 1e-12)
    return np.clip(-unit_n[:, 2], -1.0, 1.0), (east * along, north * along)
