"""When faults act. Every fault has a trigger, which all its effects ask.

Between two communication points the loop moves all triggers from one to the other: then each of them says of both
whether it acts there, and since when. Kinds:

======  ================================================================================================
LISTED  in windows first <= k < end that the plan has made a list of
WHEN    for a time, once: from the first point in its window on before which a condition held for long enough
DURING  in its windows, at the points before which a condition held for long enough
======  ================================================================================================

``move_triggers`` in source/trigger.h is the one place where it is decided what acts at a point. It comes after
everything of the point before has left, been recorded and been asked; a condition sees that, and so acts one step
after it became true.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from typing import Any, NamedTuple

import numpy as np

from navfmu.engine.clock import FOREVER, TOLERANCE, Clock, exact
from navfmu.engine.effect import fault_stream
from navfmu.engine.operations import Operations
from navfmu.engine.philox import STREAM_BASE, TIMES, stream_of, uniform, words
from navfmu.errors import NavfmuError
from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.program import Program
from navfmu.faults.fault import Fault
from navfmu.fmi.description import Description

KINDS = ("LISTED", "WHEN", "DURING")
LISTED, WHEN, DURING = range(len(KINDS))
SPANS = 100  # in which it is kept when a trigger acted; what comes later lengthens the last one

WINDOW = np.dtype([("first", np.int64), ("end", np.int64), ("start", np.float64)], align=True)
MOMENT = np.dtype([("acts", np.int32), ("since", np.int64), ("start", np.float64)], align=True)
SPAN = np.dtype([("first", np.int64), ("end", np.int64)], align=True)  # it acted at first <= k < end
TRIGGER = np.dtype(
    [
        ("kind", np.int32),
        ("window", np.int32),  # its next window, and behind its last one
        ("last", np.int32),
        ("first_operation", np.int32),  # the condition
        ("operations", np.int32),
        ("first_span", np.int32),  # when it acted: place and length in the table of spans, and how many there are
        ("room", np.int32),
        ("spans", np.int32),
        ("needed", np.int64),  # points in a row at which the condition must hold, and has held
        ("row", np.int64),
        ("lasts", np.int64),  # WHEN: points at which it acts
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
    begin = exact(fault.start)
    lasting = fault.duration == math.inf or "when" in fault.parameters  # the window is where its condition is asked
    end = None if lasting else begin + exact(fault.duration)
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


@dataclass(frozen=True)
class Table:
    """The triggers of a plan, and what they refer to."""

    triggers: np.ndarray  # TRIGGER
    windows: np.ndarray  # WINDOW
    spans: np.ndarray  # SPAN, room for them


def table(
    faults: Sequence[Fault],
    found: Sequence[Windows],
    conditions: Sequence[Program | None],
    operations: Operations,
    clock: Clock,
) -> Table:
    """A trigger for each list of windows: those of the faults first; the ``conditions`` join the ``operations``."""
    rows, places, room = np.zeros(len(found), TRIGGER), 0, 0
    for row, fault, windows, condition in zip_longest(rows, faults, found, conditions):
        row["window"], row["last"] = places, places + len(windows)
        row["first_operation"], row["operations"] = operations.add(condition)
        row["first_span"], row["room"] = room, max(1, min(len(windows), SPANS))
        if condition:
            once = "when" in fault.parameters
            row["kind"], row["room"] = (WHEN, 1) if once else (DURING, SPANS)
            row["needed"] = clock.index(fault.parameters.get("hold", 0.0)) + 1
            row["lasts"] = max(1, clock.index(fault.duration)) if once else 0
        places, room = places + len(windows), room + int(row["room"])
    windows = np.array([tuple(window) for windows in found for window in windows], WINDOW)
    return Table(rows, windows, np.zeros(room, SPAN))


def condition(
    fault: Fault, system: Mapping[str, Description], phases: Mapping[str, str], faults: Collection[str]
) -> Program | None:
    """The program of a fault's condition; ``phases`` are conditions that have a name, ``faults`` all ids of the run."""
    if not fault.condition:
        return None
    try:
        return compile_expression(fault.condition, system, faults, phases, boolean=True)
    except NavfmuError as error:
        name = "when" if "when" in fault.parameters else "during"
        raise fault.error(f"'{name}': {error}", name) from None


@dataclass(frozen=True)
class Moment:
    """Whether a trigger acts at a communication point; if so, since which point, and which time (s)."""

    acts: bool = False
    since: int = 0
    start: float = 0.0


class Trigger:
    """One trigger of the reference engine; says of the point to which it was moved, and of the one before."""

    def __init__(self, row: np.void, windows: np.ndarray, condition: Program | None) -> None:
        self.now, self.before, self.row = Moment(), Moment(), 0
        self.spans: list[tuple[int, int]] = []
        self._plan, self._condition = row, condition
        self._windows = [Window(*window) for window in windows[row["window"] : row["last"]].tolist()]

    def ask(self, signals: Sequence[float], time: float, active: Mapping[str, bool]) -> None:
        """Whether its condition holds at the point at which it is."""
        if self._condition is not None:
            self.row = self.row + 1 if self._condition.value(signals, time, active) != 0.0 else 0

    def move(self, k: int, clock: Clock) -> None:
        """To communication point ``k`` from the one before."""
        self.before, listed = self.now, Moment()
        for window in self._windows:
            if window.first <= k < window.end:
                listed = Moment(True, window.first, window.start)
        kind, needed = int(self._plan["kind"]), int(self._plan["needed"])
        self.now = listed if kind == LISTED or (listed.acts and self.row >= needed) else Moment()
        if kind == DURING and self.now.acts and k - (self.row - needed) > listed.since:
            since = k - (self.row - needed)  # the condition came later than the window
            self.now = Moment(True, since, clock.time(since))
        if kind == WHEN and (self.spans or self.now.acts):
            onset = self.spans[0][0] if self.spans else k
            self.now = Moment(True, onset, clock.time(onset)) if k - onset < self._plan["lasts"] else Moment()
        if self.now.acts:
            begins = not self.before.acts and len(self.spans) < self._plan["room"]
            first = k if begins else self.spans.pop()[0]
            self.spans.append((first, k + 1))

    def state(self) -> tuple[Any, ...]:
        """What it knows of the run, for a snapshot."""
        return self.now, self.before, self.row, list(self.spans)

    def set_state(self, state: tuple[Any, ...]) -> None:
        """Back to a snapshot."""
        self.now, self.before, self.row = state[:3]
        self.spans = list(state[3])
