"""One receiver, two, or one that scans: how much worse than the best."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.approach import METHODS, NEEDED, NOTES, flown
from navfmu_figures.thesis.claims import horizontal

BEST, TWO, ONE, SLOWER = (3, 15.0), (2, 15.0), (1, 15.0), (2, 30.0)
TRANSIENT = 120.0
"""s, in which the error has not grown to that of ranges."""


@row(
    "A scanning receiver is best, two receivers are 25 m worse on the average and one 50 m, all bounded",
    "thesis section 7.2.2, pp. 208-214, Figs 7.7 to 7.10",
    fmus=NEEDED,
)
def t23(task: Task) -> Found:
    """The approach by each way of asking."""
    errors = {case: horizontal(one) for case, one in flown(task, [BEST, TWO, ONE, SLOWER]).items()}
    words = "Horizontal error by how ranges are asked for, and a close look"
    return Found(compared(errors), picture(errors), words, NOTES)


def above(errors: Mapping[tuple[int, float], pd.Series], case: tuple[int, float]) -> float:
    """How much worse than the scanning receiver, on the average, m."""
    apart = errors[case] - errors[BEST]
    return float(apart[apart.index > TRANSIENT].mean())


def compared(errors: Mapping[tuple[int, float], pd.Series]) -> list[Comparison]:
    """Averages above the best, and which pairs are alike."""
    read = "'on average', of curves in Fig 7.7 whose saw teeth are as high: half of it to either side"
    one, two, slower = (above(errors, case) for case in (ONE, TWO, SLOWER))
    return [
        Comparison("2 receivers over scanning, on the average", "25 m", two, 12.5, 37.5, read, "m"),
        Comparison("1 receiver over scanning, on the average", "50 m", one, 25.0, 75.0, read, "m"),
        Comparison("1 receiver over 2, both over scanning", "2", one / two, 1.4, 3.0,
                   "the quotient of two numbers that are read off to a half"),
        Comparison("2 receivers at 30 s over 1 receiver at 15 s, both over scanning", "comparable", slower / one, 0.8,
                   1.25, "comparable is within a quarter"),
    ]  # fmt: skip


def picture(errors: Mapping[tuple[int, float], pd.Series]) -> bytes:
    """Figs 7.7 to 7.9."""
    with figure(1, 2, size=(11.5, 4.2)) as (drawing, axes):
        for (mode, interval), colour in zip(errors, COLOURS, strict=False):
            one = errors[mode, interval]
            name = METHODS[mode] + (f", {interval:.0f} s" if mode != BEST[0] else "")
            for axis in axes:
                axis.plot(one.index / 60.0, one, color=colour, lw=0.9, label=name)
        for axis in axes:
            axis.set(xlabel="time since the last fix, min", ylabel="horizontal error, 1 sigma, m")
        axes[0].set_ylim(0.0, None)
        axes[1].set(xlim=(20.0, 24.0), ylim=(300.0, 520.0))
        axes[1].legend()
        better = above(errors, TWO) < above(errors, ONE)
        title(drawing, axes[0], "Scanning, two receivers, one: " + ("in this order" if better else "not in this order"))
        title(
            drawing, axes[1], f"{above(errors, TWO):.0f} and {above(errors, ONE):.0f} m above scanning on the average"
        )
        return png(drawing)
