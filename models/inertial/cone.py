"""Motion on a cone, the test of attitude algorithms: Mark and Tazartes in RTO MP-43 (1999), appendix.

The attitude is that of the rotation vector half_angle (sin w t, cos w t, 0), (A-1): the third axis of b goes round on a
cone. All formulas are exact.
"""

from __future__ import annotations

import numpy as np


def rate(half_angle, frequency, time):
    """Rate of b in b, rad/s, shape (..., 3), (A-6); ``frequency`` w in rad/s, ``time`` in s."""
    turn = frequency * np.asarray(time)
    across = frequency * np.sin(half_angle)
    along = np.full_like(turn, 2.0 * frequency * np.sin(0.5 * half_angle) ** 2)
    return np.stack([across * np.cos(turn), -across * np.sin(turn), along], axis=-1)


def increments(half_angle, frequency, times):
    """Integrals of :func:`rate` between successive times, rad, shape (len(times) - 1, 3), (A-8)."""
    turn = frequency * np.asarray(times)
    sine, along = np.sin(half_angle), 2.0 * np.sin(0.5 * half_angle) ** 2
    return np.diff(np.stack([sine * np.sin(turn), sine * np.cos(turn), along * turn], axis=-1), axis=0)


def quaternion(half_angle, frequency, time):
    """Attitude as (q0, q1, q2, q3), shape (..., 4), (A-2)."""
    turn = frequency * np.asarray(time)
    sine, zero = np.sin(0.5 * half_angle), np.zeros_like(turn)
    return np.stack([zero + np.cos(0.5 * half_angle), sine * np.sin(turn), sine * np.cos(turn), zero], axis=-1)
