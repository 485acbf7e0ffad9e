"""How stations are seen from points: distance, direction, and whether the Earth lets them be heard.

Arrays of stations come first, points second: (stations, points).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymap3d

from navfmu.constants import RADIO_EARTH_RADIUS
from navfmu.navaids.station import Station

ANTENNA = 10.0
"""Height of a station's antenna above its ground, m."""


@dataclass(frozen=True)
class Sight:
    """Stations from points: distances in m, the direction cosines to north and east of each, and who is heard."""

    distance: np.ndarray
    north: np.ndarray
    east: np.ndarray
    heard: np.ndarray


def sight(
    stations: Sequence[Station], latitude: np.ndarray, longitude: np.ndarray, altitude: np.ndarray, ground: float = 0.0
) -> Sight:
    """Stations from points (rad, rad, m above the sea), each (points,).

    A station is heard within its range and above the horizon of a smooth Earth of 4/3 radius whose surface lies
    ``ground`` (m) above the sea; what lies deeper counts as lying on it. Mean sea level and the ellipsoid are one.
    """

    def column(of: str) -> np.ndarray:
        return np.array([getattr(one, of) for one in stations], float)[:, None]

    height = column("elevation")
    azimuth, elevation, distance = pymap3d.geodetic2aer(
        column("latitude"), column("longitude"), height, latitude, longitude, altitude, deg=False
    )
    level = np.cos(elevation)
    visible = horizon(altitude - ground) + horizon(np.maximum(height - ground, 0.0) + ANTENNA)
    heard = distance <= np.minimum(visible, column("range"))
    return Sight(distance, level * np.cos(azimuth), level * np.sin(azimuth), heard)


def horizon(height: np.ndarray) -> np.ndarray:
    """Distance of the horizon (m) of what is ``height`` (m) above a smooth Earth of 4/3 radius."""
    return np.sqrt(2.0 * RADIO_EARTH_RADIUS * np.maximum(height, 0.0))


def dilution(seen: Sight, used: np.ndarray) -> np.ndarray:
    """Horizontal dilution of precision at each point, (points,): sqrt(trace((H' H)^-1)), thesis section 7.1.

    The rows of H are the horizontal direction cosines of slant ranges; the height is known. ``used`` (stations, points)
    says which count. Infinite where two lines do not cross.
    """
    weight = np.where(used, 1.0, 0.0)
    nn, ee, ne = (np.sum(weight * a * b, axis=0) for a, b in
                  ((seen.north, seen.north), (seen.east, seen.east), (seen.north, seen.east)))  # fmt: skip
    determinant = nn * ee - ne * ne
    crossing = determinant > 1e-9
    return np.where(crossing, np.sqrt((nn + ee) / np.where(crossing, determinant, 1.0)), np.inf)
