"""Which of a satellite's ephemerides a receiver uses: the nearest in time of two neighbours in a table."""

from __future__ import annotations

import numpy as np

from models.satellite.ephemeris import Ephemeris
from models.satellite.gps_time import WEEK, elapsed

APART = 1e4
"""Weeks between the places of one satellite and of the next."""


def place(prn, week, second):
    """Where a satellite's row for a time belongs in a table, in weeks; it is found within 0.1 ms."""
    return APART * prn + week + second / WEEK


def around(rows, prn, week, second):
    """The row at or before a time and the next one, as a ``Table`` of a component finds them; rows (n, columns)."""
    at = np.searchsorted(rows[:, 0], place(prn, week, second), side="right") - 1
    at = np.clip(at, 0, len(rows) - 2)
    return Ephemeris.of(rows[at]), Ephemeris.of(rows[at + 1])


def nearest(earlier, later, prn, week, second, future=True):
    """The nearer one of two ephemerides by its t_oe; of two as near the later one.

    Rows of another satellite do not count. Files hold what a receiver had not heard yet: with ``future`` False an
    ephemeris counts from when it was sent. Which one is near enough, :func:`usable` tells.
    """
    prior, next_one = (_distance(one, prn, week, second, future) for one in (earlier, later))
    return Ephemeris(*(np.where(next_one <= prior, b, a) for a, b in zip(earlier, later, strict=True)))


def known(ephemeris, prn, week, second, future=True):
    """Whether it is an ephemeris of this satellite, and was sent by then (or ``future``)."""
    sent = elapsed(week, second, ephemeris.sent_week, ephemeris.sent) >= 0.0
    return (ephemeris.prn == prn) & np.logical_or(sent, future)


def holds(ephemeris, prn, week, second, future=True):
    """Whether it is known, and within its limit of t_oe."""
    near = np.abs(elapsed(week, second, ephemeris.toe_week, ephemeris.toe)) <= ephemeris.limit
    return known(ephemeris, prn, week, second, future) & near


def usable(ephemeris, prn, week, second, future=True):
    """Whether it holds, and the satellite calls itself healthy."""
    return holds(ephemeris, prn, week, second, future) & (ephemeris.health == 0.0)


def _distance(ephemeris, prn, week, second, future):
    away = np.abs(elapsed(week, second, ephemeris.toe_week, ephemeris.toe))
    return np.where(known(ephemeris, prn, week, second, future), away, np.inf)
