"""What distances tell of position, wind and sensors: tracks in line with the stations, and beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import FuncFormatter
from pymap3d import vincenty

from navfmu.analysis.direction import apart, words
from navfmu.analysis.error_state import DISTANCE_NOISE
from navfmu.analysis.observability import LEAST, Observability, observability
from navfmu.constants import FOOT, NAUTICAL_MILE
from navfmu.figures import Comparison, Found, Task, row
from navfmu.navaids.coverage import Points
from navfmu.navaids.station import Station, plane
from navfmu.report.figure import COLOURS, GREY, figure, png, title

MIDDLE = 37.7, -121.8
"""deg."""
ALTITUDE = 2000.0 * FOOT
SPEED = 46.0
"""90 kt, m/s."""
STEP = 5.0
LASTS = 900.0
"""s."""


def reached(bearing: float, far: float, start: tuple[float, float] = MIDDLE) -> tuple[float, float]:
    """Latitude and longitude (deg) of what lies in a direction (deg), so many m away."""
    latitude, longitude = vincenty.vreckon(*start, far, bearing % 360.0)
    return float(latitude), (float(longitude) + 180.0) % 360.0 - 180.0


def station(ident: str, bearing: float, far: float) -> Station:
    """One that lies in this direction (deg) of the middle, so many nmi away, at sea level."""
    latitude, longitude = np.radians(reached(bearing, far * NAUTICAL_MILE))
    return Station(ident, "", float(latitude), float(longitude), 0.0, 110.0, 200 * NAUTICAL_MILE)


def straight(bearing: float) -> Points:
    """A track through the middle, of geodesics to both sides."""
    along = np.arange(-0.5 * LASTS, 0.5 * LASTS + STEP, STEP) * SPEED
    places = [reached(bearing if far >= 0.0 else bearing + 180.0, abs(far)) for far in along]
    return _track(places)


def varied() -> Points:
    """Circles of 5 min that begin in the middle, at speeds that change by a third within 6 min."""
    here, places = MIDDLE, []
    for time in np.arange(0.0, LASTS + STEP, STEP):
        places.append(here)
        speed = SPEED * (1.0 + np.sin(2.0 * np.pi * time / 400.0) / 3.0)
        here = reached(360.0 * time / 300.0, speed * STEP, here)
    return _track(places)


def _track(places: list[tuple[float, float]]) -> Points:
    latitude, longitude = np.radians(places).T
    time = STEP * np.arange(len(places))
    return Points(latitude, longitude, np.full(time.shape, ALTITUDE), time=time)


CENTRE = station("", 0.0, 0.0)


@dataclass(frozen=True)
class Case:
    """A flight between two stations, at these bearings (deg) of the middle and 30 nmi away."""

    name: str
    bearings: tuple[float, float]
    flown: Callable[[], Points]

    def seen(self, model: str) -> Observability:
        """Of distances in turn every 15 s with the wide-band noise of Table 6.1, in windows of 5 min."""
        stations = [station(ident, bearing, 30.0) for ident, bearing in zip("AB", self.bearings, strict=True)]
        return observability(self.flown(), stations, model, sigma=DISTANCE_NOISE)


CASES = {
    "a": Case("in line with both, to north", (0.0, 180.0), lambda: straight(0.0)),
    "b": Case("in line with both, to east", (90.0, 270.0), lambda: straight(90.0)),
    "c": Case("in line with both, to 30 deg", (30.0, 210.0), lambda: straight(30.0)),
    "I": Case("beside both, to north", (60.0, 120.0), lambda: straight(0.0)),
    "II": Case("circles at changing speed", (60.0, 120.0), varied),
}
"""Those of Figs 6.3 and 6.4."""


def ranks() -> dict[tuple[str, str], np.ndarray]:
    """How many directions the windows of a case and a model tell."""
    asked = [(case, model) for case in "abc" for model in ("position", "reduced")]
    asked += [("I", model) for model in ("position", "reduced", "sensors")] + [("II", "sensors")]
    return {(case, model): CASES[case].seen(model).ranks for case, model in asked}


@row("No distance tells a position across a track through both stations, nor a heading without turns",
     "thesis section 6.3, (6.1)-(6.20), Figs 6.3 and 6.4")  # fmt: skip
def t28(task: Task) -> Found:
    """Ranks of the three cases of Fig 6.3 and of the two of Fig 6.4."""
    unseen = CASES["I"].seen("sensors").weakest
    states = CASES["I"].seen("sensors").states
    together = "; ".join(words(one, states) for one in apart(unseen.directions[unseen.rank :]))
    notes = [
        f"A direction counts as told where its singular value is {LEAST:g} or more, in units of what is known "
        "beforehand (0.5 nmi, Table 6.1) and of the wide-band noise of a distance.",
        f"At constant heading and speed two directions are lost, not one: {together}. The thesis has columns 4 to 6 "
        "depend on each other; 3 to 6 have a rank of 2.",
        "(6.19) is printed without the sign that V sin(psi) has in (6.15).",
        "On the ellipsoid north turns along a track to the east: position across then has 5e-4 of the singular value "
        "of position along, where in the plane it has 0.",
    ]
    shows = "Tracks and stations, and singular values of position, wind, heading and airspeed in the weakest window"
    return Found(compared(ranks()), picture(), shows, notes)


def compared(found: dict[tuple[str, str], np.ndarray]) -> list[Comparison]:
    """What the windows tell, at most where the thesis says that something is lost, at least where it says that not."""
    count = "it is a count"
    along = "what is told lies along the track"
    position, wind = ("position", "2 of position"), ("reduced", "4 of position and wind")
    lost = [
        Comparison(f"case {case} of Fig 6.3: of {what}, told at most", f"less than {what[0]}",
                   float(np.max(found[case, model])), of, of, along)
        for (model, what), of in ((position, 1), (wind, 2))
        for case in "abc"
    ]  # fmt: skip
    told = [
        Comparison(f"beside both: of {what}, told at least", what[0], float(np.min(found["I", model])), of, of, count)
        for (model, what), of in ((position, 2), (wind, 4))
    ]
    constant, changing = float(np.max(found["I", "sensors"])), float(np.min(found["II", "sensors"]))
    same = "position and wind are told, as with four unknowns"
    return [
        *lost,
        *told,
        Comparison("constant heading and speed: of 6, told at most", "less than 6", constant, 4, 5, same),
        Comparison("changing heading and speed: of 6, told at least", "6", changing, 6, 6, count),
    ]


def picture() -> bytes:
    """Tracks with their stations, and singular values of six unknowns."""
    with figure(1, 2, size=(11.0, 5.4), below=0.6) as (drawing, (plan, values)):
        for number, (name, case) in enumerate(CASES.items()):
            found, colour = case.seen("sensors"), COLOURS[number]
            points = found.path.points
            north, east = found.path.moved_n.T / NAUTICAL_MILE
            x0, y0 = (-of / NAUTICAL_MILE for of in plane(CENTRE, points.latitude[0], points.longitude[0]))
            plan.plot(x0 + east, y0 + north, color=colour, lw=1.5)
            for one in found.stations:
                plan.plot(
                    *(of / NAUTICAL_MILE for of in plane(one, *np.radians(MIDDLE))),
                    "^",
                    color=colour,
                    ms=12 - 1.5 * number,
                )
            shown = np.maximum(found.weakest.values, 1e-6)
            values.semilogy(np.arange(1, 7), shown, "o-", color=colour, lw=0.8, ms=5, label=f"{name}: {case.name}")
        values.axhline(LEAST, color=GREY, lw=0.9, ls=":")
        values.yaxis.set_major_formatter(FuncFormatter(lambda number, _: f"{number:g}"))
        values.set(xlabel="number of the singular value", ylabel="singular value")
        values.legend(loc="upper left", bbox_to_anchor=(-0.05, -0.12), ncol=2, fontsize=8)
        plan.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
        title(drawing, plan, "Tracks, and the stations of each")
        title(drawing, values, "Told above the dotted line")
        return png(drawing)
