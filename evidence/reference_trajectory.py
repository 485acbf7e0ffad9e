"""The reference trajectory of a recorded flight: an inertial navigator forwards, and what it knows afterwards.

For each flight in ``sensors/flights/`` under NAVFMU_DATA that ``flown_navigation`` takes: fifteen states with GPS
position and velocity at their time of validity, then the smoother of Rauch, Tung and Striebel. Fixes of half a minute
are kept from it, over and over along the flight: how far it is from these says what it is worth where nothing was kept
(AGARD CP-298, paper 11, made references so, of inertial units and radar or cameras, to some tens of metres).
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.recorded_sensors.flight import Flight, flights, vectors
from evidence.recorded_sensors.flown import attitude, delay
from evidence.section import Section, illustrated, left_out, recorded
from fmus.grades import inertial_parameters
from fmus.navigation.small_aircraft import INERTIAL
from models.attitude import quaternion
from models.filters import kalman
from models.filters.smoother import Step, smoothed
from models.navigation import inertial
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png, title

HEADING = "Reference trajectories of recorded flights"
GAP, EVERY = 30.0, 15.0
"""Fixes of GAP s are kept back, from a time on that moves by EVERY s, from SETTLED s after the begin to as long before
the end."""
SETTLED = 20.0
SUBSTEP = 0.1
"""Of the covariance, s."""
UNIT = {**inertial_parameters("automotive"), **INERTIAL.values}
VERTICAL = 5.0
"""Standard deviation of the altitude of a fix, m."""
TILT = (3.0, 3.0, 6.0)
"""Of the attitude reference in the first moment of flight, deg (own choice)."""
TIMES = 3.0
"""How many times nearer the smoothed trajectory is at least."""
AXES = ("north", "east", "down")


@dataclass(frozen=True)
class Trajectory:
    """By GPS epoch: time, s; position forwards and smoothed (rad, rad, m), and sigma of this, north and east, m."""

    time: np.ndarray
    forwards: np.ndarray
    smoothed: np.ndarray
    sigma: np.ndarray


@dataclass
class Navigator:
    """Position, velocity, attitude and biases, and their covariance, packed."""

    position: np.ndarray
    velocity: np.ndarray
    turn: np.ndarray
    biases: np.ndarray
    upper: np.ndarray

    def correct(self, correction: np.ndarray) -> None:
        """Blend in."""
        self.position = self.position + correction[inertial.POSITION]
        self.velocity = self.velocity + correction[inertial.VELOCITY]
        self.turn = quaternion.product(quaternion.of_rotation(correction[inertial.TILT]), self.turn)
        self.biases = self.biases + correction[9:]


def noise(time: float) -> tuple[np.ndarray, np.ndarray]:
    """Factors of the biases and the diagonal of C_d over a time, s."""
    force, force_time = inertial.slow(
        UNIT["accelerometer_null_shift_sigma"], UNIT["accelerometer_drift_sigma"], UNIT["accelerometer_drift_time"]
    )
    rate, rate_time = inertial.slow(UNIT["gyro_null_shift_sigma"], UNIT["gyro_drift_sigma"], UNIT["gyro_drift_time"])
    decay = np.exp(-time / np.repeat([force_time, rate_time], 3))
    white = np.repeat([0.0, UNIT["accelerometer_noise"] ** 2 * 0.01, UNIT["gyro_noise"] ** 2 * 0.01], 3) * time
    return decay, np.concatenate([white, np.repeat([force, rate], 3) ** 2 * (1.0 - decay**2)])


def begun(fix: pd.Series, angles: pd.Series) -> Navigator:
    """At a fix, with the attitude of then."""
    position = fix[["latitude", "longitude", "altitude"]].to_numpy(float)
    scale = np.array(inertial.metres(position[0], position[2]))
    force, _ = inertial.slow(
        UNIT["accelerometer_null_shift_sigma"], UNIT["accelerometer_drift_sigma"], UNIT["accelerometer_drift_time"]
    )
    rate, _ = inertial.slow(UNIT["gyro_null_shift_sigma"], UNIT["gyro_drift_sigma"], UNIT["gyro_drift_time"])
    sigmas = np.concatenate(
        [
            np.array([UNIT["fix_sigma"], UNIT["fix_sigma"], VERTICAL]) / scale,
            np.full(3, UNIT["velocity_sigma"]),
            np.radians(TILT),
            np.full(3, force),
            np.full(3, rate),
        ]
    )
    turn = quaternion.of_euler(*angles[["roll", "pitch", "heading"]].to_numpy(float))
    velocity = fix[[f"velocity_{axis}" for axis in AXES]].to_numpy(float)
    return Navigator(position, velocity, turn, np.zeros(6), kalman.of_variances(sigmas**2))


def carried(state: Navigator, time: np.ndarray, force: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Carry a navigator over samples at these times; returns Phi of all of it."""
    whole = np.eye(inertial.STATES)
    matrix, spent = np.zeros((inertial.DRIVEN, inertial.STATES)), 0.0
    for k in range(1, len(time)):
        step = time[k] - time[k - 1]
        mean, felt = (
            0.5 * (rate[k] + rate[k - 1]) - state.biases[3:],
            0.5 * (force[k] + force[k - 1]) - state.biases[:3],
        )
        C_nb = quaternion.dcm(quaternion.product(state.turn, quaternion.of_rotation(0.5 * step * mean)))
        matrix = matrix + step * inertial.dynamics(state.position, state.velocity, C_nb @ felt, C_nb)
        state.position, state.velocity, state.turn = inertial.strapdown(
            state.position, state.velocity, state.turn, mean, felt, step
        )
        spent += step
        if spent >= SUBSTEP or k == len(time) - 1:
            decay, added = noise(spent)
            rows = inertial.transition(matrix / spent, spent)
            state.upper = kalman.propagate(state.upper, rows, decay, added)
            whole = np.concatenate([rows, np.diag(np.concatenate([np.zeros(9), decay]))[9:]]) @ whole
            matrix, spent = np.zeros_like(matrix), 0.0
    return whole


def trajectory(flight: Flight, angles: pd.DataFrame, late: float, kept: tuple[float, float]) -> Trajectory:
    """Forwards and back, without the fixes between two times."""
    first, last = flight.airborne
    fixes = flight.gps.copy()
    fixes["time"] = fixes["time"] - late
    fixes = fixes[(fixes["time"] >= first) & (fixes["time"] <= last)].reset_index(drop=True)
    samples = flight.stream("imu")
    time, force, rate = samples["time"].to_numpy(), vectors(samples, "specific_force"), vectors(samples, "rate")
    start = float(fixes["time"].iloc[0])
    state = begun(fixes.iloc[0], angles.iloc[int(np.searchsorted(angles.index, start))])
    steps, positions = [], [state.position]
    before = start
    for _, fix in fixes.iloc[1:].iterrows():
        now = float(fix["time"])
        inside = (time > before) & (time < now)
        at = np.concatenate([[before], time[inside], [now]])
        one, two = (
            np.column_stack([np.interp(at, time, values[:, axis]) for axis in range(3)]) for values in (force, rate)
        )
        begins = kalman.unpack(state.upper)
        phi = carried(state, at, one, two)
        predicted = kalman.unpack(state.upper)
        correction = np.zeros(inertial.STATES)
        if not kept[0] < now <= kept[1]:
            correction = updated(state, fix)
        steps.append(Step(begins, phi, predicted, correction))
        positions.append(state.position)
        before = now
    changes, covariances = smoothed(steps, kalman.unpack(state.upper))
    forwards = np.array(positions)
    scale = np.array(inertial.metres(forwards[0, 0], forwards[0, 2]))
    sigma = np.sqrt(np.maximum(covariances[:, [0, 1], [0, 1]], 0.0)) * scale[:2]
    return Trajectory(fixes["time"].to_numpy(), forwards, forwards + changes[:, inertial.POSITION], sigma)


def updated(state: Navigator, fix: pd.Series) -> np.ndarray:
    """Take a fix, and return the correction."""
    scale = np.array(inertial.metres(state.position[0], state.position[2]))
    place = fix[["latitude", "longitude", "altitude"]].to_numpy(float)
    velocity = fix[[f"velocity_{axis}" for axis in AXES]].to_numpy(float)
    residuals = np.concatenate([place - state.position, velocity - state.velocity])
    sigmas = np.concatenate(
        [np.array([UNIT["fix_sigma"], UNIT["fix_sigma"], VERTICAL]) / scale, np.full(3, UNIT["velocity_sigma"])]
    )
    correction = np.zeros(inertial.STATES)
    for place_, row in enumerate(np.eye(inertial.STATES)[:6]):
        if np.isfinite(residuals[place_]):
            correction, state.upper, _ = kalman.update(
                correction, state.upper, row, sigmas[place_] ** 2, residuals[place_]
            )
    state.correct(correction)
    return correction


@dataclass(frozen=True)
class Kept:
    """A stretch of fixes that was kept back: how far both are from these, north and east, m, and the sigma of that, of
    what is smoothed and of a fix."""

    flight: str
    time: np.ndarray
    forwards: np.ndarray
    smoothed: np.ndarray
    sigma: np.ndarray


def kept_back(flight: Flight, angles: pd.DataFrame, late: float) -> list[Kept]:
    """All stretches of a flight."""
    first, last = flight.airborne
    fixes = flight.gps
    found = []
    for begin in np.arange(first + SETTLED, last - SETTLED - GAP, EVERY):
        one = trajectory(flight, angles, late, (begin, begin + GAP))
        inside = (one.time > begin) & (one.time <= begin + GAP)
        true = np.column_stack(
            [np.interp(one.time, fixes["time"] - late, fixes[name]) for name in ("latitude", "longitude")]
        )
        scale = np.array(inertial.metres(true[0, 0], 0.0))[:2]
        errors = [((way[:, :2] - true) * scale)[inside] for way in (one.forwards, one.smoothed)]
        sigma = np.hypot(one.sigma[inside], UNIT["fix_sigma"])
        found.append(Kept(flight.name, one.time[inside] - begin, *errors, sigma))
    return found


def run(out: Path) -> Section:
    """All flights."""
    folder, lacking = recorded("*/imu.parquet", under="sensors/flights")
    if lacking:
        return left_out(HEADING, lacking)
    found: list[Kept] = []
    with tempfile.TemporaryDirectory(prefix="navfmu-") as made:
        for flight in flights(folder):
            try:
                angles = attitude(flight, Path(made) / flight.name, flight.airborne[1])
                found += kept_back(flight, angles, delay(flight, angles))
            except NavfmuError:
                continue
    claims = claimed(found)
    write_file(out / "reference_trajectory.png", picture(found))
    words = "Errors where half a minute of fixes was kept back, forwards and smoothed"
    return illustrated(HEADING, claims, lambda: picture(found), words, *rows(found))


def rms(values: Sequence[np.ndarray]) -> float:
    """Horizontal, of several stretches, m."""
    return float(np.sqrt(np.mean(np.concatenate([np.sum(one**2, axis=1) for one in values]))))


def claimed(found: Sequence[Kept]) -> list[Claim]:
    """How much nearer smoothing is. What its sigma holds is told, and not claimed: units of 10 Hz alias."""
    ratio = rms([one.forwards for one in found]) / rms([one.smoothed for one in found])
    return [
        Claim("Without half a minute of fixes the smoothed trajectory is nearer than the filter by", ratio, TIMES, True,
              "times", opposite="Smoothing does not come nearer"),
    ]  # fmt: skip


def rows(found: Sequence[Kept]) -> tuple[list[str], list[list[str]]]:
    """Of each flight."""
    head = ["flight", "stretches", "forwards, m rms", "smoothed, m rms", "smoothed within 3 sigma, %"]
    table = []
    for name in dict.fromkeys(one.flight for one in found):
        ours = [one for one in found if one.flight == name]
        inside = np.mean(np.concatenate([np.abs(one.smoothed) <= 3.0 * one.sigma for one in ours]))
        table.append([name, str(len(ours)), f"{rms([one.forwards for one in ours]):.0f}",
                      f"{rms([one.smoothed for one in ours]):.1f}", f"{100.0 * inside:.0f}"])  # fmt: skip
    return head, table


def picture(found: Sequence[Kept]) -> bytes:
    """Errors over the time."""
    with figure(1, 2, size=(11.5, 4.2)) as (drawing, axes):
        names = list(dict.fromkeys(one.flight for one in found))
        for axis, kind in zip(axes, ("forwards", "smoothed"), strict=True):
            for one in found:
                colour = COLOURS[names.index(one.flight) % len(COLOURS)]
                axis.plot(one.time, np.hypot(*getattr(one, kind).T), color=colour, lw=0.8)
            axis.set(xlabel="time since the last fix, s", ylabel=f"{kind}: horizontal error, m", ylim=(0.0, None))
        for name in names:
            axes[1].plot([], [], color=COLOURS[names.index(name) % len(COLOURS)], label=name)
        axes[1].legend()
        title(drawing, axes[0], f"Alone the unit is {rms([one.forwards for one in found]):.0f} m off (rms)")
        title(drawing, axes[1], f"With the fixes after it, too, {rms([one.smoothed for one in found]):.0f} m")
        return png(drawing)
