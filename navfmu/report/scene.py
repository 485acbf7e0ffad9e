"""What pictures and statistics are made from: recorded runs as plain numbers, with the texts and bounds around them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Recorded:
    """One run: its name in legends ("seed 3"), its times (s) and its signals, all of one length.

    ``planned`` (s) has the times of the whole run, of which there are more where an FMU has ended it early.
    """

    name: str
    time: np.ndarray
    signals: Mapping[str, np.ndarray]
    planned: np.ndarray | None = None

    @property
    def points(self) -> np.ndarray:
        """The times of the whole run, s."""
        return self.time if self.planned is None else self.planned

    def __getitem__(self, signal: str) -> np.ndarray:
        """The values of a signal as numbers; false is 0 and true is 1."""
        return np.asarray(self.signals[signal], np.float64)


def whole(runs: Sequence[Recorded]) -> list[Recorded]:
    """The runs with the points of the longest of them; NaN from where a run has ended."""
    points = max((run.points for run in runs), key=len)

    def filled(values: np.ndarray) -> np.ndarray:
        return np.append(values, np.full(len(points) - len(values), np.nan))

    return [Recorded(run.name, points, {name: filled(run[name]) for name in run.signals}) for run in runs]


def early(runs: Sequence[Recorded]) -> str:
    """ "2 of 8 runs ended early, the first at t = 3.2 s", or "" when all are whole."""
    points = max(len(run.points) for run in runs)
    ends = [float(run.time[-1]) for run in runs if len(run.time) < points]
    if not ends:
        return ""
    if len(runs) == 1:
        return f"ended early, at t = {ends[0]:g} s"
    return f"{len(ends)} of {len(runs)} runs ended early, the first at t = {min(ends):g} s"


@dataclass(frozen=True)
class Window:
    """Times in which something is different, a fault for instance; shaded in pictures. From when to when, in s."""

    name: str
    spans: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Bound:
    """What a requirement asks of a signal from ``start`` to ``end`` (s), in the signal's unit."""

    name: str
    signal: str
    least: float | None
    most: float | None
    unit: str
    start: float = 0.0
    end: float = math.inf

    def window(self, time: np.ndarray) -> np.ndarray:
        """Which points in time lie in it."""
        return (time >= self.start - 1e-9) & (time <= self.end + 1e-9)


@dataclass(frozen=True)
class Event:
    """Something that happens at one time (s) in a run: a fault begins, it is noticed, a requirement is violated."""

    kind: str  # "fault", "notice" or "violation"
    name: str
    time: float


@dataclass(frozen=True)
class Scene:
    """The runs of one variant in one case, or a single one."""

    label: str  # "scanning, gps_lost": the beginning of titles; may be empty
    runs: tuple[Recorded, ...]
    shown: Recorded  # the run that is shown where only one can be
    units: Mapping[str, str]  # of the signals; "" or missing where there is none
    windows: tuple[Window, ...] = ()
    bounds: tuple[Bound, ...] = ()
    constants: Mapping[str, Any] = field(default_factory=dict)  # start values; lists for arrays
    events: tuple[Event, ...] = ()  # of the run that is shown

    def titled(self, text: str) -> str:
        """A title with the label in front."""
        return f"{self.label}: {text}" if self.label else text

    def unit(self, signal: str) -> str:
        """The unit of a signal, or ""."""
        return self.units.get(signal) or ""


@dataclass(frozen=True)
class Drawn:
    """A picture; the title says what is to be seen in it."""

    png: bytes
    title: str
    caption: str = ""


def words(signal: str) -> str:
    """The last part of a signal's name in words: "horizontal error"."""
    return signal.removesuffix("@true").rpartition(".")[2].replace("_", " ")


def readable(value: float) -> str:
    """A number for people: four digits, no exponent where a person would write none."""
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.4g}"


def with_unit(text: str, unit: str) -> str:
    """A number or a name with its unit after it, where it has one."""
    return text if unit in ("", "1") else f"{text} {unit}"
