"""A ground transponder as a navaid file tells it, and the ranges that its numbers must keep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pymap3d
from pymap3d import vincenty

from navfmu.constants import FOOT, NAUTICAL_MILE
from navfmu.errors import NavfmuError

RANGES = {
    "latitude": (-90.0, 90.0, "degrees"),
    "longitude": (-180.0, 180.0, "degrees"),
    "elevation": (-2000.0, 20000.0, "ft"),
    "range": (1.0, 1000.0, "nmi"),
    "bias": (-20.0, 20.0, "nmi"),
}
"""Least and largest, and the unit in files."""
BANDS = ((108.00, 117.95), (133.30, 135.95))
"""MHz: the channels that are paired with a VOR or ILS, and those of TACAN that are paired with nothing."""
SPACING = 0.05
"""MHz between channels."""
SAME_PLACE = 100.0
"""Stations of one channel that are nearer (m) are one transponder, which two runways name each in its way."""


@dataclass(frozen=True)
class Station:
    """A transponder; ``line`` is where it stands in its file.

    Latitude and longitude in rad (WGS-84), ``elevation`` in m above mean sea level, ``range`` of service in m.
    ``bias`` (m) is in the distance that it lets a receiver show: one of an ILS may read zero at the threshold.
    """

    ident: str
    name: str
    latitude: float
    longitude: float
    elevation: float
    frequency: float
    """MHz of the VOR or ILS that it is paired with."""
    range: float
    bias: float = 0.0
    line: int = 0


def station(ident: str, name: str, numbers: Mapping[str, float], where: str, line: int = 0) -> Station:
    """A station of ``numbers`` in the units of files: latitude, longitude, elevation, frequency, range, bias."""
    for key, (least, largest, unit) in RANGES.items():
        if not least <= numbers[key] <= largest:
            raise NavfmuError(
                f"{where}: the {key} of '{ident}' is {numbers[key]:g} {unit}; expected {least:g} to {largest:g}"
            )
    frequency = numbers["frequency"]
    channel = round(frequency / SPACING) * SPACING
    if not any(low - 1e-6 <= frequency <= high + 1e-6 for low, high in BANDS) or abs(channel - frequency) > 1e-3:
        bands = " or ".join(f"{low:.2f} to {high:.2f} MHz" for low, high in BANDS)
        raise NavfmuError(
            f"{where}: the frequency of '{ident}' is {frequency:g} MHz; expected {bands} in steps of 0.05"
        )
    return Station(
        ident,
        name,
        float(np.radians(numbers["latitude"])),
        float(np.radians(numbers["longitude"])),
        numbers["elevation"] * FOOT,
        frequency,
        numbers["range"] * NAUTICAL_MILE,
        numbers["bias"] * NAUTICAL_MILE,
        line,
    )


@dataclass(frozen=True)
class Stations:
    """The stations of a file, each transponder once, without those that show a bias.

    Neither an FMU nor a computation of coverage knows biases: such a station would give wrong distances.
    """

    source: str
    stations: tuple[Station, ...]
    biased: int
    """How many were left out because they have a bias."""
    repeated: int
    """How many were left out because they stand on one place and channel with another."""

    @classmethod
    def of(cls, source: str, found: Iterable[Station]) -> Stations:
        """Those of a file that can be used; the first of a transponder stays, and none if one has a bias."""
        found = list(found)
        kept: dict[float, list[Station]] = {}
        wrong: dict[float, list[Station]] = {}
        for one in found:
            if one.bias:
                wrong.setdefault(round(one.frequency, 2), []).append(one)
        biased = repeated = 0
        for one in found:
            channel = round(one.frequency, 2)
            others = kept.setdefault(channel, [])
            if any(_together(one, other) for other in wrong.get(channel, ())):
                biased += 1
            elif any(_together(one, other) for other in others):
                repeated += 1
            else:
                others.append(one)
        chosen = {id(one) for others in kept.values() for one in others}
        return cls(source, tuple(one for one in found if id(one) in chosen), biased, repeated)

    def within(self, latitude: float, longitude: float, reach: float) -> tuple[Station, ...]:
        """Those nearer than ``reach`` (m) to a place (rad), the nearest first."""
        latitudes, longitudes = (
            np.array([getattr(one, of) for one in self.stations]) for of in ("latitude", "longitude")
        )
        far = distance(latitude, longitude, latitudes, longitudes)
        return tuple(self.stations[i] for i in np.argsort(far, kind="stable") if far[i] <= reach)

    def sentences(self) -> list[str]:
        """What was found, and what was left out."""
        told = [f"{len(self.stations)} stations"]
        if self.biased:
            told.append(f"{self.biased} more show a distance with a bias (an ILS, zero at the threshold): left out")
        if self.repeated:
            told.append(f"{self.repeated} more stand on one place and channel with another: one transponder, left out")
        return told


def _together(one: Station, other: Station) -> bool:
    if abs(one.latitude - other.latitude) > SAME_PLACE / 6e6:  # most are far apart, which is quick to see
        return False
    return bool(distance(one.latitude, one.longitude, other.latitude, other.longitude) < SAME_PLACE)


def distance(latitude: float, longitude: float, latitudes: np.ndarray, longitudes: np.ndarray) -> np.ndarray:
    """Straight distances from a place on the ellipsoid to others (rad), m."""
    here = np.array(pymap3d.geodetic2ecef(latitude, longitude, 0.0, deg=False))
    there = np.array(pymap3d.geodetic2ecef(latitudes, longitudes, np.zeros_like(latitudes), deg=False))
    return np.sqrt(np.sum((there.T - here) ** 2, axis=-1))


def plane(one: Station, latitude: float, longitude: float) -> tuple[float, float]:
    """East and north of a place (rad) where a station lies on a map that is true to distance and bearing, m."""
    far, bearing = vincenty.vdist(
        *np.degrees([latitude, longitude, one.latitude, one.longitude]),
    )
    return float(far * np.sin(np.radians(bearing))), float(far * np.cos(np.radians(bearing)))
