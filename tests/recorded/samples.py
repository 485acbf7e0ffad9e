"""Made recordings of sensors, as frames with irregular times."""

from __future__ import annotations

import numpy as np
import pandas as pd

AXES = ("x", "y", "z")
G = 9.80665


def stamps(count: int, shortest: float, longest: float, seed: int = 3, first: float = 0.0123) -> np.ndarray:
    """Times of a log whose intervals are anything between two bounds, in s, with six decimals as such files have."""
    intervals = np.random.default_rng(seed).uniform(shortest, longest, count - 1)
    return np.round(first + np.append(0.0, np.cumsum(intervals)), 6)


def imu(time: np.ndarray, seed: int = 4) -> pd.DataFrame:
    """Rolling and pitching by some 20 degrees, so that the specific force turns as the gyros say; body axes FRD."""
    rng = np.random.default_rng(seed)
    roll, pitch = 0.35 * np.sin(0.8 * time), 0.3 * np.sin(0.5 * time + 1.0)
    roll_rate, pitch_rate = 0.28 * np.cos(0.8 * time), 0.15 * np.cos(0.5 * time + 1.0)
    rate = np.stack([roll_rate, pitch_rate * np.cos(roll), -pitch_rate * np.sin(roll)], axis=1)
    up = [-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)]
    force = -G * np.stack(up, axis=1) + 0.02 * rng.standard_normal((len(time), 3))
    return frame(time, rate=rate + 1e-3 * rng.standard_normal(rate.shape), specific_force=force)


def field(time: np.ndarray, seed: int = 5) -> pd.DataFrame:
    """A slow turn in a field of 48 uT with a dip of 62 degrees."""
    angle = 0.05 * time
    level = np.stack([22.5e-6 * np.cos(angle), -22.5e-6 * np.sin(angle), np.full_like(time, 42.4e-6)], axis=1)
    return frame(time, field=level + 2e-7 * np.random.default_rng(seed).standard_normal(level.shape))


def fixes(time: np.ndarray, seed: int = 6) -> pd.DataFrame:
    """Circles at 40 m/s over Livermore that climb and descend, with the noise of a receiver."""
    rng = np.random.default_rng(seed)
    course, climb = 0.04 * time, 2.0 * np.cos(0.02 * time)
    north, east = 1000.0 * np.sin(course), -1000.0 * np.cos(course)
    latitude = 0.6581 + (north + 0.5 * rng.standard_normal(time.shape)) / 6.36e6
    longitude = -2.1262 + (east + 0.5 * rng.standard_normal(time.shape)) / (6.39e6 * np.cos(0.6581))
    altitude = 1500.0 + 100.0 * np.sin(0.02 * time)
    moved = {"velocity_north": 40.0 * np.cos(course), "velocity_east": 40.0 * np.sin(course), "velocity_down": -climb}
    return pd.DataFrame({"time": time, "latitude": latitude, "longitude": longitude, "altitude": altitude, **moved})


def air(time: np.ndarray, seed: int = 7) -> pd.DataFrame:
    """A climb at 46 m/s from 1500 m."""
    rng = np.random.default_rng(seed)
    return pd.DataFrame(
        {
            "time": time,
            "calibrated_airspeed": 46.3 + 0.5 * rng.standard_normal(time.shape),
            "pressure_altitude": 1500.0 + 2.5 * time + rng.standard_normal(time.shape),
        }
    )


def frame(time: np.ndarray, **vectors: np.ndarray) -> pd.DataFrame:
    """Vectors as three columns each."""
    columns = {f"{name}_{axis}": part for name, v in vectors.items() for axis, part in zip(AXES, v.T, strict=True)}
    return pd.DataFrame({"time": time, **columns})
