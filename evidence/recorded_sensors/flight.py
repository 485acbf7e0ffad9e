"""A recorded flight, as its folder tells it: when it flies, what is learned and when, and what its sensors are."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from models.magnetic import magnetic_field
from navfmu.calibration.magnetometer.choice import choose
from navfmu.errors import NavfmuError

AXES = ("x", "y", "z")
FLYING, SETTLED = 8.0, 5.0
"""Ground speed from which on an aircraft flies, m/s, and the time after that at which it is said to, s."""
LEARNING, SHORT, LONG = 60.0, 40.0, 200.0
"""Time in flight in which everything is learned, s; in flights that are not longer than LONG it is SHORT."""
BETWEEN = 10.0
"""From cut to cut, and from the last one to the end, s."""
DATES = {"thor75": 2012.78, "swisslog1": 2014.0, "alfa_engine_failure": 2018.55}
"""Years of flights, for Earth's field: no stream has them."""
DATE = 2016.0
"""Of others: in ten years declination changes by a degree or two, which is learned with the wind."""
TICKS = (0.02, 0.01, 0.005, 0.004, 0.002, 0.001)
FAST = 40.0
"""Samples of the inertial unit in a second from which on an attitude can be made of them."""
METHOD = "hard-iron"
NEEDED = ("imu", "magnetometer", "gps", "air")


@dataclass(frozen=True)
class Flight:
    """A recording in ``folder``; times in s of its log."""

    folder: Path

    @property
    def name(self) -> str:
        return self.folder.name

    def stream(self, name: str) -> pd.DataFrame:
        return pd.read_parquet(self.folder / f"{name}.parquet")

    @cached_property
    def gps(self) -> pd.DataFrame:
        """Fixes that have all numbers, one for each time; a velocity down that was not recorded is 0."""
        fixes = self.stream("gps")
        if "velocity_down" not in fixes:
            fixes = fixes.assign(velocity_down=0.0)
        needed = ["latitude", "longitude", "altitude", "velocity_north", "velocity_east", "velocity_down"]
        return fixes[["time", *needed]].dropna().drop_duplicates("time").reset_index(drop=True)

    @cached_property
    def interval(self) -> float:
        """Between samples of the inertial unit, s, the median."""
        return float(np.median(np.diff(self.stream("imu")["time"])))

    @property
    def tick(self) -> float:
        """At which samples come, s: well below what lies between two of the inertial unit."""
        return next((tick for tick in TICKS if tick < 0.7 * self.interval), TICKS[-1])

    @property
    def fast(self) -> bool:
        """Whether its inertial unit was recorded often enough for an attitude."""
        return self.interval <= 1.0 / FAST

    @cached_property
    def airborne(self) -> tuple[float, float]:
        """The longest time above FLYING, but for less than 5 s, from SETTLED after its begin on; whole seconds."""
        fast = np.hypot(self.gps["velocity_north"], self.gps["velocity_east"]).to_numpy() > FLYING
        times = self.gps["time"].to_numpy()
        longest = max(parts(times, fast), key=lambda part: part[1] - part[0], default=(0.0, 0.0))
        least = SETTLED + SHORT + 2.0 * BETWEEN
        if longest[1] - longest[0] < least:
            raise NavfmuError(f"{self.folder}: nothing in it flies for {least:g} s above {FLYING:g} m/s by GPS")
        return float(np.ceil(longest[0]) + SETTLED), float(np.floor(longest[1]))

    @property
    def learned(self) -> float:
        """When GPS is taken away first, s."""
        return self.airborne[0] + (LEARNING if self.airborne[1] - self.airborne[0] > LONG else SHORT)

    @property
    def cuts(self) -> np.ndarray:
        """When GPS is taken away for good, s: each of these is a flight of its own."""
        return np.arange(self.learned, self.airborne[1] - BETWEEN, BETWEEN)

    @cached_property
    def field_n(self) -> np.ndarray:
        """Earth's field where the flight begins, T, by the World Magnetic Model."""
        first = self.gps.iloc[0]
        date = DATES.get(self.name, DATE)
        return np.asarray(magnetic_field.field(first["latitude"], first["longitude"], first["altitude"], date))

    @property
    def declination(self) -> float:
        return float(np.arctan2(self.field_n[1], self.field_n[0]))

    @cached_property
    def hard_iron(self) -> np.ndarray | None:
        """What ``navfmu calibrate magnetometer`` finds before the first cut, T; None where it refuses."""
        samples = self.stream("magnetometer")
        samples = samples[samples["time"].between(self.airborne[0], self.learned)].dropna()
        strength, horizontal = (float(np.linalg.norm(self.field_n[:n])) for n in (3, 2))
        found = None
        with contextlib.suppress(NavfmuError):
            centre = choose(vectors(samples, "field"), strength, horizontal, METHOD, self.name).locus.centre
            found = np.concatenate([centre, np.zeros(3 - len(centre))])  # in a level turn of x and y alone
        return found

    @cached_property
    def air(self) -> tuple[str, Mapping[str, Any]]:
        """The file with air data, and which of its columns ``navfmu replay air_data`` is to take."""
        pressures = (self.folder / "pressure.parquet").exists()
        name = "pressure" if pressures and "dynamic_pressure" in self.stream("pressure") else "air"
        have = self.stream(name)
        names = {"calibrated_airspeed": "indicated_airspeed", "impact_pressure": "dynamic_pressure"}
        speed = next(({ours: (theirs,)} for ours, theirs in names.items() if theirs in have), {})
        level = {} if {"static_pressure", "pressure_altitude"} & {*have} else {
            "values": {"pressure_altitude": f"{self.gps['altitude'].median():.1f} m"}
        }  # fmt: skip
        return name, {"columns": speed, **level}


def flights(folder: Path) -> list[Flight]:
    """All folders that hold what a flight needs, by name."""
    return [Flight(each) for each in sorted(folder.iterdir()) if all((each / f"{n}.parquet").exists() for n in NEEDED)]


def parts(times: np.ndarray, fast: np.ndarray) -> list[tuple[float, float]]:
    """Begin and end of times that are ``fast``, but for slow ones that follow each other for less than 5 s."""
    found: list[tuple[float, float]] = []
    slow = times[~fast]
    for time in times[fast]:
        between = slow[(slow > found[-1][1]) & (slow < time)] if found else slow
        if found and (len(between) == 0 or np.ptp(between) < 5.0):
            found[-1] = found[-1][0], time
        else:
            found.append((time, time))
    return found


def vectors(samples: pd.DataFrame, name: str) -> np.ndarray:
    """A vector's columns, (n, 3)."""
    return samples[[f"{name}_{axis}" for axis in AXES]].to_numpy(float).copy()
