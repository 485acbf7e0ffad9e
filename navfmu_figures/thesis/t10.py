"""GPS attitude and gyros by Euler angles: biases that are learned, and what is left when GPS is lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.attitude_flight import (
    ANGLES,
    HORIZON,
    IDENTITY,
    NULL_SHIFT,
    STEP,
    Flight,
    errors,
    table,
)

RUNS = 60
LOST, STOP = 600.0, 900.0
"""GPS is lost, and five minutes later, s."""
LIMIT = 4.0
"""Degrees, Fig 4.11."""
AVERAGED = 10.0
"""Seconds on either side over which noise is averaged out of what the gyros are wrong by."""
EVERY = 5.0
"""s between the moments at which biases are looked at."""
DRIFTS = {"0.05 deg/s (Table 3.1)": 0.05, "0.01 deg/s (p. 46)": 0.01}
"""The Horizon's drift, deg/s: of all five hours of Fig 3.4, and without its warming up."""
TABLES = {"euler": table(0.2, 2.0e-4 * IDENTITY), "printed": table(0.2, 2.0e-4)}
"""Table 4.2, beta with the identity as R_wb and with (4.44)."""


@dataclass(frozen=True)
class Flown:
    """What flights with one drift have shown; times are those of the moments."""

    time: np.ndarray
    missing: dict[str, np.ndarray]
    """What is missing in the biases of each table, deg/s, (runs, times, 3)."""
    learned: np.ndarray
    """The biases of the first run, deg/s, (times, 3)."""
    off: np.ndarray
    """Errors of roll, pitch and heading after GPS is lost, degrees, (runs, times, 3)."""

    def left(self, name: str) -> np.ndarray:
        """Root of the mean of squares of what is missing, over what was at first."""
        return np.sqrt(np.mean(self.missing[name] ** 2, axis=(0, 2))) / np.degrees(NULL_SHIFT)


def flown(task: Task, drift: float, done: int = 0, runs: int = RUNS) -> Flown:
    """Fly RUNS times with a drift of so many deg/s; ``done`` runs were made before."""
    folder = task.folder / str(done)
    folder.mkdir()
    unit = {**HORIZON, "gyro_drift_sigma": np.radians(drift), "gyro_null_shift_sigma": NULL_SHIFT}
    fmus = {name: task.fmu(name) for name in ("aircraft", "imu", "gps", "ahrs_euler")}
    flight = Flight(folder, fmus, {name: ("ahrs_euler", values) for name, values in TABLES.items()}, unit)
    half = round(AVERAGED / STEP)
    at = np.arange(half, round(LOST / STEP) - half + 1, round(EVERY / STEP))
    missing: dict[str, list[np.ndarray]] = {name: [] for name in TABLES}
    learned, off = [], []
    for number in range(runs):
        run = flight.run(STOP, LOST, 1000 * task.seed + number, STEP, ("imu.reading.rate", "aircraft.rate"))
        rates = [run[[f"{name}[{i}]" for i in (1, 2, 3)]].to_numpy() for name in ("imu.reading.rate", "aircraft.rate")]
        total = np.cumsum(np.degrees(rates[0] - rates[1]), axis=0)
        wrong = (total[at + half] - total[at - half]) / (2 * half)
        for name in TABLES:
            told = np.degrees(run[[f"{name}.gyro_bias[{i}]" for i in (1, 2, 3)]].to_numpy())
            missing[name].append(told[at] - wrong)
            if name == "euler":
                learned.append(told[at])
        off.append(errors(run, "euler")[round(LOST / STEP) :: round(EVERY / STEP)])
        task.progress(done + number, len(DRIFTS) * runs)
    return Flown(at * STEP, {name: np.array(values) for name, values in missing.items()}, learned[0], np.array(off))


@row(
    "Gyro biases settle in 3 to 4 minutes, and 5 minutes without GPS are coasted with less than 4 degrees in all axes",
    "thesis section 4.11.1, (4.32)-(4.51), pp. 131-135, Table 4.2, Figs 4.10, 4.11",
    fmus=["ahrs_euler", "aircraft", "imu", "gps"],
)
def t10(task: Task) -> Found:
    """Many flights with both drifts that the thesis has for the gyros."""
    by_drift = {name: flown(task, drift, RUNS * i) for i, (name, drift) in enumerate(DRIFTS.items())}
    words = "Biases of one flight, what is missing in those of all, and errors after GPS is lost"
    return Found([*settled(by_drift), *coasted(by_drift)], picture(by_drift), words, NOTES)


NOTES = (
    "(4.34), (4.54) have F_gyro at the left, where it would drive biases by angles; (4.35), (4.45) print -cos for -sin "
    "in row 2, column 3; (4.50) prints (H' P H + R).",
    "alpha 0.2 is 1 / sqrt(25 Hz): R_wn (4.43), the variance of a sample, is taken for a density, and at 20 samples "
    "a second the gyros' own noise has 0.22.",
    "The size of the null shift is not in the thesis, 0.1 deg/s (1 sigma) is taken; what is left over it depends on it "
    "little.",
)


def settled(by_drift: dict[str, Flown]) -> list[Comparison]:
    """Minutes until a twentieth of the null shift is left, and what (4.44) as printed leaves by then."""
    quiet = by_drift[list(DRIFTS)[-1]]
    minutes = np.argmax(quiet.left("euler") < 0.05) * EVERY / 60.0 + quiet.time[0] / 60.0
    late = quiet.time > 240.0
    left = 100.0 * float(np.mean(quiet.left("printed")[late]))
    why = "half a minute to either side, which is what 'stabilized' leaves open: from a tenth to a thirtieth is left"
    known = Difference(
        80.0, 110.0,
        "beta 2e-4 times the drift of (4.44) puts the pole of a bias at 6 hours. Where R_wb is the identity in "
        "(deg/s)^2/s, as the text has it for FOGs, the pole is at 46 s, and biases settle as in Fig 4.10",
    )  # fmt: skip
    return [
        Comparison("until 5 % of the null shift are left", "3 to 4 min", float(minutes), 2.5, 4.5, why, "min"),
        Comparison("left after 4 min with R_wb of (4.44)", "settled", left, 0.0, 10.0, "settled is a tenth or less",
                   "%", difference=known),
    ]  # fmt: skip


def coasted(by_drift: dict[str, Flown]) -> list[Comparison]:
    """Percent of the flights that stay below 4 degrees in all axes for five minutes."""
    why = "the thesis's is one flight: it is none of ours only if hardly one of them stays below"
    return [
        Comparison(f"flights below {LIMIT:g} deg for 5 min, drift {name}", "the one flight",
                   100.0 * float(np.mean(np.abs(flights.off).max(axis=(1, 2)) < LIMIT)), 2.5, 100.0, why, "%")
        for name, flights in by_drift.items()
    ]  # fmt: skip


def picture(by_drift: dict[str, Flown]) -> bytes:
    """A panel each."""
    quiet = by_drift[list(DRIFTS)[-1]]
    with figure(1, 3, size=(13.0, 4.2)) as (drawing, (biases, missing, coasting)):
        for i, axis in enumerate("pqr"):
            biases.plot(quiet.time / 60.0, quiet.learned[:, i], color=COLOURS[i], label=axis)
            truth = quiet.learned[:, i] - quiet.missing["euler"][0, :, i]
            biases.plot(quiet.time / 60.0, truth, ":", lw=0.8, color=COLOURS[i])
        biases.set(xlabel="time, min", ylabel="bias, deg/s (dotted: true)")
        biases.legend()
        title(drawing, biases, "One flight, as Fig 4.10")
        for (drift, flights), colour in zip(by_drift.items(), COLOURS, strict=False):
            missing.plot(flights.time / 60.0, 100.0 * flights.left("euler"), color=colour, label=drift)
        missing.plot(quiet.time / 60.0, 100.0 * quiet.left("printed"), "--", color=COLOURS[2], label="R_wb of (4.44)")
        missing.axvspan(3.0, 4.0, color=COLOURS[3], alpha=0.15)
        missing.set(xlabel="time, min", ylabel="of the null shift is missing, %", yscale="log")
        missing.legend()
        title(drawing, missing, f"Biases settle ({RUNS} flights)")
        for (drift, flights), colour in zip(by_drift.items(), COLOURS, strict=False):
            worst = np.sort(np.abs(flights.off).max(axis=2), axis=0)
            time = np.arange(worst.shape[1]) * EVERY / 60.0
            coasting.plot(time, np.median(worst, axis=0), color=colour, label=drift)
            coasting.fill_between(time, *np.quantile(worst, [0.05, 0.95], axis=0), color=colour, alpha=0.15, lw=0)
        coasting.axhline(LIMIT, ls="--", color=COLOURS[2], label="thesis, one flight")
        coasting.set(xlabel="time without GPS, min", ylabel=f"largest of {', '.join(ANGLES)}, deg")
        coasting.legend()
        title(drawing, coasting, "Median and 90 % of the flights")
        return png(drawing)
