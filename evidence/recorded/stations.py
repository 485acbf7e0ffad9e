"""Which real DME stations a recorded flight can use, and the five that serve it best."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pymap3d

from fmus.radio.stations import PLACES, Station
from models.radio import dme
from navfmu.constants import FOOT, NAUTICAL_MILE

ANTENNA = 10.0
"""Height of a station's antenna above its ground, m."""


class Usable:
    """Which stations of a region can be received along a track, and what geometry they give."""

    def __init__(self, track: dict[str, np.ndarray], table: pd.DataFrame) -> None:
        table = table[table["bias_nmi"] == 0.0].drop_duplicates("ident")
        self.stations = [
            Station(r.ident, r.name_, r.latitude_deg, r.longitude_deg, r.elevation_ft, r.frequency_mhz, r.range_nmi)
            for r in table.rename(columns={"name": "name_"}).itertuples()
        ]
        shape = len(self.stations), len(track["time"])
        self.north, self.east, self.inside = np.zeros(shape), np.zeros(shape), np.zeros(shape, bool)
        for i, station in enumerate(self.stations):
            height = station.elevation * FOOT
            azimuth, _, distance = pymap3d.geodetic2aer(
                track["latitude"], track["longitude"], track["altitude"],
                np.radians(station.latitude), np.radians(station.longitude), height, deg=False,
            )  # fmt: skip
            reach = np.minimum(dme.horizon(track["altitude"], height, ANTENNA), station.range * NAUTICAL_MILE)
            self.north[i], self.east[i], self.inside[i] = np.cos(azimuth), np.sin(azimuth), distance <= reach

    def hdop(self, chosen: list[int]) -> np.ndarray:
        """Dilution of precision along the track with these stations; 99 where two lines do not cross."""
        columns = zip(self.north[chosen].T, self.east[chosen].T, self.inside[chosen].T, strict=True)
        return np.array([dme.dilution(north, east, inside) for north, east, inside in columns])

    def choose(self) -> list[int]:
        """Up to five stations, each in turn the one that makes the mean of min(HDOP, 10) least; best pair first."""
        chosen: list[int] = []
        while len(chosen) < min(PLACES, len(self.stations)):
            left = [i for i in range(len(self.stations)) if i not in chosen and self.inside[i].any()]
            if not left:
                break
            if not chosen:
                pairs = [(self._cost([i, j]), i, j) for i in left for j in left if i < j]
                chosen = list(min(pairs)[1:]) if pairs else left[:1]
                continue
            cost, best = min((self._cost([*chosen, i]), i) for i in left)
            if cost >= self._cost(chosen) - 1e-3:
                break
            chosen.append(best)
        return chosen

    def _cost(self, chosen: list[int]) -> float:
        return float(np.mean(np.minimum(self.hdop(chosen), 10.0)))

    def shares(self, chosen: list[int]) -> list[tuple[Station, float]]:
        """The chosen stations and the share of the flight in which each can be received."""
        return [(self.stations[i], float(np.mean(self.inside[i]))) for i in chosen]
