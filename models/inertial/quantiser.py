"""What a sensor's electronics make of a value: no more than its range, and whole steps.

A reading that is converted is rounded anew at each sample. (Integrating sensors, which count whole quanta and keep what
has made none for the next count, are in ``increments``.) A step or a range of 0 means none.
"""

from __future__ import annotations

import numpy as np


def within(value, largest):
    """The value, but at most ``largest`` to both sides."""
    return np.where(largest > 0.0, np.clip(value, -largest, largest), value)


def rounded(value, step):
    """The whole multiple of ``step`` that is nearest to the value."""
    unit = np.where(step > 0.0, step, 1.0)
    return np.where(step > 0.0, unit * np.rint(value / unit), value)
