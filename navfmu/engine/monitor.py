"""What is asked at every communication point of a run: whether a value lies in its bounds, for how long, how far off.

The engines keep the numbers while running, so that nothing that happens between two recorded points escapes them.
``source/monitor.h`` and :class:`Observer` are the two implementations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from navfmu.engine.clock import FOREVER, Clock
from navfmu.engine.operations import Operations, program_of
from navfmu.engine.trigger import Trigger
from navfmu.errors import NavfmuError
from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.program import Program
from navfmu.fmi.description import Description

ORIGINS = ("start", "onset", "over")  # from where it counts: of the run, or of a fault its beginning or its end
START, ONSET, OVER = range(len(ORIGINS))
NONE = ("first_outside", "last_outside", "first_inside", "last_inside", "worst_at", "latest_from", "back", "settled")
NEVER = -2  # place of a fault that the run does not have
# One monitor, laid out as struct Monitor in source/master.h.
MONITOR = np.dtype(
    [
        ("counts_from", np.int32),  # START, ONSET or OVER
        ("fault", np.int32),  # whose; -1: of all faults together
        ("first_operation", np.int32),  # its value
        ("operations", np.int32),
        ("first_when", np.int32),  # asked while this is not 0; without any: always
        ("whens", np.int32),
        ("least", np.float64),
        ("most", np.float64),
        ("begin", np.int64),  # communication points, begin <= k - origin <= end
        ("end", np.int64),
        ("origin", np.int64),  # -1: it has not come
        ("tolerated", np.int64),  # points in a row that may lie outside
        ("points", np.int64),  # at which it was asked
        ("not_finite", np.int64),
        ("outside", np.int64),  # points outside, in longer rows than tolerated
        ("episodes", np.int64),  # such rows
        ("row", np.int64),  # points outside in a row, now
        ("longest", np.int64),
        ("first_outside", np.int64),  # where the first such row begins; -1: there is none
        ("last_outside", np.int64),
        ("first_inside", np.int64),
        ("last_inside", np.int64),
        ("worst_at", np.int64),
        ("latest", np.int64),  # points from an origin to behind the last one outside, at most
        ("latest_from", np.int64),  # which origin that was
        ("back", np.int64),  # the same of the present origin, -1 at a point outside
        ("settled", np.int64),  # at most, of those at whose last point it is inside, -1: there is none
        ("worst", np.float64),  # the value furthest outside, or nearest to it
        ("excess", np.float64),
        ("squares", np.float64),  # sum over the finite values
        ("greatest", np.float64),  # size
    ],
    align=True,
)


@dataclass(frozen=True)
class Monitor:
    """A question: does ``value`` lie from ``least`` to ``most``, from ``begin`` to ``end`` (s), while ``when`` holds?

    ``value`` and ``when`` are expressions; a truth value lies inside where it is true and needs no bounds. Bounds are
    in SI, or in the unit of the signal if the expression is nothing but one. Points outside in a row count only if they
    are outside for longer than ``tolerance`` (s).

    ``begin`` and ``end`` are counted from the ``start`` of the run, or from the first ``onset`` of a fault, or from
    where it was ``over``, while it does not act. Without the id of a ``fault``: from the first onset of any, or while
    none acts.
    """

    id: str
    value: str
    least: float = -math.inf
    most: float = math.inf
    begin: float = 0.0
    end: float = math.inf
    when: str = ""
    tolerance: float = 0.0
    counts_from: str = "start"
    fault: str = ""

    def describe(self) -> dict[str, Any]:
        """As plain data; JSON has no infinity."""
        content = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {name: value for name, value in content.items() if value != self.__dataclass_fields__[name].default}

    def program(self, system: Mapping[str, Description], phases: Mapping[str, str]) -> Program:
        """The program of its value; ``phases`` are conditions by name."""
        return self._compiled("value", self.value, system, phases, None)

    def condition(self, system: Mapping[str, Description], phases: Mapping[str, str]) -> Program | None:
        """The program of its condition."""
        return self._compiled("when", self.when, system, phases, True) if self.when else None

    def _compiled(
        self,
        what: str,
        text: str,
        system: Mapping[str, Description],
        phases: Mapping[str, str],
        boolean: bool | None,
    ) -> Program:
        try:
            return compile_expression(text, system, named=phases, boolean=boolean)
        except NavfmuError as error:
            raise NavfmuError(f"'{self.id}', {what}: {error}") from None

    def bounds(self, program: Program) -> tuple[float, float]:
        """Bounds on the number that the program returns."""
        asks_truth = program.boolean and (self.least, self.most) == (-math.inf, math.inf)
        return (1.0, 1.0) if asks_truth else (self.least, self.most)


@dataclass(frozen=True)
class Observed:
    """What a monitor saw. Times are in s, NaN where there is none."""

    points: int  # at which it was asked
    missing: int  # points that a run did not reach which ended early
    outside: int  # points, in rows that were longer than tolerated
    episodes: int  # such rows
    not_finite: int  # points
    longest: float  # s, outside at a time, tolerated or not
    first_outside: float
    last_outside: float
    first_inside: float
    last_inside: float
    worst: float
    worst_time: float
    rms: float
    greatest: float  # size of the value
    origin: float = 0.0  # from where it counted
    soonest: float = math.nan  # s, from there to the first point inside
    latest: float = 0.0  # s, from there, or where it counted from before, to behind the last point outside, at most
    latest_from: float = math.nan  # which of them that was
    settled: float = math.nan  # s, the same, of those after which it was inside until the fault came again, or the end
    left: float = math.inf  # s, from there to the end of a run that is not cut short

    def describe(self) -> dict[str, Any]:
        """As plain data; JSON has no NaN and no infinity."""
        content = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {k: v if math.isfinite(v) else repr(v) for k, v in content.items()}

    @classmethod
    def restored(cls, content: Mapping[str, Any]) -> Observed:
        """From plain data."""
        return cls(**{k: float(v) if isinstance(v, str) else v for k, v in content.items()})

    @classmethod
    def of(cls, row: np.void, clock: Clock, k: int) -> Observed:
        """From a row of the table, in a run that came to communication point ``k``."""
        origin = int(row["origin"])
        begin, end = origin + int(row["begin"]), min(origin + int(row["end"]), clock.steps)

        def when(name: str) -> float:
            return clock.time(int(row[name])) if row[name] >= 0 else math.nan

        finite = int(row["points"] - row["not_finite"])
        settled = max(int(row["settled"]), int(row["back"]))
        return cls(
            points=int(row["points"]),
            missing=max(0, end - max(begin, k + 1) + 1) if origin >= 0 else 0,
            outside=int(row["outside"]),
            episodes=int(row["episodes"]),
            not_finite=int(row["not_finite"]),
            longest=int(row["longest"]) * clock.step,
            first_outside=when("first_outside"),
            last_outside=when("last_outside"),
            first_inside=when("first_inside"),
            last_inside=when("last_inside"),
            worst=float(row["worst"]),
            worst_time=when("worst_at"),
            rms=math.sqrt(float(row["squares"]) / finite) if finite else math.nan,
            greatest=float(row["greatest"]) if finite else math.nan,
            origin=when("origin"),
            soonest=clock.time(int(row["first_inside"]) - origin) if row["first_inside"] >= 0 else math.nan,
            latest=clock.time(int(row["latest"])),
            latest_from=when("latest_from"),
            settled=clock.time(settled) if settled >= 0 else math.nan,
            left=clock.time(clock.steps - origin) if origin >= 0 else math.nan,
        )


def table(
    monitors: Sequence[Monitor],
    programs: Sequence[tuple[Program, Program | None]],
    operations: Operations,
    clock: Clock,
    faults: Sequence[str] = (),
) -> np.ndarray:
    """A row for each monitor, whose programs join the ``operations``; ``faults`` are the ids of those of the run."""
    rows = np.zeros(len(monitors), MONITOR)
    for row, monitor, (value, when) in zip(rows, monitors, programs, strict=True):
        row["first_operation"], row["operations"] = operations.add(value)
        row["first_when"], row["whens"] = operations.add(when)
        row["least"], row["most"] = monitor.bounds(value)
        row["counts_from"], row["fault"] = ORIGINS.index(monitor.counts_from), _place(monitor.fault, faults)
        row["begin"], row["origin"] = clock.index(monitor.begin), 0 if monitor.counts_from == "start" else -1
        row["end"] = clock.last(monitor.end) if math.isfinite(monitor.end) else FOREVER
        row["tolerated"] = clock.last(monitor.tolerance)
        for name in NONE:
            row[name] = -1
        row["worst"], row["excess"] = math.nan, -math.inf
    return rows


def _place(fault: str, faults: Sequence[str]) -> int:
    """The place of a fault among those of the run; -1: all of them, or ``NEVER``."""
    if not fault:
        return -1
    return faults.index(fault) if fault in faults else NEVER


class Observer:
    """A monitor in Python: the reference for ``source/monitor.h``."""

    def __init__(self, row: np.void, operations: np.ndarray, faults: Sequence[str] = ()) -> None:
        self.row = row.copy()
        self._value = program_of(operations, row["first_operation"], row["operations"], faults)
        self._when = program_of(operations, row["first_when"], row["whens"], faults)

    def observe(
        self,
        signals: Sequence[float],
        k: int,
        t: float,
        active: Mapping[str, bool] | None = None,
        triggers: Sequence[Trigger] = (),
    ) -> None:
        """Look at communication point ``k``, at the time ``t`` (s); ``active`` are faults, and "" any of them."""
        row, origin = self.row, self._origin(triggers)
        if origin < 0:
            row["row"], row["back"], row["settled"] = 0, -1, max(row["settled"], row["back"])
        if origin < 0 or not row["begin"] <= k - origin <= row["end"]:
            return
        row["origin"] = origin
        if self._when is not None and self._when.value(signals, t, active) == 0.0:
            row["row"] = 0
            return
        value = float(self._value.value(signals, t, active))
        least, most = float(row["least"]), float(row["most"])
        excess = math.inf if math.isnan(value) else max(least - value, value - most)
        row["points"] += 1
        if math.isfinite(value):
            row["squares"] += value * value
            row["greatest"] = max(float(row["greatest"]), abs(value))
        else:
            row["not_finite"] += 1
        if row["worst_at"] < 0 or excess > row["excess"]:
            row["excess"], row["worst"], row["worst_at"] = excess, value, k
        if least <= value <= most:
            row["row"], row["last_inside"] = 0, k
            row["back"] = max(0, row["last_outside"] - row["origin"] + 1)
            row["first_inside"] = k if row["first_inside"] < 0 else row["first_inside"]
        else:
            self._outside(k)

    def _origin(self, triggers: Sequence[Trigger]) -> int:
        """The point from which it counts; -1: it has not come."""
        kind, fault = int(self.row["counts_from"]), int(self.row["fault"])
        if kind == START:
            return 0
        its = triggers if fault == -1 else triggers[fault : fault + 1] if fault >= 0 else ()
        acted = [trigger for trigger in its if trigger.spans]
        if not acted or (kind == OVER and any(trigger.now.acts for trigger in its)):
            return -1
        return min(t.spans[0][0] for t in acted) if kind == ONSET else max(t.spans[-1][1] for t in acted)

    def _outside(self, k: int) -> None:
        """A point outside of the bounds: it counts once more of them follow one another than are put up with."""
        row = self.row
        row["row"], row["back"] = row["row"] + 1, -1
        if k - row["origin"] >= row["latest"]:
            row["latest"], row["latest_from"] = k - row["origin"] + 1, row["origin"]
        row["longest"] = max(row["longest"], row["row"])
        if row["row"] <= row["tolerated"]:
            return
        begins = row["row"] == row["tolerated"] + 1
        row["outside"] += row["row"] if begins else 1
        row["last_outside"] = k
        row["episodes"] += begins
        if begins and row["first_outside"] < 0:
            row["first_outside"] = k - row["tolerated"]

    def state(self) -> np.void:
        """What it has seen, for a snapshot."""
        return self.row.copy()

    def set_state(self, state: np.void) -> None:
        """Back to a snapshot."""
        self.row = state.copy()
