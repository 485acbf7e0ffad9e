"""DME stations of the shipped systems: facts typed in, and their form as values of the parameters of dme and navigator.

``STATION_SETS["thesis_like"].parameters()`` gives names and values, the same for both components, which inherit the
parameters themselves from ``StationTable``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.constants import FOOT, NAUTICAL_MILE
from navfmu.export import Parameter

PLACES = 5
"""Stations a receiver and a navigator can hold."""
UNLIMITED = 130.0
"""Service range of the high-altitude stations, nmi."""


@dataclass(frozen=True)
class Station:
    """A ground transponder."""

    ident: str
    name: str
    latitude: float  # deg
    longitude: float  # deg
    elevation: float  # ft; mean sea level and the ellipsoid are taken as one
    frequency: float | None = None  # MHz of the paired VOR or ILS channel
    range: float = UNLIMITED  # service range, nmi


@dataclass(frozen=True)
class StationSet:
    """At most five stations; receivers with one or two channels ask them in this order."""

    description: str
    stations: Sequence[Station]

    def parameters(self) -> dict[str, int | np.ndarray]:
        """Return ``station_count``, ``station_latitude`` and so on; unused places hold zeros."""

        def column(values: list[float]) -> np.ndarray:
            return np.array(values + [0.0] * (PLACES - len(values)))

        return {
            "station_count": len(self.stations),
            "station_latitude": column([float(np.radians(s.latitude)) for s in self.stations]),
            "station_longitude": column([float(np.radians(s.longitude)) for s in self.stations]),
            "station_altitude": column([s.elevation * FOOT for s in self.stations]),
        }

    def ranges(self) -> dict[str, np.ndarray]:
        """Return ``station_range``, the service ranges in m, which the receiver alone has."""
        values = [s.range * NAUTICAL_MILE for s in self.stations]
        return {"station_range": np.array(values + [UNLIMITED * NAUTICAL_MILE] * (PLACES - len(values)))}


THESIS_LIKE = StationSet(
    "Two hypothetical transponders in the manner of thesis Fig 7.12, whose coordinates the text does not give: on "
    "Mount Diablo north-west of the flight, and in the San Joaquin delta north-east of it. Their lines of sight cross "
    "at near 90 degrees from the turns to the runway, where the HDOP is between 1.41 and 1.50.",
    (
        Station("DIA", "Mount Diablo (hypothetical)", 37.8816, -121.9142, 3849.0),
        Station("DLT", "San Joaquin delta (hypothetical)", 38.0000, -121.3800, 10.0),
    ),
)

BAY_AREA = StationSet(
    "Real stations around Livermore, navigation data cycle 2013.10. The first two cross best (HDOP 1.4 to 1.5 along "
    "the flight), all five give about 1.",
    (
        Station("LIN", "Linden VORTAC", 38.07458889, -121.00385833, 260.0, 114.8),
        Station("SUU", "Travis TACAN", 38.245558, -121.945072, 32.0, 116.6, 40.0),
        Station("OAK", "Oakland VORTAC", 37.72591944, -122.22358889, 13.0, 116.8),
        Station("ECA", "Manteca VOR-DME", 37.83360278, -121.171375, 47.0, 116.0),
        Station("SJC", "San Jose VOR-DME", 37.37471111, -121.94466667, 35.0, 114.1, 40.0),
    ),
)

STATION_SETS = {"thesis_like": THESIS_LIKE, "bay_area": BAY_AREA}
NETWORK = 32
"""Stations that a receiver can choose from."""
NETWORK_COLUMNS = (("number", "1"), ("latitude", "rad"), ("longitude", "rad"), ("altitude", "m"), ("range", "m"))


def network(stations: Sequence[Station]) -> np.ndarray:
    """Rows of a table of NETWORK_COLUMNS."""
    return np.array(
        [
            (i + 1.0, np.radians(s.latitude), np.radians(s.longitude), s.elevation * FOOT, s.range * NAUTICAL_MILE)
            for i, s in enumerate(stations)
        ]
    )


DEFAULT = THESIS_LIKE.parameters()
"""Start values of the station parameters."""


class StationTable:
    """The stations as parameters, for components to inherit: where they are (receiver) or are believed to be (filter).

    Both are set alike (``StationSet.parameters``); a navigator with a wrong database is given other values.
    """

    station_count = Parameter(
        kind="integer",
        start=DEFAULT["station_count"],
        min=1,
        max=PLACES,
        description="how many of the five places hold a station",
    )
    station_latitude = Parameter(
        PLACES,
        "rad",
        start=DEFAULT["station_latitude"],
        min=-np.pi / 2,
        max=np.pi / 2,
        display_unit="deg",
        description="geodetic latitude of each station",
    )
    station_longitude = Parameter(
        PLACES,
        "rad",
        start=DEFAULT["station_longitude"],
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="longitude of each station",
    )
    station_altitude = Parameter(
        PLACES,
        "m",
        start=DEFAULT["station_altitude"],
        min=-1000.0,
        max=10000.0,
        display_unit="ft",
        description="height of each station above the ellipsoid",
    )
