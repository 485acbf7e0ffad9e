"""Kalman filtering on the factors of the covariance, P = U D U', one scalar measurement at a time.

U is upper triangular with a diagonal of ones, D is diagonal. None of its elements can become negative, whatever is
rounded on the way, so P stays a covariance where the matrix itself would not: its update is a difference of numbers
that agree in most digits, or in all. Both travel as the columns of U one after the other, each from the first row to
its diagonal, where the element of D takes the place of the one: n (n + 1) / 2 numbers for n states.

Equations: G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press 1977, chapters V.3
(measurement) and VI.4 (time: C. L. Thornton's modified weighted Gram-Schmidt orthogonalisation). The functions are used
as those of :mod:`models.filters.kalman`.
"""

from __future__ import annotations

from functools import cache

import numpy as np


@cache
def _places(n: int) -> tuple[np.ndarray, np.ndarray]:
    """For each element of U its place among the packed ones, a 0 and a 1; and the places of D."""
    place = np.full((n, n), n * (n + 1) // 2)
    column, row = np.tril_indices(n)
    place[row, column] = np.arange(len(row))
    diagonal = np.diag(place).copy()
    np.fill_diagonal(place, n * (n + 1) // 2 + 1)
    return place, diagonal


def order(columns) -> int:
    """Number of states n of n (n + 1) / 2 packed elements."""
    return (round((8 * np.shape(columns)[-1] + 1) ** 0.5) - 1) // 2


def unit(columns):
    """U, shape (n, n)."""
    return np.concatenate([columns, [0.0, 1.0]])[_places(order(columns))[0]]


def diagonal(columns):
    """The n elements of D."""
    return columns[_places(order(columns))[1]]


def column(columns, state: int):
    """What U has above its diagonal in the column of a state."""
    first = state * (state + 1) // 2
    return columns[first : first + state]


def covariance(columns):
    """P = U D U', shape (n, n)."""
    u = unit(columns)
    return (u * diagonal(columns)) @ u.T


def variances(columns):
    """The diagonal of P, n elements."""
    u = unit(columns)
    return np.sum(u * u * diagonal(columns), axis=1)


def factors(covariance):
    """The packed factors of a covariance that is positive definite, shape (n, n)."""
    root = np.linalg.cholesky(covariance[::-1, ::-1])[::-1, ::-1]  # of the states in reverse order: upper triangular
    scale = np.diag(root)
    u = root / scale
    return np.concatenate([np.append(u[:i, i], scale[i] * scale[i]) for i in range(len(scale))])


def of_variances(variances):
    """The packed factors for independent states."""
    return np.concatenate([np.append(np.zeros(i), variance) for i, variance in enumerate(variances)])


def propagate(columns, rows, factor, noise):
    """P[k+1] = Phi P Phi' + C_d as the factors of W D_w W', W = [Phi U, 1] and D_w = (D, C_d): chapter VI.4.

    From the last state to the first, the row of W of a state is taken out of the rows above it: what they had of it is
    the state's column of U, its weighted square the element of D.

    Parameters
    ----------
    columns
        Packed factors of the covariance of n states.
    rows
        The first m rows of Phi, by the first k states: shape (m, k).
    factor
        What each of the other n - m states is multiplied by: 1 for one that holds its value.
    noise
        Diagonal of C_d, n elements.
    """
    driven, driving = np.shape(rows)
    u = unit(columns)
    moved = np.concatenate([rows @ u[:driving], factor[:, None] * u[driven:]])
    weights = np.concatenate([diagonal(columns), noise])
    above = np.concatenate([moved, np.eye(len(noise))], axis=1)
    result = []
    for state in reversed(range(len(noise))):
        row, above = above[state], above[:state]
        weighted = weights * row
        square = row @ weighted
        share = (above @ weighted) / np.where(square > 0.0, square, 1.0)  # of a state without variance nothing
        above = above - np.outer(share, row)
        result.append(np.append(share, square))
    return np.concatenate(result[::-1])


def update(correction, columns, row, variance, residual, use=True, gate=0.0):
    """One scalar measurement with the noise ``variance``: chapter V.3.

    The measurement's noise is seen first, then the states one after the other: alpha[j] is the variance of the
    innovation as far as it comes from the noise and the states up to j, and ``gathered`` the covariance of the states
    with that part of it.

    Parameters
    ----------
    correction
        Corrections of the states gathered so far in this measurement epoch (all residuals refer to the same
        prediction), n elements.
    columns
        Packed factors of the covariance.
    row
        H, the derivatives of the measurement with respect to the n states.
    residual
        Measurement minus the prediction before the epoch's first correction.
    use
        Whether there is a measurement.
    gate
        Innovations beyond this many of their standard deviations are rejected; 0: none is.

    Returns
    -------
    correction, columns, and whether the measurement was taken.
    """
    n, d = order(columns), diagonal(columns)
    f = row + np.array([np.sum(row[:state] * column(columns, state)) for state in range(n)])
    v = d * f
    alpha = variance + np.cumsum(f * v)
    before = np.append(variance, alpha[:-1])
    innovation, spread = residual - row @ correction, alpha[-1]
    inside = np.logical_or(gate <= 0.0, innovation * innovation <= gate * gate * spread)
    taken = np.logical_and(use, inside)
    share = np.where(taken, f / before, 0.0)
    square = d * np.where(taken, before / alpha, 1.0)
    gathered, result = v[:0], []
    for state in range(n):
        u = column(columns, state)
        result.append(np.append(u - share[state] * gathered, square[state]))
        gathered = np.append(gathered + v[state] * u, v[state])
    return correction + np.where(taken, innovation / spread, 0.0) * gathered, np.concatenate(result), taken
