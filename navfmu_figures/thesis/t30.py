"""Angle random walk."""

from __future__ import annotations

import numpy as np
from scipy import stats

from navfmu import System
from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.unit import at_rest

SIGMA = 0.05
"""Wide-band noise of a Horizon, deg/s, thesis Table 3.1."""
CASES = ((1.0, 60.0), (1.0, 600.0), (20.0, 60.0))
"""Sampling frequency f_s, Hz, and duration T, s."""
ANGLES = 3000
"""How many are integrated of each case; three axes of one run each."""
CHANCE = 1e-4
"""Of a verdict that is wrong, of all cases together."""


@row(
    "An angle that is integrated of wide-band noise walks as sigma sqrt(T / f_s)",
    "thesis Appendix B, (B.10)",
    fmus=["imu"],
)
def t30(task: Task) -> Found:
    """Integrate gyros that stand still, and compare how the angles spread."""
    system = System.load(task.fmu("imu"))
    comparisons, walks = [], []
    for number, (frequency, duration) in enumerate(CASES):
        angles = integrated(system, frequency, duration, task.seed)
        task.progress(number + 1, len(CASES))
        walks.append(angles)
        comparisons.append(compared(angles[-1], frequency, duration))
    words = "Angles of gyros that stand still, integrated; the lines are one and two sigma of (B.10)"
    note = "(B.2) has n - 1 samples and (B.6) has n: n are taken, as (B.9) says."
    return Found(comparisons, picture(walks), words, [note])


def integrated(system: System, frequency: float, duration: float, seed: int) -> np.ndarray:
    """Angles in deg after 1, 2 ... n samples, (n, ANGLES): consecutive stretches of three axes."""
    step, n = 1.0 / frequency, round(frequency * duration)
    given = {"sample_period": step, "gyro_noise_sigma": np.radians(SIGMA)}
    rates = at_rest(system, ANGLES // 3 * duration, step, seed, given).reshape(ANGLES // 3, n, 3)
    return np.cumsum(rates, axis=1).transpose(1, 0, 2).reshape(n, ANGLES) * step


def compared(angles: np.ndarray, frequency: float, duration: float) -> Comparison:
    """Root mean square of the angles at the end over that of (B.10)."""
    expected = SIGMA * np.sqrt(duration / frequency)
    count = len(angles)
    low, high = np.sqrt(stats.chi2.ppf([0.5 * CHANCE / len(CASES), 1.0 - 0.5 * CHANCE / len(CASES)], count) / count)
    return Comparison(
        f"spread of angles after {duration:g} s at {frequency:g} Hz",
        f"{expected:.4g} deg",
        float(np.sqrt(np.mean(np.square(angles)))),
        float(low * expected),
        float(high * expected),
        f"{count} independent normal angles of (B.10)'s sigma spread outside of this once in "
        f"{len(CASES) / CHANCE:,.0f} times (chi-square)",
        "deg",
    )


def picture(walks: list[np.ndarray]) -> bytes:
    """Some angles of each case over time, and (B.10)."""
    with figure(1, len(walks), size=(12.0, 4.2)) as (drawing, axes):
        for axis, angles, (frequency, duration) in zip(axes, walks, CASES, strict=True):
            time = np.arange(1, len(angles) + 1) / frequency
            axis.plot(time, angles[:, :30], color=COLOURS[0], lw=0.4)
            sigma = SIGMA * np.sqrt(time / frequency)
            for factor in (-2.0, -1.0, 1.0, 2.0):
                axis.plot(time, factor * sigma, color=COLOURS[1], lw=1.2)
            axis.set(xlabel="time, s", ylabel="angle, deg")
            title(drawing, axis, f"{duration:g} s at {frequency:g} Hz")
        return png(drawing, 80)
