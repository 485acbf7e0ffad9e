"""Kalman filtering on the upper triangle of the covariance, one scalar measurement at a time.

A covariance of n states travels as its n (n + 1) / 2 upper elements, row by row, so it is symmetric by construction and
its update costs half. Leading axes are free: the same functions run one filter or a whole Monte Carlo of them.

Sequential scalar updates equal the matrix form L = P H' (H P H' + R)^-1 where R is diagonal, which is the corrected
form of thesis (4.50) and (6.39): both print (H' P H + R).
"""

from __future__ import annotations

from functools import cache

import numpy as np


@cache
def _triangle(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows and columns of the packed elements, and for each element of the matrix its place in the packed form."""
    rows, columns = np.triu_indices(n)
    place = np.zeros((n, n), dtype=int)
    place[rows, columns] = place[columns, rows] = np.arange(len(rows))
    return rows, columns, place


def order(upper) -> int:
    """Number of states n of a packed covariance of n (n + 1) / 2 elements."""
    return (round((8 * np.shape(upper)[-1] + 1) ** 0.5) - 1) // 2


def pack(matrix):
    """Upper triangle, row by row."""
    rows, columns, _ = _triangle(np.shape(matrix)[-1])
    return matrix[..., rows, columns]


def unpack(upper):
    """The symmetric matrix of a packed covariance."""
    return upper[..., _triangle(order(upper))[2]]


def diagonal(upper):
    """Variances of a packed covariance."""
    return upper[..., np.diagonal(_triangle(order(upper))[2])]


def of_variances(variances):
    """Packed covariance of independent states."""
    return pack(np.diag(variances))


def propagate(upper, rows, factor, noise):
    """P[k+1] = Phi P Phi' + C_d, thesis (4.46), (6.31), where only the first states are driven by others.

    Parameters
    ----------
    upper
        Packed covariance of n states.
    rows
        The first m rows of Phi, by the first k states: shape (m, k). The product of full matrices would take several
        times as many operations.
    factor
        What each of the other n - m states is multiplied by: 1 for one that holds its value.
    noise
        Diagonal of C_d, n elements.
    """
    covariance = unpack(upper)
    driven, driving = np.shape(rows)[-2:]
    moved = rows @ covariance[..., :driving, :]
    corner = moved[..., :driving] @ np.swapaxes(rows, -1, -2)
    side = moved[..., driven:] * factor[..., None, :]
    rest = covariance[..., driven:, driven:] * factor[..., :, None] * factor[..., None, :]
    above = np.concatenate([corner, side], axis=-1)
    below = np.concatenate([np.swapaxes(side, -1, -2), rest], axis=-1)
    return pack(np.concatenate([above, below], axis=-2) + noise[..., None] * np.eye(np.shape(noise)[-1]))


def innovate(correction, upper, row, variance, residual):
    """Innovation of a scalar measurement, its variance H P H' + R, and P H'; arguments as of :func:`update`."""
    row = np.asanyarray(row)
    cross = np.sum(unpack(upper) * row[..., None, :], axis=-1)
    return residual - np.sum(row * correction, axis=-1), np.sum(row * cross, axis=-1) + variance, cross


def update(correction, upper, row, variance, residual, use=True, gate=0.0):
    """One scalar measurement with the noise ``variance``, thesis (6.39)-(6.42).

    Parameters
    ----------
    correction
        Corrections of the states gathered so far in this measurement epoch (all residuals refer to the same
        prediction).
    upper
        Packed covariance.
    row
        H, the derivatives of the measurement with respect to the states.
    residual
        Measurement minus the prediction before the epoch's first correction.
    use
        Whether there is a measurement.
    gate
        Innovations beyond this many of their standard deviations are rejected; 0: none is.

    Returns
    -------
    correction, upper, and whether the measurement was taken.
    """
    innovation, spread, cross = innovate(correction, upper, row, variance, residual)
    inside = np.logical_or(gate <= 0.0, innovation * innovation <= gate * gate * spread)
    taken = np.logical_and(use, inside)
    gain = np.where(taken, 1.0 / spread, 0.0)[..., None] * cross
    rows, columns, _ = _triangle(order(upper))
    shift = np.where(taken, innovation, 0.0)[..., None] * gain
    return correction + shift, upper - gain[..., rows] * cross[..., columns], taken


def updates(correction, upper, rows, variances, residuals, use, gate=0.0):
    """Several measurements, one after the other; arguments as of :func:`update`, with an axis of measurements: the last
    but one of ``rows``, the last of the others.

    Returns correction, upper, which measurements were taken, and of each the innovation and its variance.
    """
    taken, innovations, spreads = [], [], []
    for one in range(np.shape(residuals)[-1]):
        row, variance, residual = rows[..., one, :], variances[..., one], residuals[..., one]
        innovation, spread, _ = innovate(correction, upper, row, variance, residual)
        correction, upper, was_taken = update(correction, upper, row, variance, residual, use[..., one], gate)
        taken.append(was_taken)
        innovations.append(innovation)
        spreads.append(spread)
    return correction, upper, np.stack(taken, -1), np.stack(innovations, -1), np.stack(spreads, -1)
