"""``repeat`` while tracing: its function is traced once and becomes the body of a loop.

What the body calculates from what changes stays in it; what does not change is calculated once, before the loop. Of
what is done at most once all stays in it: nothing is calculated if it is not done.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable
from itertools import count as counting
from typing import Any
from weakref import WeakValueDictionary

import numpy as np

from navfmu.export.printing.printer import c_call
from navfmu.export.record import arrays
from navfmu.export.record.graph import Array, Node, Operand, depends, element, in_order
from navfmu.export.tracing import wholes
from navfmu.export.tracing.rules import Scalar, expression, is_boolean, is_whole, number, whole
from navfmu.export.tracing.traced import Traced, filled, objects, symbols, type_of
from navfmu.repetition.repeat import applied, masked

_OWN = "repeated"  # the vectors that stand for what changes, which no node outside of a body reads
_serials = counting()
_known: WeakValueDictionary[str, arrays.Call] = WeakValueDictionary()
_KINDS = {bool: "b", int: "i", float: "f"}


def _repeated(function: Callable, value: Any, count: Any, most: int) -> Any:
    """Return ``repeat(function, value, count, most)`` with a count that is traced."""
    if not _is_plain(value):
        return masked(function, value, count, most)
    parts = [objects(part) for part in _parts(value)]
    shapes = [part.shape for part in parts]
    kinds = [_KINDS[type_of(part)] for part in parts]
    while True:
        vector = f"{_OWN}{next(_serials)}"
        first = Node("number", 0.0).made
        results = applied(function, _like(value, _symbols(vector, shapes, kinds)))
        if not _is_plain(results):
            return masked(function, value, count, most)
        found = [objects(part) for part in _parts(results)]
        wider = [max(kind, _KINDS[type_of(part)], key="bif".index) for kind, part in zip(kinds, found, strict=True)]
        if wider == kinds:
            break
        kinds = wider  # as an array that gets a real number is one of real numbers
    begin = [_converted(e, kind) for part, kind in zip(parts, kinds, strict=True) for e in part.ravel().tolist()]
    ends = [_converted(e, kind) for part, kind in zip(found, kinds, strict=True) for e in part.ravel().tolist()]
    body = _Body(vector, [expression(e) for e in ends], first if most == 1 else math.inf)
    others = [wholes.block([Scalar(node) for node in body.constant])] if body.constant else []
    call = _call(body, [len(begin), *(other.size for other in others)])
    operands = [wholes.operand(begin), *others, wholes.operand(objects(count).ravel().tolist())]
    array = wholes.made(arrays.Repeat(call, most), len(begin), operands)
    answers, first = [], 0
    for shape, kind in zip(shapes, kinds, strict=True):
        size = math.prod(shape)
        answers.append(filled(shape, wholes.elements(array, kind, size, first)))
        first += size
    return _like(value, answers)


def _parts(value: Any) -> list[Any]:
    return [leaf for part in value for leaf in _parts(part)] if isinstance(value, tuple) else [value]


def _like(value: Any, parts: Iterable[Any]) -> Any:
    """Return parts in tuples as those of a value."""
    left = iter(parts)

    def build(value: Any) -> Any:
        return tuple(build(part) for part in value) if isinstance(value, tuple) else next(left)

    return build(value)


def _is_plain(value: Any) -> bool:
    """Whether all parts are numbers and arrays of them, traced or not."""
    plain = (Traced, Scalar, bool, int, float, np.generic)
    return all(isinstance(part, plain) or type(part) is np.ndarray for part in _parts(value))


def _symbols(vector: str, shapes: list[tuple[int, ...]], kinds: list[str]) -> list[Traced]:
    sizes = [math.prod(shape) for shape in shapes]
    all_ = symbols(vector, "".join(kind * size for kind, size in zip(kinds, sizes, strict=True)))
    parts, first = [], 0
    for shape, size in zip(shapes, sizes, strict=True):
        part = all_[first : first + size].reshape(shape)
        part.setflags(write=False)
        parts.append(part)
        first += size
    return parts


def _converted(e: Any, kind: str) -> Any:
    """Return an element as one of a kind, which is not narrower."""
    if kind == "b" or (kind == "i" and is_whole(e) and not is_boolean(e)):
        return e
    return whole(e) if kind == "i" else number(e)


def _call(body: _Body, sizes: list[int]) -> arrays.Call:
    """Return the function with the body's results, named after what it does: the same one where that is the same."""
    what = ("p0", "p1")[: len(sizes)], tuple(body.results), tuple(sorted(body.before))
    text = c_call(arrays.Call("", *what), sizes)
    name = f"repeated_{hashlib.sha256(text.encode()).hexdigest()[:12]}"
    about = "One pass of repeat: p0 is what changes, p1 what stays as it is"
    return _known.setdefault(name, arrays.Call(name, *what, about=about))


class _Body:
    """The results of one pass over ``p0``, what changes, and ``p1``, what does not.

    Operations made from ``first`` on count as what changes.
    """

    def __init__(self, vector: str, results: list[Node], first: float) -> None:
        self.vector, self.first = vector, first
        self.constant: list[Node] = []  # what is calculated before the loop
        self.before: set[str] = set()  # what routines in it are given besides numbers
        self._places: dict[Any, int] = {}
        self._changes: dict[Node, bool] = {}
        self._new: dict[Node, Node] = {}
        for node in in_order(results):
            self._changes[node] = self._does_change(node)
            if self._changes[node]:
                self._new[node] = self._moved(node)
        self.results = [self._renewed(node) for node in results]

    def _is_own(self, operand: Operand) -> bool:
        return isinstance(operand.source, str) and operand.source == self.vector

    def _does_change(self, node: Node) -> bool:
        if node.op == "element" and node.of[0] == self.vector:
            return True
        if node.op not in ("number", "element") and node.made >= self.first:
            return True
        reads = isinstance(node, Array) and any(self._is_own(o) for o in node.operands)
        return reads or any(self._changes[n] for n in depends(node))

    def _renewed(self, node: Node) -> Node:
        """Return what stands for a node in the body."""
        if node.op == "number":
            return node
        return self._new[node] if self._changes[node] else element("p1", self._place(node))

    def _place(self, node: Node) -> int:
        key = node.of if node.op == "element" else node
        if key not in self._places:
            self._places[key] = len(self.constant)
            self.constant.append(node)
        return self._places[key]

    def _moved(self, node: Node) -> Node:
        if node.op == "element":
            source, place = node.of
            return element("p0" if source == self.vector else self._new[source], place)
        if isinstance(node, Array):
            how = node.how.call if isinstance(node.how, arrays.Repeat) else node.how
            self.before.update(getattr(how, "before", ()))
            return Array(node.how, node.size, [self._operand(operand) for operand in node.operands])
        return Node(node.op, *(self._renewed(n) for n in node.of))

    def _operand(self, operand: Operand) -> Operand:
        source, places, size = operand.source, operand.places, operand.size
        if isinstance(source, np.ndarray):
            return operand
        if self._is_own(operand):
            return Operand("p0", places, size)
        if places is None:
            return Operand(self._renewed(source), None, size)
        if isinstance(source, Node) and self._changes[source]:
            return Operand(self._new[source], places, size)
        at = {place: self._place(element(source, place)) for place in sorted(set(places.tolist()))}
        return Operand("p1", np.array([at[place] for place in places.tolist()]), size)


Traced.__repeat__ = staticmethod(_repeated)
Scalar.__repeat__ = staticmethod(_repeated)
