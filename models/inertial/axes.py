"""Axes of a triad of sensors: how they are mounted, and that they are not at right angles to each other.

A triad shows N C_m s, s a vector in b. C_m = I - [misalignment x], thesis (3.29), turns the triad as a whole. N leans
its axes: x is taken as it is, y leans by one angle toward x, z by two angles toward x and toward y,

        1       0       0
    N = a_yx    1       0          (small angles, to first order)
        a_zx    a_zy    1

so that six numbers are all there is: three that turn, three that lean. Some take N as symmetric; to first order that is
this N turned as a whole.
"""

from __future__ import annotations

import numpy as np


def leaning(angles):
    """N of the angles (a_yx, a_zx, a_zy), rad."""
    zero, one = 0.0 * angles[0], 0.0 * angles[0] + 1.0
    return np.array([[one, zero, zero], [angles[0], one, zero], [angles[1], angles[2], one]])


def turned(vector, rotation):
    """(I - [rotation x]) vector, thesis (3.29): the vector in axes that are turned by small angles, rad."""
    return vector - np.cross(rotation, vector)
