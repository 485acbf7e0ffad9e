"""Kalman filtering on the triangular root of the covariance, P = S S', one scalar measurement at a time.

S is upper triangular and travels as its columns one after the other, each from the first row to its diagonal:
n (n + 1) / 2 numbers for n states. Its digits are worth twice as many of P, at n square roots an update; the factors of
:mod:`models.filters.kalman_ud` do the same without.

Equations: N. A. Carlson, Fast triangular formulation of the square root filter, AIAA Journal 11 (1973), p. 1259;
M. J. Dyment and D. F. Liang in AGARD CP-298 (1981), p. 15-6, b).
"""

from __future__ import annotations

import numpy as np

from models.filters import kalman_ud
from models.filters.kalman_ud import order


def column(columns, state: int):
    """The column of S of a state, from the first row to its diagonal."""
    first = state * (state + 1) // 2
    return columns[first : first + state + 1]


def root(columns):
    """S, shape (n, n)."""
    n = order(columns)
    return np.stack([np.concatenate([column(columns, j), np.zeros(n - 1 - j)]) for j in range(n)], axis=1)


def covariance(columns):
    """P = S S', shape (n, n)."""
    s = root(columns)
    return s @ s.T


def variances(columns):
    """The diagonal of P, n elements."""
    s = root(columns)
    return np.sum(s * s, axis=1)


def factors(covariance):
    """The packed root of a covariance that is positive definite, shape (n, n)."""
    return of_ud(kalman_ud.factors(covariance))


def of_variances(variances):
    """The packed root for independent states."""
    return of_ud(kalman_ud.of_variances(variances))


def of_ud(columns):
    """S = U sqrt(D) from the packed U and D."""
    n, scale = order(columns), np.sqrt(kalman_ud.diagonal(columns))
    return np.concatenate([np.append(kalman_ud.column(columns, j) * scale[j], scale[j]) for j in range(n)])


def to_ud(columns):
    """The packed U and D; a state without variance has nothing above its diagonal."""
    parts = []
    for state in range(order(columns)):
        one = column(columns, state)
        scale = one[-1]
        parts.append(np.append(one[:-1] / np.where(scale > 0.0, scale, 1.0), scale * scale))
    return np.concatenate(parts)


def propagate(columns, rows, factor, noise):
    """P[k+1] = Phi P Phi' + C_d, by the factors of :func:`models.filters.kalman_ud.propagate`, whose arguments these
    are."""
    return of_ud(kalman_ud.propagate(to_ud(columns), rows, factor, noise))


def update(correction, columns, row, variance, residual, use=True, gate=0.0):
    """One scalar measurement; arguments and results as of :func:`models.filters.kalman_ud.update`.

    alpha[j] is the variance of the innovation as far as it comes from the noise and the states up to j, and
    ``gathered`` the covariance of the states with that part of it.
    """
    n = order(columns)
    f = np.array([np.sum(row[: state + 1] * column(columns, state)) for state in range(n)])
    alpha = variance + np.cumsum(f * f)
    before = np.append(variance, alpha[:-1])
    innovation, spread = residual - row @ correction, alpha[-1]
    inside = np.logical_or(gate <= 0.0, innovation * innovation <= gate * gate * spread)
    taken = np.logical_and(use, inside)
    shrink = np.where(taken, np.sqrt(before / alpha), 1.0)
    share = np.where(taken, f / np.sqrt(before * alpha), 0.0)
    gathered, result = f[:0], []
    for state in range(n):
        s = column(columns, state)
        known = np.append(gathered, 0.0)
        result.append(shrink[state] * s - share[state] * known)
        gathered = known + f[state] * s
    return correction + np.where(taken, innovation / spread, 0.0) * gathered, np.concatenate(result), taken
