"""Numbers of runs along something that varies from run to run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.scene import Drawn, with_unit
from navfmu.report.strips import BAD, scaled


@dataclass(frozen=True)
class Points:
    """Runs: where they stand on the axis, a number of each, and whether it is as it should be."""

    places: tuple[float, ...]
    values: tuple[float, ...]
    held: tuple[bool, ...]


def along(
    heading: str, x: str, y: str, unit: str, groups: Mapping[str, Points], bounds: Sequence[float], caption: str
) -> Drawn:
    """The picture; the groups differ in colour, runs that are not as they should be are crossed out."""
    with figure(size=(9.0, 4.2), left=0.9, below=0.25) as (drawing, plot):
        for number, (name, points) in enumerate(groups.items()):
            colour = COLOURS[number % len(COLOURS)]
            place, value, held = (np.array(part) for part in (points.places, points.values, points.held))
            plot.plot(place, value, "o", color=colour, markersize=4.5, alpha=0.7, label=name)
            plot.plot(place[~held], value[~held], "x", color=BAD, markersize=7, mew=1.3)
        for bound in bounds:
            plot.axhline(bound, color=COLOURS[1], linestyle="--", linewidth=1.2)
        if scaled(np.array([place for points in groups.values() for place in points.places])):
            plot.set_xscale("log")
        if scaled(np.array([value for points in groups.values() for value in points.values])):
            plot.set_yscale("log")
        plot.set_xlabel(x)
        plot.set_ylabel(with_unit(y + ",", unit) if unit not in ("", "1") else y)
        plot.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4)
        title(drawing, plot, heading)
        return Drawn(png(drawing), heading, caption)
