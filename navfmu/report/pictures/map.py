"""Truth and estimate over ground, with marks such as ground stations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator

from navfmu.constants import NAUTICAL_MILE
from navfmu.errors import NavfmuError
from navfmu.files.schema import Field, Number, Table
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.finite import remark
from navfmu.report.kind import Picture as Base
from navfmu.report.kind import pair, same_unit
from navfmu.report.panel import Curve, Panel
from navfmu.report.scene import Drawn, Recorded, Scene, early

EARTH = 6_371_000.0  # m, radius of a sphere: for pictures only
RADIANS = {"rad": 1.0, "deg": np.pi / 180}
Place = Annotated[list[str], AfterValidator(pair)]
MARKS = ("^", "s", "D", "v", "P", "*")
SYMBOLS = ("triangle-up", "square", "diamond", "triangle-down", "cross", "star")
EVENTS = (
    ("fault", "fault begins", "#555555", "x"),
    ("notice", "noticed", "#009E73", "circle-open"),
    ("violation", "first violated", "#D00000", "diamond-open"),
)  # kind, name in the legend, colour, symbol


class Marks(Table):
    """Places that are parameters of a component."""

    label: str = Field(description="what they are, for the legend")
    latitude: str = Field(description="a parameter, or an array of them")
    longitude: str = Field(description="a parameter, or an array of them")
    count: str | None = Field(None, description="a parameter that says how many elements are used; default: all")

    def places(self, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
        """Latitudes and longitudes, rad."""
        ends = [
            np.atleast_1d(np.asarray(scene.constants[name], np.float64)) * RADIANS[scene.unit(name)]
            for name in (self.latitude, self.longitude)
        ]
        count = min(end.size for end in ends)
        if self.count is not None:
            count = min(count, int(scene.constants[self.count]))
        return ends[0][:count], ends[1][:count]


class Ellipses(Table):
    """Where the estimate says that the truth is: north and east standard deviations around it."""

    north: str = Field(description="signal: the standard deviation to the north that is claimed, in m")
    east: str = Field(description="signal: that to the east, in m")
    factor: Number = Field(3, gt=0, allow_inf_nan=False, description="how many sigmas; default 3")
    count: int = Field(12, gt=0, le=100, description="how many are drawn along the track; default 12")


class Picture(Base):
    """Truth and estimate of one run over ground, in nautical miles from the middle of the track."""

    kind: Literal["map"]
    truth: Place = Field(description="signals of latitude and longitude")
    estimate: Place | None = Field(None, description="signals of estimated latitude and longitude")
    valid: str | None = Field(None, description="the estimate is drawn where this signal is not 0; default: always")
    marks: list[Marks] = Field([], description="places to mark")
    ellipses: Ellipses | None = Field(None, description="of the error that the estimate claims; needs an estimate")

    def needs(self) -> list[str]:
        claimed = [self.ellipses.north, self.ellipses.east] if self.ellipses else []
        return [*self.truth, *(self.estimate or []), *([self.valid] if self.valid else []), *claimed]

    def constants(self) -> list[str]:
        names = [name for mark in self.marks for name in (mark.latitude, mark.longitude, mark.count)]
        return [name for name in names if name is not None]

    def check(self, units: Mapping[str, str]) -> None:
        places = [*self.truth, *(self.estimate or [])]
        for name in places + [name for mark in self.marks for name in (mark.latitude, mark.longitude)]:
            if units.get(name) not in RADIANS:
                raise NavfmuError(f"'{name}' is in {units.get(name) or '1'}, expected an angle in rad or deg")
        if self.ellipses is not None:
            same_unit(units, self.ellipses.north, self.ellipses.east)
            if units.get(self.ellipses.north) != "m":
                raise NavfmuError(f"'{self.ellipses.north}' is in {units.get(self.ellipses.north) or '1'}, expected m")
            if self.estimate is None:
                raise NavfmuError("'ellipses' stand around an estimate, and there is none")

    def draw(self, scene: Scene) -> Drawn:
        run = scene.shown
        truth = [run[name] * RADIANS[scene.unit(name)] for name in self.truth]
        ground = Ground(*truth)
        missing = remark([np.add(*truth)])
        sentences = [f"TRUTH {missing.upper()}"] if missing else []
        with figure(size=(7.0, 6.7), below=0.3, above=0.2) as (drawing, axis):
            east, north = ground.local(*truth)
            axis.plot(east, north, color="#000000", linewidth=1.4, label="truth")
            axis.plot(*ground.local(*_first(truth)), "o", color="#000000", markersize=6, label="start")
            if self.estimate:
                sentences += self._estimate(axis, ground, scene)
            for number, mark in enumerate(self.marks):
                places = ground.local(*mark.places(scene))
                if places[0].size:
                    shape, colour = MARKS[number % len(MARKS)], COLOURS[(0, 2, 3, 4)[number % 4]]
                    axis.plot(*places, shape, color=colour, markersize=9, label=mark.label)
            axis.set_aspect("equal", adjustable="datalim")
            heading, seen = scene.titled(", ".join(filter(None, ["ground track", run.name]))), ", ".join(sentences)
            title(drawing, axis, f"{heading}\n{seen}")
            axis.set_xlabel(f"east of {ground.meridian}, nmi")
            axis.set_ylabel(f"north of {ground.parallel}, nmi")
            axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=5)
            caption = (
                f"Truth{' and estimate' if self.estimate else ''}; distances and directions from the middle are true."
            )
            caption += f" The run {ended}." if (ended := early([run])) else ""
            return Drawn(png(drawing), ": ".join(filter(None, [heading, seen])), caption)

    def panels(self, scene: Scene) -> list[Panel]:
        run = scene.shown
        truth = [run[name] * RADIANS[scene.unit(name)] for name in self.truth]
        ground = Ground(*truth)
        east, north = ground.local(*truth)
        curves = [Curve("truth", east, north, colour="#000000")]
        sentences = [f"TRUTH {said.upper()}"] if (said := remark([np.add(*truth)])) else []
        sentences += [said.upper()] if (said := early([run])) else []
        if self.estimate:
            places, known = self._estimated(scene)
            along = [np.where(known, values, np.nan) for values in ground.local(*places)]
            curves.append(Curve("estimate", *along, colour=COLOURS[1]))
            if self.ellipses is not None and known.any():
                outlines = self._outlines(run, *along)
                label = f"{self.ellipses.factor:g} sigma claimed"
                curves.append(Curve(label, *outlines, "outline", COLOURS[2], sampled=False))
            sentences = [*self._off(scene, places, known), *sentences]
        for number, mark in enumerate(self.marks):
            places = ground.local(*mark.places(scene))
            shape, colour = SYMBOLS[number % len(SYMBOLS)], COLOURS[(0, 2, 3, 4)[number % 4]]
            texts = tuple(f"{mark.label} {element}" for element in range(1, len(places[0]) + 1))
            curves.append(Curve(mark.label, *places, "marks", colour, False, texts=texts, symbol=shape))
        curves += _happened(run, east, north, scene)
        title = ": ".join(filter(None, ["ground track", ", ".join(sentences)]))
        axes = f"east of {ground.meridian}, nmi", f"north of {ground.parallel}, nmi"
        return [Panel(title, *axes, tuple(curves), timed=False, equal=True)]

    def _outlines(self, run: Recorded, east: np.ndarray, north: np.ndarray) -> list[np.ndarray]:
        """Ellipses around the estimate (nmi), equally spaced in time, one after the other with a gap between."""
        usable = np.isfinite(east + north + run[self.ellipses.north] + run[self.ellipses.east])
        points = np.flatnonzero(usable)
        chosen = points[np.unique(np.linspace(0, len(points) - 1, min(self.ellipses.count, len(points))).astype(int))]
        angle = np.append(np.linspace(0.0, 2.0 * np.pi, 33), np.nan)
        size = self.ellipses.factor / NAUTICAL_MILE
        return [
            (middle[chosen, None] + size * run[sigma][chosen, None] * turn(angle)).ravel()
            for middle, sigma, turn in ((east, self.ellipses.east, np.sin), (north, self.ellipses.north, np.cos))
        ]

    def _estimated(self, scene: Scene) -> tuple[list[np.ndarray], np.ndarray]:
        """Latitude and longitude (rad) of the estimate, and where it is valid."""
        run = scene.shown
        places = [run[name] * RADIANS[scene.unit(name)] for name in self.estimate or ()]
        return places, run[self.valid] != 0 if self.valid else np.ones(run.time.size, bool)

    def _estimate(self, axis: Any, ground: Ground, scene: Scene) -> list[str]:
        """Draw the estimate where it is valid; what to say about it."""
        run = scene.shown
        places, known = self._estimated(scene)
        east, north = (np.where(known, values, np.nan) for values in ground.local(*places))
        axis.plot(east, north, color=COLOURS[1], linewidth=1.0, label="estimate")
        if self.ellipses is not None and known.any():
            label = f"{self.ellipses.factor:g} sigma claimed"
            axis.plot(*self._outlines(run, east, north), color=COLOURS[2], linewidth=0.8, label=label)
        return self._off(scene, places, known)

    def _off(self, scene: Scene, places: list[np.ndarray], known: np.ndarray) -> list[str]:
        """How far the estimate is off."""
        if not known.any():
            return ["ESTIMATE NEVER VALID"]
        run = scene.shown
        away = distance(places, [run[name] * RADIANS[scene.unit(name)] for name in self.truth])[known]
        missing = remark([away])
        away = away[np.isfinite(away)]
        found = [f"estimate up to {away.max():.3g} nmi off"] if away.size else []
        return found + ([f"ESTIMATE {missing.upper()}"] if missing else [])


def _happened(run: Recorded, east: np.ndarray, north: np.ndarray, scene: Scene) -> list[Curve]:
    """Where on the true track something happened."""
    found = []
    for kind, label, colour, symbol in EVENTS:
        events = [e for e in scene.events if e.kind == kind and run.time[0] <= e.time <= run.time[-1]]
        if events:
            at = np.searchsorted(run.time, [event.time for event in events])
            texts = tuple(f"{event.name}, t = {event.time:g} s" for event in events)
            curve = Curve(label, east[at], north[at], "marks", colour, sampled=False, texts=texts, symbol=symbol)
            found.append(curve)
    return found


class Ground:
    """A plane that touches a sphere in the middle of a track; azimuthal equidistant, also over poles and date line.

    Distance and direction from the middle are true; positive is east and north there.
    """

    def __init__(self, latitude: np.ndarray, longitude: np.ndarray) -> None:
        """Latitudes and longitudes (rad) of the track."""
        points = _directions(latitude, longitude)
        points = points[:, np.isfinite(points).all(axis=0)]
        middle = points.mean(axis=1) if points.size else np.array([1.0, 0.0, 0.0])
        if np.linalg.norm(middle) < 1e-6:  # all around the world
            middle = points[:, 0]
        self.latitude = float(np.arctan2(middle[2], np.hypot(middle[0], middle[1])))
        self.longitude = float(np.arctan2(middle[1], middle[0]))

    @property
    def parallel(self) -> str:
        """The middle's latitude as text."""
        return f"{np.degrees(self.latitude):.3f} deg"

    @property
    def meridian(self) -> str:
        """The middle's longitude as text."""
        return f"{np.degrees(self.longitude):.3f} deg"

    def local(self, latitude: np.ndarray, longitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """East and north of the middle, nautical miles."""
        points = _directions(latitude, longitude)
        (sin_lat, cos_lat), (sin_lon, cos_lon) = ((np.sin(a), np.cos(a)) for a in (self.latitude, self.longitude))
        east = -sin_lon * points[0] + cos_lon * points[1]
        north = -sin_lat * (cos_lon * points[0] + sin_lon * points[1]) + cos_lat * points[2]
        up = cos_lat * (cos_lon * points[0] + sin_lon * points[1]) + sin_lat * points[2]
        across = np.hypot(east, north)
        scale = np.divide(np.arctan2(across, up), across, out=np.ones_like(across), where=across > 0)
        return east * scale * EARTH / NAUTICAL_MILE, north * scale * EARTH / NAUTICAL_MILE


def distance(places: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> np.ndarray:
    """Distance over ground between two series of latitude and longitude (rad), nautical miles."""
    chord = np.linalg.norm(_directions(*places) - _directions(*others), axis=0)
    return 2.0 * np.arcsin(np.minimum(chord / 2.0, 1.0)) * EARTH / NAUTICAL_MILE


def _directions(latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """Unit vectors from the middle of the sphere, shape (3, points)."""
    latitude, longitude = np.atleast_1d(latitude), np.atleast_1d(longitude)
    flat = np.cos(latitude)
    return np.stack([flat * np.cos(longitude), flat * np.sin(longitude), np.sin(latitude)])


def _first(places: list[np.ndarray]) -> list[np.ndarray]:
    """The first finite place."""
    finite = np.flatnonzero(np.isfinite(np.add(*places)))
    return [values[finite[:1]] for values in places]
