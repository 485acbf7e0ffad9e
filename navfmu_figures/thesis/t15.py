"""The filter of full order on flights with all errors: as wrong as it says, by each way of asking for ranges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy import stats

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.flown import FMUS, NO_MEAN, Flights, Flown, Side

RUNS = 48
LOST, STOP = 300.0, 1800.0
MOMENTS = np.arange(420.0, STOP + 1.0, 180.0)
"""Seconds between which errors are nearly independent: biases live for 20 s, heading for 120 s."""
METHODS = {"one_receiver": 1, "two_receivers": 2, "scanning": 3}
RARE = 1e-3


@row(
    "The aided filter of full order is bounded and knows what it is wrong by",
    "thesis section 6.4, (6.24)-(6.53), Table 6.1",
    fmus=[*FMUS, "navigator_full"],
)
def t15(task: Task) -> Found:
    """RUNS flights with each way of asking, in a wind about a mean of 0, as Table 6.1 has it."""
    sides = {name: Side("navigator_full", {}, mode) for name, mode in METHODS.items()}
    flown = Flights(task, sides, NO_MEAN).fly(RUNS, STOP, (LOST, None))
    return Found(compared(flown), picture(flown), "Errors by time, and what the covariance makes of them", NOTES)


NOTES = (
    "(6.39) prints H' P H + R where H P H' + R is meant; H12 (6.35) has zeros where a range shows the bias of its "
    "station.",
    "Slant ranges on the ellipsoid take the place of ranges on a plane (6.32), and their rows that of (6.36).",
)


def bounds(count: int, degrees: int = 2) -> tuple[float, float]:
    """Of the mean of so many normalised squared errors."""
    low, high = stats.chi2.ppf([0.5 * RARE, 1.0 - 0.5 * RARE], degrees * count) / count
    return float(low), float(high)


def compared(flown: Mapping[str, Flown]) -> list[Comparison]:
    """Mean normalised squared errors, and the largest root mean square of a moment."""
    found = []
    for name, one in flown.items():
        squares = one.at(MOMENTS).squares
        low, high = bounds(squares.size)
        why = f"chi-square of {2 * squares.size} degrees of freedom; outside once in {1 / RARE:.0f} times"
        words = name.replace("_", " ")
        found.append(Comparison(f"normalised squared error, {words}", "2", float(np.mean(squares)), low, high, why))
        rms = float(np.max(np.sqrt(np.mean(one.at(MOMENTS).error ** 2, axis=0))))
        found.append(Comparison(f"largest rms error of a moment, {words}", "bounded", rms, 0.0, 926.0, "0.5 nmi", "m"))
    return found


def picture(flown: Mapping[str, Flown]) -> bytes:
    """Root mean squares and claims, and normalised squares with their interval."""
    with figure(1, 2, size=(11.5, 4.2)) as (drawing, (errors, squares)):
        for (name, one), colour in zip(flown.items(), COLOURS, strict=False):
            seen = one.at(np.arange(LOST, STOP + 1.0, 15.0))
            minutes = (seen.time - LOST) / 60.0
            errors.plot(minutes, np.sqrt(np.mean(seen.error**2, axis=0)), color=colour, label=name.replace("_", " "))
            errors.plot(minutes, np.sqrt(np.mean(seen.nn + seen.ee, axis=0)), color=colour, ls="--", lw=0.9)
            moments = one.at(MOMENTS)
            squares.plot((moments.time - LOST) / 60.0, np.mean(moments.squares, axis=0), "o-", color=colour)
        low, high = bounds(RUNS)
        squares.axhspan(low, high, color="0.9", lw=0)
        errors.set(xlabel="time without GPS, min", ylabel="horizontal error, m", ylim=(0.0, 926.0))
        errors.legend(title="rms of flights (dashed: claimed)")
        squares.set(xlabel="time without GPS, min", ylabel="mean normalised squared error", ylim=(0.0, 4.0))
        within = all(one.verdict == "agrees" for one in compared(flown))
        title(drawing, errors, f"{RUNS} flights are as wrong as was claimed" if within else "Claim and error differ")
        title(drawing, squares, f"Grey: where a mean of {RUNS} honest flights is, but once in {1 / RARE:.0f} times")
        return png(drawing)
