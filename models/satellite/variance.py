"""How far a pseudorange may be off: the variance by which satellites are weighed.

The sum of what code and phase tracking, ephemeris and clock, code bias, ionosphere and troposphere leave, as in
RTKLIB 2.4.3, function rescode of its single point solution.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

CODE = 0.3
"""Of a receiver's code at the zenith, m."""
BIAS = 0.3
"""Of what differs between the codes of a satellite, m."""
ACCURACY = (2.4, 3.4, 4.85, 6.85, 9.65, 13.65, 24.0, 48.0, 96.0, 192.0, 384.0, 768.0, 1536.0, 3072.0, 6144.0)
"""Bounds of the user range accuracy by its index, m: IS-GPS-200, 20.3.3.3.1.3."""
IONOSPHERE = 0.5
"""Of the delay by Klobuchar's model."""
TROPOSPHERE = 0.3
"""Of the delay by a model, at the zenith, m; it grows with 1 / (sin(elevation) + 0.1)."""


def bound(accuracy):
    """The upper bound of the index that a user range accuracy (m) belongs to; files hold values within these."""
    upper = ACCURACY[0] + 0.0 * accuracy
    for below, above in pairwise(ACCURACY):
        upper = np.where(accuracy > below, above, upper)
    return upper


def pseudorange(sine, accuracy, ionosphere):
    """Variance, m2, of ranges by the ``sine`` of the elevation, the satellites' user range accuracy (m) and the delay
    of the ionosphere (m)."""
    accuracy = bound(accuracy)
    left = (IONOSPHERE * ionosphere) ** 2 + (TROPOSPHERE / (sine + 0.1)) ** 2
    return code(sine) + accuracy * accuracy + BIAS * BIAS + left


def code(sine):
    """Variance of the receiver's own part, m2: what differential corrections leave."""
    return CODE * CODE * (1.0 + 1.0 / sine)
