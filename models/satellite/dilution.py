"""Dilution of precision: errors of a solution, in those of a range, by the directions of its satellites alone."""

from __future__ import annotations

import numpy as np

NONE = 9999.0
"""What is told where there is no solution, and at most."""


def dilutions(q):
    """GDOP, PDOP, HDOP, VDOP, TDOP of q = (H' H)^-1, shape (4, 4): north, east, down, clock.

    NONE of the q that :func:`models.satellite.least_squares.covariance` gives where there is no inverse.
    """
    north, east, down, clock = q[0, 0], q[1, 1], q[2, 2], q[3, 3]
    squares = np.stack([north + east + down + clock, north + east + down, north + east, down, clock])
    good = np.all(np.stack([north, east, down, clock]) > 0.0)
    return np.where(good, np.minimum(np.sqrt(np.where(good, squares, 1.0)), NONE), NONE)


def growth(q, h, weight):
    """By how much the trace of q grows without each of the rows ``h``, shape (rows,).

    By the formula of Sherman and Morrison, w |q h|^2 / (1 - w h' q h); infinite for a row that cannot be missed.
    """
    turned = h @ q
    share = weight * np.sum(turned * h, axis=1)
    return weight * np.sum(turned * turned, axis=1) / np.maximum(1.0 - share, 1e-12)


def least(value, among):
    """A truth value for each: whether it is the first of the least ones ``among`` which one is sought."""
    sought = np.where(among, value, np.inf)
    first = np.argmin(sought)
    return np.logical_and(np.arange(value.shape[0]) == first, among)
