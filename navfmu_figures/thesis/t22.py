"""The filter of full order along an approach: bounded, better across the track, worse along it."""

from __future__ import annotations

import numpy as np
import pandas as pd

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.approach import NEEDED, NOTES, flown
from navfmu_figures.thesis.claims import horizontal

CASE = (1, 15.0)
TRANSIENT, BEFORE = 300.0, 200.0
"""s after the last fix in which the error grows to what ranges hold; and before the end in which the lines to both
stations become one."""
CYCLE = 30.0
"""In which both stations were asked, s."""


@row(
    "The error of full order is bounded; across the track it shrinks and along it it grows on the way to the airport",
    "thesis section 7.2.1, pp. 204-208, Table 7.1, Fig 7.6",
    fmus=NEEDED,
)
def t22(task: Task) -> Found:
    """One receiver, a range every 15 s."""
    claims = flown(task, [CASE])[CASE]
    return Found(
        compared(claims), picture(claims), "What the filter claims of north and east along the approach", NOTES
    )


def smooth(sigma: pd.Series) -> pd.Series:
    """The mean of each cycle, without its saw teeth."""
    return sigma.groupby((sigma.index // CYCLE) * CYCLE).mean()


def compared(claims: pd.DataFrame) -> list[Comparison]:
    """That it is bounded, and how it changes from the transient's end to the airport."""
    sigma = horizontal(claims)
    end = float(claims.index[-1])
    north, east = (smooth(np.sqrt(claims[name])) for name in ("nn", "ee"))
    middle = (north.index > TRANSIENT) & (north.index < end - BEFORE)
    grows, shrinks = (one[middle].iloc[-1] / one[middle].iloc[0] for one in (north, east))
    before = float(sigma[sigma.index < end - BEFORE].max())
    return [
        Comparison("largest error until the lines to both stations are nearly one", "bounded", before, 0.0, 926.0,
                   "bounded is at most half a nautical mile, which is asked for", "m"),
        Comparison("cross-track (east) error at the end over that after five minutes", "decreases steadily",
                   float(shrinks), 0.0, 0.8, "by a fifth at least, which Fig 7.6 shows at a glance"),
        Comparison("in-track (north) error at the end over that after five minutes", "increases", float(grows), 1.25,
                   np.inf, "by a quarter at least, which Fig 7.6 shows at a glance"),
    ]  # fmt: skip


def picture(claims: pd.DataFrame) -> bytes:
    """Fig 7.6."""
    with figure(1, 1, size=(9.0, 4.2)) as (drawing, axis):
        for name, label, colour in zip(("nn", "ee"), ("north (in-track)", "east (cross-track)"), COLOURS, strict=False):
            axis.plot(claims.index / 60.0, np.sqrt(claims[name]), color=colour, lw=0.9, label=label)
        axis.axhline(926.0, color="0.5", lw=0.8)
        axis.set(xlabel="time since the last fix, min", ylabel="1 sigma, m", ylim=(0.0, 1000.0))
        axis.legend(title="grey: 0.5 nmi")
        bounded = compared(claims)[0].verdict == "agrees"
        title(drawing, axis, "Bounded until the stations are abeam" if bounded else "Not bounded on the way")
        return png(drawing)
