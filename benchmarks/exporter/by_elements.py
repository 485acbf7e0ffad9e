"""The filter on U-D factors as it is written for a computer without arrays: number by number, in plain functions that
are called in loops over the states. What :mod:`models.filters.kalman_ud` says in whole arrays.
"""

from __future__ import annotations

import numpy as np

from models.filters.kalman_ud import column, diagonal, order, unit


def weighted_sum(a, b, weights):
    """The sum of ``weights[k] a[k] b[k]``."""
    total = 0.0
    for k in range(len(a)):
        total = total + a[k] * (weights[k] * b[k])
    return total


def without(above, row, weights, square):
    """Take a row out of one above it: the share that this had of it, and what is left."""
    share = weighted_sum(above, row, weights) / np.where(square > 0.0, square, 1.0)
    return share, np.array([above[k] - share * row[k] for k in range(len(row))])


def propagate(columns, rows, factor, noise):
    """P[k+1] = Phi P Phi' + C_d: modified weighted Gram-Schmidt orthogonalisation."""
    driven, n = len(rows), len(noise)
    u = unit(columns)
    weights = np.concatenate([diagonal(columns), noise])
    moved = [rows[i] @ u for i in range(driven)] + [factor[i - driven] * u[i] for i in range(driven, n)]
    w = [np.concatenate([moved[i], np.eye(n)[i]]) for i in range(n)]
    result = [[0.0] * (j + 1) for j in range(n)]
    for j in reversed(range(n)):
        result[j][j] = weighted_sum(w[j], w[j], weights)
        for i in range(j):
            result[j][i], w[i] = without(w[i], w[j], weights, result[j][j])
    return np.array([x for one in result for x in one])


def seen(row, u, gathered, d, h, before):
    """One state in a scalar measurement: its packed column, the covariance of the states up to it with what is seen so
    far, and the variance of that."""
    f = h
    for i in range(len(u)):
        f = f + row[i] * u[i]
    v = d * f
    alpha = before + f * v
    share = f / before
    after = [u[i] - share * gathered[i] for i in range(len(u))] + [d * before / alpha]
    return np.array(after), np.array([gathered[i] + u[i] * v for i in range(len(u))] + [v]), alpha


def update(correction, columns, row, variance, residual):
    """One scalar measurement: Bierman's recursion over the states."""
    d, alpha, gathered, result = diagonal(columns), variance, np.zeros(0), []
    for j in range(order(columns)):
        after, gathered, alpha = seen(row[:j], column(columns, j), gathered, d[j], row[j], alpha)
        result.append(after)
    shift = (residual - row @ correction) / alpha
    return correction + shift * gathered, np.concatenate(result)
