"""Products of traced arrays: of matrices, along any axes, of vectors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from navfmu.export.tracing import wholes
from navfmu.export.tracing.extent import current
from navfmu.export.tracing.rules import add, is_whole, refuse
from navfmu.export.tracing.traced import Traced, as_numbers, built, filled, is_kept_whole, objects, type_of, wrapped


def product(function: Callable, a: Any, b: Any) -> Any:
    """Return ``function(a, b)``, one of NumPy's products of matrices; each sum begins at 0.0 and goes in order."""
    a, b = objects(a), objects(b)
    if type_of(a) is type_of(b) is bool:
        refuse("NumPy's product of arrays of truth values is no count", "multiply a.astype(float)")
    if current().whole < math.inf and a.ndim and b.ndim:
        return _MATRICES[function](a, b)
    return _multiply(function, a, b)


def _multiply(function: Callable, a: np.ndarray, b: np.ndarray) -> Traced:
    products = objects(function(a.view(np.ndarray), b.view(np.ndarray)))
    sums = as_numbers(products.ravel().tolist())
    return built(products.shape, [e if is_whole(e) else add(0.0, e) for e in sums])  # sums begin at 0.0


def _matrix_product(a: np.ndarray, b: np.ndarray) -> Traced:
    """Product of two matrices, in one node if it is large."""
    (rows, inner), columns = a.shape, b.shape[1]
    left, right = a.ravel().tolist(), b.ravel().tolist()
    if inner != len(b) or not is_kept_whole(rows * inner * columns // 4, left, right):
        return _multiply(np.matmul, a, b)
    elements = wholes.multiplied(as_numbers(left), as_numbers(right), rows, inner, columns)
    return filled((rows, columns), elements)


def _matmul(a: np.ndarray, b: np.ndarray) -> Traced:
    first, second = a[None] if a.ndim == 1 else a, b[:, None] if b.ndim == 1 else b
    stack = np.broadcast_shapes(first.shape[:-2], second.shape[:-2])
    pairs = [np.broadcast_to(x, stack + x.shape[-2:]).reshape(math.prod(stack), *x.shape[-2:]) for x in (first, second)]
    products = [_matrix_product(x, y) for x, y in zip(*pairs, strict=True)]
    shape = stack + first.shape[-2 : -1 if a.ndim > 1 else -2] + second.shape[-1 if b.ndim > 1 else second.ndim :]
    return filled(shape, [e for product in products for e in product.ravel().tolist()])


def _dot(a: np.ndarray, b: np.ndarray) -> Traced:
    columns = np.moveaxis(b, -2, 0) if b.ndim > 1 else b[:, None]
    shape = a.shape[:-1] + (b.shape[:-2] + b.shape[-1:] if b.ndim > 1 else ())
    rows, right = math.prod(a.shape[:-1]), math.prod(columns.shape[1:])
    return _matrix_product(a.reshape(rows, len(columns)), columns.reshape(len(columns), right)).reshape(shape)


def _inner(a: np.ndarray, b: np.ndarray) -> Traced:
    left, right = (x.reshape(math.prod(x.shape[:-1]), x.shape[-1]) for x in (a, b))
    return _matrix_product(left, right.T).reshape(a.shape[:-1] + b.shape[:-1])


_MATRICES: dict[Callable, Callable] = {np.matmul: _matmul, np.dot: _dot, np.inner: _inner}


def tensordot(a: Any, b: Any, axes: Any = 2) -> Any:
    """Sums of products over pairs of axes, as one product of matrices."""
    a, b = np.asarray(a), np.asarray(b)
    if np.ndim(axes) == 0:
        axes = range(a.ndim - axes, a.ndim), range(axes)
    ours, theirs = ([int(i) % x.ndim for i in np.atleast_1d(list(axis))] for axis, x in zip(axes, (a, b), strict=True))
    kept = [[i for i in range(x.ndim) if i not in gone] for x, gone in ((a, ours), (b, theirs))]
    first, second = np.transpose(a, kept[0] + ours), np.transpose(b, theirs + kept[1])
    shape = first.shape[: len(kept[0])] + second.shape[len(theirs) :]
    inner = math.prod(first.shape[len(kept[0]) :])
    return np.dot(first.reshape(-1, inner), second.reshape(inner, -1)).reshape(shape)


def einsum(subscripts: Any, *operands: Any, **options: Any) -> Any:
    """Sums of products as the subscripts say: they begin at 0.0 and go through the summed letters in their order."""
    if not isinstance(subscripts, str) or "." in subscripts:
        return wrapped(np.einsum._implementation(subscripts, *operands, **options))
    given, arrow, result = subscripts.replace(" ", "").partition("->")
    letters = given.split(",")
    if not arrow:
        result = "".join(sorted(x for x in set(given) - {","} if given.count(x) == 1))
    summed = "".join(dict.fromkeys(x for x in given if x not in {",", *result}))
    factors = [_along(x, own, result + summed) for x, own in zip(operands, letters, strict=True)]
    total = factors[0]
    for factor in factors[1:]:
        total = total * factor
    sizes = {x: n for own, one in zip(letters, operands, strict=True) for x, n in zip(own, np.shape(one), strict=True)}
    total = np.broadcast_to(total, [sizes[x] for x in result + summed])
    if not summed:
        return total * 1 if len(factors) == 1 else total
    shape = np.shape(total)[: len(result)]
    rows = np.moveaxis(np.reshape(total, (*shape, math.prod(np.shape(total)[len(result) :]), 1)), -2, 0)
    return np.reshape(np.sum(rows, axis=0), shape)  # not the axis that lies side by side: one term after the other


def _along(x: Any, own: str, letters: str) -> Any:
    """Return an array with an axis for each of the letters, of length 1 for those that it has not."""
    for letter in dict.fromkeys(own):
        while own.count(letter) > 1:
            first = own.index(letter)
            second = own.index(letter, first + 1)
            x = np.diagonal(x, axis1=first, axis2=second)
            own = own[:first] + own[first + 1 : second] + own[second + 1 :] + letter
    x = np.transpose(x, [own.index(letter) for letter in letters if letter in own])
    sizes = iter(np.shape(x))
    return np.reshape(x, [next(sizes) if letter in own else 1 for letter in letters])


def kron(a: Any, b: Any) -> Any:
    """Each element of ``a`` times ``b``."""
    a, b = np.asarray(a), np.asarray(b)
    axes = max(a.ndim, b.ndim)
    first, second = ((1,) * (axes - x.ndim) + x.shape for x in (a, b))
    blocks = np.reshape(a, [n for m in first for n in (m, 1)]) * np.reshape(b, [n for m in second for n in (1, m)])
    return np.reshape(blocks, [m * n for m, n in zip(first, second, strict=True)])


def cross(a: Any, b: Any, axisa: int = -1, axisb: int = -1, axisc: int = -1, axis: int | None = None) -> Any:
    """Cross product of vectors."""
    if axis is not None:
        axisa = axisb = axisc = axis
    first, second = np.moveaxis(np.asarray(a), axisa, -1), np.moveaxis(np.asarray(b), axisb, -1)
    if (first.shape[-1], second.shape[-1]) != (3, 3):
        return wrapped(np.cross._implementation(a, b, axisa, axisb, axisc))
    parts = [first[..., i] * second[..., j] - first[..., j] * second[..., i] for i, j in ((1, 2), (2, 0), (0, 1))]
    return np.moveaxis(np.stack(parts, axis=-1), -1, axisc)
