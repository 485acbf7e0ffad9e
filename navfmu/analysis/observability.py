"""What distances along a track tell of the errors of dead reckoning: rank and singular values of their matrix.

Thesis section 6.3. The matrix has a row for each distance of a window, H_k Phi(t_k, t_0): its change by the errors at
the beginning of the window. (6.15), (6.16) and (6.20) hold heading and speed, here they are integrated along the track;
(6.19) has lost the sign of V sin(psi) in (6.15).

Errors are counted in what is known of them beforehand (their sigmas) and distances in their noise. A singular value s
then says how much the window tells of a direction among the errors: what is not known of it becomes 1 / sqrt(1 + s^2)
of what it was. A direction counts as observable from s = 1 on, where the distances of the window tell as much as was
known without them. A rank by rounding alone would call a wind observable that takes hours to show.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.analysis.error_state import State, noise, states
from navfmu.errors import NavfmuError
from navfmu.files.numbers import label
from navfmu.navaids.coverage import Points
from navfmu.navaids.sight import sight
from navfmu.navaids.station import Station
from navfmu.recorded.defects import local_metric

LEAST = 1.0
"""Singular value from which on a direction counts as observable."""
FINEST = 5.0
"""s between points between which heading is that of the displacement: what jitters in a recording is then small."""
ROUNDING = 1e-6
"""Below, singular values are that of rounding."""
STANDING = 100.0
"""m: a track that goes no farther does not move."""


@dataclass(frozen=True)
class Path:
    """A track at even times: ``time`` s, ``points``, ``moved_n`` m to north and east from the first, (points, 2).

    ``air_n`` is the way through the air, without that of the wind.
    """

    points: Points
    moved_n: np.ndarray
    air_n: np.ndarray

    @classmethod
    def of(cls, track: Points, step: float, wind_n: tuple[float, float] = (0.0, 0.0)) -> Path:
        """A track, linear between its rows, every ``step`` s in a wind that blows to north and east, m/s."""
        time = np.arange(track.time[0], track.time[-1] + 1e-6, step)
        places = [np.interp(time, track.time, of) for of in (track.latitude, track.longitude, track.altitude)]
        per = np.stack(local_metric(places[0], places[2]))
        steps = 0.5 * (per[:, 1:] + per[:, :-1]) * np.diff(places[:2])
        moved = np.concatenate([np.zeros((1, 2)), np.cumsum(steps.T, axis=0)])
        air = moved - np.outer(time - time[0], wind_n)
        return cls(Points(*places, track.ground, time=time), moved, air)

    @property
    def speed(self) -> float:
        """Over ground, in the middle, m/s."""
        lengths = np.hypot(*np.diff(self.moved_n, axis=0).T)
        return float(np.median(lengths)) / float(self.points.time[1] - self.points.time[0])


def effects(path: Path, found: Sequence[State], idents: Sequence[str], start: int, end: int) -> tuple:
    """What one sigma of each state at the point ``start`` does until ``end``: to the position to north and east,
    (points, 2, states), to the altitude, (points, states), and to the distance of each station, (points, stations,
    states); m."""
    time = path.points.time[start:end] - path.points.time[start]
    way = np.diff(path.air_n[start:end], axis=0)
    ahead = way / np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    step = np.diff(time)[:, None]
    right = np.stack([-way[:, 1], way[:, 0]], axis=-1)
    rates = {  # displacement of each step by an error of 1
        "wind to north": step * [1.0, 0.0],
        "wind to east": step * [0.0, 1.0],
        "heading": right,
        "airspeed": step * ahead,
    }
    held = {"position to north": [1.0, 0.0], "position to east": [0.0, 1.0]}
    level, high = np.zeros((len(time), 2, len(found))), np.zeros((len(time), len(found)))
    far = np.zeros((len(time), len(idents), len(found)))
    for i, state in enumerate(found):
        left = state.sigma * np.exp(-time / state.time)
        if state.name in held:
            level[:, :, i] = np.outer(left, held[state.name])
        elif state.name in rates:
            middle = 0.5 * (left[1:] + left[:-1])[:, None]
            level[1:, :, i] = np.cumsum(middle * rates[state.name], axis=0)
        elif state.name == "altitude":
            high[:, i] = left
        else:
            far[:, list(idents).index(state.name.removeprefix("distance of ")), i] = left
    return level, high, far


@dataclass(frozen=True)
class Window:
    """``values``: singular values, the largest first, (states,); ``directions`` to them, rows in sigmas of the states.

    From ``start`` to ``end``, s; ``count`` is how many distances there are.
    """

    start: float
    end: float
    count: int
    values: np.ndarray
    directions: np.ndarray

    @property
    def left(self) -> np.ndarray:
        """What is not known of each direction after the window, of what it was before, (states,)."""
        return 1.0 / np.sqrt(1.0 + self.values**2)

    @property
    def rank(self) -> int:
        """How many directions are observable."""
        return int(np.sum(self.values >= LEAST))


@dataclass(frozen=True)
class Observability:
    """Of all windows along a track."""

    path: Path
    stations: tuple[Station, ...]
    states: tuple[State, ...]
    model: str
    every: float
    window: float
    together: bool
    windows: tuple[Window, ...]

    @property
    def ranks(self) -> np.ndarray:
        """Of each window."""
        return np.array([one.rank for one in self.windows])

    def columns(self) -> dict[str, np.ndarray]:
        """A table, a row for each window."""
        points = self.path.points
        at = np.searchsorted(points.time, [one.start for one in self.windows])
        values = np.stack([one.values for one in self.windows], axis=-1)
        return {
            label("time", "s"): np.array([one.start for one in self.windows]),
            label("latitude", "deg"): np.degrees(points.latitude[at]),
            label("longitude", "deg"): np.degrees(points.longitude[at]),
            "distances": np.array([one.count for one in self.windows]),
            "observable": self.ranks,
            **{f"value {i}": of for i, of in enumerate(values, 1)},
        }

    @property
    def weakest(self) -> Window:
        """The window that tells least: of the lowest rank, of these the one with the smallest singular value."""
        return min(self.windows, key=lambda one: (one.rank, max(one.values[-1], ROUNDING)))


def observability(
    track: Points, stations: Sequence[Station], model: str = "reduced", *, every: float = 15.0, window: float = 300.0,
    together: bool = False, wind_n: tuple[float, float] = (0.0, 0.0), sigma: float | None = None, source: str = "track",
) -> Observability:  # fmt: skip
    """Analyse a track: every ``every`` s a distance, of each station in turn or of all ``together``.

    Windows of ``window`` s begin at each of these times. Distances of stations that are not heard are lost. ``sigma``
    (m) is the noise of a distance in place of the model's, ``wind_n`` (m/s) that in which the aircraft flew.
    """
    _check(track, stations, every, window, source)
    parts = int(np.ceil(every / FINEST))
    path = Path.of(track, every / parts, wind_n)
    points = path.points
    spread = float(np.max(np.hypot(*path.moved_n.T)))
    if spread < STANDING:
        raise NavfmuError(
            f"{source}: the track does not move (it stays within {spread:.0f} m); what distances tell of errors that "
            f"grow comes of motion: expected a flight of more than {STANDING:.0f} m"
        )
    idents = [one.ident for one in stations]
    found = states(model, idents, path.speed)
    sigma = noise(model) if sigma is None else sigma
    seen = sight(stations, points.latitude, points.longitude, points.altitude, points.ground)
    level = np.stack([seen.north, seen.east], axis=-1)
    above = np.sqrt(np.maximum(1.0 - np.sum(level * level, axis=-1), 0.0))  # the station lies below
    times = np.arange(0, len(points.time), parts)
    count = int(window / every + 1e-9)
    windows = []
    for first in range(len(times) - count):
        start, end = times[first], times[first + count] + 1
        position, high, far = effects(path, found, idents, start, end)
        numbers = np.arange(first, first + count + 1)
        if together:
            at, which = np.repeat(times[numbers], len(stations)), np.tile(np.arange(len(stations)), count + 1)
        else:
            at, which = times[numbers], numbers % len(stations)
        heard = seen.heard[which, at]
        at, which = at[heard], which[heard]
        rows = -np.einsum("ka,kas->ks", level[which, at], position[at - start])
        rows += above[which, at][:, None] * high[at - start] + far[at - start, which]
        matrix = np.vstack(
            [rows / sigma, np.zeros((len(found), len(found)))]
        )  # a value for each state, of few rows too
        _, values, directions = np.linalg.svd(matrix, full_matrices=False)
        windows.append(Window(float(points.time[start]), float(points.time[end - 1]), len(rows), values, directions))
    return Observability(path, tuple(stations), found, model, every, window, together, tuple(windows))


def _check(track: Points, stations: Sequence[Station], every: float, window: float, source: str) -> None:
    if len(stations) < 2:
        raise NavfmuError(
            f"{source}: {stations[0].ident} is the only station; section 6.3 takes distances of two or more: expected "
            "another one, or a file that has one nearer to the track"
        )
    if window < every:
        raise NavfmuError(
            f"a window of {window:g} s has no two distances that are {every:g} s apart; expected a longer one"
        )
    lasts = float(track.time[-1] - track.time[0])
    if lasts < window:
        raise NavfmuError(
            f"{source}: the track is too short, {lasts:g} s for a window of {window:g} s; expected a longer track or "
            "--window"
        )
