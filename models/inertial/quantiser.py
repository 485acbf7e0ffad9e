"""What a sensor's electronics make of a value: no more than its range, and whole steps.

A reading that is converted is rounded anew at each sample. (Integrating sensors, which count whole quanta and keep what
has made none for the next count, are in ``increments``.) A step or a range of 0 means none.
"""

from __future__ import annotations

import numpy as np


def within(value, largest):
    """The value, but at most ``largest`` to both sides."""
    return np.where(largest > 0.0, np.clip(value, -largest, largest), value)


def reading(value, largest, step):
    """The whole multiple of ``step`` that is nearest to the value, of those within ``largest`` to both sides."""
    unit = np.where(step > 0.0, step, 1.0)
    steps = np.rint(value / unit)
    most = np.floor(largest / unit * (1.0 + 1e-12))
    counted = unit * np.where(largest > 0.0, np.clip(steps, -most, most), steps)
    return np.where(step > 0.0, counted, within(value, largest))
