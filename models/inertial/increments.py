"""Increments of angle and velocity: what integrating sensors put out."""

from __future__ import annotations

import numpy as np


def trapezoid(before, now, period):
    """Integral over ``period`` of what goes straight from ``before`` to ``now``.

    An oscillation passes with (a/2) cot(a/2), a its angle in a period, without delay; see
    ``models.inertial.coning.SHAPES``.
    """
    return 0.5 * period * (before + now)


def counted(increment, remainder, quantum):
    """Whole quanta of an increment and of what was left before, and what is left now.

    So the sum of what is put out is never further from that of the increments than half a quantum. With a quantum of 0
    all is put out.
    """
    whole = quantum > 0.0
    total = increment + remainder
    out = np.where(whole, quantum * np.rint(total / np.where(whole, quantum, 1.0)), total)
    return out, total - out
