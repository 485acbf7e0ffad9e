"""What is asked at every communication point of a run: whether a value lies in its bounds, for how long, how far off.

The engines keep the numbers while running, so that nothing that happens between two recorded points escapes them.
``source/monitor.h`` and :class:`Observer` are the two implementations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from navfmu.engine.clock import FOREVER, Clock
from navfmu.errors import NavfmuError
from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.program import Op, Program, Source
from navfmu.fmi.description import Description

# One operation of a program, laid out as struct Operation in source/expression.h.
OPERATION = np.dtype([("kind", np.int32), ("place", np.int32), ("number", np.float64)], align=True)
# One monitor, laid out as struct Monitor in source/master.h.
MONITOR = np.dtype(
    [
        ("first_operation", np.int32),  # its value
        ("operations", np.int32),
        ("first_when", np.int32),  # asked while this is not 0; without any: always
        ("whens", np.int32),
        ("least", np.float64),
        ("most", np.float64),
        ("begin", np.int64),  # communication points, begin <= k <= end
        ("end", np.int64),
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
    """

    id: str
    value: str
    least: float = -math.inf
    most: float = math.inf
    begin: float = 0.0
    end: float = math.inf
    when: str = ""
    tolerance: float = 0.0

    def describe(self) -> dict[str, Any]:
        """As plain data; JSON has no infinity."""
        content = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {name: value for name, value in content.items() if value != self.__dataclass_fields__[name].default}

    def program(self, system: Mapping[str, Description]) -> Program:
        """The program of its value."""
        return self._compiled("value", self.value, system, None)

    def condition(self, system: Mapping[str, Description]) -> Program | None:
        """The program of its condition."""
        return self._compiled("when", self.when, system, True) if self.when else None

    def _compiled(self, what: str, text: str, system: Mapping[str, Description], boolean: bool | None) -> Program:
        try:
            return compile_expression(text, system, boolean=boolean)
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
        begin, end = int(row["begin"]), min(int(row["end"]), clock.steps)

        def when(name: str) -> float:
            return clock.time(int(row[name])) if row[name] >= 0 else math.nan

        finite = int(row["points"] - row["not_finite"])
        return cls(
            points=int(row["points"]),
            missing=max(0, end - max(begin, k + 1) + 1),
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
        )


Place = Callable[[Source], tuple[int, float, float]]  # of a signal: its place, and what scales it


def tables(
    monitors: Sequence[Monitor],
    programs: Sequence[tuple[Program, Program | None]],
    place: Place,
    clock: Clock,
    faults: Sequence[str] = (),
) -> tuple[np.ndarray, np.ndarray]:
    """The rows of monitors and of their operations; ``faults`` are the ids of those of the run."""
    rows, operations = np.zeros(len(monitors), MONITOR), []
    for row, monitor, (value, when) in zip(rows, monitors, programs, strict=True):
        row["first_operation"] = len(operations)
        operations += _placed(value, place, faults)
        row["first_when"] = row["operations"] = len(operations)
        row["operations"] -= row["first_operation"]
        operations += _placed(when, place, faults) if when else []
        row["whens"] = len(operations) - row["first_when"]
        row["least"], row["most"] = monitor.bounds(value)
        row["begin"] = clock.index(monitor.begin)
        row["end"] = clock.last(monitor.end) if math.isfinite(monitor.end) else FOREVER
        row["tolerated"] = clock.last(monitor.tolerance)
        for name in ("first_outside", "last_outside", "first_inside", "last_inside", "worst_at"):
            row[name] = -1
        row["worst"], row["excess"] = math.nan, -math.inf
    table = np.zeros(len(operations), OPERATION)
    for row, operation in zip(table, operations, strict=True):
        row["kind"], row["place"], row["number"] = operation
    return rows, table


def _placed(program: Program, place: Place, faults: Sequence[str]) -> list[tuple[int, int, float]]:
    """Operations on the signals of a plan; what is scaled on its way to an input is scaled here, too."""
    rows: list[tuple[int, int, float]] = []
    for op, argument in program.operations:
        if op == Op.LOAD_SIGNAL:
            slot, factor, offset = place(program.sources[int(argument)])
            rows.append((op, slot, 0.0))
            if (factor, offset) != (1.0, 0.0):
                rows += [(Op.CONSTANT, 0, factor), (Op.MULTIPLY, 0, 0.0), (Op.CONSTANT, 0, offset), (Op.PLUS, 0, 0.0)]
        elif op == Op.ACTIVE and argument >= 0:
            fault = program.faults[int(argument)]  # one that the run does not have does not act
            rows.append((op, faults.index(fault), 0.0) if fault in faults else (Op.CONSTANT, 0, 0.0))
        else:
            rows.append((op, -1 if op == Op.ACTIVE else 0, argument if op == Op.CONSTANT else 0.0))
    return rows


class Observer:
    """A monitor in Python: the reference for ``source/monitor.h``."""

    def __init__(self, row: np.void, operations: np.ndarray, faults: Sequence[str] = ()) -> None:
        self.row = row.copy()
        self._value = _program(operations, row["first_operation"], row["operations"], faults)
        self._when = _program(operations, row["first_when"], row["whens"], faults) if row["whens"] else None

    def observe(self, signals: Sequence[float], k: int, t: float, active: Mapping[str, bool] | None = None) -> None:
        """Look at communication point ``k``, at the time ``t`` (s); ``active`` are faults, and "" any of them."""
        row = self.row
        if not row["begin"] <= k <= row["end"]:
            return
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
            row["first_inside"] = k if row["first_inside"] < 0 else row["first_inside"]
        else:
            self._outside(k)

    def _outside(self, k: int) -> None:
        """A point outside of the bounds: it counts once more of them follow one another than are put up with."""
        row = self.row
        row["row"] += 1
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


def _program(operations: np.ndarray, first: int, count: int, faults: Sequence[str]) -> Program:
    """A program whose sources are the signals of the plan, and whose faults are those of the run."""
    rows = operations[first : first + count].tolist()
    loads = (Op.LOAD_SIGNAL, Op.ACTIVE)
    return Program(
        "", tuple((Op(k), float(p) if k in loads else n) for k, p, n in rows), (), tuple(faults), False, None
    )
