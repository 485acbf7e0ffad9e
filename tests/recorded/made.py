"""A made flight with known truth, and the ways in which a receiver spoils it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

KNOT, FOOT = 1852.0 / 3600.0, 0.3048
FINE = 0.05  # s between the points of the truth


@dataclass(frozen=True)
class Truth:
    """Time s, latitude and longitude rad, altitude m, speed m/s, track rad (continuous), climb m/s, every 0.05 s."""

    time: np.ndarray
    latitude: np.ndarray
    longitude: np.ndarray
    altitude: np.ndarray
    speed: np.ndarray
    track: np.ndarray
    climb: np.ndarray

    def at(self, time: np.ndarray) -> dict[str, np.ndarray]:
        names = ("latitude", "longitude", "altitude", "speed", "track", "climb")
        return {name: np.interp(time, self.time, getattr(self, name)) for name in names}


def _ramps(time: np.ndarray, changes: list[tuple[float, float]], ramp: float) -> np.ndarray:
    """A quantity that moves smoothly to each value at each time, over ``ramp`` seconds."""
    value, current = np.zeros(len(time)), 0.0
    for begin, target in changes:
        x = np.clip((time - begin) / ramp, 0.0, 1.0)
        value += (target - current) * x * x * (3.0 - 2.0 * x)
        current = target
    return value


def flight(latitude: float = 37.4, longitude: float = -122.05, taxi: float = 60.0) -> Truth:
    """Taxi, take-off, climb, a holding pattern with standard turns, descent and landing roll: twenty minutes."""
    time = np.arange(0.0, taxi + 1200.0 + taxi, FINE)
    t = time - taxi
    knots = [(-taxi, 10.0), (0.0, 90.0), (60.0, 120.0), (900.0, 95.0), (1170.0, 10.0)]
    speed = _ramps(t, [(begin, v * KNOT) for begin, v in knots], 30.0)
    standard = np.radians(3.0)
    turns = [(120.0, standard), (182.0, 0.0), (260.0, standard), (440.0, 0.0), (560.0, -standard), (650.0, 0.0)]
    turn = _ramps(t, turns, 4.0)
    feet_per_minute = [(28.0, 700.0), (330.0, 0.0), (740.0, -550.0), (1130.0, 0.0)]
    climb = _ramps(t, [(begin, w * FOOT / 60.0) for begin, w in feet_per_minute], 6.0)
    track = np.radians(120.0) + np.cumsum(turn) * FINE
    altitude = 10.0 + np.cumsum(climb) * FINE
    a, e2 = 6378137.0, 6.69437999014e-3
    phi, lam = np.radians(latitude), np.radians(longitude)
    latitudes, longitudes = np.empty(len(time)), np.empty(len(time))
    north, east = speed * np.cos(track) * FINE, speed * np.sin(track) * FINE
    for i in range(len(time)):
        latitudes[i], longitudes[i] = phi, lam
        w = np.sqrt(1.0 - e2 * np.sin(phi) ** 2)
        phi += north[i] / (a * (1.0 - e2) / w**3 + altitude[i])
        lam += east[i] / ((a / w + altitude[i]) * np.cos(phi))
    return Truth(time, latitudes, longitudes, altitude, speed, track, climb)


def recorded(truth: Truth, interval: float = 5.0, jitter: float = 0.0, seed: int = 1, on_ground: bool = True):
    """What a receiver writes: a row every ``interval``, position ``jitter`` off in time, rounded as such files are."""
    time = np.arange(0.0, truth.time[-1], interval)
    error = np.random.default_rng(seed).normal(0.0, jitter, len(time)) if jitter else np.zeros(len(time))
    place, motion = truth.at(time + error), truth.at(time)
    altitude = np.round(place["altitude"] / FOOT / 25.0) * 25.0
    if on_ground:
        altitude = np.where(motion["speed"] < 60.0 * KNOT, 0.0, altitude)
    return pd.DataFrame(
        {
            "time_s": time,
            "latitude_deg": np.round(np.degrees(place["latitude"]), 6),
            "longitude_deg": np.round(np.degrees(place["longitude"]), 6),
            "altitude_ft": altitude,
            "groundspeed_kt": np.round(motion["speed"] / KNOT),
            "track_deg": np.round(np.degrees(motion["track"])) % 360.0,
            "vertical_rate_ft_min": np.round(motion["climb"] / FOOT * 60.0 / 64.0) * 64.0,
        }
    )


def hole(frame: pd.DataFrame, begin: float, end: float, how: str) -> pd.DataFrame:
    """Nothing received from ``begin`` to ``end``: rows that 'repeat', 'freeze', are 'interpolated' or 'missing'."""
    frame = frame.copy()
    inside = (frame.time_s > begin) & (frame.time_s < end)
    if how == "missing":
        return frame[~inside].reset_index(drop=True)
    columns = ["latitude_deg", "longitude_deg"]
    if how in ("freeze", "interpolated"):
        columns += [c for c in frame.columns if c not in ("time_s", *columns)]
    held = frame[columns].astype(float).mask(inside)
    frame[columns] = held.interpolate() if how == "interpolated" else held.ffill()
    return frame
