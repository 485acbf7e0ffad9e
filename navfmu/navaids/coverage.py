"""How many stations are heard at points, and how well their circles cross."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pymap3d import vincenty

from navfmu.constants import FOOT
from navfmu.files.numbers import label
from navfmu.navaids.sight import dilution, sight
from navfmu.navaids.station import Station

BLOCK = 1_000_000
"""Pairs of a station and a point that are looked at together: so a fine grid does not fill the memory."""
MOST = 99.0
"""What a table shows where circles do not cross, or do so with a larger dilution."""


@dataclass(frozen=True)
class Points:
    """Where coverage is asked for: rad, rad and m above the sea, each (points,).

    ``shape`` is (heights, north, east) of a grid, whose points lie in this order, and ``sides`` (m) are its axes to
    north and east. ``time`` (s, points) is that of a track.
    """

    latitude: np.ndarray
    longitude: np.ndarray
    altitude: np.ndarray
    ground: float = 0.0
    shape: tuple[int, int, int] | None = None
    sides: np.ndarray | None = None
    time: np.ndarray | None = None

    @classmethod
    def around(
        cls, latitude: float, longitude: float, radius: float, count: int, heights: Sequence[float], ground: float = 0.0
    ) -> Points:
        """A square of ``count`` times ``count`` points around a place (rad), ``radius`` (m) to each side.

        One for each of the ``heights`` (m) above the ``ground``, which is in m above the sea.
        """
        sides = np.linspace(-radius, radius, count)
        north, east = np.meshgrid(sides, sides, indexing="ij")
        azimuth, far = np.arctan2(east, north), np.hypot(north, east)
        lats, lons = vincenty.vreckon(
            np.degrees(latitude), np.degrees(longitude), far.ravel(), np.degrees(azimuth.ravel())
        )
        lons = (np.asarray(lons) + 180.0) % 360.0 - 180.0
        n = len(heights)
        return cls(
            np.tile(np.radians(lats), n),
            np.tile(np.radians(lons), n),
            np.repeat(ground + np.asarray(heights, float), count * count),
            ground,
            (n, count, count),
            sides,
        )


@dataclass(frozen=True)
class Coverage:
    """What is heard at points: ``count`` of stations and ``hdop``, (points,); ``share`` of points of each station."""

    stations: tuple[Station, ...]
    points: Points
    count: np.ndarray
    hdop: np.ndarray
    share: np.ndarray

    @classmethod
    def of(cls, stations: Sequence[Station], points: Points) -> Coverage:
        """Coverage of points by all stations together."""
        size = len(points.altitude)
        count, hdop, heard = np.zeros(size, int), np.zeros(size), np.zeros(len(stations))
        for part in np.array_split(np.arange(size), 1 + size * len(stations) // BLOCK):
            places = (of[part] for of in (points.latitude, points.longitude, points.altitude))
            seen = sight(stations, *places, points.ground)
            count[part], hdop[part] = np.sum(seen.heard, axis=0), dilution(seen, seen.heard)
            heard += np.sum(seen.heard, axis=1)
        return cls(tuple(stations), points, count, hdop, heard / size)

    def part(self, least: int) -> float:
        """Share of the points at which at least so many stations are heard."""
        return float(np.mean(self.count >= least))

    def layers(self) -> list[tuple[float, np.ndarray, np.ndarray]]:
        """Of a grid: each height above the ground (m), count and hdop there, (north, east)."""
        shape = self.points.shape
        heights = self.points.altitude.reshape(shape)[:, 0, 0] - self.points.ground
        return list(zip(heights, self.count.reshape(shape), self.hdop.reshape(shape), strict=True))

    def columns(self) -> dict[str, np.ndarray]:
        """A table, a row for each point."""
        points = self.points
        time = {} if points.time is None else {label("time", "s"): points.time}
        return time | {
            label("latitude", "deg"): np.degrees(points.latitude),
            label("longitude", "deg"): np.degrees(points.longitude),
            label("altitude", "ft"): points.altitude / FOOT,
            "stations": self.count,
            "hdop": np.minimum(self.hdop, MOST),
        }
