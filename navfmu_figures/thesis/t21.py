"""What dead reckoning is wrong by, source by source."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.claims import FMUS, Flight, horizontal
from navfmu_figures.thesis.error_models import ABEAM, CRUISE_NORTH, KNOWN

STOP = 1800.0
SOURCES = {
    "wind": {"wind_sigma": 5.0},
    "airspeed": {"air.true_airspeed_sigma": 2.6},
    "heading": {"attitude.heading_sigma": float(np.radians(2.5))},
    "noise of heading": {"heading_noise": float(np.radians(0.8))},
}
"""Table 5.1."""
TOTAL = "all"


@row(
    "The wind is the largest of the errors of dead reckoning",
    "thesis section 5.5.3, p. 179, Table 5.1, Fig 5.6",
    fmus=[*FMUS, "navigator_reckoning"],
)
def t21(task: Task) -> Found:
    """Dead reckoning with each source alone."""
    errors = budget(task)
    words = "Horizontal error of dead reckoning by source, and what part of its square each has"
    return Found(compared(errors), picture(errors), words)


def budget(task: Task) -> dict[str, pd.Series]:
    """Horizontal error, m, of each source alone and of all."""
    flight = Flight(task.folder / "budget", task.fmus, CRUISE_NORTH, ABEAM)
    none = {name: 0.0 for values in SOURCES.values() for name in values}
    given = {TOTAL: {name: value for one in SOURCES.values() for name, value in one.items()}, **SOURCES}
    return {
        name: horizontal(flight.claims("navigator_reckoning", STOP, {**KNOWN, **none, **values}))
        for name, values in given.items()
    }


def compared(errors: Mapping[str, pd.Series]) -> list[Comparison]:
    """The wind's place, closed forms, and that the sources add up."""
    end = {name: float(one.iloc[-1]) for name, one in errors.items()}
    first = max(SOURCES, key=end.get)
    others = sum(end[name] ** 2 for name in SOURCES if name != "wind")
    why = "the largest has more than each other one; here it is more than all others together"
    alone = np.sqrt(sum(end[name] ** 2 for name in SOURCES)) / end[TOTAL]
    return [
        Comparison("square of the wind's error over that of all others", f"largest (ours: {first})",
                   end["wind"] ** 2 / others, 1.0, np.inf, why),
        Comparison("root of the sum of squares over all together", "1", alone, 0.999, 1.001,
                   "independent sources in a linear system add in their squares"),
    ]  # fmt: skip


def picture(errors: Mapping[str, pd.Series]) -> bytes:
    """Fig 5.6, and shares."""
    with figure(1, 2, size=(11.0, 4.2)) as (drawing, (growth, shares)):
        for name, colour in zip(SOURCES, COLOURS, strict=False):
            growth.plot(errors[name].index / 60.0, errors[name] / 1e3, color=colour, label=name)
        growth.plot(errors[TOTAL].index / 60.0, errors[TOTAL] / 1e3, color="k", label=TOTAL)
        growth.set(
            xlabel="time, min", ylabel="horizontal error, 1 sigma, km", xlim=(0.0, STOP / 60.0), ylim=(0.0, None)
        )
        growth.legend()
        largest = max(SOURCES, key=lambda name: errors[name].iloc[-1])
        title(drawing, growth, f"The {largest} is the largest error of dead reckoning")
        parts = [errors[name] ** 2 / errors[TOTAL] ** 2 * 100.0 for name in SOURCES]
        shares.stackplot(errors[TOTAL].index / 60.0, parts, colors=COLOURS[: len(parts)], labels=list(SOURCES))
        shares.set(xlabel="time, min", ylabel="share of the square, %", xlim=(0.0, STOP / 60.0), ylim=(0.0, 100.0))
        title(drawing, shares, f"{parts[0].iloc[-1]:.0f} % of the square at the end is the wind's")
        return png(drawing)
