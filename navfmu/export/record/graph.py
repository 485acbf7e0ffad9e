"""The record of a traced computation, which printers turn into code: a graph of operations.

A :class:`Node` is one number. Its ``op`` says which:

``"number"``
    a constant; ``of`` is its value.
``"element"``
    an element of a vector that the function reads, or of an :class:`Array`; ``of`` is the vector's name or the Array,
    and the place.
one of :data:`OPERATIONS`
    an operation of C on doubles; ``of`` are the nodes of its operands.

An :class:`Array` is all that one NumPy call computes, where it is kept whole; its numbers are read as elements of it.
What it computes stands in :mod:`navfmu.export.record.arrays`.

Nothing is rewritten: a printer does the operations that were recorded, each once, and every operation is that of the C
language on doubles, so that ``-0.0``, infinities and NaN go their way. A truth value is 0.0 or 1.0; what is not zero is
true, NaN too.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Container, Iterable, Sequence
from itertools import count
from typing import Any

import numpy as np

#: What can be done: operation -> C expression.
OPERATIONS = {
    "add": "{} + {}",
    "subtract": "{} - {}",
    "multiply": "{} * {}",
    "divide": "{} / {}",
    "negative": "-{}",
    "less": "{} < {}",
    "less_equal": "{} <= {}",
    "equal": "{} == {}",
    "not_equal": "{} != {}",
    "and": "{} && {}",
    "or": "{} || {}",
    "not": "!{}",
    "where": "{} ? {} : {}",
}
#: The operations that give a truth value, and which of their operands are truth values.
TRUTHS = {"less": (), "less_equal": (), "equal": (), "not_equal": (), "and": (0, 1), "or": (0, 1), "not": (0,)}
_PLAIN_OF_ONE, _PLAIN_OF_TWO = "fabs floor ceil trunc rint sqrt".split(), "copysign fmax fmin".split()
_CALLS_OF_ONE = """
exp expm1 exp2 log log1p log2 log10 sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh
""".split()
_CALLS_OF_TWO = "fmod pow atan2 hypot".split()
OPERATIONS |= {name: f"{name}({{}})" for name in _PLAIN_OF_ONE + _CALLS_OF_ONE}
OPERATIONS |= {name: f"{name}({{}}, {{}})" for name in _PLAIN_OF_TWO + _CALLS_OF_TWO}
#: Those that are calls of a function of the C library, and not an instruction or a few.
CALLS = frozenset(_CALLS_OF_ONE + _CALLS_OF_TWO)


_made = count()


class Node:
    """One number of the record; see the module's first lines. ``made`` grows from each node to the next one made."""

    __slots__ = ("made", "of", "op")

    def __init__(self, op: str, *of: object) -> None:
        self.op, self.of = op, of
        self.made = next(_made)


class Vector(str):
    """The name of a vector that stands for values of one task alone: those of another one have the same name."""

    __slots__ = ()


class Operand:
    """What an array node reads: ``size`` numbers, ``source[places[i]]``, or one number for all its places.

    ``source`` is the name of a vector, an Array, constants as a NumPy array, or, where ``places`` is None, the Node of
    the one number.
    """

    __slots__ = ("places", "size", "source")

    def __init__(self, source: str | Node | np.ndarray, places: np.ndarray | None, size: int) -> None:
        self.source, self.places, self.size = source, places, size

    def strides(self, shape: Sequence[int]) -> list[int] | None:
        """Return by how much the place moves along each axis of a shape; None where that is no fixed number."""
        assert self.places is not None
        grid = self.places.reshape(shape)
        steps, affine = [], np.array(grid.flat[0])
        for axis, n in enumerate(shape):
            corner = [0] * len(shape)
            corner[axis] = min(1, n - 1)
            step = int(grid[tuple(corner)] - grid.flat[0])
            steps.append(step)
            affine = affine[..., None] + step * np.arange(n)
        return steps if np.array_equal(affine, grid) else None

    @property
    def contiguous(self) -> bool:
        """Whether these are elements of a source one after the other."""
        return self.places is not None and bool(np.all(np.diff(self.places) == 1))


class Array(Node):
    """Numbers that one NumPy call computes, ``size`` of them in C order, from ``operands``.

    ``how`` says what is computed, one of the classes of :mod:`navfmu.export.record.arrays`; ``of`` are the nodes that
    it depends on, elements of vectors aside.
    """

    __slots__ = ("how", "operands", "size")

    def __init__(self, how: Any, size: int, operands: Sequence[Operand]) -> None:
        nodes = dict.fromkeys(o.source for o in operands if isinstance(o.source, Node))
        super().__init__(type(how).__name__, *nodes)
        self.how, self.size, self.operands = how, size, tuple(operands)


def number(value: float) -> Node:
    """Return the node of a number."""
    return Node("number", float(value))


def element(source: str | Array, place: int) -> Node:
    """Return the node of an element of a vector or an array."""
    return Node("element", source, place)


def depends(node: Node) -> tuple:
    """Return the nodes that a node is calculated from."""
    if node.op == "number":
        return ()
    if node.op == "element":
        return node.of[:1] if isinstance(node.of[0], Array) else ()
    return node.of


def in_order(results: Iterable[Node], known: Container[Node] = ()) -> list[Node]:
    """Return the nodes that the results depend on, each after those that it depends on itself unless it is known."""
    order: dict[Node, None] = {}
    waiting = [(node, False) for node in reversed(list(results))]
    while waiting:
        node, ready = waiting.pop()
        if node in order:
            continue
        before = () if ready or node in known else depends(node)
        if before:
            waiting.append((node, True))
            waiting += [(n, False) for n in reversed(before)]
        else:
            order[node] = None
    return list(order)


def settled(results: Iterable[Node], constant: Callable[[Node], bool]) -> dict[Node, int]:
    """Return what can be calculated once, before any of the results is.

    These are the operations and arrays that depend on constant elements only and that the results or others of their
    operations use. Each has the place of its (first) number, counted from 0; equal operations have one.
    """
    results = list(results)
    still: dict[Node, bool] = {}
    same: dict[tuple, Node] = {}  # what a node is -> the first that is so
    first: dict[Node, Node] = {}
    found: dict[Node, None] = {}
    for node in in_order(results):
        if isinstance(node, Array):
            elements = (element(vector, i) for vector, places in reads(node) for i in places)
            still[node] = all(still[n] for n in node.of) and all(constant(e) for e in elements)
            what: tuple = (node,)
        elif node.op in OPERATIONS:
            what = (node.op, *(first[n] for n in node.of))
            still[node] = all(still[n] for n in node.of)
        elif node.op == "number":
            what, still[node] = (node.op, struct.pack("<d", *node.of)), True
        else:
            what = (node.op, *node.of)
            still[node] = still[node.of[0]] if depends(node) else constant(node)
        if not still[node]:
            found |= dict.fromkeys(n for n in depends(node) if still[n])
        first[node] = same.setdefault(what, node)
    found |= dict.fromkeys(node for node in results if still[node])
    found = {depends(n)[0] if n.op == "element" and depends(n) else n: None for n in found}
    places: dict[Node, int] = {}
    size = 0
    for node in found:
        if (node.op in OPERATIONS or isinstance(node, Array)) and first[node] not in places:
            places[first[node]] = size
            size += node.size if isinstance(node, Array) else 1
    return {n: places[first[n]] for n in found if first[n] in places}


def reads(array: Array) -> list[tuple[str, list[int]]]:
    """Return what an array reads of vectors itself: their names, and which of their elements."""
    found = []
    for operand in array.operands:
        if isinstance(operand.source, str):
            found.append((operand.source, sorted(set(operand.places.tolist()))))
    return found


def vectors_read(results: Iterable[Node]) -> list[str]:
    """Return the names of the vectors of which the results depend on elements; of equal ones each that is another."""
    found: dict[int, str] = {}
    for node in in_order(results):
        sources = [operand.source for operand in node.operands] if isinstance(node, Array) else node.of[:1]
        found |= {id(source): source for source in sources if isinstance(source, str)}
    return [*found.values()]


def is_inexact(results: Iterable[Node], vectors: Container[str]) -> bool:
    """Return whether something is calculated from elements of these vectors alone that NumPy may calculate with other
    bits: products, sums, functions of the library."""
    only: dict[Node, bool | None] = {}  # None: of numbers, which are of no vector
    for node in in_order(results):
        found = [only[n] for n in depends(node)]
        if isinstance(node, Array):
            found += [vector in vectors for vector, _ in reads(node)]
        elif node.op == "element" and not depends(node):
            found.append(node.of[0] in vectors)
        told = [one for one in found if one is not None]
        only[node] = all(told) if told else None
        if only[node] and not _is_exact(node):
            return True
    return False


def _is_exact(node: Node) -> bool:
    if isinstance(node, Array):
        formula = getattr(node.how, "formula", None)
        return node.op == "Pack" or (node.op == "Map" and all(map(_is_exact, in_order([formula]))))
    return node.op not in CALLS and not (node.op == "add" and any(n.op == "multiply" for n in node.of))


def elements_used(results: Sequence[Node], vector: str) -> list[set[int]]:
    """Return, for each result, the indices of the elements of a vector that it depends on, choices included."""
    used: dict[Node, set[int]] = {}
    for node in in_order(results):
        used[node] = set().union(*(used[n] for n in depends(node)))
        if node.op == "element" and node.of[0] == vector:
            used[node] = {node.of[1]}
        if isinstance(node, Array):
            used[node].update(i for name, places in reads(node) if name == vector for i in places)
    return [used[node] for node in results]
