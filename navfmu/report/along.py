"""Numbers of runs along something that varies from run to run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.scene import Drawn, with_unit
from navfmu.report.strips import scaled


@dataclass(frozen=True)
class Points:
    """Runs: where they stand on the axis, a number of each, and whether it is as it should be."""

    places: tuple[float, ...]
    values: tuple[float, ...]
    held: tuple[bool, ...]


def along(
    heading: str, x: str, y: str, unit: str, groups: Mapping[str, Points], bounds: Sequence[float], caption: str
) -> Drawn:
    """The picture; the groups stand side by side, and what is not as it should be is a cross."""
    with figure(size=(9.0, 4.2), left=0.9, below=0.25) as (drawing, plot):
        every = np.array([place for points in groups.values() for place in points.places])
        logarithmic = scaled(every)
        for number, (name, points) in enumerate(groups.items()):
            colour = COLOURS[number % len(COLOURS)]
            value, held = np.array(points.values), np.array(points.held)
            place = beside(np.array(points.places), every, (number + 0.5) / len(groups) - 0.5, logarithmic)
            plot.plot(place[held], value[held], "o", color=colour, markersize=4.5, alpha=0.7)
            plot.plot(place[~held], value[~held], "x", color=colour, markersize=5.5, mew=1.2, alpha=0.8)
            plot.plot([], [], "s", color=colour, label=name)
        for bound in bounds:
            plot.axhline(bound, color=COLOURS[1], linestyle="--", linewidth=1.2)
        if logarithmic:
            plot.set_xscale("log")
        if scaled(np.array([value for points in groups.values() for value in points.values])):
            plot.set_yscale("log")
        plot.set_xlabel(x)
        plot.set_ylabel(with_unit(y + ",", unit) if unit not in ("", "1") else y)
        plot.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4)
        title(drawing, plot, heading)
        return Drawn(png(drawing), heading, caption)


def beside(places: np.ndarray, every: np.ndarray, share: float, logarithmic: bool) -> np.ndarray:
    """Places moved aside by a ``share`` (-0.5 to 0.5) of half the least distance of two of them."""
    to, back = (np.log, np.exp) if logarithmic else (np.asarray, np.asarray)
    apart = np.diff(np.unique(to(every)))
    return back(to(places) + share * 0.5 * (apart.min() if apart.size else 0.0))
