"""From GPS to the backup and back: no step."""

from __future__ import annotations

import numpy as np
from scipy import stats

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.flown import FMUS, Flights, Flown, Side

RUNS = 60
LOST, BACK, STOP = 300.0, 900.0, 1000.0
AROUND = 5.0
"""s before and after a switch that are looked at."""
RARE = 1e-3


@row(
    "The switch from GPS to the backup, and back, leaves no step but what the filter says of itself",
    "thesis section 2.3, p. 17, Figs 2.2, 2.3",
    fmus=[*FMUS, "navigator"],
)
def t18(task: Task) -> Found:
    """RUNS flights without GPS for ten minutes."""
    flown = Flights(task, {"navigator": Side("navigator")}).fly(RUNS, STOP, (LOST, BACK))["navigator"]
    return Found(compared(flown), picture(flown), "Errors around the loss of GPS and its return", NOTES)


NOTES = (
    "The thesis says that calibration goes on until GPS is lost, and that the backup begins from there, in words.",
)


def step(flown: Flown, moment: float) -> np.ndarray:
    """Change of the error over its claim at a switch, in sigma, of each flight: from the second before to the one
    after, in the larger of both claims."""
    before, after = flown.at(np.array([moment])), flown.at(np.array([moment + 2.0]))
    change = np.stack([after.north - before.north, after.east - before.east])
    sigma = np.sqrt(np.stack([np.maximum(before.nn, after.nn), np.maximum(before.ee, after.ee)]))
    return np.max(np.abs(change) / sigma, axis=(0, 2))


def compared(flown: Flown) -> list[Comparison]:
    """Steps in sigma, and metres once GPS is back."""
    count = 2 * RUNS
    most = float(stats.norm.isf(0.5 * RARE / count)) * np.sqrt(2.0)
    why = f"the largest of {count} honest ones: a difference of two errors, more in {RARE:.1%} of times"
    back = flown.at(np.array([BACK + 10.0]))
    return [
        Comparison("largest step at the loss, over the claim", "none", float(np.max(step(flown, LOST))), 0.0, 3.0,
                   "3 sigma of what the filter claims"),
        Comparison("largest step at the return, over the claim", "none", float(np.max(step(flown, BACK))), 0.0, most,
                   why),
        Comparison("largest error 10 s after the return", "that of GPS", float(np.max(back.error)), 0.0, 10.0,
                   "2 m on each axis (section 3.10), the largest of 60, five sigma", "m"),
    ]  # fmt: skip


def picture(flown: Flown) -> bytes:
    """All flights around both switches."""
    with figure(1, 2, size=(11.5, 4.0)) as (drawing, axes):
        for axis, moment, words in zip(axes, (LOST, BACK), ("the loss", "the return"), strict=True):
            near = flown.at(np.arange(moment - 30.0, moment + 31.0))
            axis.plot(near.time - moment, near.error.T, color=COLOURS[0], lw=0.5, alpha=0.5)
            axis.plot(
                near.time - moment, 3.0 * np.sqrt(np.mean(near.nn + near.ee, axis=0)), "k--", lw=1.0, label="3 sigma"
            )
            axis.set(xlabel=f"time from {words} of GPS, s", ylabel="horizontal error, m", ylim=(0.0, None))
            axis.legend()
        title(drawing, axes[0], f"At the loss at most {np.max(step(flown, LOST)):.1f} sigma of a step")
        title(drawing, axes[1], f"At the return {np.max(step(flown, BACK)):.1f} sigma at most: what was wrong is gone")
        return png(drawing)
