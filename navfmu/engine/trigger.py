"""When faults act. Every fault has a trigger, which all its effects ask.

Between two communication points the loop moves all triggers from one to the other: then each of them says of both
whether it acts there, and since when. Kinds:

======  ================================================================
LISTED  in windows first <= k < end that the plan has made a list of
======  ================================================================

``move_triggers`` in source/trigger.h is the one place where it is decided what acts at a point. It comes after
everything of the point before has left, been recorded and been asked.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from navfmu.engine.clock import FOREVER, Clock
from navfmu.faults.fault import Fault

KINDS = ("LISTED",)
(LISTED,) = range(len(KINDS))

WINDOW = np.dtype([("first", np.int64), ("end", np.int64), ("start", np.float64)], align=True)
MOMENT = np.dtype([("acts", np.int32), ("since", np.int64), ("start", np.float64)], align=True)
TRIGGER = np.dtype(
    [
        ("kind", np.int32),
        ("window", np.int32),  # LISTED: its next window, and behind its last one
        ("last", np.int32),
        ("now", MOMENT),  # at the point to which it was moved, and at the one before
        ("before", MOMENT),
    ],
    align=True,
)


class Window(NamedTuple):
    """Communication points first <= k < end, and the time from which a drift grows (s)."""

    first: int
    end: int
    start: float


ALWAYS = (Window(0, FOREVER, 0.0),)
Windows = tuple[Window, ...]  # in their order; none overlaps another


def windows(fault: Fault, clock: Clock) -> Windows:
    """The communication points at which a fault acts."""
    first, end = clock.index(fault.start), clock.index(fault.start + fault.duration)
    if end <= first:
        raise fault.error(
            f"no communication point lies between its start {fault.start:.9g} s and its end "
            f"{fault.start + fault.duration:.9g} s at the step {clock.step:.9g} s",
            "duration",
        )
    return (Window(first, min(end, FOREVER), fault.start),)


def tables(lists: Sequence[Windows]) -> tuple[np.ndarray, np.ndarray]:
    """A row of ``TRIGGER`` for each list, and all rows of ``WINDOW``."""
    rows = np.zeros(len(lists), TRIGGER)
    for row, begin, found in zip(rows, np.cumsum([0, *map(len, lists)]).tolist(), lists, strict=False):
        row["kind"], row["window"], row["last"] = LISTED, begin, begin + len(found)
    return rows, np.array([tuple(window) for found in lists for window in found], WINDOW)


@dataclass(frozen=True)
class Moment:
    """Whether a trigger acts at a communication point; if so, since which point, and which time (s)."""

    acts: bool = False
    since: int = 0
    start: float = 0.0


@dataclass
class Trigger:
    """One trigger of the reference engine; says of the point to which it was moved, and of the one before."""

    windows: Sequence[np.void]
    now: Moment = Moment()
    before: Moment = Moment()

    @classmethod
    def of(cls, row: np.void, windows: np.ndarray) -> Trigger:
        """That of a row of the plan."""
        return cls(list(windows[row["window"] : row["last"]]))

    def move(self, k: int) -> None:
        """To communication point ``k`` from the one before."""
        self.before, self.now = self.now, Moment()
        for window in self.windows:
            if window["first"] <= k < window["end"]:
                self.now = Moment(True, int(window["first"]), float(window["start"]))

    def copy(self) -> Trigger:
        """As it is now, for a snapshot."""
        return dataclasses.replace(self)
