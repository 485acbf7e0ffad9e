"""The picture of the analysis: how far each failure leads astray, and when it is noticed."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from evidence.failures.injection import Injection
from navfmu.report.figure import COLOURS, GREY, figure, png

ROW = 0.145  # inch
BOUND = 926.0  # m
BEYOND = 3.0e5  # m, where an arrow stands
LOOKS = {
    "noticed in every run": ("o", COLOURS[0]),
    "noticed in some runs": ("D", COLOURS[4]),
    "noticed in none, without harm": ("o", GREY),
    "harm in some run with no sign": ("X", "#D00000"),
}


def picture(injections: Sequence[Injection], unseen: Collection[Injection], heading: str) -> bytes:
    """A row for each failure: 95 % of its error, and the times from the onset to the first sign."""
    from matplotlib.lines import Line2D

    height = 1.6 + ROW * len(injections)
    with figure(1, 2, size=(10.0, height), left=2.0, below=0.5, sharey=True) as (drawing, (left, right)):
        for row, each in enumerate(injections):
            mark, colour = LOOKS[_kind(each, unseen)]
            finite = np.isfinite(each.percentile)
            size = 5 if mark == "X" else 4
            left.plot(
                each.percentile if finite else BEYOND, row, mark if finite else ">", color=colour, markersize=size
            )
            right.plot(np.maximum(each.delays, 0.1), np.full(each.delays.size, row), "|", color=colour, markersize=5)
            if each.noticed < each.runs:
                words = f"no sign in {each.runs - each.noticed} of {each.runs}"
                right.annotate(words, (2000.0, row), va="center", fontsize=6, color=colour)
        left.axvline(BOUND, color=GREY, lw=1, ls="--")
        left.set_xscale("log")
        right.set_xscale("log")
        right.set_xlim(0.08, 2.0e4)
        right.set_xticks([0.1, 1.0, 10.0, 100.0, 1000.0], ["0", "1", "10", "100", "1000"])
        left.set_yticks(range(len(injections)), [f"{e.name}  {', '.join(e.lines)}" for e in injections], fontsize=6.5)
        left.set_ylim(len(injections) - 0.4, -0.6)
        left.set_xlabel("95 % of the horizontal error, m; dashed: 0.5 nmi; arrow: no number", fontsize=8)
        right.set_xlabel("time to the first sign, s", fontsize=8)
        handles = [Line2D([], [], marker=m, color=c, lw=0, label=words) for words, (m, c) in LOOKS.items()]
        drawing.legend(handles=handles, loc="lower center", ncols=len(handles), fontsize=8, frameon=False)
        drawing.text(0.02, 1.0 - 0.2 / height, heading, fontsize=11, fontweight="bold", va="center")
        return png(drawing)


def _kind(injection: Injection, unseen: Collection[Injection]) -> str:
    """Which of LOOKS."""
    if injection in unseen:
        return "harm in some run with no sign"
    if injection.noticed == injection.runs:
        return "noticed in every run"
    return "noticed in some runs" if injection.noticed else "noticed in none, without harm"
