"""Angles as (sine, cosine): sums and small ones cost a few products, where the library's sine costs ten times that."""

from __future__ import annotations

import numpy as np

SMALL = 0.11
"""rad."""


def of(angle):
    """Sine and cosine of an angle, rad."""
    return np.sin(angle), np.cos(angle)


def both(one, other):
    """Those of the sum of two angles."""
    (s, c), (sine, cosine) = one, other
    return s * cosine + c * sine, c * cosine - s * sine


def small(angle):
    """Those of an angle of at most SMALL, rad, by their series: what is left out is 7e-17."""
    x = angle * angle
    sine = x * (-1.0 / 6.0 + x * (1.0 / 120.0 + x * (-1.0 / 5040.0 + x * (1.0 / 362880.0))))
    cosine = x * (-0.5 + x * (1.0 / 24.0 + x * (-1.0 / 720.0 + x * (1.0 / 40320.0))))
    return angle + angle * sine, 1.0 + cosine
