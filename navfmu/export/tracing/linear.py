"""Linear algebra with traced matrices: routines of the runtime that choose pivots as they go.

NumPy raises an error for a matrix that is singular or not positive definite; here the results are infinite or NaN then.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from navfmu.export.tracing.rules import refuse
from navfmu.export.tracing.traced import routine


def _square(a: Any, name: str) -> Any:
    a = np.asanyarray(a).astype(float)
    if a.ndim < 2 or a.shape[-1] != a.shape[-2] or a.shape[-1] == 0:
        refuse(f"np.linalg.{name} needs square matrices, and the shape is {a.shape}", "give it one (n, n) at the end")
    return a


def _each(function: Callable, a: Any, *more: Any) -> Any:
    """Apply a function to each matrix of a stack."""
    if a.ndim == 2:
        return function(a, *more)
    return np.stack([_each(function, *parts) for parts in zip(a, *more, strict=True)])


def solve(a: Any, b: Any) -> Any:
    """``x`` of ``a x = b``, by elimination with the largest pivots of each column."""
    a, b = _square(a, "solve"), np.asanyarray(b).astype(float)
    if b.ndim == 1:
        return solve(a, b[:, None])[..., 0]
    stack = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    a, b = (np.broadcast_to(x, stack + x.shape[-2:]) for x in (a, b))
    if a.shape[-1] != b.shape[-2]:
        refuse(f"np.linalg.solve has matrices {a.shape} and right sides {b.shape}", "give it as many rows of each")
    return _each(_solve, a, b)


def _solve(a: Any, b: Any) -> Any:
    n, columns = b.shape
    size = n * columns
    return routine("solve", [a, b], (size + n * n,), numbers=(n, columns))[:size].reshape(n, columns)


def inv(a: Any) -> Any:
    """Inverse: the solution for the unit matrix."""
    a = _square(a, "inv")
    return _each(lambda one: _solve(one, np.eye(len(one))), a)


def det(a: Any) -> Any:
    """Determinant: the product of the pivots."""
    return _each(lambda one: routine("determinant", [one], (1 + one.size,), numbers=(len(one),))[0], _square(a, "det"))


def cholesky(a: Any, /, *, upper: bool = False) -> Any:
    """Lower factor L of ``a = L L'``, of which the lower triangle is read."""
    a = _square(a, "cholesky")
    if upper:
        return np.swapaxes(cholesky(np.swapaxes(a, -1, -2)), -1, -2)
    return _each(lambda one: routine("cholesky", [one], one.shape, numbers=(len(one),)), a)


FUNCTIONS: dict[Callable, Callable] = {
    np.linalg.solve: solve,
    np.linalg.inv: inv,
    np.linalg.det: det,
    np.linalg.cholesky: cholesky,
}
