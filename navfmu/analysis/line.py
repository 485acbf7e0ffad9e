"""Lines of position: what the distance or the bearing of a station says of a place, thesis Appendix D.

Latitude and longitude are unknown, the height is known. The Earth is the ellipsoid, where (D.2) to (D.4) have a plane.
The thesis prints arctan((x - x1)/(y - y1)) in (D.3) and its inverse in (D.4); with x to the north and bearings from
north it is the second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pymap3d

from navfmu.navaids.station import Station

DISTANCE, BEARING = "distance", "bearing"


@dataclass(frozen=True)
class Line:
    """A slant range (m) or a bearing from the station, clockwise from its true north (rad), wrong by ``sigma``."""

    station: Station
    kind: Literal["distance", "bearing"]
    sigma: float

    def seen(self, latitude: np.ndarray, longitude: np.ndarray, altitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What is measured at places (rad, rad, m above the ellipsoid), (...), and its change for each m that the place
        moves to north and east, (..., 2)."""
        one = self.station
        away = position(latitude, longitude, altitude) - position(one.latitude, one.longitude, one.elevation)
        if self.kind == DISTANCE:
            value = np.sqrt(np.sum(away * away, axis=-1))
            slope = away / np.maximum(value, 1e-9)[..., None]
        else:
            north, east = level(one.latitude, one.longitude)
            to_north, to_east = away @ north, away @ east
            value = np.arctan2(to_east, to_north) % (2.0 * np.pi)
            slope = np.multiply.outer(to_north, east) - np.multiply.outer(to_east, north)
            slope = slope / np.maximum(to_north**2 + to_east**2, 1e-9)[..., None]
        return value, np.stack([np.sum(slope * axis, axis=-1) for axis in level(latitude, longitude)], axis=-1)

    def away(self, latitude: np.ndarray, longitude: np.ndarray, altitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far places are from the station, m, and how high above its level plane, rad; each (...)."""
        one = self.station
        away = position(latitude, longitude, altitude) - position(one.latitude, one.longitude, one.elevation)
        up = np.cross(*level(one.latitude, one.longitude)[::-1])
        far = np.sqrt(np.sum(away * away, axis=-1))
        return far, np.arcsin(np.clip(away @ up / np.maximum(far, 1e-9), -1.0, 1.0))

    def missing(self, measured: np.ndarray, value: np.ndarray) -> np.ndarray:
        """What is measured without what should be; bearings by the shorter way."""
        off = measured - value
        return off if self.kind == DISTANCE else (off + np.pi) % (2.0 * np.pi) - np.pi


def position(latitude: np.ndarray, longitude: np.ndarray, altitude: np.ndarray) -> np.ndarray:
    """Places (rad, rad, m) in the frame e, m, (..., 3)."""
    return np.stack(np.broadcast_arrays(*pymap3d.geodetic2ecef(latitude, longitude, altitude, deg=False)), axis=-1)


def level(latitude: np.ndarray, longitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The directions to north and east at places (rad), in the frame e, each (..., 3)."""
    sin, cos = np.sin(latitude), np.cos(latitude)
    east = np.stack([-np.sin(longitude), np.cos(longitude), np.zeros_like(sin + longitude)], axis=-1)
    north = np.stack([-sin * np.cos(longitude), -sin * np.sin(longitude), cos + np.zeros_like(longitude)], axis=-1)
    return north, east
