"""How long one may wait for a range."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.approach import NEEDED, NOTES, flown
from navfmu_figures.thesis.claims import horizontal

INTERVALS = (15.0, 30.0, 60.0, 90.0, 120.0)
HALF_MILE = 926.0
EARLY, BEFORE = 900.0, 200.0
"""What counts as the initial transient, s after the last fix; and what is left out before the end (see T22)."""


@row(
    "At every interval from 15 to 120 s the error is bounded; long ones begin beyond half a nautical mile",
    "thesis section 7.2.3, pp. 214-216, Fig 7.11",
    fmus=NEEDED,
)
def t24(task: Task) -> Found:
    """One receiver, by interval."""
    errors = {interval: horizontal(one) for (_, interval), one in flown(task, [(1, one) for one in INTERVALS]).items()}
    return Found(compared(errors), picture(errors), "Horizontal error of one receiver by its interval", NOTES)


def halves(error: pd.Series) -> tuple[float, float]:
    """The largest error of the transient, and of what comes then, m."""
    then = error[(error.index > EARLY) & (error.index < error.index[-1] - BEFORE)]
    return float(error[error.index <= EARLY].max()), float(then.max())


def compared(errors: Mapping[float, pd.Series]) -> list[Comparison]:
    """Bounded at each, and where the transient is beyond half a mile."""
    found = []
    why = "a curve that grows on would be twice as high or more: a free one is, in as long a time"
    for interval, error in errors.items():
        first, then = halves(error)
        found.append(
            Comparison(f"largest error after the transient over that of it, {interval:.0f} s", "in check", then / first,
                       0.0, 1.25, why)
        )  # fmt: skip
    short, long = (halves(errors[one])[0] for one in (INTERVALS[0], INTERVALS[-1]))
    found.append(
        Comparison(
            "transient at 120 s", "beyond 926 m", long, HALF_MILE, np.inf, "so the text says of the longer ones", "m"
        )
    )
    found.append(
        Comparison("transient at 15 s", "within 926 m", short, 0.0, HALF_MILE, "only the longer ones are beyond", "m")
    )
    return found


def picture(errors: Mapping[float, pd.Series]) -> bytes:
    """Fig 7.11."""
    with figure(1, 1, size=(9.0, 4.4)) as (drawing, axis):
        for (interval, error), colour in zip(errors.items(), COLOURS, strict=False):
            axis.plot(error.index / 60.0, error, color=colour, lw=0.9, label=f"{interval:.0f} s")
        axis.axhline(HALF_MILE, color="0.5", lw=0.8)
        axis.set(xlabel="time since the last fix, min", ylabel="horizontal error, 1 sigma, m", ylim=(0.0, None))
        axis.legend(title="a range every (grey: 0.5 nmi)")
        within = [interval for interval, error in errors.items() if halves(error)[0] <= HALF_MILE]
        title(drawing, axis, f"Bounded at every interval; up to {max(within):.0f} s half a nautical mile is never left")
        return png(drawing)
