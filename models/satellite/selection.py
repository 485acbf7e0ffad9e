"""Which of a satellite's ephemerides a receiver uses: the nearest in time of neighbours in a table."""

from __future__ import annotations

import numpy as np

from models.satellite.ephemeris import Ephemeris
from models.satellite.gps_time import WEEK, elapsed

APART = 1e4
"""Weeks between the places of one satellite and of the next."""
STEP = 1e-9
"""Weeks, 0.6 ms: a place so much before that of a row is another row's."""


def place(prn, week, second):
    """Where a satellite's row for a time belongs in a table, in weeks; it is found within 0.1 ms."""
    return APART * prn + week + second / WEEK


def finder(rows):
    """What finds ephemerides in rows (n, columns) as a ``Table`` does: the one at or before a place, and the next."""

    def find(place):
        at = np.clip(np.searchsorted(rows[:, 0], place, side="right") - 1, 0, len(rows) - 2)
        return Ephemeris.of(rows[at]), Ephemeris.of(rows[at + 1])

    return find


def around(find, prn, week, second):
    """Two ephemerides before a time and two after it; ``find`` is that of :func:`finder`.

    Two would do if all were sent in the order of their t_oe. Of an upload the new one is sent after the old one and may
    be for a time that is 16 s earlier; then the nearest one that was sent is the second.
    """
    earlier, later = find(place(prn, week, second))
    before, _ = find(earlier.place - STEP)
    _, behind = find(later.place)
    return before, earlier, later, behind


def nearest(among, prn, week, second, future=True):
    """The nearest one by its t_oe of some ephemerides in the order of these; of two as near the later one.

    Rows of another satellite do not count. Files hold what a receiver had not heard yet: with ``future`` False an
    ephemeris counts from when it was sent. Which one is near enough, :func:`usable` tells.
    """
    best, *others = among
    away = _distance(best, prn, week, second, future)
    for other in others:
        distance = _distance(other, prn, week, second, future)
        best = Ephemeris(*(np.where(distance <= away, b, a) for a, b in zip(best, other, strict=True)))
        away = np.minimum(away, distance)
    return best


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
