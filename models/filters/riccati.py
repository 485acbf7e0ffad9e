"""Where a covariance comes to rest: the discrete Riccati equation of thesis (4.46), (4.50) in the end."""

from __future__ import annotations

import numpy as np

from navfmu.repetition import repeat

DOUBLINGS = 30
"""Each doubles the number of updates that have been made: 1e9 of them."""


def steady(transition, noise, row, variance):
    """Covariance before an update, shape (n, n), after as many updates as it takes to change no more.

    Structure-preserving doubling (Anderson, *Int. J. Control* 28 (1978), p. 295): the covariance after 1, 2, 4 ...
    updates. It is that of ``P = Phi (P - P h (h' P h + R)^-1 h' P) Phi' + C_d``.

    Parameters
    ----------
    transition, noise
        Phi and C_d between two updates, shape (n, n).
    row, variance
        h, shape (n,), of what is measured in an update, and R.
    """
    one = np.eye(np.shape(noise)[0])

    def doubled(value):
        closed, information, covariance = value
        through = closed @ np.linalg.inv(one + information @ covariance)
        return (
            through @ closed,
            information + through @ information @ closed.T,
            covariance + closed.T @ covariance @ np.linalg.inv(one + information @ covariance) @ closed,
        )

    begun = transition.T, np.outer(row, row) / variance, noise
    return repeat(doubled, begun, DOUBLINGS, DOUBLINGS)[2]


def gain(covariance, row, variance):
    """L = P h (h' P h + R)^-1 of one scalar measurement, shape (n,)."""
    cross = covariance @ row
    return cross / (np.sum(row * cross) + variance)
