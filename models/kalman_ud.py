"""Kalman filtering on the factors of the covariance, P = U D U', one scalar measurement at a time.

U is upper triangular with a diagonal of ones, D a diagonal matrix that travels as its elements. None of these can
become negative, whatever is rounded on the way, so P stays a covariance where the matrix itself would not: its update
is a difference of numbers that agree in most digits, or in all.

Equations: G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press 1977, chapters V.3
(measurement) and VI.4 (time: C. L. Thornton's modified weighted Gram-Schmidt orthogonalisation). The arguments are
those of :mod:`models.kalman`.
"""

from __future__ import annotations

import numpy as np


def covariance(unit, diagonal):
    """P = U D U' of the factors, shape (n, n)."""
    return (unit * diagonal) @ unit.T


def variances(unit, diagonal):
    """The diagonal of P, n elements."""
    return np.sum(unit * unit * diagonal, axis=1)


def factors(covariance):
    """U, shape (n, n), and the n elements of D, of a covariance that is positive definite."""
    root = np.linalg.cholesky(covariance[::-1, ::-1])[::-1, ::-1]  # of the states in reverse order: upper triangular
    scale = np.diag(root)
    return root / scale, scale * scale


def propagate(unit, diagonal, rows, factor, noise):
    """P[k+1] = Phi P Phi' + C_d as the factors of W D_w W', W = [Phi U, 1] and D_w = (D, C_d): chapter VI.4.

    From the last state to the first, the row of a state is taken out of the rows above it; what they had of it is its
    column of U, its weighted square its element of D.

    Parameters
    ----------
    unit, diagonal
        Factors of the covariance of n states, shapes (n, n) and (n,).
    rows
        The first m rows of Phi, by the first k states: shape (m, k).
    factor
        What each of the other n - m states is multiplied by: 1 for one that holds its value.
    noise
        Diagonal of C_d, n elements.
    """
    driven, driving = np.shape(rows)
    moved = np.concatenate([rows @ unit[:driving], factor[:, None] * unit[driven:]])
    weights = np.concatenate([diagonal, noise])
    above = np.concatenate([moved, np.eye(len(noise))], axis=1)
    columns, squares = [], []
    for state in reversed(range(len(noise))):
        row, above = above[state], above[:state]
        weighted = weights * row
        square = row @ weighted
        share = (above @ weighted) / np.where(square > 0.0, square, 1.0)  # of a state without variance nothing
        above = above - np.outer(share, row)
        columns.append(np.concatenate([share, np.eye(len(noise))[state, state:]]))
        squares.append(square)
    return np.stack(columns[::-1], axis=1), np.stack(squares[::-1])


def update(correction, unit, diagonal, row, variance, residual, use=True, gate=0.0):
    """One scalar measurement with the noise ``variance``: chapter V.3.

    The measurement's noise is seen first, then the states one after the other: alpha[j] is the variance of the
    innovation as far as it comes from the noise and the first j states, and gathered[:, j] the covariance of the states
    with that part of it.

    Parameters
    ----------
    correction
        Corrections of the states gathered so far in this measurement epoch (all residuals refer to the same
        prediction), n elements.
    unit, diagonal
        Factors of the covariance, shapes (n, n) and (n,).
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
    correction, unit, diagonal, and whether the measurement was taken.
    """
    f = row @ unit
    v = diagonal * f
    alpha = variance + np.cumsum(v * f)
    before = np.concatenate([[variance], alpha[:-1]])
    gathered = np.cumsum(unit * v, axis=1)
    earlier = np.concatenate([np.zeros((len(v), 1)), gathered[:, :-1]], axis=1)
    innovation, spread = residual - row @ correction, alpha[-1]
    inside = np.logical_or(gate <= 0.0, innovation * innovation <= gate * gate * spread)
    taken = np.logical_and(use, inside)
    return (
        correction + np.where(taken, innovation / spread, 0.0) * gathered[:, -1],
        unit - np.where(taken, f / before, 0.0) * earlier,
        diagonal * np.where(taken, before / alpha, 1.0),
        taken,
    )
