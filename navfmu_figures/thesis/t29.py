"""The Allan chart of error mechanisms and of a Horizon."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from navfmu import System
from navfmu.calibration.allan.chart import Chart, chart
from navfmu.calibration.allan.terms import gauss_markov
from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu_figures.thesis.unit import at_rest

SAMPLES = 100_000
"""Of three axes, a second apart; the thesis has three hours of one."""
HORIZON, DRIFTS, TIME = 0.05, (0.01, 0.05), 1000.0
"""Noise and drift of the Horizon, deg/s, and its correlation time, s: Table 3.1 and section C.4."""
TURN = 300.0
"""s, where the measured chart of the Horizon turns, Fig 3.2."""
HOURS = 3.0
SIGMAS = 4.0
"""Of a slope; six slopes together are farther off once in 2600 times."""
LONG = 16.0
"""s: of shorter averages a slow error shows that it is held for a second."""
SECOND = {"sample_period": 1.0, "drift_period": 1.0}


@dataclass(frozen=True)
class Mechanism:
    """``printed`` is the slope of Table C.1, which holds from ``start`` to ``end`` (s) of averaging time.

    ``bend`` is by how much a slope over these times is another one for the mechanism itself.
    """

    name: str
    printed: float
    start: float
    end: float
    samples: np.ndarray
    bend: float = 0.0

    @property
    def chart(self) -> Chart:
        return chart([self.samples], 1.0)

    @property
    def slope(self) -> tuple[float, float]:
        """Slope of the deviation in logarithms, all axes together, and its standard deviation."""
        found = self.chart
        kept = (found.time >= self.start) & (found.time <= self.end)
        x, axes = np.log(found.time[kept]), self.samples.shape[1]
        y = 0.5 * np.log(np.mean(found.variance[kept], axis=1))
        weight = axes * found.pairs[kept]
        x = x - np.average(x, weights=weight)
        information = float(np.sum(weight * x * x))
        return float(np.sum(weight * x * y) / information), float(np.sqrt(0.5 / information))


def mechanisms(system: System, seed: int) -> list[Mechanism]:
    """One of each line of Table C.1: by the unit, but for a ramp and a sine, which need none."""

    def shown(what: str = "reading.rate", **errors: float) -> np.ndarray:
        given = {name: value if name.endswith("time") else np.radians(value) for name, value in errors.items()}
        return at_rest(system, float(SAMPLES), 1.0, seed, SECOND | given, what)

    noisy = {"gyro_noise_sigma": 10.0, "coning_samples": np.degrees(1.0)}
    pulses = shown("increment.angle", **noisy, angle_quantum=0.1) - shown("increment.angle", **noisy)
    time = np.arange(SAMPLES)[:, None]
    young = TIME / 10.0
    drift = shown(gyro_drift_sigma=DRIFTS[0], gyro_drift_time=TIME)
    bend = 0.5 * np.log(gauss_markov(young, TIME) / gauss_markov(LONG, TIME)) / np.log(young / LONG) - 0.5
    return [
        Mechanism("wide-band noise", -0.5, 1.0, 4096.0, shown(gyro_noise_sigma=HORIZON)),
        Mechanism("Gauss-Markov process, young", 0.5, LONG, young, drift, float(bend)),
        Mechanism("rate random walk", 0.5, LONG, 4096.0, shown(gyro_walk_sigma=0.05)),
        Mechanism("linear rate ramp", 1.0, 1.0, 4096.0, time / 3600.0),
        Mechanism("quantisation noise", -1.0, 1.0, 4096.0, pulses),
        Mechanism("sinusoid, far below its period", 1.0, 1.0, 64.0, np.sin(2.0 * np.pi * time / 2000.0)),
        Mechanism("flicker noise", 0.0, 32.0, 1024.0, shown(gyro_flicker=0.01, flicker_time=1.0)),
    ]


@row(
    "Errors have slopes of their own in an Allan chart, and that of the Horizon turns at 300 s",
    "thesis Appendix C, Table C.1, Figs C.1, C.4; section 3.3.1, Fig 3.2",
    fmus=["imu"],
)
def t29(task: Task) -> Found:
    """Simulate each mechanism, and the Horizon with both of its drifts."""
    system = System.load(task.fmu("imu"))
    found = mechanisms(system, task.seed)
    task.progress(1, 2)
    horizons = {}
    for sigma in DRIFTS:
        given = {
            "gyro_noise_sigma": np.radians(HORIZON),
            "gyro_drift_sigma": np.radians(sigma),
            "gyro_drift_time": TIME,
        }
        horizons[sigma] = chart([at_rest(system, float(SAMPLES), 1.0, task.seed, SECOND | given)], 1.0)
    words = "Allan deviations of error mechanisms, with the printed slopes, and of a Horizon with both of its drifts"
    comparisons = [*map(sloped, found), *turned(horizons)]
    return Found(comparisons, picture(found, horizons), words, NOTES)


NOTES = (
    "(C.4) prints the expectation without the square; half the mean square of the difference is taken.",
    "Three hours at 1 Hz are printed as 108 000 points; they are 10 800.",
    "Flicker noise of the unit is a sum of processes, flat from 18 to 1800 times the shortest correlation time.",
    "A ramp and a sinusoid are calculated, not simulated: the unit has neither.",
)


def sloped(one: Mechanism) -> Comparison:
    """A slope beside that of Table C.1."""
    slope, sigma = one.slope
    free = one.samples.shape[1] == 1  # calculated, no chance in it
    edge = 0.01 if free else SIGMAS * sigma
    low, high = one.printed + min(one.bend, 0.0) - edge, one.printed + max(one.bend, 0.0) + edge
    why = "nothing in it is random, and it is nearly a line" if free else f"{SIGMAS:g} standard deviations of the slope"
    why += f" from {one.start:g} to {one.end:g} s"
    if one.bend:
        why += f", and the bend of the closed form, {one.bend:+.3f}"
    return Comparison(f"slope of {one.name}", f"{one.printed:+g}", slope, low, high, why)


def turned(horizons: dict[float, Chart]) -> list[Comparison]:
    """How far above its lowest point the chart is where the printed one turns."""
    scatter = 100.0 / np.sqrt(2.0 * HOURS * 3600.0 / TURN)
    fine = np.geomspace(2.0, 4096.0, 500)
    above = {
        sigma: 100.0 * (float(level(found, TURN)) / np.min(level(found, fine)) - 1.0)
        for sigma, found in horizons.items()
    }
    one, other = DRIFTS
    return [
        Comparison(
            f"Horizon with a drift of {one:g} deg/s: chart at 300 s above its lowest point", "turns at 300 s",
            above[one], 0.0, scatter,
            f"one standard deviation of a chart of {HOURS:g} h at 300 s: nearer a lowest point cannot be read", "%",
        ),
        Comparison(
            f"the same with {other:g} deg/s", "matches less", above[other], scatter, np.inf,
            f"then the lowest point is elsewhere; {other:g} deg/s is to cover temperature, section C.4", "%",
        ),
    ]  # fmt: skip


def mean(found: Chart) -> np.ndarray:
    """Deviation of all axes together."""
    return np.sqrt(np.mean(found.variance, axis=1))


def level(found: Chart, time: float | np.ndarray) -> np.ndarray:
    """Deviation at averaging times between those of the chart."""
    return np.exp(CubicSpline(np.log(found.time), np.log(mean(found)))(np.log(time)))


def picture(found: list[Mechanism], horizons: dict[float, Chart]) -> bytes:
    """As Figs C.1 and C.4."""
    with figure(1, 2, size=(12.0, 4.8)) as (drawing, (errors, horizon)):
        for one, colour in zip(found, COLOURS, strict=False):
            drawn = one.chart
            errors.loglog(drawn.time, mean(drawn), "o", ms=3, color=colour, label=f"{one.name}, {one.printed:+g}")
            ends = np.array([one.start, one.end])
            middle = np.sqrt(ends[0] * ends[1])
            errors.loglog(ends, level(drawn, middle) * (ends / middle) ** one.printed, color=colour, lw=0.9)
        errors.set(
            xlabel="averaging time, s (lines: printed slopes)", ylabel="Allan deviation, deg/s", ylim=(1e-7, 30.0)
        )
        errors.legend(fontsize=7, ncols=2, loc="upper left")
        title(drawing, errors, "Table C.1")
        for (sigma, drawn), colour in zip(horizons.items(), COLOURS, strict=False):
            horizon.loglog(drawn.time, mean(drawn), "o-", ms=3, lw=0.9, color=colour, label=f"drift of {sigma:g} deg/s")
        horizon.axvline(TURN, color=GREY, lw=0.8, ls=":", label="300 s")
        horizon.set(xlabel="averaging time, s", ylabel="Allan deviation, deg/s")
        horizon.legend()
        title(drawing, horizon, "Horizon at 1 Hz, Fig C.4")
        return png(drawing)
