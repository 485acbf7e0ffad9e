"""Products of arrays: each is a product element by element, with axes for all indices, and a sum over some of them.

Of the terms of these sums only those are differentiated that depend on x.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from functools import reduce
from typing import Any

import numpy as np

from navfmu.derivatives.composed import composed
from navfmu.derivatives.dual import refuse
from navfmu.derivatives.elementwise import PARTIALS

Labels = Sequence[Hashable]


def _spread(x: Any, labels: Labels, all_labels: Labels) -> Any:
    """The array with an axis for each of ``all_labels``, of length 1 where it has no such index."""
    order = sorted(range(len(labels)), key=lambda i: all_labels.index(labels[i]))
    lengths = dict(zip(labels, np.shape(x), strict=True))
    return np.reshape(np.transpose(x, order), [lengths.get(label, 1) for label in all_labels])


def _contracted(a: Any, of_a: Labels, b: Any, of_b: Labels, of_result: Labels) -> Any:
    """The sum over all indices that the result does not have of the products of two arrays."""
    over = [label for label in dict.fromkeys([*of_a, *of_b]) if label not in of_result]
    together = [*of_result, *over]
    product = _spread(a, of_a, together) * _spread(b, of_b, together)
    return np.sum(product, tuple(range(len(of_result), len(together)))) if over else product


@composed(np.matmul, np.linalg.matmul)
def _matmul(a: Any, b: Any) -> Any:
    more = max(np.ndim(a), np.ndim(b)) - 2
    of_a = ["k"] if np.ndim(a) == 1 else [*range(more + 2 - np.ndim(a), more), "i", "k"]
    of_b = ["k"] if np.ndim(b) == 1 else [*range(more + 2 - np.ndim(b), more), "k", "j"]
    rows, columns = ["i"] * (np.ndim(a) > 1), ["j"] * (np.ndim(b) > 1)
    return _contracted(a, of_a, b, of_b, [*range(max(more, 0)), *rows, *columns])


@composed(np.tensordot, np.linalg.tensordot)
def _tensordot(a: Any, b: Any, axes: Any = 2) -> Any:
    if isinstance(axes, int):
        axes = range(np.ndim(a) - axes, np.ndim(a)), range(axes)
    summed = [[i % np.ndim(x) for i in np.atleast_1d(own).tolist()] for x, own in zip((a, b), axes, strict=True)]
    of_a = [("sum", summed[0].index(i)) if i in summed[0] else ("a", i) for i in range(np.ndim(a))]
    of_b = [("sum", summed[1].index(i)) if i in summed[1] else ("b", i) for i in range(np.ndim(b))]
    return _contracted(a, of_a, b, of_b, [label for label in [*of_a, *of_b] if label[0] != "sum"])


@composed(np.dot)
def _dot(a: Any, b: Any, out: None = None) -> Any:
    if np.ndim(a) == 0 or np.ndim(b) == 0:
        return a * b
    return _tensordot(a, b, (-1, max(np.ndim(b) - 2, 0)))


@composed(np.inner)
def _inner(a: Any, b: Any) -> Any:
    return a * b if np.ndim(a) == 0 or np.ndim(b) == 0 else _tensordot(a, b, (-1, -1))


@composed(np.vdot)
def _vdot(a: Any, b: Any) -> Any:
    return _tensordot(np.ravel(a), np.ravel(b), 1)


@composed(np.vecdot, np.linalg.vecdot)
def _vecdot(a: Any, b: Any, axis: int = -1) -> Any:
    return np.sum(a * b, axis)


@composed(np.outer, np.linalg.outer)
def _outer(a: Any, b: Any, out: None = None) -> Any:
    return np.ravel(a)[:, None] * np.ravel(b)


for _ufunc in [one for one in (*PARTIALS, np.maximum, np.minimum) if getattr(one, "nin", 0) == 2]:

    @composed((_ufunc, "outer"))
    def _ufunc_outer(a: Any, b: Any, _ufunc: np.ufunc = _ufunc) -> Any:
        return _ufunc(np.reshape(a, np.shape(a) + (1,) * np.ndim(b)), b)


@composed(np.kron)
def _kron(a: Any, b: Any) -> Any:
    ndim = max(np.ndim(a), np.ndim(b))
    first, second = (np.reshape(x, (1,) * (ndim - np.ndim(x)) + np.shape(x)) for x in (a, b))
    product = np.expand_dims(first, tuple(range(1, 2 * ndim, 2))) * np.expand_dims(second, tuple(range(0, 2 * ndim, 2)))
    return np.reshape(product, [m * n for m, n in zip(np.shape(first), np.shape(second), strict=True)])


@composed(np.cross, np.linalg.cross)
def _cross(a: Any, b: Any, axisa: int = -1, axisb: int = -1, axisc: int = -1, axis: int | None = None) -> Any:
    if axis is not None:
        axisa = axisb = axisc = axis
    a, b = np.moveaxis(np.array(a), axisa, 0), np.moveaxis(np.array(b), axisb, 0)
    if len(a) != 3 or len(b) != 3:
        refuse("np.cross of vectors of two elements has no derivative", "write x[0] * y[1] - x[1] * y[0]")
    parts = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    return np.stack(parts, axisc)


@composed(np.trace, np.linalg.trace)
def _trace(a: Any, offset: int = 0, axis1: int = 0, axis2: int = 1, dtype: Any = None, out: None = None) -> Any:
    return np.sum(np.diagonal(a, offset, axis1, axis2), -1)


@composed(np.linalg.multi_dot)
def _multi_dot(arrays: Sequence[Any], *, out: None = None) -> Any:
    return reduce(np.dot, arrays)


@composed(np.linalg.matrix_power)
def _matrix_power(a: Any, n: int) -> Any:
    if n < 0:
        a, n = np.linalg.inv(a), -n
    return reduce(np.matmul, [a] * n, np.eye(len(a)))


def _subscripts(text: str, operands: Sequence[Any]) -> tuple[list[list], list]:
    """The indices of each operand and of the result: letters, and numbers for an ellipsis."""
    given, arrow, result = text.replace(" ", "").partition("->")
    labels = []
    for part, x in zip(given.split(","), operands, strict=True):
        before, dots, after = part.partition("...")
        hidden = np.ndim(x) - len(before + after) if dots else 0
        labels.append([*before, *range(-hidden, 0), *after])
    hidden = range(min((label for own in labels for label in own if isinstance(label, int)), default=0), 0)
    if arrow:
        before, dots, after = result.partition("...")
        return labels, [*before, *(hidden if dots else ()), *after]
    counts = Counter(given.replace("...", "").replace(",", ""))
    return labels, [*hidden, *sorted(letter for letter, count in counts.items() if count == 1)]


@composed(np.einsum)
def _einsum(subscripts: str, *operands: Any, **kwargs: Any) -> Any:
    if not isinstance(subscripts, str):
        refuse("np.einsum with lists of indices has no derivative", "write the indices as a text, 'ij,jk->ik'")
    labels, result = _subscripts(subscripts, operands)
    arrays = [np.array(x) for x in operands]
    for n, own in enumerate(labels):
        for label in [label for label, count in Counter(own).items() if count > 1]:
            while own.count(label) > 1:
                first = own.index(label)
                second = own.index(label, first + 1)
                arrays[n] = np.diagonal(arrays[n], 0, first, second)
                own = [one for i, one in enumerate(own) if i not in (first, second)] + [label]
        labels[n] = own
    a, of_a = arrays[0], labels[0]
    for n in range(1, len(arrays)):
        later = {label for own in labels[n + 1 :] for label in own}
        kept = [label for label in dict.fromkeys([*of_a, *labels[n]]) if label in result or label in later]
        a, of_a = _contracted(a, of_a, arrays[n], labels[n], kept), kept
    over = tuple(i for i, label in enumerate(of_a) if label not in result)
    left = [label for label in of_a if label in result]
    return np.transpose(np.sum(a, over) if over else a, [left.index(label) for label in result])
