"""A picture of coverage: of a grid a map for each height, of a track its course, and both along time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import MaxNLocator

from navfmu.constants import FOOT, NAUTICAL_MILE
from navfmu.navaids.coverage import Coverage
from navfmu.navaids.station import Station, plane
from navfmu.report.figure import COLOURS, GREY, figure, png

COUNTS = ("#ffffff", "#f2f2f2", "#fdd0a2", "#c6dbef", "#6baed6", "#2171b5")
"""None, one, two, three, four, five and more."""
DILUTIONS = (0.0, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0)


def draw(coverage: Coverage, title: str) -> bytes:
    """The picture as PNG."""
    return _map(coverage, title) if coverage.points.shape else _along(coverage, title)


def _map(coverage: Coverage, title: str) -> bytes:
    layers = coverage.layers()
    sides = coverage.points.sides / NAUTICAL_MILE
    size = 4.6
    with figure(len(layers), 2, (11.6, size * len(layers) + 0.4), below=0.1, above=0.45, squeeze=False) as (d, axes):
        for (height, count, hdop), row in zip(layers, axes, strict=True):
            text = f"{height / FOOT:,.0f} ft above the ground"
            for axis, what in zip(row, (counts, dilutions), strict=True):
                what(d, axis, sides, count if what is counts else hdop)
                axis.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
                axis.set_title(f"{'Stations' if what is counts else 'HDOP'}, {text}", fontsize=10)
                _mark(axis, coverage, sides[-1])
        d.suptitle(title, x=0.01, ha="left", fontsize=11)
        return png(d, dpi=90)


def counts(drawing: Any, axis: Any, sides: np.ndarray, count: np.ndarray) -> None:
    """Fill a map with how many stations are heard, and draw its scale."""
    found = axis.pcolormesh(sides, sides, np.minimum(count, 5), **_colours(), rasterized=True)
    axis.grid(False)
    _scale(drawing, axis, found)


def _colours() -> dict[str, Any]:
    return {"cmap": ListedColormap(COUNTS), "norm": BoundaryNorm(np.arange(-0.5, 6.0), len(COUNTS))}


def _scale(drawing: Any, axis: Any, found: Any) -> None:
    scale = drawing.colorbar(found, ax=axis, shrink=0.85, label="stations", ticks=range(6))
    scale.ax.set_yticklabels([*"01234", "5 and more"])


def dilutions(drawing: Any, axis: Any, sides: np.ndarray, hdop: np.ndarray) -> None:
    """Fill a map with the dilution, white where circles do not cross, and draw its scale."""
    levels = BoundaryNorm(DILUTIONS, 256, extend="max")
    shown = np.where(np.isfinite(hdop), hdop, np.nan)
    found = axis.pcolormesh(sides, sides, shown, cmap="viridis_r", norm=levels, rasterized=True)
    axis.grid(False)
    drawing.colorbar(found, ax=axis, shrink=0.85, label="HDOP")


def _mark(axis: Any, coverage: Coverage, side: float) -> None:
    points = coverage.points
    middle = points.sides.size // 2 * (points.sides.size + 1)
    places = []
    for one in coverage.stations:
        x, y = (metres / NAUTICAL_MILE for metres in plane(one, points.latitude[middle], points.longitude[middle]))
        if max(abs(x), abs(y)) < side:
            places.append((one, x, y))
    _stations(axis, places)


def _stations(axis: Any, places: Sequence[tuple[Station, float, float]]) -> None:
    """Stations at x, y of a map that has its limits; names where there is room."""
    for _, x, y in places:
        axis.plot(x, y, "^", color=COLOURS[1], ms=4, mec="white", mew=0.4)
    wide, high = 0.07 * np.ptp(axis.get_xlim()), 0.03 * np.ptp(axis.get_ylim())
    named: list[tuple[float, float]] = []
    for one, x, y in places:
        if not any(abs(x - a) < wide and abs(y - b) < high for a, b in named):
            axis.annotate(one.ident, (x, y), xytext=(2, 2), textcoords="offset points", fontsize=6, clip_on=True)
            named.append((x, y))


def _along(coverage: Coverage, title: str) -> bytes:
    points = coverage.points
    minutes = (points.time - points.time[0]) / 60.0
    with figure(1, 3, (14.0, 4.4), above=0.4) as (drawing, (course, count, hdop)):
        first = np.degrees(points.longitude[0])
        lat, lon = np.degrees(points.latitude), _beside(points.longitude, first)
        course.plot(lon, lat, color=GREY, lw=0.3)
        shown = course.scatter(lon, lat, 5, np.minimum(coverage.count, 5), **_colours())
        _scale(drawing, course, shown)
        heard = [one for one, share in zip(coverage.stations, coverage.share, strict=True) if share > 0.0]
        _stations(course, [(one, _beside(one.longitude, first), float(np.degrees(one.latitude))) for one in heard])
        course.set(xlabel="longitude, deg", ylabel="latitude, deg", aspect=1.0 / np.cos(np.mean(points.latitude)))
        count.step(minutes, coverage.count, where="post", color=COLOURS[0], lw=0.8)
        count.set(xlabel="time, min", ylabel="stations that are heard", ylim=(0.0, None))
        count.yaxis.set_major_locator(MaxNLocator(integer=True))
        height = count.twinx()
        height.plot(minutes, points.altitude / FOOT, color=GREY, lw=0.7)
        height.set_ylabel("altitude, ft (grey)")
        height.grid(False)
        crossing = np.where(np.isfinite(coverage.hdop), coverage.hdop, np.nan)
        hdop.semilogy(minutes, np.minimum(crossing, 100.0), color=COLOURS[0], lw=0.8)
        hdop.set(xlabel="time, min", ylabel="HDOP (a gap: circles do not cross)", ylim=(0.1, 100.0))
        ticks = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)
        hdop.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        hdop.minorticks_off()
        hdop.set_xlim(count.get_xlim())
        drawing.suptitle(title, x=0.01, ha="left", fontsize=11)
        drawing.subplots_adjust(wspace=0.45)
        return png(drawing, dpi=90)


def _beside(longitude: Any, first: float) -> Any:
    """Longitudes (rad) in degrees, less than half a turn from the ``first`` (deg): across 180 degrees as well."""
    return first + (np.degrees(longitude) - first + 180.0) % 360.0 - 180.0
