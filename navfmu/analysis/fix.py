"""Position fixing by distances and bearings: how well, and what many fixes with errors give.

Thesis Appendix D. It prints (D.11) as sigma^2 (H' H)^-1 H', which has not the size of a covariance; it is
(H' R^-1 H)^-1 with the variances R of the lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.analysis.circle import principal, radius
from navfmu.analysis.line import BEARING, DISTANCE, Line
from navfmu.analysis.place import Place, moved
from navfmu.constants import FOOT
from navfmu.files.numbers import label
from navfmu.navaids.coverage import Points
from navfmu.navaids.sight import sight
from navfmu.navaids.station import Station

STEPS = 30
"""Of Gauss and Newton; from where a fix is sought they end after some 5."""
STILL = 1e-4
"""A step that ends them, m."""
CONE = float(np.radians(60.0))
"""From so steep above it on a VOR has no bearing: its cone of confusion."""
LONGEST = 50e3
"""A step is cut to, m."""


def methods(stations: Sequence[Station], distance: float, bearing: float) -> dict[str, tuple[Line, ...]]:
    """The fixes that stations give, by name: rho-rho, theta-theta, rho-theta of each, all lines together.

    ``distance`` (m) and ``bearing`` (rad) are the sigmas of the lines.
    """
    far = tuple(Line(one, DISTANCE, distance) for one in stations)
    round_ = tuple(Line(one, BEARING, bearing) for one in stations)
    each = {f"rho-theta {a.station.ident}": (a, b) for a, b in zip(far, round_, strict=True)}
    if len(stations) == 1:
        return each
    names = " ".join(one.ident for one in stations)
    return {f"rho-rho {names}": far, **each, f"theta-theta {names}": round_, f"all of {names}": (*far, *round_)}


def information(lines: Sequence[Line], latitude, longitude, altitude) -> np.ndarray:
    """H' R^-1 H at places (rad, rad, m), packed (..., 3): north, both, east; 1/m2."""
    total = np.zeros((*np.shape(latitude), 3))
    for line in lines:
        slope = line.seen(latitude, longitude, altitude)[1] / line.sigma
        total += np.stack([slope[..., 0] ** 2, slope[..., 0] * slope[..., 1], slope[..., 1] ** 2], axis=-1)
    return total


def covariance(lines: Sequence[Line], latitude, longitude, altitude) -> np.ndarray:
    """Of the errors of a fix to north and east, packed (..., 3), m2; infinite where it is useless.

    It is where a station whose bearing is taken stands steeper than ``CONE`` below, and where the longer axis of its
    ellipse (one sigma) reaches as far as the nearest station is: so far lines are not straight, and what they say of
    the place they say of the station, too. That is so where lines do not cross.
    """
    north, both, east = np.moveaxis(information(lines, latitude, longitude, altitude), -1, 0)
    determinant = north * east - both * both
    known = determinant > 1e-14 * (north + east) ** 2
    packed = np.stack([east, -both, north], axis=-1) / np.where(known, determinant, 1.0)[..., None]
    nearest = np.full(np.shape(latitude), np.inf)
    for line in lines:
        far, steep = line.away(latitude, longitude, altitude)
        nearest = np.minimum(nearest, far)
        known &= (line.kind == DISTANCE) | (steep < CONE)
    known &= principal(packed)[0] < nearest
    return np.where(known[..., None], packed, np.inf)


def solve(lines: Sequence[Line], measured: np.ndarray, latitude: float, longitude: float, altitude: float):
    """Places (rad) with the least weighted squares, each (...), of what is ``measured``, (..., lines); NaN where none.

    Steps (D.8) by Gauss and Newton from a place, with the gain alpha = 1.
    """
    lat, lon = (np.full(measured.shape[:-1], float(start)) for start in (latitude, longitude))
    for _ in range(STEPS):
        step = _step(lines, measured, lat, lon, altitude)
        far = np.hypot(step[0], step[1])
        lat, lon = moved(lat, lon, altitude, *(step * np.minimum(1.0, LONGEST / np.maximum(far, 1e-9))))
        if np.all(far < STILL):
            break
    found = far < STILL
    return np.where(found, lat, np.nan), np.where(found, lon, np.nan)


def _step(lines: Sequence[Line], measured: np.ndarray, latitude, longitude, altitude) -> np.ndarray:
    """(D.8) solved with weights, (2, ...), m to north and east."""
    total, towards = np.zeros((3, *np.shape(latitude))), np.zeros((2, *np.shape(latitude)))
    for i, line in enumerate(lines):
        value, slope = line.seen(latitude, longitude, altitude)
        north, east = np.moveaxis(slope / line.sigma, -1, 0)
        total += np.stack([north * north, north * east, east * east])
        towards += np.stack([north, east]) * line.missing(measured[..., i], value) / line.sigma
    determinant = np.maximum(total[0] * total[2] - total[1] ** 2, 1e-300)
    return (
        np.stack([total[2] * towards[0] - total[1] * towards[1], total[0] * towards[1] - total[1] * towards[0]])
        / determinant
    )


def direction(covariance: np.ndarray) -> np.ndarray:
    """Where the longer axis of an ellipse points, from north to east, rad, 0 to pi, of packed covariances (..., 3)."""
    north, both, east = np.moveaxis(covariance, -1, 0)
    return (0.5 * np.arctan2(2.0 * both, north - east)) % np.pi


def crossing(lines: Sequence[Line], place: Place) -> float:
    """The largest angle at which two of the lines cross at a place, rad, 0 to pi/2."""
    slopes = [line.seen(*map(np.asarray, place.values()))[1] for line in lines]
    turns = [
        np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), abs(a @ b)) for i, a in enumerate(slopes) for b in slopes[i + 1 :]
    ]
    return float(max(turns))


def useless(lines: Sequence[Line], points: Points, place: Place) -> str:
    """Why there is no fix at a place, as the end of a sentence."""
    steep = [
        line.station.ident
        for line in lines
        if line.kind == BEARING and line.away(*map(np.asarray, place.values()))[1] >= CONE
    ]
    if steep:
        return f"{steep[0]} stands too steep below for a bearing, by more than {np.degrees(CONE):.0f} degrees"
    silent = [
        line.station.ident
        for line in lines
        if not sight([line.station], points.latitude, points.longitude, points.altitude, points.ground).heard[0, 0]
    ]
    if silent:
        return f"{silent[0]} is not heard there"
    return (
        f"its lines cross at {np.degrees(crossing(lines, place)):.2g} degrees, and along them a fix would be wrong by "
        "more than the nearest station is away: they must cross (two circles do not on the line through their "
        "stations, and two bearings neither)"
    )


def measured(lines: Sequence[Line], place: Place) -> np.ndarray:
    """What the lines are at a place, (lines,)."""
    return np.array([line.seen(*map(np.asarray, place.values()))[0] for line in lines])


def drawn(lines: Sequence[Line], place: Place, count: int, seed: int) -> np.ndarray:
    """Errors of so many fixes to north and east, (count, 2), m, of lines that are wrong by normal errors."""
    rng = np.random.default_rng(seed)
    sigmas = np.array([line.sigma for line in lines])
    errors = sigmas * rng.standard_normal((count, len(lines)))
    return place.offset(*solve(lines, measured(lines, place) + errors, *place.values()))


@dataclass(frozen=True)
class Fixes:
    """The fixes of stations at points: ``covariance`` of each, packed (points, 3), infinite where there is none."""

    points: Points
    lines: dict[str, tuple[Line, ...]]
    covariance: dict[str, np.ndarray]

    @classmethod
    def of(cls, lines: dict[str, tuple[Line, ...]], points: Points) -> Fixes:
        """Those by all stations of a fix, where all of them are heard."""
        where = points.latitude, points.longitude, points.altitude
        found = {}
        for name, some in lines.items():
            seen = sight([line.station for line in some], *where, points.ground)
            found[name] = np.where(np.all(seen.heard, axis=0)[:, None], covariance(some, *where), np.inf)
        return cls(points, lines, found)

    def columns(self) -> dict[str, np.ndarray]:
        """A table, a row for each point: of each fix the axes of one sigma and the circle of 95 %, -1 where none is."""
        points = self.points
        found = {} if points.time is None else {label("time", "s"): points.time}
        found |= {
            label("latitude", "deg"): np.degrees(points.latitude),
            label("longitude", "deg"): np.degrees(points.longitude),
            label("altitude", "ft"): points.altitude / FOOT,
        }
        for name, packed in self.covariance.items():
            known = np.isfinite(packed).all(axis=-1)
            sound = np.where(known[:, None], packed, [1.0, 0.0, 1.0])
            long, short = principal(sound)
            for what, unit, values in (
                ("long axis", "m", long), ("short axis", "m", short),
                ("direction", "deg", np.degrees(direction(sound))), ("95 % circle", "m", radius(sound, 0.95)),
            ):  # fmt: skip
                found[label(f"{name} {what}", unit)] = np.where(known, values, -1.0)
        return found
