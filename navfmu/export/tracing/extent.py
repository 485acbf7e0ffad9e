"""How far a trace goes: single numbers where they are few, else arrays as wholes.

A function of a model is traced with the elements of its arrays on their own, but for large arrays, which makes the
fastest code, until there are more operations than a compiler likes. Then it is traced again, with all but the smallest
arrays as nodes and the model's own functions as calls. Both do the same operations in the same order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.export.record.alike import Alike

#: Operations on single numbers that a task is traced with before its arrays are kept whole.
MOST = 13_000
#: The same for a function that is called, and for a task that has an array of VAST elements or a function of LONG
#: operations more than once.
FEWER = 3_000
VAST = 512
LONG = 2_500
#: Arrays with so many elements are kept whole even then, and products with four times as many terms.
LARGE = 256
#: Arrays with fewer elements never are.
LEAST = 8
#: Operations on single numbers that are too many for a compiler.
LIMIT = 60_000


class TooLong(BaseException):
    """More operations than the extent allows; no error, so no model catches it."""


@dataclass
class Extent:
    """What a trace may do, and has done."""

    most: float = math.inf
    whole: float = math.inf  # from so many elements on an array is kept whole
    calls: bool = False  # the model's own functions are called
    operations: int = 0
    packs: dict = field(default_factory=dict)  # what was gathered for array nodes, each once
    alike: Alike = field(default_factory=Alike)  # the array nodes that were made, of equal ones the first
    handed_out: dict = field(default_factory=dict)  # their numbers
    functions: dict = field(default_factory=dict)  # of the model that were recorded as calls
    written_out: set = field(default_factory=set)  # long functions of the model that were traced in their place

    def begin(self) -> None:
        """What was traced so far is forgotten."""
        self.operations = 0
        self.packs.clear()
        self.written_out.clear()

    def meet(self, size: int) -> None:
        """An array of that size is read or made."""
        if size >= VAST and not self.calls:
            self.most = min(self.most, FEWER)

    def write_out(self, function: object, operations: int) -> None:
        """A function of the model was traced in its place, where it made so many operations."""
        if operations >= LONG and function in self.written_out:
            self.most = min(self.most, FEWER)
        if operations >= LONG:
            self.written_out.add(function)

    def count(self) -> None:
        """One more operation on single numbers."""
        self.operations += 1
        if self.operations > self.most:
            raise TooLong


_extents = [Extent()]


def current() -> Extent:
    """Return the extent of the trace that is running."""
    return _extents[-1]


@contextmanager
def extent(of: Extent) -> Iterator[Extent]:
    """Trace with an extent of its own."""
    _extents.append(of)
    try:
        yield of
    finally:
        _extents.pop()


def shortest(
    function: Callable[[], Any], what: str, functions: dict, most: int = MOST, large: int = LARGE, least: int = LEAST
) -> tuple[Any, Extent]:
    """Call a function that traces: with single numbers, and if that gets long once more with arrays as wholes.

    ``functions`` are those that were recorded as calls so far, for all that becomes one model. Returns what it
    returned, and the extent that it needed.
    """
    with extent(Extent(most, large)) as used:
        try:
            return function(), used
        except TooLong:
            pass
    with extent(Extent(LIMIT, least, calls=True, functions=functions)) as used:
        try:
            return function(), used
        except TooLong:
            raise NavfmuError(
                f"{what} has more than {LIMIT} operations on single numbers; write loops over elements as operations "
                "on arrays, and what is repeated as a function of the module, which is compiled once"
            ) from None
