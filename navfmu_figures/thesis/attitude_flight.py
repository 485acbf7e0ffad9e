"""A flight of ``aircraft`` whose gyros and three GPS antennas attitude filters see, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from navfmu import Fault, System
from navfmu.ssp import SystemSource

STEP = 0.05
"""s: 20 Hz, p. 132."""
PERIOD = 0.5
"""Of GPS attitude, s."""
RATE = 1.0 / STEP
ANGLES = ("roll", "pitch", "heading")
HORIZON = {"gyro_drift_sigma": np.radians(0.05), "gyro_drift_time": 1000.0, "gyro_noise_sigma": np.radians(0.05)}
"""Systron Donner Horizon, Table 3.1."""
NULL_SHIFT = np.radians(0.1)
"""1 sigma, rad/s (not in the thesis)."""
PERFECT = {"gyro_scale_factor_sigma": 0.0, "misalignment_sigma": 0.0}
FILTER = {
    "sample_period": STEP,
    "aiding_period": PERIOD,
    "gyro_noise": np.radians(0.05),
    "gyro_drift_sigma": np.radians(0.05),
    "gyro_drift_time": 1000.0,
    "gyro_scale_sigma": 0.0,
}
"""What Tables 4.2 to 4.4 have in common."""
IDENTITY = np.radians(1.0) / np.sqrt(2.0 * FILTER["gyro_drift_sigma"] ** 2 / FILTER["gyro_drift_time"])
"""What beta is multiplied by where R_wb is not (4.44) but the identity, in (deg/s)^2/s."""
SCHEDULED = 2


def table(alpha: float, beta: float, **more: float) -> dict[str, float]:
    """Parameters of a filter; alpha of the variance of a sample, (4.43), becomes one of its density."""
    return {**FILTER, "alpha": alpha * np.sqrt(RATE), "beta": beta, "gains": SCHEDULED, **more}


@dataclass(frozen=True)
class Flight:
    """Filters, by a name each, with their FMUs and parameters, and which of them are shown the field."""

    folder: Path
    fmus: Mapping[str, Path]
    filters: Mapping[str, tuple[str, Mapping[str, Any]]]
    unit: Mapping[str, Any]
    field: tuple[str, ...] = ()

    @cached_property
    def system(self) -> System:
        source = SystemSource("attitude", fmus=self.folder, stop_time=600.0, step=STEP)
        for fmu in self.fmus.values():
            (self.folder / fmu.name).write_bytes(fmu.read_bytes())
        sensors = ["imu", "gps", *(["magnetometer", "air_data"] if self.field else [])]
        for name in ("aircraft", *sensors):
            source.component(name, f"{name}.fmu")
        for name in ("latitude", "longitude", "altitude", *ANGLES):
            for sensor in ("gps", "magnetometer") if self.field else ("gps",):
                source.connect(f"aircraft.{name}", f"{sensor}.{name}")
        source.connect("aircraft.velocity_n", "gps.velocity_n")
        if self.field:
            source.connect("aircraft.velocity_n", "air_data.velocity_n")
            source.connect("aircraft.altitude", "air_data.altitude").connect(
                "aircraft.air_velocity_n", "air_data.wind_n"
            )
        source.connect("aircraft.rate", "imu.rate").connect("aircraft.specific_force", "imu.specific_force")
        source.parameters("imu", {"sample_period": STEP, **PERFECT, **self.unit})
        source.parameters("aircraft", {"update_period": STEP})
        for name, (fmu, parameters) in self.filters.items():
            source.component(name, f"{fmu}.fmu").parameters(name, parameters)
            source.connect("imu.reading", f"{name}.imu").connect("gps.attitude", f"{name}.gps")
            source.connect("gps.fix", f"{name}.position")
            if name in self.field:
                source.connect("magnetometer.field", f"{name}.field").connect("air_data.air", f"{name}.air")
        source.write(self.folder / "system")
        return System.load(self.folder / "system")

    def run(
        self,
        stop: float,
        lost: float,
        seed: int,
        period: float = PERIOD,
        more: tuple[str, ...] = (),
        parameters: Mapping[str, Any] | None = None,
    ) -> Any:
        """The recording of a flight of ``stop`` s that has no GPS from ``lost`` s on."""
        names = [f"{name}.{shown}" for name in self.filters for shown in ("attitude", "gyro_bias", "aiding")]
        return self.system.run(
            stop=stop,
            step=STEP,
            record_period=period,
            seed=seed,
            parameters=parameters or {},
            record=[*(f"aircraft.{angle}" for angle in ANGLES), *names, *more],
            faults=[Fault("gps_lost", "gps.jammed", "input", value=True, start=lost)],
        )


def errors(run: Any, name: str) -> np.ndarray:
    """Errors of roll, pitch and heading of a filter, degrees, (times, 3)."""
    off = np.stack([run[f"{name}.attitude.{angle}"] - run[f"aircraft.{angle}"] for angle in ANGLES], axis=1)
    return np.degrees((off + np.pi) % (2.0 * np.pi) - np.pi)
