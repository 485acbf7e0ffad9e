"""Array nodes made of columns of elements, and what they read: elements as they lie, or gathered."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from navfmu.export.record.arrays import Fold, Map, Pack, Product, Run
from navfmu.export.record.graph import Array, Node, Operand, element, in_order
from navfmu.export.tracing.extent import LEAST, current
from navfmu.export.tracing.rules import Scalar, expression, is_boolean, is_whole


def made(how: Any, size: int, operands: Sequence[Operand]) -> Array:
    """Return the array node that calculates this; there is but one."""
    return current().alike.first(Array(how, size, operands))


def elements(array: Array, kind: str, size: int | None = None, first: int = 0) -> list[Scalar]:
    """Return numbers of an array node, of which there is but one each."""
    known, key = current().handed_out, (array, kind, size, first)
    if key not in known:
        known[key] = [Scalar(element(array, first + i), kind) for i in range(array.size if size is None else size)]
    return [*known[key]]


def operand(column: Sequence[Any], fits: Callable[[Operand], bool] = lambda _: True) -> Operand:
    """Return the operand that reads these elements as they lie if that ``fits``, else what gathers them, once."""
    found = _plain(column)
    if found is not None and fits(found):
        return found
    known, key = current().packs, tuple(_identities(column))
    if key not in known:
        pieces = [found] if found is not None else [_plain(piece) for piece in _pieces(column)]
        packed = made(Pack(), len(column), [piece for piece in pieces if piece is not None])
        known[key] = Operand(packed, np.arange(len(column)), len(column)), column  # kept: its identities are the key
    return known[key][0]


def matrix(column: Sequence[Any], rows: int, columns: int, beside: bool = False) -> Operand:
    """Return the operand for a matrix that can be read with a stride for each axis; ``beside``: the columns by 1."""

    def fits(one: Operand) -> bool:
        strides = None if one.places is None else one.strides((rows, columns))
        return strides is not None and (not beside or strides[1] <= 1)

    return operand(column, fits)


def block(column: Sequence[Any]) -> Operand:
    """Return the operand for elements that must lie one after the other."""
    return operand(column, lambda o: o.contiguous)


def _identities(column: Sequence[Any]) -> list[int]:
    return [id(e.node) if type(e) is Scalar else id(e) for e in column]


def uniform(column: Sequence[Any]) -> bool:
    """Whether all elements are the same one, or the same number."""
    if len(set(_identities(column))) == 1:
        return True
    if any(type(e) is Scalar for e in column):
        return False
    return len({type(e) for e in column}) == 1 and len(set(np.array(column, float).view(np.int64).tolist())) == 1


def _source(e: Any) -> Any:
    """Return what an element is read from: a vector, an array, None for a constant or itself for an operation."""
    if type(e) is not Scalar:
        return None
    return e.node.of[0] if e.node.op == "element" else e.node


def _plain(column: Sequence[Any]) -> Operand | None:
    """Return the operand that reads elements from the one source that they have, None if there are several."""
    if len(column) == 1 or len(set(_identities(column))) == 1:
        first = column[0]
        if type(first) is not Scalar:
            return Operand(np.array([float(first)]), np.zeros(len(column), int), len(column))
        if first.node.op != "element":
            return Operand(first.node, None, len(column))
    source = _source(column[0])
    if any(_source(e) is not source for e in column):
        return None
    if source is None:
        return Operand(np.array(column, float), np.arange(len(column)), len(column))
    if isinstance(source, Node) and not isinstance(source, Array):
        return None if any(e.node is not source for e in column) else Operand(source, None, len(column))
    return Operand(source, np.array([e.node.of[1] for e in column]), len(column))


def lies_together(column: Sequence[Any]) -> bool:
    """Whether elements are all of one source, or all one element."""
    return _plain(column) is not None


def _pieces(column: Sequence[Any]) -> list[list[Any]]:
    """Split elements where their source changes."""
    pieces: list[list[Any]] = []
    before: Any = object()
    for e in column:
        source = _source(e)
        if source is not before:
            pieces.append([])
        pieces[-1].append(e)
        before = source
    return pieces


def placeholders(columns: Sequence[Sequence[Any]]) -> list[Any]:
    """Return what a rule is applied to in place of whole columns of elements: a constant where there is but one."""
    found: list[Any] = []
    for k, column in enumerate(columns):
        first = column[0]
        if type(first) is not Scalar and uniform(column):
            found.append(first)
            continue
        kind = "b" if all(map(is_boolean, column)) else "i" if all(map(is_whole, column)) else "f"
        found.append(Scalar(element("x", k), kind))
    return found


def mapped(rule: Callable, columns: Sequence[Sequence[Any]], shape: tuple[int, ...]) -> list[Any]:
    """Return what a rule gives for the elements at each place of columns of one length."""
    if not any(type(e) is Scalar for column in columns for e in column):
        return [rule(*constants) for constants in zip(*columns, strict=True)]
    given = placeholders(columns)
    result = rule(*given)
    size = len(columns[0])
    if type(result) is not Scalar:
        return [result] * size
    for k, place in enumerate(given):
        if type(place) is Scalar and result.node is place.node:
            same = result.kind == place.kind
            return list(columns[k]) if same else [Scalar(expression(e), result.kind) for e in columns[k]]
    used = {n.of[1] for n in _leaves(result.node)}
    order = sorted(used)
    operands = [operand(columns[k]) for k in order]
    formula = _renumbered(result.node, {k: i for i, k in enumerate(order)})
    return elements(made(Map(formula, shape), size, operands), result.kind)


def _leaves(formula: Node) -> list[Node]:
    return [n for n in in_order([formula]) if n.op == "element"]


def _renumbered(formula: Node, to: dict[int, int]) -> Node:
    """Return a formula whose places have other numbers."""
    if all(k == i for k, i in to.items()):
        return formula
    new: dict[Node, Node] = {}
    for node in in_order([formula]):
        if node.op == "element":
            new[node] = element("x", to[node.of[1]])
        elif node.op == "number":
            new[node] = node
        else:
            new[node] = Node(node.op, *(new[n] for n in node.of))
    return new[formula]


def folded(
    rule: Callable, column: Sequence[Any], rows: int, length: int, first: float | None, pairwise: bool
) -> list[Any]:
    """Return rows of a matrix of elements, each folded by a rule of two elements; see :class:`Fold`."""
    result = rule(*_pair(column))
    how = Fold(rows, length, expression(result), first, pairwise)
    return elements(made(how, rows, [matrix(column, rows, length)]), result.kind)


def accumulated(rule: Callable, column: Sequence[Any], rows: int, length: int) -> list[Any]:
    """Return all that a fold passes through; see :class:`Run`."""
    result = rule(*_pair(column))
    how = Run(rows, length, expression(result))
    return elements(made(how, rows * length, [matrix(column, rows, length)]), result.kind)


def _pair(column: Sequence[Any]) -> list[Scalar]:
    kind = "b" if all(map(is_boolean, column)) else "i" if all(map(is_whole, column)) else "f"
    return [Scalar(element("x", k), kind) for k in range(2)]


def multiplied(a: Sequence[Any], b: Sequence[Any], rows: int, inner: int, columns: int) -> list[Any]:
    """Return the elements of a product of matrices; see :class:`Product`."""
    kind = "i" if all(map(is_whole, a)) and all(map(is_whole, b)) else "f"
    operands = [matrix(a, rows, inner), matrix(b, inner, columns, beside=min(rows, columns) >= LEAST)]
    return elements(made(Product(rows, inner, columns), rows * columns, operands), kind)
