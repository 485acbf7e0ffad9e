"""An inertial navigator of automotive grade, with and without a range now and then."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.flown import FMUS, NO_MEAN, Flights, Flown, Side
from navfmu_figures.thesis.t15 import RARE, bounds

RUNS = 40
LOST, STOP = 300.0, 1500.0
MOMENTS = np.arange(420.0, STOP + 1.0, 180.0)
SIDES = {
    "inertial_alone": Side("navigator_inertial", {"dme_aiding": False}),
    "inertial_with_ranges": Side("navigator_inertial"),
    "dead_reckoning_with_ranges": Side("navigator_full"),
}


@row(
    "An inertial navigator of this grade is of no use without aiding, and a range every 15 s is not enough for it",
    "thesis sections 5.4, 6.2 (p. 185), 8.2.1; Appendix A",
    fmus=[*FMUS, "navigator_inertial", "navigator_full"],
)
def t17(task: Task) -> Found:
    """RUNS flights whose biases GPS has taught for five minutes."""
    flown = Flights(task, SIDES, NO_MEAN).fly(RUNS, STOP, (LOST, None))
    return Found(compared(flown), picture(flown), "Errors of inertial navigation and dead reckoning by time", NOTES)


NOTES = (
    "What (5.41) to (5.51) print is corrected where differentiation of the equations of motion says otherwise: "
    "docs/navigator_inertial.md has the list.",
    "The thesis did not print how its inertial navigator with ranges did: 'found to be unsatisfactory'. Ours has "
    "biases of ranges as states and pressure altitude as a measurement.",
)


def rms(one: Flown, moment: float) -> float:
    """Of all flights, m."""
    return float(np.sqrt(np.mean(one.at(np.array([moment])).error ** 2)))


def compared(flown: Mapping[str, Flown]) -> list[Comparison]:
    """Alone, with ranges, and whether it knows."""
    alone, aided, reckoned = (flown[name] for name in SIDES)
    squares = aided.at(MOMENTS).squares
    low, high = bounds(squares.size)
    why = f"chi-square of {2 * squares.size} degrees of freedom; outside once in {1 / RARE:.0f} times"
    better = Difference(
        0.8, 2.0,
        "with the biases of ranges as states, and tilts that GPS has taught, its errors are of the size of those of "
        "dead reckoning; without ranges it is lost within minutes",
    )  # fmt: skip
    ratio = np.sqrt(np.mean(aided.at(MOMENTS).error ** 2) / np.mean(reckoned.at(MOMENTS).error ** 2))
    return [
        Comparison("rms error alone after 5 min", "far beyond 926 m", rms(alone, LOST + 300.0), 926.0, np.inf,
                   "beyond half a nautical mile", "m"),
        Comparison("normalised squared error with ranges", "2", float(np.mean(squares)), low, high, why),
        Comparison("rms error with ranges over that of dead reckoning with ranges", "unsatisfactory", float(ratio), 2.0,
                   np.inf, "unsatisfactory is twice as bad", difference=better),
    ]  # fmt: skip


def picture(flown: Mapping[str, Flown]) -> bytes:
    """Root mean squares and claims."""
    with figure(1, 1, size=(9.0, 4.4)) as (drawing, axis):
        for (name, one), colour in zip(flown.items(), COLOURS, strict=False):
            seen = one.at(np.arange(LOST, STOP + 1.0, 15.0))
            minutes = (seen.time - LOST) / 60.0
            axis.plot(minutes, np.sqrt(np.mean(seen.error**2, axis=0)), color=colour, label=name.replace("_", " "))
            axis.plot(minutes, np.sqrt(np.mean(seen.nn + seen.ee, axis=0)), color=colour, ls="--", lw=0.9)
        axis.axhline(926.0, color="0.5", lw=0.8)
        axis.set(xlabel="time without GPS, min", ylabel="horizontal error, m", yscale="log", ylim=(10.0, 1e5))
        axis.yaxis.set_major_formatter("{x:g}")
        axis.legend(title="rms of flights (dashed: claimed; grey: 0.5 nmi)")
        gone = rms(flown["inertial_alone"], LOST + 300.0)
        aided = rms(flown["inertial_with_ranges"], STOP)
        title(drawing, axis, f"Alone {gone / 1e3:.0f} km off after 5 min, with ranges {aided:.0f} m after 20")
        return png(drawing)
