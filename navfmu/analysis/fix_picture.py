"""Pictures of fixes: a place with its lines and ellipses, maps of ellipses, and what is known along a track."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator

from navfmu.analysis.circle import principal, radius
from navfmu.analysis.fix import Fixes, direction
from navfmu.analysis.ghost import ghost
from navfmu.analysis.line import DISTANCE, Line
from navfmu.analysis.place import Place
from navfmu.constants import NAUTICAL_MILE
from navfmu.navaids.station import plane
from navfmu.report.figure import COLOURS, GREY, figure, png, title

SHARE = 0.95
TURN = np.linspace(0.0, 2.0 * np.pi, 181)
NUMBERS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
DOTS = 1000
"""Draws that are shown."""


def ellipse(covariance: np.ndarray, share: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """East and north of an ellipse around 0 that holds this share of the errors, or of one sigma; packed (3,), m."""
    times = 1.0 if share is None else np.sqrt(-2.0 * np.log1p(-share))
    long, short = (times * axis for axis in principal(covariance))
    along, across, turn = long * np.cos(TURN), short * np.sin(TURN), direction(covariance)
    return along * np.sin(turn) + across * np.cos(turn), along * np.cos(turn) - across * np.sin(turn)


def at_place(place: Place, fixes: Fixes, draws: Mapping[str, np.ndarray]) -> bytes:
    """The lines that cross at a place, and the ellipses of one sigma with the errors that were drawn."""
    lines = max(fixes.lines.values(), key=len)
    with figure(1, 2, (11.6, 5.6), below=0.45, above=0.1) as (drawing, (course, errors)):
        _lines(course, lines, place)
        other = next(filter(None, (ghost(some, place) for some in fixes.lines.values())), None)
        course.plot(0.0, 0.0, "o", color=COLOURS[6], ms=5, label="the place")
        if other is not None:
            course.plot(*place.offset(other.latitude, other.longitude)[::-1] / NAUTICAL_MILE, "o", color=COLOURS[6],
                        ms=6, mfc="white", label="where circles cross, too")  # fmt: skip
        course.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
        course.legend(loc="upper left", bbox_to_anchor=(0.0, -0.14), ncol=2, fontsize=8)
        title(drawing, course, "Circles of distance and rays of bearing")
        widest = 0.0
        for number, (name, packed) in enumerate(fixes.covariance.items()):
            if np.all(np.isfinite(packed)):
                colour = COLOURS[number % len(COLOURS)]
                north, east = draws[name][:DOTS].T
                errors.plot(east, north, ".", color=colour, ms=1.2, alpha=0.25)
                errors.plot(*ellipse(packed[0]), color=colour, lw=1.8, label=name)
                widest = max(widest, 1.6 * float(principal(packed[0])[0]))
        errors.set(aspect="equal", xlim=(-widest, widest), ylim=(-widest, widest))
        errors.locator_params(nbins=7)
        errors.set(xlabel="error to the east, m", ylabel="error to the north, m")
        errors.legend(loc="upper left", fontsize=8)
        title(drawing, errors, "Ellipses of one sigma, and fixes that were drawn")
        return png(drawing, dpi=100)


def _lines(axis: Any, lines: Sequence[Line], place: Place) -> None:
    """Circles and rays on a map around the place."""
    for line in lines:
        x, y = (metres / NAUTICAL_MILE for metres in plane(line.station, place.latitude, place.longitude))
        if line.kind == DISTANCE:
            far = np.hypot(x, y)
            axis.plot(x + far * np.sin(TURN), y + far * np.cos(TURN), color=COLOURS[0], lw=0.9)
            axis.plot(x, y, "^", color=COLOURS[1], ms=7)
            axis.annotate(line.station.ident, (x, y), xytext=(4, 4), textcoords="offset points", fontsize=9)
        else:
            axis.plot([x, -0.15 * x], [y, -0.15 * y], color=COLOURS[2], lw=0.9)


def on_map(fixes: Fixes, name: str) -> bytes:
    """A map for each fix: the circle that holds 95 % of the errors, with ellipses of the same share."""
    points, count = fixes.points, len(fixes.covariance)
    sides, columns = points.sides / NAUTICAL_MILE, min(count, 3)
    rows = -(-count // columns)
    with figure(rows, columns, (4.6 * columns, 3.9 * rows + 0.4), above=0.2, squeeze=False) as (drawing, axes):
        for axis in axes.flat[count:]:
            axis.set_visible(False)
        every = max(1, (len(sides) - 1) // 8)
        chosen = np.zeros(points.shape[1:], bool)
        chosen[every // 2 :: every, every // 2 :: every] = True
        spacing = every * (sides[1] - sides[0]) * NAUTICAL_MILE
        scale = _magnified(fixes, chosen.ravel(), spacing)
        for axis, (fix, packed) in zip(axes.flat, fixes.covariance.items(), strict=False):
            known = np.isfinite(packed).all(axis=-1)
            shown = np.full(len(packed), np.nan)
            shown[known] = radius(packed[known], SHARE) / NAUTICAL_MILE
            found = axis.pcolormesh(
                sides,
                sides,
                shown.reshape(points.shape[1:]),
                cmap="viridis_r",
                norm=LogNorm(0.1, 10.0),
                rasterized=True,
            )
            drawing.colorbar(found, ax=axis, shrink=0.85, label=f"{100 * SHARE:g} % circle, nmi", extend="both",
                             ticks=NUMBERS, format=FuncFormatter(_plain)).minorticks_off()  # fmt: skip
            for at in np.flatnonzero(known & chosen.ravel()):
                east, north = (scale * part / NAUTICAL_MILE for part in ellipse(packed[at], SHARE))
                if np.max(np.hypot(east, north)) < 2.0 * spacing / NAUTICAL_MILE:
                    axis.plot(sides[at % len(sides)] + east, sides[at // len(sides)] + north, color="white", lw=0.9)
            middle = len(sides) // 2 * (len(sides) + 1)
            for line in fixes.lines[fix]:
                x, y = plane(line.station, points.latitude[middle], points.longitude[middle])
                axis.plot(x / NAUTICAL_MILE, y / NAUTICAL_MILE, "^", color=COLOURS[1], ms=6, mec="white", mew=0.5)
            axis.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
            axis.set(xlim=(sides[0], sides[-1]), ylim=(sides[0], sides[-1]))
            axis.grid(False)
            axis.set_title(fix, fontsize=10)
        drawing.suptitle(
            f"{name}: ellipses of {100 * SHARE:g} %, {scale:g} times their size", x=0.01, ha="left", fontsize=11
        )
        return png(drawing, dpi=90)


def _plain(number: float, _: int) -> str:
    return f"{number:g}"


def _magnified(fixes: Fixes, chosen: np.ndarray, spacing: float) -> float:
    """1, 2 or 5 times a power of ten, so that most ellipses are a little smaller than the spacing between them."""
    known = (packed[chosen & np.isfinite(packed).all(axis=-1)] for packed in fixes.covariance.values())
    sizes = np.concatenate([principal(packed)[0] for packed in known])
    wanted = 0.2 * spacing / float(np.median(sizes)) if sizes.size else 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def along(fixes: Fixes, name: str) -> bytes:
    """Over time the circle that holds 95 % of the errors, of each fix; a gap where there is none."""
    minutes = (fixes.points.time - fixes.points.time[0]) / 60.0
    with figure(1, 1, (10.0, 4.6), below=0.25, above=0.1) as (drawing, axis):
        for number, (fix, packed) in enumerate(fixes.covariance.items()):
            known = np.isfinite(packed).all(axis=-1)
            shown = np.full(len(packed), np.nan)
            shown[known] = radius(packed[known], SHARE) / NAUTICAL_MILE
            axis.semilogy(minutes, shown, color=COLOURS[number % len(COLOURS)], lw=1.1, label=fix)
        axis.axhline(0.5, color=GREY, lw=0.7, ls="--")
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter(FuncFormatter(_plain))
        axis.minorticks_off()
        axis.set(xlabel="time, min", ylabel=f"{100 * SHARE:g} % circle, nmi")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=5, fontsize=8)
        title(drawing, axis, f"{name}: fixes along the track (a gap: none)")
        return png(drawing, dpi=100)
