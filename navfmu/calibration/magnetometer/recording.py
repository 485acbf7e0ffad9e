"""Fields that a triad measured while it was turned, from a file: columns by name, checked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.calibration.columns import Columns, opened
from navfmu.errors import NavfmuError
from navfmu.recorded.replay.asked import check_turn, turn

QUANTITIES = {"time": (1, "s"), "field": (3, "T"), "heading": (1, "rad")}
FEWEST = 50
"""Samples, at least."""
MOST = 20000
"""Samples, at most: more, of one recording, tell hardly more, since errors of neighbours go together."""
PLAUSIBLE = (0.05, 50.0)
"""Size of a measured field over that of Earth's: hard iron of many gauss and gains of 4 are in the thesis."""
EARTH = 5e-5
"""T, where no strength is told: 22 to 67 uT are on Earth."""
WILD = 10.0
"""A field that is farther from the one in the middle, over Earth's, was not measured: gains of 4 make twice 4 of it."""


@dataclass(frozen=True)
class Recording:
    """``measured`` fields (samples, 3), T, forward, right, down; ``heading`` (samples,), rad, magnetic, or None;
    ``places`` says where each sample stands in the file."""

    source: str
    measured: np.ndarray
    heading: np.ndarray | None
    sentences: tuple[str, ...]
    places: Callable[[int], str]


def recording(
    path: str | Path,
    columns: Mapping[str, tuple[str, ...]],
    units: Mapping[str, str],
    axes: tuple[str, ...] = ("x", "y", "z"),
    begin: float | None = None,
    end: float | None = None,
) -> Recording:
    """Read a table, or a log of PX4, from ``begin`` to ``end``, s of its time."""
    file = opened(path, "field_x")
    check_turn(axes, "--axes")
    asked = Columns(file, QUANTITIES, columns, units)
    measured = asked.values("field") @ turn(axes, "--axes").T
    heading = asked.values("heading") if asked.has("heading") else None
    told = list(file.told)
    rows = np.arange(len(measured))
    if begin is not None or end is not None:
        time = asked.values("time")
        begin, end = (time[0] if begin is None else begin), (time[-1] if end is None else end)
        rows = np.flatnonzero((time >= begin) & (time <= end))
        told.append(f"{len(rows)} of {len(time)} rows are from {begin:g} to {end:g} s")
        if not len(rows):
            raise NavfmuError(
                f"{file.path}: no row is from {begin:g} to {end:g} s; expected --begin and --end in its time, "
                f"{np.min(time):g} to {np.max(time):g} s"
            )
    if len(rows) < FEWEST:
        raise NavfmuError(f"{file.path}: {len(rows)} samples are too few; expected {FEWEST} at least")
    every = 1 + (len(rows) - 1) // MOST
    if every > 1:
        rows = rows[::every]
        told.append(f"one row of {every} is taken, {len(rows)}")
    return Recording(
        file.path, measured[rows], None if heading is None else heading[rows], tuple(told), lambda i: file.row(rows[i])
    )


def check_strength(taken: Recording, strength: float | None) -> None:
    """A sentence where measured fields are not of the size of Earth's."""
    size = float(np.median(np.linalg.norm(taken.measured, axis=1)))
    low, high = (bound * (strength or EARTH) for bound in PLAUSIBLE)
    if not low <= size <= high:
        raise NavfmuError(
            f"{taken.source}: the field is {size:.3g} T in the middle; expected {low:.1g} to {high:.1g}; name the unit "
            "of the file, as in --unit field=mG"
        )
    off = np.linalg.norm(taken.measured - np.median(taken.measured, axis=0), axis=1)
    if not np.max(off) <= WILD * (strength or EARTH):
        at = int(np.argmax(off))
        told = ", ".join(f"{x:.3g}" for x in taken.measured[at])
        raise NavfmuError(
            f"{taken.source}, {taken.places(at)}: the field is {told} T, {np.max(off):.2g} from that in the middle; "
            f"expected {WILD * (strength or EARTH):.2g} at most; leave out what was not measured"
        )
    if not np.all(np.ptp(taken.measured, axis=0) > 0.0):
        axis = "xyz"[int(np.argmin(np.ptp(taken.measured, axis=0)))]
        raise NavfmuError(f"{taken.source}: the field along {axis} has one value only; expected a triad that is turned")
