"""Derivatives of linear algebra, from those of the equation that the result fulfils."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy import zeros

from navfmu.derivatives.composed import composed
from navfmu.derivatives.dual import RULES, Dual, dual, values
from navfmu.derivatives.slopes import Slopes


def _solve(call: Callable, level: int, a: Any, b: Any) -> Any:
    """A x = b, so A dx = db - dA x: every column of dx is one more right-hand side."""
    matrix, right = values(a, level), values(b, level)
    x = call(matrix, right)
    of_columns = np.ndim(right) > 1
    rest = b - a @ x if of_columns else b[:, None] - a @ x[..., None]  # its slopes are those of db - dA x
    if not (isinstance(rest, Dual) and rest.level == level):
        return x
    depending = rest.slopes.pattern.any(axis=0)
    sides = rest.slopes.dense()[:, depending]
    solved = call(matrix, np.reshape(sides, (*rest.shape[:-1], -1)))
    pattern = zeros((x.size, len(depending)), bool)
    pattern[:, depending] = True
    return dual(x, Slopes(pattern, np.ravel(solved)), level)


RULES[np.linalg.solve] = _solve


def _inverse(a: Any) -> Any:
    """d(A^-1) = -A^-1 dA A^-1."""
    inverse = np.linalg.inv(values(a, a.level))
    return -(inverse @ a @ inverse)


def _determinant(a: Any) -> Any:
    """d(det A) = sum of cofactors times dA (Laplace), also where A has no inverse."""
    bare, count = values(a, a.level), np.shape(a)[-1]
    if count == 1:
        return a[..., 0, 0]
    others = np.array([[j for j in range(count) if j != i] for i in range(count)])
    minors = bare[..., others[:, None, :, None], others[None, :, None, :]]  # (..., n, n, n - 1, n - 1)
    signs = 1.0 - 2.0 * (np.add.outer(np.arange(count), np.arange(count)) % 2)
    return np.sum(signs * np.linalg.det(minors) * a, (-2, -1))


def _cholesky(a: Any, *, upper: bool = False) -> Any:
    """A = L L', so dL = L times the lower half of L^-1 dA L^-T. NumPy reads the lower triangle of A only."""
    factor = np.linalg.cholesky(values(a, a.level))
    inverse = np.linalg.inv(factor)
    lower = np.tril(a)
    whole = lower + np.swapaxes(np.tril(a, -1), -1, -2)
    half = np.tril(inverse @ whole @ np.swapaxes(inverse, -1, -2)) * (1.0 - 0.5 * np.eye(np.shape(a)[-1]))
    return factor @ half


for _function, _rule in ((np.linalg.inv, _inverse), (np.linalg.det, _determinant), (np.linalg.cholesky, _cholesky)):
    composed(_function)(_rule)
