"""Flights with all errors of sensors, wind and ranges, and several navigators on each, side by side.

Truth, wind, inertial unit, magnetometer, air data, GPS and attitude are flown once; each navigator has a receiver of
ranges and an evaluation of its own. Each receiver has noise of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from navfmu import Fault, System
from navfmu.figures import Task
from navfmu.ssp import SystemSource

FMUS = ("wind", "aircraft", "imu", "magnetometer", "air_data", "dme", "gps", "ahrs", "evaluation")
STEP = 0.01
NO_MEAN = {"wind": {"mean_n": [0.0, 0.0, 0.0]}}
"""A wind about a mean of 0, which the filters of the thesis forecast."""
ERRORS = ("north_error", "east_error")
POSITION, ANGLES = ("latitude", "longitude", "altitude"), ("roll", "pitch", "heading")


@dataclass(frozen=True)
class Flown:
    """What was seen, each of shape (run, second): errors north and east, m, and what was claimed of them, m2."""

    time: np.ndarray
    north: np.ndarray
    east: np.ndarray
    nn: np.ndarray
    ne: np.ndarray
    ee: np.ndarray

    @property
    def error(self) -> np.ndarray:
        """Horizontal, m."""
        return np.hypot(self.north, self.east)

    @property
    def squares(self) -> np.ndarray:
        """Normalised squared error, two degrees of freedom."""
        n, e = self.north, self.east
        return (n * n * self.ee - 2.0 * n * e * self.ne + e * e * self.nn) / (self.nn * self.ee - self.ne**2)

    def at(self, seconds: np.ndarray) -> Flown:
        """At these times only."""
        places = np.searchsorted(self.time, seconds)
        return Flown(
            self.time[places], *(getattr(self, name)[:, places] for name in ("north", "east", "nn", "ne", "ee"))
        )


@dataclass(frozen=True)
class Side:
    """A navigator: its FMU, its parameters, and the receiver's mode."""

    fmu: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    mode: int = 1


@dataclass(frozen=True)
class Flights:
    """Navigators by a name each, in the errors of ``parameters`` (by component and name)."""

    task: Task
    sides: Mapping[str, Side]
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @cached_property
    def system(self) -> System:
        """All of them."""
        folder = self.task.folder / f"flown{len(list(self.task.folder.glob('*')))}"
        folder.mkdir()
        source = SystemSource("flown", fmus=folder, stop_time=2100.0, step=STEP)
        one = {name: name for name in FMUS if name not in ("dme", "evaluation")}
        for name, fmu in one.items():
            self._component(source, folder, name, fmu)
        self._sensors(source)
        for stream, (name, side) in enumerate(self.sides.items(), 1):
            receiver, judge = f"{name}_dme", f"{name}_evaluation"
            for part, fmu in ((receiver, "dme"), (name, side.fmu), (judge, "evaluation")):
                self._component(source, folder, part, fmu)
            source.parameters(receiver, {"mode": side.mode, "stream": stream, **self.parameters.get("dme", {})})
            source.parameters(name, dict(side.parameters))
            self._navigator(source, name, receiver, judge, side.fmu == "navigator_inertial")
        source.connect(f"{next(iter(self.sides))}.solution", "ahrs.position")
        source.write(folder / "system")
        return System.load(folder / "system")

    def _component(self, source: SystemSource, folder: Path, name: str, fmu: str) -> None:
        (folder / f"{fmu}.fmu").write_bytes(self.task.fmu(fmu).read_bytes())
        source.component(name, f"{fmu}.fmu")
        if name in self.parameters:
            source.parameters(name, dict(self.parameters[name]))

    def _sensors(self, source: SystemSource) -> None:
        for output in POSITION:
            for sensor in ("magnetometer", "gps"):
                source.connect(f"aircraft.{output}", f"{sensor}.{output}")
        for output in ANGLES:
            for sensor in ("magnetometer", "gps"):
                source.connect(f"aircraft.{output}", f"{sensor}.{output}")
        for start, ends in {
            "wind.wind_n": ("aircraft.wind_n",),
            "aircraft.velocity_n": ("air_data.velocity_n", "gps.velocity_n"),
            "aircraft.altitude": ("air_data.altitude",),
            "aircraft.air_velocity_n": ("air_data.wind_n",),
            "aircraft.specific_force": ("imu.specific_force",),
            "aircraft.rate": ("imu.rate",),
            "imu.reading": ("ahrs.imu",),
            "magnetometer.field": ("ahrs.field",),
            "air_data.air": ("ahrs.air",),
        }.items():
            for end in ends:
                source.connect(start, end)

    def _navigator(self, source: SystemSource, name: str, receiver: str, judge: str, inertial: bool) -> None:
        for output in POSITION:
            source.connect(f"aircraft.{output}", f"{receiver}.{output}").connect(
                f"aircraft.{output}", f"{judge}.{output}"
            )
        source.connect("aircraft.velocity_n", f"{receiver}.velocity_n")
        for start, end in (
            ("ahrs.attitude", "attitude"),
            ("air_data.air", "air"),
            ("gps.fix", "fix"),
            (f"{receiver}.ranging", "ranging"),
            *([("imu.reading", "imu")] if inertial else []),
        ):
            source.connect(start, f"{name}.{end}")
        source.connect(f"{name}.solution", f"{judge}.solution")

    def fly(
        self, runs: int, stop: float, lost: tuple[float, float | None], total: int | None = None
    ) -> dict[str, Flown]:
        """So many flights, by seeds from that of the task on; GPS is ``lost`` from and until, s."""
        names = {
            name: [
                *(f"{name}_evaluation.{error}" for error in ERRORS),
                *(f"{name}.position_covariance[{i}]" for i in (1, 2, 3)),
            ]
            for name in self.sides
        }
        recorded = [one for each in names.values() for one in each]
        back = {} if lost[1] is None else {"duration": lost[1] - lost[0]}
        jammed = [Fault("gps_lost", "gps.jammed", "input", value=True, start=lost[0], **back)]
        found, time = [], np.zeros(0)
        for number in range(runs):
            run = self.system.run(
                stop=stop, step=STEP, seed=1000 * self.task.seed + number, record=recorded, record_period=1.0,
                faults=jammed,
            )  # fmt: skip
            time = run.index.to_numpy()
            found.append(run[recorded].to_numpy(float))
            self.task.progress(number + 1, total or runs)
        every = np.array(found).reshape(runs, len(time), len(self.sides), 5)
        return {name: Flown(time, *np.moveaxis(every[:, :, i], -1, 0)) for i, name in enumerate(self.sides)}
