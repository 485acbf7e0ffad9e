"""A compiled expression: operations on a stack, which the C loop and NumPy carry out to the same bits.

``engine/source/expression.h`` is the other evaluator; the operations and their numbers are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from navfmu.fmi.names import Signal
from navfmu.fmi.units import Unit

DEEPEST = 64  # values on the stack at a time


class Op(IntEnum):
    """What an operation does to the top of the stack; truth values are 1 and 0."""

    CONSTANT = 0  # push a number
    LOAD_SIGNAL = 1  # push a signal
    TIME = 2  # push the time of the communication point (s)
    ACTIVE = 3  # push whether a fault acts, or any of them (-1)
    NEGATE = 4
    ABS = 5
    SQUARE = 6
    SQRT = 7
    NOT = 8
    PLUS = 9  # this one and all that follow take two values
    MINUS = 10
    MULTIPLY = 11
    DIVIDE = 12
    MINIMUM = 13  # NaN if one of them is
    MAXIMUM = 14
    LESS = 15
    AT_MOST = 16
    GREATER = 17
    AT_LEAST = 18
    EQUAL = 19
    DIFFERENT = 20
    AND = 21
    OR = 22


@dataclass(frozen=True, slots=True)
class Source:
    """A signal that an expression looks at; ``true``: its value without faults."""

    signal: Signal
    true: bool = False

    def __str__(self) -> str:
        return f"{self.signal}{'@true' if self.true else ''}"


@dataclass(frozen=True)
class Program:
    """The operations of an expression.

    The argument of LOAD_SIGNAL is a place in ``sources``, that of ACTIVE one in ``faults``.
    """

    text: str
    operations: tuple[tuple[Op, float], ...]  # with an argument
    sources: tuple[Source, ...]
    faults: tuple[str, ...]
    boolean: bool
    unit: Unit | None  # of the value: a unit without factor and offset; None where no unit is known

    @property
    def depth(self) -> int:
        """Values on the stack at a time, at most."""
        deep = most = 0
        for op, _ in self.operations:
            deep += 1 if op <= Op.ACTIVE else -1 if op >= Op.PLUS else 0
            most = max(most, deep)
        return most

    def value(self, signals: Sequence[Any], time: Any = 0.0, active: Mapping[str, Any] | None = None) -> Any:
        """The value for a value of each source, or for arrays of them, at ``time`` (s).

        ``active`` has for each fault whether it acts; the empty id stands for any.
        """
        stack: list[Any] = []
        with np.errstate(all="ignore"):
            for op, argument in self.operations:
                if op == Op.CONSTANT:
                    stack.append(np.float64(argument))
                elif op == Op.LOAD_SIGNAL:
                    stack.append(np.asarray(signals[int(argument)], np.float64)[()])
                elif op == Op.TIME:
                    stack.append(np.asarray(time, np.float64)[()])
                elif op == Op.ACTIVE:
                    fault = self.faults[int(argument)] if argument >= 0 else ""
                    stack.append(np.asarray((active or {}).get(fault, 0.0), np.float64)[()])
                elif op < Op.PLUS:
                    stack.append(_ONE[op](stack.pop()))
                else:
                    right, left = stack.pop(), stack.pop()
                    stack.append(_TWO[op](left, right))
        return stack.pop()


def _float(value: Any) -> Any:
    return np.asarray(value, np.float64)[()]


def _least(a: Any, b: Any) -> Any:
    return np.where(np.isnan(a) | np.isnan(b), a + b, np.where(b < a, b, a))[()]


def _greatest(a: Any, b: Any) -> Any:
    return np.where(np.isnan(a) | np.isnan(b), a + b, np.where(b > a, b, a))[()]


_ONE: dict[Op, Callable[[Any], Any]] = {
    Op.NEGATE: lambda a: -a,
    Op.ABS: np.abs,
    Op.SQUARE: lambda a: a * a,
    Op.SQRT: np.sqrt,
    Op.NOT: lambda a: _float(a == 0.0),
}
_TWO: dict[Op, Callable[[Any, Any], Any]] = {
    Op.PLUS: lambda a, b: a + b,
    Op.MINUS: lambda a, b: a - b,
    Op.MULTIPLY: lambda a, b: a * b,
    Op.DIVIDE: lambda a, b: a / b,
    Op.MINIMUM: _least,
    Op.MAXIMUM: _greatest,
    Op.LESS: lambda a, b: _float(a < b),
    Op.AT_MOST: lambda a, b: _float(a <= b),
    Op.GREATER: lambda a, b: _float(a > b),
    Op.AT_LEAST: lambda a, b: _float(a >= b),
    Op.EQUAL: lambda a, b: _float(a == b),
    Op.DIFFERENT: lambda a, b: _float(a != b),
    Op.AND: lambda a, b: _float((a != 0.0) & (b != 0.0)),
    Op.OR: lambda a, b: _float((a != 0.0) | (b != 0.0)),
}
