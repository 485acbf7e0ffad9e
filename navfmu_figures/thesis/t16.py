"""The filter that the thesis flew: four states, and what its R leaves out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.flown import FMUS, NO_MEAN, Flights, Flown, Side
from navfmu_figures.thesis.t15 import LOST, MOMENTS, RARE, RUNS, STOP, bounds

RATIO = 0.17 / 0.004
"""Of the bias of a range over its wide-band noise, (3.38)."""
SIDES = {
    "full_order": Side("navigator_full"),
    "reduced": Side("navigator_reduced"),
    "reduced_as_printed": Side("navigator_reduced", {"bias_sigma": 0.0, "innovation_gate": 0.0, "gust_sigma": 0.0}),
}


@row(
    "The filter of reduced order does not diverge, though it ignores heading, airspeed and biases",
    "thesis section 6.5, (6.54), Fig 6.5, p. 200; section 7.2.1, p. 204",
    fmus=[*FMUS, "navigator_full", "navigator_reduced"],
)
def t16(task: Task) -> Found:
    """The flights of T15 with one receiver."""
    flown = Flights(task, SIDES, NO_MEAN).fly(RUNS, STOP, (LOST, None))
    words = "Errors of full and reduced order, and how often the claim of each is exceeded"
    return Found(compared(flown), picture(flown), words, NOTES)


NOTES = (
    "R (6.40) has the wide-band noise of a range, 0.004 nmi, and not its bias of 0.17 nmi. Taken literally the filter "
    "claims tens of metres where it is hundreds wrong. With the bias as noise that carries as much information as one "
    "with its correlation it is honest.",
)


def rms(one: Flown) -> float:
    """Of all moments, m."""
    return float(np.sqrt(np.mean(one.at(MOMENTS).error ** 2)))


def compared(flown: Mapping[str, Flown]) -> list[Comparison]:
    """Errors of reduced over full order, and the consistency of both readings of R."""
    full, reduced, printed = (flown[name] for name in SIDES)
    low, high = bounds(full.at(MOMENTS).squares.size)
    seen = {name: float(np.mean(one.at(MOMENTS).squares)) for name, one in flown.items()}
    why = f"chi-square of {RUNS} flights and {len(MOMENTS)} moments; outside once in {1 / RARE:.0f} times"
    end = printed.at(MOMENTS[-1:])
    worst = float(np.sqrt(np.mean(end.error**2)))
    return [
        Comparison("rms error of reduced over full order", "not much worse ('jittery')", rms(reduced) / rms(full),
                   1.0, 1.5, "a half more at most; less than full order would be a mistake of that"),
        Comparison("normalised squared error of reduced order, bias in R", "2", seen["reduced"], 0.8 * low, 1.2 * high,
                   f"{why}; a fifth for heading and airspeed, which it does not have"),
        Comparison("normalised squared error with R (6.40) as printed", "2 (not asked in the thesis)",
                   seen["reduced_as_printed"], 100.0, 2.0 * RATIO**2,
                   "at most two squares of bias over noise, and a filter that carries wind has some of these"),
        Comparison("rms error after 25 min with R (6.40) as printed", "no divergence", worst, 0.0, 926.0,
                   "bounded is within 0.5 nmi", "m"),
    ]  # fmt: skip


def picture(flown: Mapping[str, Flown]) -> bytes:
    """Root mean squares with claims, and distributions of errors over claims."""
    with figure(1, 2, size=(11.5, 4.2)) as (drawing, (errors, ratios)):
        for (name, one), colour in zip(flown.items(), COLOURS, strict=False):
            seen = one.at(np.arange(LOST, STOP + 1.0, 15.0))
            minutes, label = (seen.time - LOST) / 60.0, name.replace("_", " ")
            errors.plot(minutes, np.sqrt(np.mean(seen.error**2, axis=0)), color=colour, label=label)
            errors.plot(minutes, np.sqrt(np.mean(seen.nn + seen.ee, axis=0)), color=colour, ls="--", lw=0.9)
            root = np.sort(np.sqrt(one.at(MOMENTS).squares.ravel()))
            ratios.plot(root, 100.0 * (1.0 - np.arange(len(root)) / len(root)), color=colour, label=label)
        sigma = np.linspace(0.0, 5.0, 200)
        ratios.plot(sigma, 100.0 * np.exp(-0.5 * sigma**2), "k:", label="honest")
        errors.set(xlabel="time without GPS, min", ylabel="horizontal error, m", ylim=(0.0, 1200.0))
        errors.legend(title="rms of flights (dashed: claimed)")
        ratios.set(xlabel="error over its claim, sigma", ylabel="flights and moments beyond, %", xlim=(0.0, 25.0))
        ratios.legend()
        boast = float(np.mean(flown["reduced_as_printed"].at(MOMENTS).squares))
        bounded = compared(flown)[3].verdict == "agrees"
        title(drawing, errors, f"Reduced order is {'' if bounded else 'not '}bounded, whatever it claims")
        title(drawing, ratios, f"R as printed boasts: squares of {boast:.0f} where 2 are honest")
        return png(drawing)
