"""Kalman filtering in the stabilised form of Joseph, P+ = (I - L H) P (I - L H)' + L R L', one scalar at a time.

The sum of two squares stays a covariance whatever gain is used, at several times the operations of
:mod:`models.filters.kalman`, whose packed covariance this takes. Equation: M. J. Dyment and D. F. Liang in AGARD CP-298
(1981), p. 15-5, (4-2), which calls it the stabilised Kalman algorithm.
"""

from __future__ import annotations

import numpy as np

from models.filters import kalman
from models.filters.kalman import diagonal, of_variances, order, pack, propagate, unpack

__all__ = ["diagonal", "of_variances", "order", "pack", "propagate", "unpack", "update"]


def update(correction, upper, row, variance, residual, use=True, gate=0.0):
    """One scalar measurement; arguments and results as of :func:`models.filters.kalman.update`."""
    innovation, spread, cross = kalman.innovate(correction, upper, row, variance, residual)
    inside = np.logical_or(gate <= 0.0, innovation * innovation <= gate * gate * spread)
    taken = np.logical_and(use, inside)
    gain = np.where(taken, 1.0 / spread, 0.0) * cross
    left = unpack(upper) - gain[:, None] * cross  # (I - L H) P
    rows, columns = np.triu_indices(order(upper))
    joseph = pack(left) - (left @ row)[rows] * gain[columns] + (variance * gain)[rows] * gain[columns]
    return correction + np.where(taken, innovation, 0.0) * gain, joseph, taken
