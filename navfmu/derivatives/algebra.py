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
    """d(det A) = det A tr(A^-1 dA), Jacobi; for a matrix that has an inverse."""
    bare = values(a, a.level)
    return np.linalg.det(bare) * np.sum(np.swapaxes(np.linalg.inv(bare), -1, -2) * a, (-2, -1))


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
