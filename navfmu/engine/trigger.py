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
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from navfmu.engine.clock import FOREVER, TOLERANCE, Clock, exact
from navfmu.engine.effect import fault_stream
from navfmu.engine.philox import STREAM_BASE, TIMES, stream_of, uniform, words
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


def lists(faults: Sequence[Fault], clock: Clock, seed: int) -> list[Windows]:
    """The windows of each fault; those of a fault that fails at random may begin after the run, or not at all."""
    first_of: dict[str, Fault] = {}
    for fault in faults:
        cause = fault.parameters.get("cause", "")
        other = first_of.setdefault(cause, fault) if cause else fault
        for name in SHARED:
            if _entry(fault, name) != _entry(other, name):
                raise fault.error(
                    f"it has the cause '{cause}' of fault '{other.id}', but another '{name}'; the random times of one "
                    "cause are the same",
                    name if name in fault.parameters else "cause",
                )
    return [windows(fault, clock, seed) for fault in faults]


SHARED = ("start", "duration", "on", "off", "mttf", "mttr", "shape")


def _entry(fault: Fault, name: str) -> Any:
    return fault.parameters.get(name, getattr(fault, name, None))


def windows(fault: Fault, clock: Clock, seed: int) -> Windows:
    """The communication points at which a fault acts."""
    for name in ("on", "off", "mttf", "mttr"):
        if fault.parameters.get(name, math.inf) < clock.step * (1.0 - TOLERANCE):
            given = f"'{name}' {fault.parameters[name]:.9g} s is shorter than the step {clock.step:.9g} s"
            raise fault.error(f"{given}; some of its times would hold no communication point", name)
    begin, end = exact(fault.start), exact(fault.start) + exact(fault.duration) if fault.duration < math.inf else None
    if clock.index(fault.start) >= (FOREVER if end is None else clock.index(float(end))):
        raise fault.error(
            f"no communication point lies between its start {fault.start:.9g} s and its end "
            f"{fault.start + fault.duration:.9g} s at the step {clock.step:.9g} s",
            "duration",
        )
    last = clock.steps * clock.ratio
    spans: Iterable[Span] = [(begin, end)]
    if "mttf" in fault.parameters:
        spans = _failures(fault, begin, end, last, seed)
    if "on" in fault.parameters:
        on, off = (exact(fault.parameters[name]) for name in ("on", "off"))
        spans = (part for span in spans for part in _parts(*span, on, off, last))
    found = (Window(clock.index(float(a)), FOREVER if b is None else clock.index(float(b)), float(a)) for a, b in spans)
    return tuple(window for window in found if window.first < window.end)


Span = tuple[Fraction, Fraction | None]  # from when to when (s); None: it does not end


def _parts(begin: Fraction, end: Fraction | None, on: Fraction, off: Fraction, last: Fraction) -> Iterator[Span]:
    """On and off in turns; one that begins after the run is the last."""
    while end is None or begin < end:
        yield begin, begin + on if end is None else min(begin + on, end)
        if begin > last:
            return
        begin += on + off


def _failures(fault: Fault, begin: Fraction, end: Fraction | None, last: Fraction, seed: int) -> Iterator[Span]:
    """Failures at random; one that begins after the run is the last.

    The n-th comes mttf / gamma(1 + 1 / shape) * (-log u)^(1 / shape) after the end of the one before and lasts
    -mttr * log u', with two uniform numbers that belong to n (Weibull, J. Appl. Mech. 18 (1951) 293).
    """
    mttf, mttr, shape = (fault.parameters.get(name, default) for name, default in RANDOM.items())
    cause = fault.parameters.get("cause")
    stream = STREAM_BASE + (fault_stream(fault) if cause is None else stream_of(f"cause {cause}"))
    scale, number = mttf / math.gamma(1.0 + 1.0 / shape), 0
    while True:
        first, second = map(uniform, words(seed, stream, 0, number, TIMES))
        begin += Fraction(scale * (-math.log(first)) ** (1.0 / shape))
        if end is not None and begin >= end:
            return
        repaired = begin + Fraction(-mttr * math.log(second)) if mttr < math.inf else None
        yield begin, repaired if end is None else end if repaired is None else min(repaired, end)
        if begin > last or repaired is None:
            return
        begin, number = repaired, number + 1


RANDOM = {"mttf": math.inf, "mttr": math.inf, "shape": 1.0}


def begin(found: Windows) -> int:
    """The communication point at which the first window begins."""
    return found[0].first if found else FOREVER


def tables(found: Sequence[Windows]) -> tuple[np.ndarray, np.ndarray]:
    """A row of ``TRIGGER`` for each list of windows, and all rows of ``WINDOW``."""
    rows = np.zeros(len(found), TRIGGER)
    for row, begin, of_one in zip(rows, np.cumsum([0, *map(len, found)]).tolist(), found, strict=False):
        row["kind"], row["window"], row["last"] = LISTED, begin, begin + len(of_one)
    return rows, np.array([tuple(window) for of_one in found for window in of_one], WINDOW)


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
