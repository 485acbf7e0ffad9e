"""The inertial unit at rest: Allan deviations of thesis Table C.1, the Horizon of Figs 3.2 and 3.5, and grades."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import allantools
import numpy as np

from evidence.section import Section
from fmus.inertial.grades import INERTIAL
from models.inertial import flicker
from navfmu import System
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system import shipped

DEG = np.pi / 180.0
HOUR = 3600.0
ALLOWED = 4.9
"""Standard deviations: probability 1e-6 on both sides."""
SENSORS = ("gyro", "accelerometer")
QUIET = {
    "misalignment_sigma": 0.0,
    **{f"{s}_{e}_sigma": 0.0 for s in SENSORS for e in ("null_shift", "scale_factor", "drift", "noise")},
}
SECOND = {"sample_period": 1.0, "drift_period": 1.0}
SAMPLES = 100_000
SPANS = 2 ** np.arange(15)
"""Averaging times, samples: of the longest there are six clusters."""
WHITE, DRIFT, TIME, WALK, FLOOR, QUANTUM = 0.05, 0.01, 1000.0, 0.05, 0.01, 0.1
TIMES = flicker.correlation_times(10.0).ravel()
"""Correlation times of the processes that make up flicker noise, s."""
GRADES = ("consumer", "automotive", "tactical", "navigation")
UNITS = (*GRADES, "fog", "ln_200", "rlgn")


def run(out: Path) -> Section:
    """Simulate, compare and draw."""
    unit = Unit()
    claims = [unit.tabled, unit.turns, unit.settles, unit.ordered]
    write_file(out / "sensors" / "imu.png", picture(unit, claims))

    def write(page: Page) -> None:
        page.heading("Inertial unit", 3)
        page.items(claim.sentence for claim in claims)
        page.picture(picture(unit, claims), "Allan deviations of errors and of units, and the warming of the Horizon")

    return Section(claims, write)


def simulate(stop: float, step: float, record: str, parameters: dict, inputs: dict | None = None) -> np.ndarray:
    """What the FMU alone shows, one row a step, without that at t = 0."""
    given = {f"imu.{name}": value for name, value in {**parameters, **(inputs or {})}.items()}
    system = System.load(shipped.path("imu.fmu"))
    frame = system.run(stop=stop, step=step, seed=1, parameters=given, record=[record], record_period=step)
    return frame.to_numpy()[1:]


def deviation(samples: np.ndarray, period: float, spans: np.ndarray) -> np.ndarray:
    """Allan deviation, root mean square over the axes."""
    found = [allantools.adev(axis, 1.0 / period, "freq", spans * period)[1] for axis in samples.T]
    return np.sqrt(np.mean(np.square(found), axis=0))


def markov(spans: np.ndarray, correlation_time: float) -> np.ndarray:
    """Allan variance of a Gauss-Markov process of unit variance that is sampled every second, exact.

    That of the process itself, ``navfmu.calibration.allan.terms``, is averaged between samples too: at one sample of a
    slow one it is two thirds of this.
    """
    left = -np.expm1(-1.0 / correlation_time)  # 1 - phi, small

    def total(n: np.ndarray) -> np.ndarray:
        """Variance of the sum of n samples."""
        return n * (2.0 - left) / left + 2.0 * (1.0 - left) * np.expm1(-n / correlation_time) / left**2

    return (4.0 * total(spans) - total(2 * spans)) / (2.0 * spans.astype(float) ** 2)


def spread(samples: int, spans: np.ndarray) -> np.ndarray:
    """Standard deviation of the logarithm of a deviation of three axes.

    Differences of successive clusters are correlated: two count as one at most.
    """
    return np.sqrt(2.0 / (2.0 * 3.0 * (samples / spans - 1.0)))


@dataclass(frozen=True)
class Unit:
    """What is measured, each part when it is first asked for. Rates in deg/s."""

    @cached_property
    def errors(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Of each error mechanism the deviations at SPANS, measured and in closed form."""
        time = SPANS.astype(float)
        expected = {
            "wide-band noise": ({"gyro_noise_sigma": WHITE}, WHITE / np.sqrt(time)),
            "Gauss-Markov drift": (
                {"gyro_drift_sigma": DRIFT, "gyro_drift_time": TIME},
                DRIFT * np.sqrt(markov(SPANS, TIME)),
            ),
            "rate random walk": (
                {"gyro_walk_sigma": WALK},
                WALK / np.sqrt(HOUR) * np.sqrt(time / 3.0 * (1.0 + 0.5 / time**2)),
            ),
            "flicker noise": (
                {"gyro_flicker": FLOOR},
                FLOOR * flicker.SHARE * np.sqrt(sum(markov(SPANS, tau) for tau in TIMES)),
            ),
        }
        found = {}
        for name, (parameters, closed) in expected.items():
            radians = {k: v if k.endswith("time") else v * DEG for k, v in parameters.items()}
            samples = simulate(SAMPLES, 1.0, "imu.reading.rate", {**QUIET, **SECOND, **radians}) / DEG
            found[name] = deviation(samples, 1.0, SPANS), closed
        return found | {"whole pulses": (self.pulses, 0.5 * QUANTUM / time)}

    @cached_property
    def pulses(self) -> np.ndarray:
        """Of the angle that whole pulses leave out; noise far above a pulse makes each remainder a new one."""
        noisy = {**QUIET, **SECOND, "gyro_noise_sigma": 100.0 * QUANTUM * DEG, "coning_samples": 1}
        exact = simulate(SAMPLES, 1.0, "imu.increment.angle", noisy)
        counted = simulate(SAMPLES, 1.0, "imu.increment.angle", {**noisy, "angle_quantum": QUANTUM * DEG})
        return deviation((counted - exact) / DEG, 1.0, SPANS)

    @property
    def tabled(self) -> Claim:
        off = [np.log(a / b) / spread(SAMPLES, SPANS) for a, b in self.errors.values()]
        return Claim(
            "Each error has its slope of thesis Table C.1: largest deviation from the closed form, in its own sigma",
            float(np.max(np.abs(off))), ALLOWED, False,
            opposite="An error does not have its slope of thesis Table C.1",
        )  # fmt: skip

    @cached_property
    def horizon(self) -> dict[str, np.ndarray]:
        """Deviations of the Horizon at 1 Hz, by the sigma of its drift."""
        found = {}
        for sigma in (0.01, 0.05):
            parameters = {"gyro_noise_sigma": 0.05 * DEG, "gyro_drift_sigma": sigma * DEG, "gyro_drift_time": TIME}
            samples = simulate(SAMPLES, 1.0, "imu.reading.rate", {**QUIET, **SECOND, **parameters}) / DEG
            found[f"{sigma} deg/s over 1000 s"] = deviation(samples, 1.0, SPANS)
        return found

    @property
    def turns(self) -> Claim:
        first = next(iter(self.horizon.values()))
        return Claim(
            "The Horizon turns at about 300 s, Fig 3.2: averaging time of the lowest point",
            float(SPANS[np.argmin(first[:12])]), 512.0, False, "s",
            "The Horizon does not turn at about 300 s",
        )  # fmt: skip

    @cached_property
    def warming(self) -> tuple[np.ndarray, np.ndarray]:
        """Five hours of a Horizon that warms itself: time in h, means of a minute of three gyros in deg/s."""
        values = {**INERTIAL["horizon_warming"].values, "gyro_null_shift_sigma": 0.0, **SECOND}
        means = simulate(5.0 * HOUR, 1.0, "imu.reading.rate", values).reshape(-1, 60, 3).mean(axis=1) / DEG
        return (np.arange(len(means)) + 0.5) / 60.0, means

    @property
    def settles(self) -> Claim:
        time, means = self.warming
        transient = 0.1 * np.exp(-time)
        left = means - transient[:, None]
        noise = 0.05**2 / 60.0  # of a mean of a minute; the drift of three gyros in 5 h is 27 independent values
        return Claim(
            "Warming itself the Horizon drifts for three hours, Fig 3.5: rms of what the transient leaves",
            float(np.sqrt(np.mean(left**2))), float(np.sqrt(noise + 0.01**2 * (1.0 + ALLOWED * np.sqrt(2.0 / 27.0)))),
            False, "deg/s",
            "Warming itself the Horizon does not drift as in Fig 3.5",
        )  # fmt: skip

    @cached_property
    def units(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Averaging times, s, and deviations, deg/h, of the gyros of each grade over an hour at 100 Hz."""
        found = {}
        for name in UNITS:
            values = {**INERTIAL[name].values, "sample_period": 0.01}
            samples = simulate(HOUR, 0.01, "imu.reading.rate", values) / DEG * HOUR
            spans = 2 ** np.arange(17)
            found[name] = 0.01 * spans, deviation(samples, 0.01, spans)
        return found

    @property
    def ordered(self) -> Claim:
        at = {name: deviations[14] for name, (_, deviations) in self.units.items()}  # 164 s, 21 clusters
        ratios = [at[a] / at[b] for a, b in pairwise(GRADES)]
        return Claim(
            "Grades differ by what they are called: least ratio of neighbours at 164 s",
            float(min(ratios)), 1.0, True,
            opposite="A grade is worse at 164 s than the one that should be worse",
        )  # fmt: skip


def picture(unit: Unit, claims: Sequence[Claim]) -> bytes:
    """A panel for each claim."""
    with figure(2, 2, size=(12.0, 8.4), left=0.8) as (drawing, axes):
        drawing.subplots_adjust(hspace=0.3)
        (errors, horizon), (warming, grades) = axes
        for (name, (found, closed)), colour in zip(unit.errors.items(), COLOURS, strict=False):
            errors.loglog(SPANS, found, "o", ms=4, color=colour, label=name)
            errors.loglog(SPANS, closed, "-", lw=0.8, color=colour)
        errors.set(xlabel="averaging time, s (lines: closed forms)", ylabel="Allan deviation, deg/s", ylim=(1e-6, 0.3))
        smooth = np.geomspace(1.0, SPANS[-1], 200)
        for (name, found), sigma, colour in zip(unit.horizon.items(), (0.01, 0.05), COLOURS, strict=False):
            closed = np.hypot(0.05 / np.sqrt(smooth), sigma * np.sqrt(markov(smooth, TIME)))
            horizon.loglog(SPANS, found, "o", ms=4, color=colour, label=name)
            horizon.loglog(smooth, closed, "-", lw=0.8, color=colour)
        horizon.axvline(300.0, color=GREY, lw=0.8, ls=":", label="300 s")
        horizon.set(xlabel="averaging time, s, at 1 Hz", ylabel="Allan deviation, deg/s")
        time, means = unit.warming
        level = np.mean(means)
        warming.plot(time, means - level, lw=0.8, color=COLOURS[0])
        warming.plot([], [], color=COLOURS[0], label="three gyros, means of a minute")
        warming.plot(time, 0.1 * np.exp(-time) - level, "k--", lw=1.2, label="transient alone")
        warming.axhline(-0.02, color=GREY, lw=0.8, ls=":", label="where it settles in Fig 3.6")
        warming.set(xlabel="time since turn-on, h", ylabel="rate at rest less its mean, deg/s")
        for (name, (times, found)), colour in zip(unit.units.items(), COLOURS, strict=False):
            grades.loglog(times, found, "-", color=colour, label=name)
        grades.set(xlabel="averaging time, s, at 100 Hz", ylabel="Allan deviation of the gyros, deg/h")
        for ax, claim in zip(axes.ravel(), claims, strict=True):
            title(drawing, ax, claim.sentence.partition(":")[0])
            ax.legend(fontsize=8, ncols=2 if ax is grades else 1)
        return png(drawing, 80)
