"""Gyros aided by level and field with gates: what diverges without, and what coasts through turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.attitude_flight import ANGLES, IDENTITY, PERIOD, STEP, Flight, errors, table

RUNS = 16
LOST, STOP = 105.0, 1500.0
"""GPS attitude until then, as in Fig 4.18; the end, s."""
TABLE = table(10.0, 1.0e-5 * IDENTITY, tilt_sigma=np.radians(0.06), needle_sigma=np.radians(0.8))
"""Table 4.4."""
FILTERS = {"open loop": {}, "aided": {}, "compensated": {"compensated": True}}
"""Without field and level, with them and the gates of p. 149, with the acceleration that airspeed and rates say."""
NOISE = {"vibrating structure": 0.05, "fibre optic": 0.2}
"""Of a sample, deg/s: Table 3.1."""
UNITS = {
    "vibrating structure": {"gyro_drift_sigma": np.radians(0.05), "gyro_drift_time": 300.0},
    "fibre optic": {"gyro_drift_sigma": 0.0},
}
"""DMU-6X and DMU-FOG, Table 3.1; null shifts have been found before."""
TURNING = np.radians(1.0)
"""rad/s of heading from which on the aircraft is in a turn."""
CLOSED = 0
"""The output ``aiding`` where nothing aids."""
RARE = 1e-3


@dataclass(frozen=True)
class Flown:
    """Flights with one unit; times are those after GPS was lost."""

    time: np.ndarray
    off: dict[str, np.ndarray]
    """Errors of roll, pitch and heading by filter, degrees, (runs, times, 3)."""
    closed: np.ndarray
    """Whether the gates of "aided" were closed, (runs, times)."""
    rate: np.ndarray
    """True rate of heading, rad/s, (runs, times)."""

    def rms(self, name: str, angle: str = "roll") -> float:
        return float(np.sqrt(np.mean(self.off[name][:, :, ANGLES.index(angle)] ** 2)))


def flown(task: Task, unit: str, done: int = 0, runs: int = RUNS) -> Flown:
    """Fly the Livermore plan, circles to either side, RUNS times; ``done`` runs were made before."""
    folder = task.folder / str(done)
    folder.mkdir()
    fmus = {name: task.fmu(name) for name in ("aircraft", "imu", "gps", "magnetometer", "air_data", "ahrs_euler")}
    filters = {name.replace(" ", "_"): ("ahrs_euler", {**TABLE, **more}) for name, more in FILTERS.items()}
    gyros = {**UNITS[unit], "gyro_noise_sigma": np.radians(NOISE[unit]), "gyro_null_shift_sigma": 0.0}
    flight = Flight(folder, fmus, filters, gyros, tuple(list(filters)[1:]))
    off: dict[str, list[np.ndarray]] = {name: [] for name in FILTERS}
    closed, rate = [], []
    for number in range(runs):
        run = flight.run(STOP, LOST, 1000 * task.seed + number)
        after = run.index.to_numpy() > LOST + PERIOD
        for name, filter_ in zip(FILTERS, filters, strict=True):
            off[name].append(errors(run, filter_)[after])
        closed.append(run["aided.aiding"].to_numpy()[after] == CLOSED)
        rate.append(np.gradient(np.unwrap(run["aircraft.heading"].to_numpy()), PERIOD)[after])
        task.progress(done + number, len(UNITS) * runs)
    time = run.index.to_numpy()[after] - LOST
    return Flown(time, {name: np.array(of) for name, of in off.items()}, np.array(closed), np.array(rate))


@row(
    "Level and field with gates keep what open loop loses, and fibre optic gyros coast through long turns",
    "thesis section 4.12, (4.67), pp. 148-153, Table 4.4, Figs 4.18, 4.19",
    fmus=["ahrs_euler", "aircraft", "imu", "gps", "magnetometer", "air_data"],
)
def t12(task: Task) -> Found:
    """Flights with both units of the thesis."""
    by_unit = {unit: flown(task, unit, RUNS * i) for i, unit in enumerate(UNITS)}
    words = "Errors of roll of one flight with each unit, gates closed where it is grey, and of all flights"
    return Found([*gated(by_unit), *kept(by_unit), walked(by_unit)], picture(by_unit), words, NOTES)


NOTES = (
    "(4.8), (4.9) are of what gravity shows, not of the specific force, and (4.9) leaves out cos(pitch).",
    "With Table 4.4 no bias is learned: beta 1e-5 puts the pole of a bias at hours or beyond, whatever R_wb is.",
    "Gyros feel Earth's rate, too: in open loop the mean of all flights goes away with it.",
    "The third filter is not in the thesis: no gates, but airspeed and rates say what acceleration is "
    "in the specific force. Its roll has half of the error of the gated one.",
)


def gated(by_unit: dict[str, Flown]) -> list[Comparison]:
    """Percent of the time in turns in which nothing aids."""
    flights = by_unit["vibrating structure"]
    turning = np.abs(flights.rate) > TURNING
    share = 100.0 * float(np.mean(flights.closed[turning]))
    why = "a turn's roll-in takes some seconds of its minutes to yaw at 0.5 deg/s"
    return [Comparison("of the time in turns the filter is off", "all", share, 95.0, 100.0, why, "%")]


def kept(by_unit: dict[str, Flown]) -> list[Comparison]:
    """Errors of roll in open loop over those with aiding."""
    said = {
        "vibrating structure": ("diverges; much better", 1.5, "'much better' is a third less, at the least"),
        "fibre optic": ("superior", 1.1, "superior is a tenth less, at the least"),
    }
    return [
        Comparison(f"error of roll in open loop over that with aiding, {unit}", printed,
                   by_unit[unit].rms("open loop") / by_unit[unit].rms("aided"), least, np.inf, why)
        for unit, (printed, least, why) in said.items()
    ]  # fmt: skip


def walked(by_unit: dict[str, Flown]) -> Comparison:
    """Spread of roll and pitch of the fibre optic gyros at the end about their mean, over (4.7).

    The mean is that of Earth's rate, which no gyro here is told of and all flights have alike.
    """
    flights = by_unit["fibre optic"]
    walk = NOISE["fibre optic"] * np.sqrt(flights.time[-1] * STEP)
    ends = flights.off["open loop"][:, -1, :2]
    free = 2 * (len(ends) - 1)
    low, high = np.sqrt(stats.chi2.ppf([0.5 * RARE, 1.0 - 0.5 * RARE], free) / free)
    found = float(np.sqrt(np.sum((ends - ends.mean(axis=0)) ** 2) / free)) / walk
    why = f"an angle that walks so spreads outside of this once in {1 / RARE:,.0f} times (chi-square of {free})"
    return Comparison("spread of fibre optic gyros in open loop over (4.7)", "random walk", found, low, high, why)


def picture(by_unit: dict[str, Flown]) -> bytes:
    """A flight with each unit, and the errors of all."""
    with figure(1, 3, size=(13.0, 4.2)) as (drawing, axes):
        for axis, (unit, flights) in zip(axes, by_unit.items(), strict=False):
            minutes = flights.time / 60.0
            for (name, off), colour in zip(flights.off.items(), COLOURS, strict=False):
                axis.plot(minutes, off[0, :, 0], color=colour, lw=0.9, label=name)
            span = axis.get_ylim()
            axis.fill_between(minutes, *span, where=flights.closed[0], color="0.9", lw=0, zorder=0)
            axis.set(xlabel="time without GPS, min", ylabel="error of roll, deg", ylim=span)
            axis.legend()
            title(drawing, axis, f"One flight, {unit}")
        place = np.arange(len(FILTERS))
        for i, ((unit, flights), colour) in enumerate(zip(by_unit.items(), COLOURS, strict=False)):
            axes[2].bar(place + 0.4 * i - 0.2, [flights.rms(name) for name in FILTERS], 0.38, color=colour, label=unit)
        axes[2].set_xticks(place, list(FILTERS))
        axes[2].set_ylabel("error of roll, deg rms")
        axes[2].legend()
        title(drawing, axes[2], f"{RUNS} flights with each")
        return png(drawing)
