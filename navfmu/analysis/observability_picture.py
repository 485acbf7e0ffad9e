"""A picture of what distances tell along a track."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import FuncFormatter, LogLocator

from navfmu.analysis.observability import LEAST, Observability
from navfmu.constants import NAUTICAL_MILE
from navfmu.navaids.station import plane
from navfmu.report.figure import COLOURS, GREY, figure, png, title

RANKS = ("#67000d", "#a50f15", "#cb181d", "#ef3b2c", "#fb6a4a", "#fdae6b", "#9ecae1", "#4292c6", "#08519c")
"""Of few to many observable directions; of a model with fewer the last ones are taken."""
SHOWN = 1e-3
"""Singular values that are smaller are drawn as this."""


def draw(found: Observability) -> bytes:
    """The course with what is observable, and the singular values over time."""
    with figure(1, 2, (11.6, 5.2), below=0.1, above=0.3) as (drawing, (course, values)):
        _course(drawing, course, found)
        middle = np.array([0.5 * (one.start + one.end) for one in found.windows])
        minutes = (middle - found.path.points.time[0]) / 60.0
        all_values = np.stack([one.values for one in found.windows])
        for number, of in enumerate(all_values.T):
            colour, style = COLOURS[number % len(COLOURS)], "-" if number < len(COLOURS) else "--"
            values.semilogy(minutes, np.maximum(of, SHOWN), style, color=colour, lw=1.2, label=f"{number + 1}")
        values.axhline(LEAST, color=GREY, lw=0.9, ls=":")
        values.set_ylim(SHOWN, None)
        values.yaxis.set_major_locator(LogLocator())
        values.yaxis.set_major_formatter(FuncFormatter(lambda number, _: f"{number:g}"))
        values.minorticks_off()
        values.set(xlabel="middle of the window, min", ylabel="singular value")
        values.legend(loc="best", ncol=3, fontsize=8)
        title(drawing, values, "Observable above the dotted line")
        drawing.suptitle(f"{found.model}: {_how(found)}", x=0.01, ha="left", fontsize=10)
        return png(drawing, dpi=100)


def _how(found: Observability) -> str:
    how = "all at a time" if found.together else "in turn"
    names = " and ".join(one.ident for one in found.stations)
    return f"distances of {names} {how} every {found.every:g} s, windows of {found.window:g} s"


def _course(drawing, axis, found: Observability) -> None:
    points, ranks, most = found.path.points, found.ranks, len(found.states)
    middle = np.searchsorted(points.time, [0.5 * (one.start + one.end) for one in found.windows])
    north, east = found.path.moved_n.T / NAUTICAL_MILE
    axis.plot(east, north, color=GREY, lw=0.5)
    colours = ListedColormap(RANKS[-(most + 1) :] if most < len(RANKS) else ["#3b0000", *RANKS])
    norm = BoundaryNorm(np.arange(-0.5, colours.N), colours.N)
    shown = axis.scatter(east[middle], north[middle], 14, ranks, cmap=colours, norm=norm, zorder=3)
    drawing.colorbar(shown, ax=axis, shrink=0.85, label=f"observable of {most}", ticks=range(colours.N))
    for one in found.stations:
        x, y = (metres / NAUTICAL_MILE for metres in plane(one, points.latitude[0], points.longitude[0]))
        axis.plot(x, y, "^", color=COLOURS[1], ms=7)
        axis.annotate(one.ident, (x, y), xytext=(4, 4), textcoords="offset points", fontsize=9)
    axis.set(xlabel="nmi to the east", ylabel="nmi to the north")
    axis.axis("equal")
    title(drawing, axis, "Course of the middle of the windows")
