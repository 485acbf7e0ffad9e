"""Field of a straight wire that carries a current: what Biot and Savart's integral is along a line.

    B = mu_0 I / (4 pi)  (a x b) (1/|a| + 1/|b|) / (|a| |b| + a . b)

with a the way from the point to where the current enters the wire, b to where it leaves it. At a distance d from the
middle of a long one this is mu_0 I / (2 pi d). A return wire is a second one with the current reversed.
"""

from __future__ import annotations

import numpy as np

OVER_FOUR_PI = 1.0e-7
"""mu_0 / (4 pi), T m/A."""


def field(begin_b, end_b, current):
    """Field at the origin, T, of ``current`` (A) from ``begin_b`` to ``end_b`` (3, m)."""
    begin, end = np.sqrt(np.sum(begin_b * begin_b)), np.sqrt(np.sum(end_b * end_b))
    shape = (1.0 / begin + 1.0 / end) / (begin * end + np.sum(begin_b * end_b))
    return OVER_FOUR_PI * current * shape * np.cross(begin_b, end_b)


def distance(begin_b, end_b):
    """From the origin to the nearest point of the wire, m."""
    along = end_b - begin_b
    length = np.sum(along * along)
    part = np.clip(-np.sum(begin_b * along) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
    nearest = begin_b + part * along
    return np.sqrt(np.sum(nearest * nearest))
