"""Truth and estimate over ground, with marks such as ground stations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator

from navfmu.errors import NavfmuError
from navfmu.files.schema import Field, Table
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.finite import remark
from navfmu.report.kind import Picture as Base
from navfmu.report.kind import pair
from navfmu.report.scene import Drawn, Scene, early

NAUTICAL_MILE = 1852.0  # m
EARTH = 6_371_000.0  # m, radius of a sphere: for pictures only
RADIANS = {"rad": 1.0, "deg": np.pi / 180}
Place = Annotated[list[str], AfterValidator(pair)]
MARKS = ("^", "s", "D", "v", "P", "*")


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


class Picture(Base):
    """Truth and estimate of one run over ground, in nautical miles from the middle of the track."""

    kind: Literal["map"]
    truth: Place = Field(description="signals of latitude and longitude")
    estimate: Place | None = Field(None, description="signals of estimated latitude and longitude")
    valid: str | None = Field(None, description="the estimate is drawn where this signal is not 0; default: always")
    marks: list[Marks] = Field([], description="places to mark")

    def needs(self) -> list[str]:
        return [*self.truth, *(self.estimate or []), *([self.valid] if self.valid else [])]

    def constants(self) -> list[str]:
        names = [name for mark in self.marks for name in (mark.latitude, mark.longitude, mark.count)]
        return [name for name in names if name is not None]

    def check(self, units: Mapping[str, str]) -> None:
        places = [*self.truth, *(self.estimate or [])]
        for name in places + [name for mark in self.marks for name in (mark.latitude, mark.longitude)]:
            if units.get(name) not in RADIANS:
                raise NavfmuError(f"'{name}' is in {units.get(name) or '1'}, expected an angle in rad or deg")

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

    def _estimate(self, axis: Any, ground: Ground, scene: Scene) -> list[str]:
        """Draw the estimate where it is valid; what to say about it."""
        run = scene.shown
        places = [run[name] * RADIANS[scene.unit(name)] for name in self.estimate or ()]
        known = run[self.valid] != 0 if self.valid else np.ones(run.time.size, bool)
        east, north = (np.where(known, values, np.nan) for values in ground.local(*places))
        axis.plot(east, north, color=COLOURS[1], linewidth=1.0, label="estimate")
        if not known.any():
            return ["ESTIMATE NEVER VALID"]
        away = distance(places, [run[name] * RADIANS[scene.unit(name)] for name in self.truth])[known]
        missing = remark([away])
        away = away[np.isfinite(away)]
        found = [f"estimate up to {away.max():.3g} nmi off"] if away.size else []
        return found + ([f"ESTIMATE {missing.upper()}"] if missing else [])


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
