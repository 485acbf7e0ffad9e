"""Dilution around an airport between two and three stations."""

from __future__ import annotations

import numpy as np
from pymap3d import vincenty

from navfmu.constants import FOOT, NAUTICAL_MILE
from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.navaids.coverage import Coverage, Points
from navfmu.navaids.picture import dilutions
from navfmu.navaids.station import Station
from navfmu.report.figure import figure, png, title

MIDDLE = (float(np.radians(37.7)), float(np.radians(-121.8)))
"""The airport."""
SIDE = 20.0
"""nmi from the airport to each station of Figs 7.1 to 7.3, and to each side of the maps."""
COUNT = 81
HEIGHT = 1500 * FOOT
NOISE = 7.4
"""m, the wide-band noise of a distance, section 7.1."""
TWO, THREE = (0.0, 180.0), (0.0, 120.0, 240.0)
"""Bearings of the stations from the airport, deg."""
LARGEST = 50.0
"""Dilution that is none: a noise of 7.4 m is then 370 m."""


def made(bearing: float) -> Station:
    """A station SIDE nmi from the airport in this direction (deg)."""
    place = np.radians(vincenty.vreckon(*np.degrees(MIDDLE), SIDE * NAUTICAL_MILE, bearing))
    return Station(f"{bearing:.0f}", "", *map(float, place), 0.0, 110.0, 200 * NAUTICAL_MILE)


def around(side: float = SIDE) -> Points:
    """A map of that many nmi to each side of the airport."""
    return Points.around(*MIDDLE, side * NAUTICAL_MILE, COUNT, [HEIGHT])


def dilution(bearings: tuple[float, ...], points: Points) -> np.ndarray:
    """HDOP on a map, (north, east)."""
    return Coverage.of([made(bearing) for bearing in bearings], points).layers()[0][2]


@row("Three stations around an airport dilute by 1.2 to 2.0, two not at all on the line between them",
     "thesis section 7.1, (6.3), Figs 7.1 to 7.3")  # fmt: skip
def t26(task: Task) -> Found:
    """Maps of dilution with three and two stations."""
    points = around()
    three, two = dilution(THREE, points), dilution(TWO, points)
    words = "Dilution with three and with two stations, each 20 nmi from the airport in the middle"
    return Found(compared(three, two, reach()), picture(points.sides / NAUTICAL_MILE, three, two), words)


def reach() -> float:
    """How far a map goes, in nmi, whose largest dilution with three stations is the printed one, to 0.5 nmi."""
    return next(side for side in np.arange(SIDE, 60.0, 0.5) if np.max(dilution(THREE, around(side))) >= 2.0)


def compared(three: np.ndarray, two: np.ndarray, far: float) -> list[Comparison]:
    """The printed range, what it makes of the noise of a distance, and the line between two stations."""
    digits = "the printed figure has no more digits"
    middle = two[:, len(two) // 2]
    area = Difference(
        1.2, 2.0,
        f"Fig 7.2 does not say how far its map goes: over {SIDE:g} nmi to each side, as far as the stations are, the "
        f"corners have the largest dilution; {far:g} nmi to each side have 2.0",
    )  # fmt: skip
    return [
        Comparison("smallest dilution of three", "1.2", float(np.min(three)), 1.15, 1.25, digits),
        Comparison("largest dilution of three", "2.0", float(np.max(three)), 1.95, 2.05, digits, difference=area),
        Comparison("smallest error by noise", "9 m", NOISE * float(np.min(three)), 8.5, 9.5, digits, "m"),
        Comparison(
            "smallest dilution of two on the line between them", "large", float(np.min(middle)), LARGEST, np.inf,
            f"with {LARGEST:g} the noise of {NOISE:g} m is {LARGEST * NOISE:.0f} m, more than the bias of a distance",
        ),
    ]  # fmt: skip


def picture(sides: np.ndarray, three: np.ndarray, two: np.ndarray) -> bytes:
    """Both maps, as Figs 7.2 and 7.3."""
    with figure(1, 2, size=(11.0, 4.8)) as (drawing, axes):
        for axis, hdop, text in zip(axes, (three, two), ("Three stations", "Two stations"), strict=True):
            dilutions(drawing, axis, sides, hdop)
            axis.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
            title(drawing, axis, f"{text}: HDOP {_span(hdop)}")
        return png(drawing)


def _span(hdop: np.ndarray) -> str:
    """From the smallest on; what is beyond any use has no number."""
    largest = float(np.max(hdop))
    return f"{np.min(hdop):.2f} to {largest:.2f}" if largest < LARGEST else f"{np.min(hdop):.2f} and more"
