"""Quaternion and Euler angles side by side: the same accuracy, and the vertical."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from navfmu import System
from navfmu.constants import STANDARD_GRAVITY
from navfmu.figures import Comparison, Found, Task, row
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import import_samples
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.ssp import SystemSource
from navfmu_figures.thesis.attitude_flight import HORIZON, IDENTITY, NULL_SHIFT, STEP, Flight, errors, table

RUNS, CLIMBS = 20, 12
SETTLED, LOST, STOP = 240.0, 600.0, 900.0
"""Biases have settled (Fig 4.10); GPS is lost; the end, s."""
FILTERS = {"Euler angles": "ahrs_euler", "quaternion": "ahrs_quaternion"}
TURNING = {f"aircraft.segment_turn_rate[{i}]": np.radians(3.0) * (-1) ** i for i in range(1, 5)}
TURNING |= {f"aircraft.segment_duration[{i}]": 120.0 for i in range(1, 5)}
"""Turns through a circle to either side."""
LEVEL, UP, END = 120.0, 149.0, 180.0
"""Of a climb: flown level with field and gravity; straight up until then, 9 s after; the end, s."""
DIP, STRENGTH = np.radians(61.2), 4.75e-5
AIDED = table(np.sqrt(STEP), 1.0, tilt_sigma=np.radians(0.5), needle_sigma=np.radians(0.8), declination=0.0)
"""Noise and drift of the gyros as they are, level and field."""
CASES = {
    f"{name}, {gains}": (fmu, number)
    for name, fmu in FILTERS.items()
    for number, gains in enumerate(("computed", "scheduled"), 1)
}
"""FMU and gains."""
FAR = 10.0
"""Degrees."""


@dataclass(frozen=True)
class Climbs:
    """Climbs straight up without anything but gyros, by case."""

    off: dict[str, np.ndarray]
    """What is left of the whole rotation, degrees, (climbs, times)."""
    valid: dict[str, np.ndarray]
    """Whether there was an attitude, (climbs, times)."""

    def lost(self, case: str) -> float:
        """Percent of the climbs after which the attitude is far off, or there is none."""
        return 100.0 * float(np.mean((self.off[case][:, -1] > FAR) | ~self.valid[case][:, -1]))

    def largest(self, case: str) -> np.ndarray:
        """Largest rotation that is left of each climb, while there is an attitude, degrees."""
        return np.max(np.where(self.valid[case], self.off[case], 0.0)[:, round(LEVEL / STEP) :], axis=1)


def side_by_side(task: Task, runs: int = RUNS) -> np.ndarray:
    """Root mean squares of errors, degrees, (runs, filters, with and without GPS, roll, pitch and heading)."""
    folder = task.folder / "flights"
    folder.mkdir()
    fmus = {name: task.fmu(name) for name in ("aircraft", "imu", "gps", *FILTERS.values())}
    filters = {name: (name, table(0.2, 2.0e-4 * IDENTITY)) for name in FILTERS.values()}
    flight = Flight(folder, fmus, filters, {**HORIZON, "gyro_null_shift_sigma": NULL_SHIFT})
    found = []
    for number in range(runs):
        run = flight.run(STOP, LOST, 1000 * task.seed + number, parameters=TURNING)
        off = [errors(run, name) for name in filters]
        spans = (run.index > SETTLED) & (run.index <= LOST), run.index > LOST
        found.append([[np.sqrt(np.mean(one[span] ** 2, axis=0)) for span in spans] for one in off])
        task.progress(number, runs + CLIMBS)
    return np.array(found)


def climb() -> Rotation:
    """Level, 20 s straight up with a nose that wavers by 2 degrees about the vertical, level again; at 0, STEP ..."""
    time = np.arange(round(END / STEP) + 1) * STEP
    pitch = 10.0 * (np.clip(time - LEVEL, 0.0, 9.0) - np.clip(time - UP, 0.0, 9.0))
    up = np.clip(time - LEVEL - 9.0, 0.0, UP - LEVEL - 9.0)
    wavering = 2.0 * np.column_stack([np.sin(0.4 * np.pi * up), np.sin(0.2 * np.pi * up)])
    level = Rotation.from_euler("ZYX", np.column_stack([0.0 * time + 40.0, pitch, 0.0 * time]), degrees=True)
    return level * Rotation.from_euler("ZY", wavering, degrees=True)


def climbed(task: Task, climbs: int = CLIMBS) -> Climbs:
    """Fly all cases up; the field is shown until the climb begins."""
    turns = climb()
    rates = (turns[:-1].inv() * turns[1:]).as_rotvec() / STEP
    rates = np.concatenate([rates[:1], 0.5 * (rates[1:] + rates[:-1]), rates[-1:]])
    down = turns.inv().apply([0.0, 0.0, 1.0])
    field = STRENGTH * turns.inv().apply([np.cos(DIP), 0.0, np.sin(DIP)])
    off: dict[str, list] = {case: [] for case in CASES}
    valid: dict[str, list] = {case: [] for case in CASES}
    for number in range(climbs):
        rng = np.random.default_rng([task.seed, number])
        wrong = NULL_SHIFT * rng.standard_normal(3) + HORIZON["gyro_noise_sigma"] * rng.standard_normal(rates.shape)
        shown = {
            "imu": {"rate": rates + wrong, "specific_force": -STANDARD_GRAVITY * down},
            "magnetometer": {"field": field[: round(LEVEL / STEP) + 1]},
        }
        folder = task.folder / f"climb{number}"
        folder.mkdir()
        run = System.load(_system(task, folder, shown)).run(
            stop=END, step=STEP, record_period=STEP, record=[f"{name}.attitude" for name in _names()]
        )
        for case, name in zip(CASES, _names(), strict=True):
            angles = run[[f"{name}.attitude.{angle}" for angle in ("heading", "pitch", "roll")]].to_numpy()
            left = turns.inv() * Rotation.from_euler("ZYX", angles[: len(turns)])
            off[case].append(np.degrees(left.magnitude()))
            valid[case].append(run[f"{name}.attitude.valid"].to_numpy() > 0.0)
        task.progress(RUNS + number, RUNS + climbs)
    return Climbs(*({case: np.array(values) for case, values in of.items()} for of in (off, valid)))


def _names() -> list[str]:
    return [f"filter_{i}" for i in range(len(CASES))]


def _system(task: Task, folder: Path, shown: dict[str, dict[str, np.ndarray]]) -> Path:
    """All cases, shown one recording of an inertial unit and a magnetometer."""
    system = SystemSource("climb", fmus=folder, stop_time=END, step=STEP)
    for sensor, vectors in shown.items():
        columns = {f"{name}_{axis}": values[:, i] for name, values in vectors.items() for i, axis in enumerate("xyz")}
        time = STEP * np.arange(len(next(iter(vectors.values()))))
        pd.DataFrame({"time": time, **columns})[1:].to_parquet(folder / f"{sensor}.parquet")
        player = import_samples(read(folder / f"{sensor}.parquet"), task.fmu(f"{sensor}_replay"), Asked(start=0.0))
        player.write(folder / f"{sensor}.fmu")
        system.component(sensor, f"{sensor}.fmu").parameters(sensor, {"tick_period": STEP})
    for fmu in FILTERS.values():
        (folder / f"{fmu}.fmu").write_bytes(task.fmu(fmu).read_bytes())
    for name, (fmu, gains) in zip(_names(), CASES.values(), strict=True):
        system.component(name, f"{fmu}.fmu").parameters(name, {**AIDED, "gains": gains})
        system.connect("imu.reading", f"{name}.imu").connect("magnetometer.field", f"{name}.field")
    system.write(folder / "system")
    return folder / "system"


@row(
    "A quaternion is as accurate as Euler angles, and the vertical is none of its singular attitudes",
    "thesis section 4.11.2, 4.11.3, (4.52)-(4.60), pp. 137-140",
    fmus=["ahrs_euler", "ahrs_quaternion", "aircraft", "imu", "gps", "imu_replay", "magnetometer_replay"],
)
def t11(task: Task) -> Found:
    """Flights with both, and climbs."""
    flights, climbs = side_by_side(task), climbed(task)
    words = "Errors of both filters in each flight, and of all cases in climbs straight up"
    return Found([*accurate(flights), *vertical(climbs)], picture(flights, climbs), words, NOTES)


NOTES = (
    "(4.58) leaves out the states before the update, and with them the biases; (4.59) prints q_GPS q^ for q^* q_GPS; "
    "(4.2), (4.3) have the whole angle for the half.",
    "What ends Euler angles with computed gains at the vertical is Phi, which has no bounds there: a sigma "
    "passes half a turn. With gains at rest there is no Phi, and 20 samples a second pass by the midpoint rule.",
)


def accurate(flights: np.ndarray) -> list[Comparison]:
    """Root mean square of all errors of the quaternion over that of Euler angles."""
    means = np.sqrt(np.mean(flights**2, axis=(0, 3)))
    why = "the readings are the same, so what is left is rounding and what the filters leave out: a hundredth"
    return [
        Comparison(f"errors of the quaternion over those of Euler angles, {when}", "no difference",
                   float(means[1, i] / means[0, i]), 0.99, 1.01, why)
        for i, when in enumerate(("with GPS", "5 min without"))
    ]  # fmt: skip


def vertical(climbs: Climbs) -> list[Comparison]:
    """What climbs leave of the attitudes."""
    cases = list(CASES)
    quaternion = max(float(np.max(climbs.largest(case))) for case in cases if case.startswith("quaternion"))
    gyro = np.degrees(HORIZON["gyro_noise_sigma"])
    why = "0.5 deg of the level and the needle before, and the walk of the gyros' noise, four standard deviations"
    limit = 4.0 * float(np.hypot(0.5, gyro * np.sqrt(STEP * (END - LEVEL))))
    return [
        Comparison("largest error of the quaternion", "none singular", quaternion, 0.0, limit, why, "deg"),
        Comparison("climbs that end Euler angles, gains computed", "singular", climbs.lost(cases[0]), 50.0, 100.0,
                   "most of them, if the vertical is what ends them", "%"),
    ]  # fmt: skip


def picture(flights: np.ndarray, climbs: Climbs) -> bytes:
    """Flights at the left, a climb and all of them at the right."""
    with figure(1, 3, size=(13.0, 4.2)) as (drawing, (alike, one, all_of_them)):
        for i, (when, colour) in enumerate(zip(("with GPS", "5 min without"), COLOURS, strict=False)):
            alike.loglog(*flights[:, :, i].transpose(1, 0, 2).reshape(2, -1), "o", ms=3, color=colour, label=when)
        ends = [flights.min(), flights.max()]
        alike.plot(ends, ends, "--", lw=0.8, color=COLOURS[2])
        alike.set(xlabel="Euler angles, deg rms", ylabel="quaternion, deg rms")
        alike.legend()
        title(drawing, alike, "Both err alike")
        time = np.arange(climbs.off[next(iter(CASES))].shape[1]) * STEP - LEVEL
        for case, colour in zip(CASES, COLOURS, strict=False):
            shown = np.where(climbs.valid[case][0], climbs.off[case][0], np.nan)
            width = 4.0 if case == next(iter(CASES)) else 1.2  # the first lies under the second until it ends
            one.semilogy(time, np.maximum(shown, 1e-3), lw=width, color=colour, label=case)
        one.set(
            xlabel="time since the climb began, s", ylabel="error, deg", xlim=(-20.0, END - LEVEL), ylim=(1e-2, 3.0)
        )
        one.legend()
        title(drawing, one, "A climb without anything but gyros")
        for case, colour in zip(CASES, COLOURS, strict=False):
            largest = np.sort(climbs.largest(case))
            all_of_them.plot(largest, np.arange(1, len(largest) + 1), "o-", ms=4, color=colour,
                                 label=f"{case}: {climbs.lost(case):.0f} % lost")  # fmt: skip
        all_of_them.set(xlabel="largest error of a climb, deg", ylabel="climbs with less")
        all_of_them.legend(fontsize=8, loc="lower right")
        title(drawing, all_of_them, f"{len(largest)} climbs")
        return png(drawing)
