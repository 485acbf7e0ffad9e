"""Latency: a sample leaves the sensor some samples after it was taken, with the time at which it was taken."""

from __future__ import annotations

import numpy as np

LONGEST = 8
"""Samples that can be under way."""


def enter(line, value):
    """The samples under way, shape (LONGEST, n), the newest first, after ``value`` has been taken."""
    return np.concatenate([np.reshape(value, (1, -1)), line[:-1]])


def leave(line, value, late):
    """The sample that was taken ``late`` samples before ``value``, from the line that ``value`` has not entered yet."""
    leaving = value
    for i in range(LONGEST):
        leaving = np.where(late == i + 1, line[i], leaving)
    return leaving
