"""A place on the ellipsoid, and what lies some metres from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.navaids.coverage import Points
from navfmu.recorded.defects import local_metric


def moved(latitude, longitude, altitude, north, east):
    """Places (rad) that lie so many m to north and east."""
    per_latitude, per_longitude = local_metric(latitude, altitude)
    return latitude + north / per_latitude, longitude + east / per_longitude


@dataclass(frozen=True)
class Place:
    """Rad, rad, m above the ellipsoid."""

    latitude: float
    longitude: float
    altitude: float

    def values(self) -> tuple[float, float, float]:
        """As arguments."""
        return self.latitude, self.longitude, self.altitude

    def points(self, ground: float = 0.0) -> Points:
        """One point."""
        return Points(*(np.array([value]) for value in self.values()), ground)

    def offset(self, latitude, longitude) -> np.ndarray:
        """Where places (rad) of its height lie from here, m to north and east, (..., 2)."""
        per_latitude, per_longitude = local_metric(self.latitude, self.altitude)
        return np.stack([(latitude - self.latitude) * per_latitude, (longitude - self.longitude) * per_longitude], -1)
