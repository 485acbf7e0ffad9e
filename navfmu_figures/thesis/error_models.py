"""The thesis's error models (Tables 3.1, 5.1, 5.2, 6.1, 7.1) and flights, as parameters of navigators."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymap3d import vincenty

from navfmu.constants import FOOT, KNOT, NAUTICAL_MILE, STANDARD_GRAVITY

SPEED = 90.0 * KNOT
AIRPORT = (float(np.radians(37.7)), float(np.radians(-121.8)))
"""Where the approach of section 7.2 ends; the text does not say where on Earth."""
SIDE = 20.0
"""nmi from the airport to each station, to the west and the east of it: Figs 7.1 and 7.5."""
DEG_PER_HOUR = np.radians(1.0) / 3600.0
UNITS = {
    "tactical": (0.35, 100.0, 0.0017, 50e-6, 60.0, 50e-5),
    "automotive": (180.0, 300.0, 0.05, 1.2e-3, 100.0, 1e-3),
    "consumer": (360.0, 300.0, 0.05, 2.4e-3, 100.0, 1e-3),
}
"""Table 5.2, p. 170: drift of gyros (deg/h), its time (s), noise (deg/s); of accelerometers in g."""
TABLE_7_1 = {"calibration": False, "gust_sigma": 0.0, "innovation_gate": 0.0}
"""Errors of Table 7.1, which are the start values, at each fix; no gusts and no gate."""
KNOWN = {**TABLE_7_1, "known_share": 1.0, "update_period": 1.0}
"""No error at the last fix, (5.59)."""


def _away(distance: float, bearing: float) -> tuple[float, float]:
    """Latitude and longitude, rad, of a place so many nmi from the airport in a direction, deg."""
    latitude, longitude = vincenty.vreckon(*np.degrees(AIRPORT), distance * NAUTICAL_MILE, bearing)
    return float(np.radians(latitude)), float(np.radians((longitude + 180.0) % 360.0 - 180.0))


def unit(grade: str) -> dict[str, float]:
    """Parameters of ``navigator_inertial`` by Table 5.2, with no error at the last fix, (5.60), and altitude held."""
    drift, time, noise, bias, bias_time, bias_noise = UNITS[grade]
    return {
        "gyro_drift_sigma": drift * DEG_PER_HOUR,
        "gyro_drift_time": time,
        "gyro_noise": float(np.radians(noise)),
        "accelerometer_drift_sigma": bias * STANDARD_GRAVITY,
        "accelerometer_drift_time": bias_time,
        "accelerometer_noise": bias_noise * STANDARD_GRAVITY,
        "gyro_null_shift_sigma": 0.0,
        "accelerometer_null_shift_sigma": 0.0,
        "gyro_scale_sigma": 0.0,
        "level_sigma": 0.0,
        "pressure_walk": 0.0,
        "known_share": 1.0,
    }


def _plan(latitude: float, longitude: float, altitude: float, segments: list[tuple[float, float]]) -> dict[str, Any]:
    """A straight flight to the north at 90 kn: (duration in s, vertical speed in m/s) of each segment."""
    count = 24
    durations = [duration for duration, _ in segments] + [0.0] * (count - len(segments))
    climbs = [climb for _, climb in segments] + [0.0] * (count - len(segments))
    return {
        "initial_latitude": latitude,
        "initial_longitude": longitude,
        "initial_altitude": altitude,
        "initial_track": 0.0,
        "initial_speed": SPEED,
        "segment_duration": durations,
        "segment_turn_rate": [0.0] * count,
        "segment_vertical_speed": climbs,
        "segment_speed": [SPEED] * count,
    }


CRUISE_NORTH = _plan(float(np.radians(37.0)), AIRPORT[1], 2000.0 * FOOT, [(4000.0, 0.0)])
"""Section 5.5.2: level, to the north, at 90 kn and 2000 ft."""


def approach() -> dict[str, Any]:
    """Section 7.2: 50 nmi to the airport, to the north, from 6000 ft to 800 ft at 2 nmi, then level."""
    begin = _away(50.0, 180.0)
    down = 48.0 * NAUTICAL_MILE / SPEED
    return _plan(*begin, 6000.0 * FOOT, [(down, -5200.0 * FOOT / down), (600.0, 0.0)])


DURATION = 50.0 * NAUTICAL_MILE / SPEED
"""Of the approach, s."""


def stations(bearings: tuple[float, ...], side: float = SIDE) -> dict[str, Any]:
    """Stations in these directions (deg) from the airport, as parameters of ``dme`` and navigators."""
    places = [_away(side, one) for one in bearings]
    latitude, longitude = ([place[i] for place in places] + [0.0] * (5 - len(places)) for i in (0, 1))
    return {
        "station_count": len(bearings),
        "station_latitude": latitude,
        "station_longitude": longitude,
        "station_altitude": [0.0] * 5,
    }


ABEAM = stations((270.0, 90.0))
"""Two stations abeam of the airport: the line between them is crossed at a right angle, Fig 7.5."""
