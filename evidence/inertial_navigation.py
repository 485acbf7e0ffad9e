"""``navigator_inertial`` beside an inertial navigator of other people, ``pyins`` (PyPI python-ins), on equal samples.

Strapdown integration of a flight with circles and no errors; and filters with fifteen states on flights with all errors
of an automotive unit, with GPS and a minute after its loss. Both are given the same error models. Without ``pyins``
(``pip install 'navfmu[others]'``) nothing is claimed.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.section import Section, illustrated, left_out
from fmus.grades import inertial_parameters
from models.attitude import quaternion
from models.navigation import inertial
from models.satellite import gps
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.system import shipped
from navfmu.system.system import System

HEADING = "Inertial navigation beside pyins"
STEP, STRAIGHT = 0.01, 600.0
"""Of samples, and length of the strapdown flight, s."""
BEGIN, LOST, STOP = 60.0, 300.0, 360.0
"""Both filters begin, GPS is lost, and the end, s."""
RUNS = 6
ANGLES = ("roll", "pitch", "heading")
AXES = (1, 2, 3)
POSITION = ("latitude", "longitude", "altitude")
APART = 1.0
"""m after ten minutes, horizontally: both are of second order, and neither has a reason to be off by more. In altitude
they have other formulas of gravity above the ellipsoid, whose difference runs away: 4 m at 1800 m."""
RATIO = 1.1
"""Of rms errors of two filters with the same models."""


def truth(name: str) -> list[str]:
    """Signals of the true motion."""
    return [f"aircraft.{one}" for one in (*POSITION, *ANGLES)] + [f"aircraft.velocity_n[{i}]" for i in AXES]


def samples(run: pd.DataFrame, rate: str, force: str) -> tuple[np.ndarray, np.ndarray]:
    """Angular rate and specific force, (samples, 3)."""
    return tuple(run[[f"{name}[{i}]" for i in AXES]].to_numpy() for name in (rate, force))


def pva(row: pd.Series, position: np.ndarray, velocity: np.ndarray, angles: np.ndarray) -> pd.Series:
    """Position, velocity and attitude as pyins takes them, in degrees."""
    names = ["lat", "lon", "alt", "VN", "VE", "VD", "roll", "pitch", "heading"]
    degrees = np.degrees(position[:2])
    return pd.Series([*degrees, position[2], *velocity, *np.degrees(angles)], index=names, name=row.name)


def imu_table(time: np.ndarray, rate: np.ndarray, force: np.ndarray) -> pd.DataFrame:
    """Samples as pyins takes them."""
    columns = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    return pd.DataFrame(np.hstack([rate, force]), index=time, columns=columns)


@dataclass(frozen=True)
class Strapdown:
    """Seconds, and horizontal distances in m: of ours to pyins, and of both to the truth."""

    time: np.ndarray
    apart: np.ndarray
    ours: np.ndarray
    theirs: np.ndarray


def strapdown(system: System) -> Strapdown:
    """The shipped flight from perfect samples."""
    names = [*truth("aircraft"), *(f"aircraft.{name}[{i}]" for name in ("rate", "specific_force") for i in AXES)]
    run = system.run(stop=STRAIGHT, step=STEP, record=names, record_period=STEP, seed=1)
    rate, force = samples(run, "aircraft.rate", "aircraft.specific_force")
    time = run.index.to_numpy()
    true = run[[f"aircraft.{name}" for name in POSITION]].to_numpy()
    velocity = run[[f"aircraft.velocity_n[{i}]" for i in AXES]].to_numpy()
    angles = run[[f"aircraft.{name}" for name in ANGLES]].to_numpy()
    ours = [true[0]]
    position, speed, turn = true[0], velocity[0], quaternion.of_euler(*angles[0])
    for k in range(1, len(time)):
        mean, felt = 0.5 * (rate[k] + rate[k - 1]), 0.5 * (force[k] + force[k - 1])
        position, speed, turn = inertial.strapdown(position, speed, turn, mean, felt, STEP)
        ours.append(position)
    other = importlib.import_module("pyins.strapdown")
    increments = other.compute_increments_from_imu(imu_table(time, rate, force), "rate")
    integrator = other.Integrator(pva(run.iloc[0], true[0], velocity[0], angles[0]))
    integrator.integrate(increments)
    theirs = integrator.trajectory[["lat", "lon", "alt"]].to_numpy().copy()
    theirs[:, :2] = np.radians(theirs[:, :2])
    scale = np.array(inertial.metres(true[0, 0], true[0, 2]))
    ours = np.array(ours)

    def distance(one: np.ndarray, two: np.ndarray) -> np.ndarray:
        return np.linalg.norm(((one - two) * scale)[:, :2], axis=1)

    return Strapdown(time, distance(ours, theirs), distance(ours, true), distance(theirs, true))


@dataclass(frozen=True)
class Filters:
    """Horizontal errors by second, m, (runs, seconds): of ours and of pyins."""

    time: np.ndarray
    ours: np.ndarray
    theirs: np.ndarray

    def rms(self, begin: float, end: float) -> tuple[float, float]:
        """Of ours and of theirs between two times."""
        inside = (self.time > begin) & (self.time <= end)
        return tuple(float(np.sqrt(np.mean(one[:, inside] ** 2))) for one in (self.ours, self.theirs))


def filters(system: System) -> Filters:
    """Flights with all errors: ours as the FMU says it, theirs on what it was told, from BEGIN on."""
    names = [
        *truth("aircraft"), *(f"imu.reading.{name}[{i}]" for name in ("rate", "specific_force") for i in AXES),
        *(f"gps.fix.{name}" for name in POSITION), *(f"gps.fix.velocity_n[{i}]" for i in AXES),
        *(f"navigator.solution.{name}" for name in POSITION), *(f"navigator.solution.velocity_n[{i}]" for i in AXES),
        *(f"navigator.angles.{name}" for name in ANGLES), *(f"navigator.angles.{name}_sigma" for name in ANGLES),
    ]  # fmt: skip
    jammed = [Fault("gps", "gps.jammed", "input", start=LOST)]
    both, time = [], np.zeros(0)
    for seed in range(1, RUNS + 1):
        run = system.run(
            stop=STOP, step=STEP, record=names, record_period=STEP, seed=seed, faults=jammed,
            parameters={"navigator.dme_aiding": False},
        )  # fmt: skip
        run = run[run.index > BEGIN - 0.5 * STEP]
        theirs = other_filter(run)
        at = np.arange(BEGIN + 1.0, STOP + 0.5)
        seen = run.iloc[np.searchsorted(run.index.to_numpy(), at - 0.5 * STEP)]
        shown = theirs.iloc[np.searchsorted(theirs.index.to_numpy(), at - 0.5 * STEP)]
        own = seen[[f"navigator.solution.{name}" for name in POSITION[:2]]].to_numpy()
        true = seen[[f"aircraft.{name}" for name in POSITION[:2]]].to_numpy()
        scale = np.array(inertial.metres(true[0, 0], 1000.0))[:2]
        errors = [np.hypot(*((one - true) * scale).T) for one in (own, np.radians(shown[["lat", "lon"]].to_numpy()))]
        both.append(errors)
        time = at
    ours, theirs = np.moveaxis(np.array(both), 1, 0)
    return Filters(time, ours, theirs)


def other_filter(run: pd.DataFrame) -> pd.DataFrame:
    """pyins from where and how ours is at BEGIN, with fixes until LOST: positions and velocities of n."""
    pyins = {name: importlib.import_module(f"pyins.{name}") for name in ("filters", "measurements", "inertial_sensor")}
    increments = importlib.import_module("pyins.strapdown").compute_increments_from_imu
    grade = inertial_parameters("automotive")
    gyro, force = (
        pyins["inertial_sensor"].EstimationModel(
            bias_sd=float(np.hypot(grade[f"{name}_null_shift_sigma"], grade[f"{name}_drift_sigma"])),
            noise=grade[f"{name}_noise"] * np.sqrt(STEP),
            bias_walk=grade[f"{name}_drift_sigma"] * np.sqrt(2.0 / grade[f"{name}_drift_time"]),
        )
        for name in ("gyro", "accelerometer")
    )
    first = run.iloc[0]
    start = pva(
        first,
        first[[f"navigator.solution.{name}" for name in POSITION]].to_numpy(),
        first[[f"navigator.solution.velocity_n[{i}]" for i in AXES]].to_numpy(),
        first[[f"navigator.angles.{name}" for name in ANGLES]].to_numpy(),
    )
    sigmas = np.degrees([first[f"navigator.angles.{name}_sigma"] for name in ANGLES])
    fixes = run.iloc[:: round(1.0 / STEP)]
    fixes = fixes[fixes.index <= LOST]
    place = np.column_stack(
        [
            np.degrees(fixes["gps.fix.latitude"]),
            np.degrees(fixes["gps.fix.longitude"]),
            fixes["gps.fix.altitude"],
        ]
    )
    speed = fixes[[f"gps.fix.velocity_n[{i}]" for i in AXES]].to_numpy()
    spread = np.array([gps.HORIZONTAL_SIGMA, gps.HORIZONTAL_SIGMA, gps.VERTICAL_SIGMA])
    measurements = [
        pyins["measurements"].Position(pd.DataFrame(place, fixes.index, ["lat", "lon", "alt"]), spread),
        pyins["measurements"].NedVelocity(pd.DataFrame(speed, fixes.index, ["VN", "VE", "VD"]), gps.VELOCITY_SIGMA),
    ]
    rate, felt = samples(run, "imu.reading.rate", "imu.reading.specific_force")
    found = pyins["filters"].run_feedback_filter(
        start, gps.HORIZONTAL_SIGMA, gps.VELOCITY_SIGMA, float(np.max(sigmas[:2])), float(sigmas[2]),
        increments(imu_table(run.index.to_numpy(), rate, felt), "rate"), gyro, force, measurements,
    )  # fmt: skip
    return found.trajectory


def run(out: Path) -> Section:
    """Both comparisons."""
    if importlib.util.find_spec("pyins") is None:
        return left_out(HEADING, "pyins is not installed (pip install 'navfmu[others]')")
    system = System.load(shipped.path("backup_navigator.ssp"), "navigator_inertial")
    integrated, filtered = strapdown(system), filters(system)
    claims = claimed(integrated, filtered)
    write_file(out / "inertial_navigation.png", picture(integrated, filtered))
    words = "Strapdown integration and filters beside those of pyins"
    table = rows(integrated, filtered)
    return illustrated(HEADING, claims, lambda: picture(integrated, filtered), words, *table)


def claimed(integrated: Strapdown, filtered: Filters) -> Sequence[Claim]:
    """What is claimed of both."""
    with_gps, without = filtered.rms(BEGIN + 60.0, LOST), filtered.rms(STOP - 1.0, STOP)
    apart = float(integrated.apart[-1])
    return [
        Claim("Ten minutes of strapdown integration end where pyins has them", apart, APART, False, "m horizontally",
              opposite="Strapdown integration ends elsewhere than that of pyins"),
        Claim("With GPS the filter is as good as that of pyins: rms error over theirs", with_gps[0] / with_gps[1],
              RATIO, False, "", opposite="With GPS the filter is worse than that of pyins"),
        Claim("and a minute after its loss", without[0] / without[1], RATIO, False, "",
              opposite="A minute after the loss of GPS it is worse than that of pyins"),
    ]  # fmt: skip


def rows(integrated: Strapdown, filtered: Filters) -> tuple[list[str], list[list[str]]]:
    """Errors of both."""
    with_gps, without = filtered.rms(BEGIN + 60.0, LOST), filtered.rms(STOP - 1.0, STOP)
    head = ["horizontal error, m", "navigator_inertial", "pyins"]
    return head, [
        ["strapdown of perfect samples, 10 min", f"{integrated.ours[-1]:.2f}", f"{integrated.theirs[-1]:.2f}"],
        [f"rms with GPS, {RUNS} flights", *(f"{one:.2f}" for one in with_gps)],
        [f"rms a minute after its loss, {RUNS} flights", *(f"{one:.0f}" for one in without)],
    ]  # fmt: skip


def picture(integrated: Strapdown, filtered: Filters) -> bytes:
    """Distances of strapdown integration, errors of the filters."""
    with figure(1, 2, size=(11.5, 4.2)) as (drawing, (left, right)):
        for one, label, colour in (
            (integrated.apart, "ours to pyins", COLOURS[0]),
            (integrated.ours, "ours to the truth", COLOURS[1]),
            (integrated.theirs, "pyins to the truth", COLOURS[2]),
        ):
            left.plot(integrated.time / 60.0, one, color=colour, label=label)
        left.set(xlabel="time, min", ylabel="distance, m", ylim=(0.0, None))
        left.legend()
        title(drawing, left, f"Perfect samples: {integrated.apart[-1]:.2f} m apart after ten minutes")
        for errors, label, colour in ((filtered.ours, "ours", COLOURS[0]), (filtered.theirs, "pyins", COLOURS[2])):
            right.plot(filtered.time, np.sqrt(np.mean(errors**2, axis=0)), color=colour, label=label)
        right.axvline(LOST, color="0.5", ls=":", lw=0.9)
        right.set(xlabel="time, s (dotted: GPS is lost)", ylabel=f"rms of {RUNS} flights, m", yscale="log")
        right.yaxis.set_major_formatter("{x:g}")
        right.legend()
        ours, theirs = filtered.rms(STOP - 1.0, STOP)
        title(drawing, right, f"A minute after the loss of GPS {ours:.0f} m, pyins {theirs:.0f} m")
        return png(drawing)
