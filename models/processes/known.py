"""What is no number does not enter what is remembered: one such input would spoil all that follows."""

from __future__ import annotations

import numpy as np


def known(value, otherwise):
    """Return ``value`` where it is a finite number, element by element, and ``otherwise`` elsewhere."""
    return np.where(np.isfinite(value), value, otherwise)


def told(valid, *values):
    """Whether a sample that says it is ``valid`` is one: all of its ``values``, numbers or arrays, are finite."""
    return np.logical_and(valid, np.isfinite(sum(np.sum(value) for value in values)))
