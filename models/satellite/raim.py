"""Receiver autonomous integrity monitoring: does one satellite disagree with the others, and which?

Parkinson and Axelrad (1988), Brown (1992), Walter and Enge (1995): weighted residuals of least squares.
"""

from __future__ import annotations

import numpy as np

ROUNDING = 1e-9
"""A row whose residual is always zero is what the others cannot check."""


def squares(residual, weight):
    """Sum of weighted squares of the residuals: chi square with as many degrees of freedom as rows are more than 4."""
    return np.sum(weight * residual * residual)


def redundancy(p, h, weight):
    """Diagonal of I - H P H' W, shape (rows,): the share of an error of each row that its own residual shows.

    It is 1 for a row that does not count, and 0 for one that no other row checks.
    """
    return 1.0 - weight * np.sum((h @ p) * h, axis=1)


def standardised(residual, weight, share):
    """Squares of residuals over their own variances: by how much the sum of squares is less without each row.

    ``share`` is the :func:`redundancy`. Of one wrong row it is largest at that row, in the mean.
    """
    checked = share > ROUNDING
    return np.where(checked, weight * residual * residual / np.where(checked, share, 1.0), 0.0)


def slopes(p, h, weight, share):
    """How far one row moves the solution while it adds 1 to the root of the sum of squares: horizontal, vertical, m.

    Rows of (P H' W)_i over sqrt(w_i share_i), both of shape (rows,); of one that nothing checks it is infinite, which
    is told as a large number.
    """
    gain = (h @ p) * weight[:, None]
    seen = np.sqrt(np.maximum(weight * share, 1e-24))
    counted = weight > 0.0
    horizontal = np.where(counted, np.sqrt(gain[:, 0] ** 2 + gain[:, 1] ** 2) / seen, 0.0)
    return horizontal, np.where(counted, np.abs(gain[:, 2]) / seen, 0.0)
