"""A flight without errors, and what navigators claim of theirs along it: the covariance analyses of the thesis.

A filter's covariance depends on where it is flown, not on what its sensors say. So sensors are perfect, and a navigator
that shows its covariance is the analysis. Truth comes from ``aircraft``, fixes until LAST from a ``gps``, heading, roll
and pitch from the antennas of another that is never jammed, ranges from ``dme``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from navfmu import Fault, System
from navfmu.ssp import SystemSource

FMUS = ("aircraft", "gps", "imu", "air_data", "dme")
LAST = 2.0
"""Time of the last fix, s: jammed from then on, the next one is none."""
FAR = 500e3
"""m: no station is out of reach."""
_PERFECT = {
    "gps": {"horizontal_sigma": 0.0, "vertical_sigma": 0.0, "velocity_sigma": 0.0, "attitude_sigma": 0.0},
    "aircraft": {"wander_sigma": 0.0, "gust_sigma": 0.0},
    "imu": {"misalignment_sigma": 0.0}
    | {
        f"{sensor}_{error}_sigma": 0.0
        for sensor in ("gyro", "accelerometer")
        for error in ("null_shift", "scale_factor", "drift", "noise")
    },
    "air_data": {
        f"{name}_sigma": 0.0
        for name in ("airspeed_error", "altitude_error", "pitot_coefficient", "pressure_offset", "temperature_error")
    },
    "dme": {"bias_sigma": 0.0, "noise_sigma": 0.0},
}
POSITION, ANGLES = ("latitude", "longitude", "altitude"), ("roll", "pitch", "heading")


@dataclass(frozen=True)
class Flight:
    """FMUs by name, a flight plan and stations as parameters, and the step of all of it, s."""

    folder: Path
    fmus: Mapping[str, Path]
    plan: Mapping[str, Any]
    stations: Mapping[str, Any]
    step: float = 1.0

    def claims(
        self,
        navigator: str,
        stop: float,
        parameters: Mapping[str, Any],
        dme: Mapping[str, Any] | None = None,
        inertial: bool = False,
        inputs: Mapping[str, float] | None = None,
    ) -> pd.DataFrame:
        """Variances of north and east and their covariance (columns "nn", "ne", "ee", m2) by seconds after the last
        fix; ``dme`` are parameters of the receiver, ``inputs`` values of what is told of heading and airspeed."""
        system = self.system(navigator, parameters, dme or {}, inertial, inputs or {})
        names = [f"navigator.position_covariance[{i}]" for i in (1, 2, 3)]
        lost = Fault("lost", "gps.jammed", "input", value=True, start=LAST)
        run = system.run(stop=stop + LAST, step=self.step, record=names, record_period=1.0, faults=[lost])
        after = run[run.index > LAST]
        after.columns = ["nn", "ne", "ee"]
        return after.set_index(after.index - LAST)

    def system(self, navigator, parameters, dme, inertial, inputs) -> System:
        """The system with this navigator."""
        folder = self.folder / str(len(list(self.folder.glob("*"))))
        folder.mkdir(parents=True)
        source = SystemSource("claims", fmus=folder, stop_time=3600.0, step=self.step)
        parts = {"aircraft": "aircraft", "gps": "gps", "antennas": "gps", "air_data": "air_data", "dme": "dme"}
        parts |= {"navigator": navigator} | ({"imu": "imu"} if inertial else {})
        for name, fmu in parts.items():
            (folder / f"{fmu}.fmu").write_bytes(self.fmus[fmu].read_bytes())
            source.component(name, f"{fmu}.fmu")
            source.parameters(name, dict(_PERFECT.get(fmu, {})))
        source.parameters("antennas", {**_PERFECT["gps"], "stream": 1})
        for name in POSITION:
            for sensor in ("gps", "antennas", "dme"):
                source.connect(f"aircraft.{name}", f"{sensor}.{name}")
        for name in ANGLES:
            source.connect(f"aircraft.{name}", f"antennas.{name}").connect(f"aircraft.{name}", f"gps.{name}")
        for sensor in ("gps", "antennas", "dme", "air_data"):
            source.connect("aircraft.velocity_n", f"{sensor}.velocity_n")
        source.connect("aircraft.altitude", "air_data.altitude").connect("aircraft.air_velocity_n", "air_data.wind_n")
        source.connect("gps.fix", "navigator.fix").connect("dme.ranging", "navigator.ranging")
        for name in (*(ANGLES if inertial else ANGLES[2:]), "valid", "sequence", "time_of_validity"):
            source.connect(f"antennas.attitude.{name}", f"navigator.attitude.{name}")
        for name in ("true_airspeed", "pressure_altitude", "valid", "sequence", "time_of_validity"):
            source.connect(f"air_data.air.{name}", f"navigator.air.{name}")
        source.parameters("aircraft", dict(self.plan))
        source.parameters("dme", {**self.stations, "station_range": FAR, **dme})
        told = {f"{name}": value for name, value in inputs.items()}
        source.parameters("navigator", {**self.stations, **parameters, **told})
        if inertial:
            source.connect("aircraft.specific_force", "imu.specific_force").connect("aircraft.rate", "imu.rate")
            source.connect("imu.reading", "navigator.imu")
            source.parameters("imu", {**_PERFECT["imu"], "sample_period": self.step})
        source.write(folder / "system")
        return System.load(folder / "system")


def horizontal(claims: pd.DataFrame) -> pd.Series:
    """Root of the sum of both variances, m, (5.61)."""
    return np.sqrt(claims["nn"] + claims["ee"])


def first_above(sigma: pd.Series, limit: float) -> float:
    """When it passes a limit for the first time, s; infinite if never."""
    above = sigma.index[sigma > limit]
    return float(above[0]) if len(above) else float("inf")
