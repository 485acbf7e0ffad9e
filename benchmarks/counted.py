"""Numbers that count what is done with them, as the code that is made of a model does it: with constants folded."""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np


class Counted:
    """A number that is not known when the code is made; ``count`` is shared by all of a calculation."""

    def __init__(self, value: float, count: Counter) -> None:
        self.value, self.count = value, count

    def __add__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._by(operator.add, other, "additions")

    def __sub__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._by(operator.sub, other, "additions")

    def __rsub__(self, other: Any) -> Any:
        return self._by(lambda x, y: y - x, other, "additions")

    def __mul__(self, other: Any) -> Any:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._by(operator.mul, other, "multiplications")

    def __truediv__(self, other: Any) -> Any:
        return self._by(operator.truediv, other, "divisions")

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if _is(other, 0.0) else self._by(lambda x, y: y / x, other, "divisions")

    def __le__(self, other: Any) -> bool:
        return self.value <= _value(other)

    def sqrt(self) -> Counted:
        """As numpy.sqrt asks it of an object."""
        return self._by(lambda x, _: float(np.sqrt(x)), 0.0, "square roots")

    def _by(self, operation: Callable[[float, float], float], other: Any, kind: str) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented  # each element for itself
        self.count[kind] += 1
        return Counted(operation(self.value, _value(other)), self.count)

    __radd__, __rmul__ = __add__, __mul__


def _is(number: Any, constant: float) -> bool:
    return not isinstance(number, Counted | np.ndarray) and number == constant


def _value(number: Any) -> float:
    return number.value if isinstance(number, Counted) else float(number)


def operations(function: Callable, arguments: Sequence[Any]) -> Counter:
    """How many operations of each kind a function of arrays takes, if none of their elements is known beforehand."""
    count: Counter = Counter()
    wrapped = np.vectorize(lambda number: Counted(float(number), count), otypes=[object])
    function(*(wrapped(argument)[()] for argument in arguments))
    return count
