"""What one NumPy call computes as a whole: the kinds of :class:`~navfmu.export.record.graph.Array`.

An array node reads its operands and gives its numbers in C order; in which order it adds and multiplies is said with
each kind and does not depend on sizes, so that it makes no difference to any bit whether something is kept whole or
not.

=============  =========================================================================================
``Pack``       its operands one after the other
``Map``        one formula for each place
``Fold``       each row of a matrix folded to one number (sums, largest, any, ...)
``Run``        all that a fold passes through (cumulative sums)
``Product``    of two matrices
``Call``       of a plain function of the model, which is traced and compiled once
``Repeat``     such a call again and again, as often as a number says
``Routine``    of a function of the C runtime (linear equations, sorting, tables)
=============  =========================================================================================
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from navfmu.export.record.graph import Array, Node, in_order


@dataclass(frozen=True)
class Pack:
    """The operands one after the other."""


@dataclass(frozen=True, eq=False)
class Map:
    """``formula`` at each place: a node over ``element("x", k)``, the number of operand k at that place."""

    formula: Node
    shape: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Fold:
    """Each of ``rows`` rows of ``length`` numbers, folded from the left.

    ``formula`` is a node over ``element("x", 0)``, what was folded so far, and ``element("x", 1)``, the next number. It
    begins with ``first``, or with the first number where that is None. Where ``pairwise``, the rows are added as NumPy
    adds what lies side by side: in eight sums up to 128 numbers, more than that in halves; then ``first`` is added to.
    """

    rows: int
    length: int
    formula: Node
    first: float | None
    pairwise: bool = False


@dataclass(frozen=True, eq=False)
class Run:
    """All partial results of a fold of each row, the first number included."""

    rows: int
    length: int
    formula: Node


@dataclass(frozen=True)
class Product:
    """``(rows, inner)`` times ``(inner, columns)``; each sum begins at 0.0 and goes from the first product to the
    last."""

    rows: int
    inner: int
    columns: int


@dataclass(frozen=True, eq=False)
class Call:
    """A function of the model. Its results are nodes over the numbers of its operands, elements of ``vectors``.

    ``before`` is what routines in it are given besides, which has the same name where it is called. ``about`` says what
    function it is and what its operands are called there.
    """

    name: str
    vectors: tuple[str, ...]
    results: tuple[Node, ...]
    before: tuple[str, ...] = ()
    about: str = ""


@dataclass(frozen=True, eq=False)
class Repeat:
    """A function that is called with its own results, ``most`` times or as often as the last operand says if that is
    less; its first operand is what it begins with, what is between them stays as it is."""

    call: Call
    most: int


@dataclass(frozen=True)
class Routine:
    """``name(*before, *numbers, *operands, r)`` of the runtime; ``before`` are arguments that have the same name there.

    Operands are pointers to numbers that lie one after the other; those that are among ``values`` are single numbers.
    """

    name: str
    numbers: tuple[int, ...] = ()
    before: tuple[str, ...] = ()
    values: frozenset[int] = frozenset()


def tables_searched(results: Iterable[Node]) -> set[int]:
    """Return the numbers of the tables in which something is looked up."""
    found: set[int] = set()
    for node in in_order(results):
        how = node.how if isinstance(node, Array) else None
        if isinstance(how, Routine) and "tables" in how.before:
            found.add(how.numbers[0])
        call = how.call if isinstance(how, Repeat) else how
        if isinstance(call, Call):
            found |= tables_searched(call.results)
    return found
