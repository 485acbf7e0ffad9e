"""GPS time: a week, which is an integer, and seconds of the week.

One double of seconds since 1980 resolves 0.24 us, in which a satellite moves by a millimetre and its signal by 70 m;
seconds of a week resolve 0.1 ns. So two numbers go through all models, and only differences are one.
"""

from __future__ import annotations

import numpy as np

WEEK = 604800.0
"""Seconds in a week."""


def elapsed(week, second, reference_week, reference_second):
    """Seconds from one time to another, IS-GPS-200 table 20-IV (t_k), across any number of weeks."""
    return (week - reference_week) * WEEK + (second - reference_second)


def normal(week, second):
    """The same time with 0 <= second < WEEK."""
    weeks = np.floor(second / WEEK)
    return week + weeks, second - weeks * WEEK
