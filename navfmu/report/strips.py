"""How numbers of runs are spread: a strip for each group, a mark for each run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.scene import Drawn, with_unit

ROW = 0.22  # inch
LETTER = 0.068  # inch, in a label
BAD = "#D00000"


@dataclass(frozen=True)
class Strip:
    """A group of runs: a number of each (NaN: none), and whether it is as it should be."""

    label: str
    values: tuple[float, ...]
    held: tuple[bool, ...]


def strips(heading: str, axis: str, unit: str, groups: Sequence[Strip], bounds: Sequence[float], caption: str) -> Drawn:
    """The picture; ``bounds`` are drawn as lines."""
    left = min(0.4 + LETTER * max(len(group.label) for group in groups), 4.5)
    height = 1.0 + ROW * max(len(groups), 3)
    with figure(size=(9.0, height), left=left) as (drawing, plot):
        for row, group in enumerate(groups):
            values, held = np.array(group.values, np.float64), np.array(group.held, bool)
            for which, look, colour in ((held, "o", COLOURS[0]), (~held, "x", BAD)):
                some = values[which & np.isfinite(values)]
                plot.plot(some, np.full(some.size, row), look, color=colour, markersize=4, alpha=0.7, mew=1.2)
        for bound in bounds:
            plot.axvline(bound, color=COLOURS[1], linestyle="--", linewidth=1.2)
        every = np.array([value for group in groups for value in group.values])
        if scaled(every):
            plot.set_xscale("log")
        plot.set_yticks(range(len(groups)), [_short(group.label) for group in groups], fontsize=8)
        plot.set_ylim(len(groups) - 0.4, -0.6)
        plot.grid(axis="y", color=GREY, alpha=0.2)
        plot.set_xlabel(with_unit(axis + ",", unit) if unit not in ("", "1") else axis)
        title(drawing, plot, heading, whole=True)
        return Drawn(png(drawing), heading, caption)


def scaled(values: np.ndarray) -> bool:
    """Whether numbers are so far apart that only a logarithmic axis shows them all."""
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0 and finite.max() / finite.min() > 300)


def _short(label: str) -> str:
    return label if len(label) <= 60 else f"{label[:28]} ... {label[-28:]}"
