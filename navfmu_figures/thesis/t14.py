"""Dead reckoning by itself: each error grows as its integral does."""

from __future__ import annotations

import numpy as np
import pandas as pd

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.claims import FMUS, Flight
from navfmu_figures.thesis.error_models import ABEAM, CRUISE_NORTH, KNOWN, SPEED

STOP, STEP = 1800.0, 0.1
TIMES = (60.0, 300.0, 900.0, STOP)
WIND, AIRSPEED, HEADING = (5.0, 400.0), (2.6, 400.0), (float(np.radians(2.5)), 120.0)
NOISE = float(np.radians(0.8))
"""Table 5.1: sigma and time of Gauss-Markov errors, m/s and rad; white noise of heading, rad in one second's mean."""


@row(
    "Errors of airspeed, heading and wind go once through an integral",
    "thesis section 5.3, (5.5)-(5.31), Table 5.1, pp. 155-165",
    fmus=[*FMUS, "navigator_reckoning"],
)
def t14(task: Task) -> Found:
    """To the north for half an hour, from no error on."""
    flight = Flight(task.folder / "reckoning", task.fmus, CRUISE_NORTH, ABEAM, STEP)
    claims = flight.claims("navigator_reckoning", STOP, {**KNOWN, "update_period": STEP})
    words = "What dead reckoning claims of north and east, and integrals in closed form"
    return Found(compared(claims), picture(claims), words, NOTES)


NOTES = (
    "No figure is printed: the closed form is that of (5.15), (5.31), integrated once more, for a flight to the north, "
    "in which airspeed errors go north and heading errors go east.",
    "The white noise of heading, 0.8 deg, is that of a mean over a second: (3.86) has it at 1 Hz.",
)


def walked(sigma: float, tau: float, time: np.ndarray) -> np.ndarray:
    """Variance of the integral of a Gauss-Markov process that is 0 at first."""
    x = np.asarray(time) / tau
    return (sigma * tau) ** 2 * (2.0 * x - 3.0 + 4.0 * np.exp(-x) - np.exp(-2.0 * x))


def closed(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Variances of north and east, m2."""
    north = walked(*WIND, time) + walked(*AIRSPEED, time)
    east = walked(*WIND, time) + SPEED**2 * (walked(*HEADING, time) + NOISE**2 * np.asarray(time))
    return north, east


def compared(claims: pd.DataFrame) -> list[Comparison]:
    """Ratios to the closed form."""
    north, east = closed(np.array(TIMES))
    why = "steps of 0.1 s, and that one sees the claim two of them later"
    found = []
    for i, time in enumerate(TIMES):
        for name, variance in (("north", north[i]), ("east", east[i])):
            ours = float(claims[2 * name[0]].loc[time])
            found.append(
                Comparison(f"{name} after {time:.0f} s over the closed form", "1", float(np.sqrt(ours / variance)),
                           0.99, 1.01, why)
            )  # fmt: skip
    return found


def picture(claims: pd.DataFrame) -> bytes:
    """Both axes."""
    with figure(1, 1, size=(8.5, 4.2)) as (drawing, axis):
        time = claims.index.to_numpy()
        for name, variance, colour in zip(("north", "east"), closed(time), COLOURS, strict=False):
            axis.plot(time / 60.0, np.sqrt(claims[2 * name[0]]) / 1e3, color=colour, label=name)
            axis.plot(time / 60.0, np.sqrt(variance) / 1e3, color="k", ls=":", lw=1.2)
        axis.set(xlabel="time, min", ylabel="1 sigma, km", xlim=(0.0, STOP / 60.0), ylim=(0.0, None))
        axis.legend(title="dotted: closed form")
        same = all(one.verdict == "agrees" for one in compared(claims))
        title(
            drawing, axis, f"Dead reckoning grows {'as' if same else 'otherwise than'} the integrals of its errors do"
        )
        return png(drawing)
