"""Which stations are asked, and when: turns of thesis Fig 2.10 among the stations that are selected."""

from __future__ import annotations

from itertools import combinations

import numpy as np

PLACES = 5
PAIRS = np.array([[place in pair for place in range(PLACES)] for pair in combinations(range(PLACES), 2)])
"""The ten pairs of five places, truth values (10, 5)."""
_FIRST, _SECOND = np.array([pair for pair in combinations(range(PLACES), 2)]).T


def slot(time, interval):
    """Number of measurements due by ``time`` (s) where one is due every ``interval`` s; 1e-9 guards whole multiples."""
    return np.floor(time / interval + 1.0e-9)


def due_now(time, period, interval):
    """Whether a measurement is due that was not a ``period`` (s) ago."""
    return slot(time, interval) > slot(time - period, interval)


def asked(time, period, mode, interval, dwell, selected):
    """Which stations are being interrogated, and which are due to be measured now, thesis Fig 2.10 and section 7.2.2.

    Parameters
    ----------
    time, period
        Now and the receiver's time step, s.
    mode
        1: one receiver, a measurement every ``interval``, stations in turn. 2: two receivers, two stations measured
        every ``interval`` at the same time, pairs in turn. 3: scanning receiver, all measured every step.
    interval
        Time between measurements, s; 15 s keep the load of a transponder at that of continuous tracking.
    dwell
        How long before a measurement the receiver is tuned to the station (lock-in plus ranging), s.
    selected
        The stations that take turns, truth values of shape (5,).

    Returns
    -------
    interrogated, due
        Truth values, shape (5,).
    announced
        Whether a measurement is due, of whichever station or, where none is selected, of none.
    """
    count = np.sum(np.where(selected, 1.0, 0.0))
    rank = np.cumsum(np.where(selected, 1.0, 0.0)) - 1.0
    now = due_now(time, period, interval)
    # the coming measurement, which may be this one
    coming = np.where(now, slot(time, interval), slot(time, interval) + 1.0)
    tuned = now | (coming * interval - time < dwell - 1.0e-9)
    receivers = np.where(mode == 2, 2.0, 1.0)
    place = rank - receivers * (coming - 1.0)
    count = np.maximum(count, 1.0)
    mine = place - count * np.floor(place / count + 1.0e-9) < receivers - 0.5
    scanning = mode == 3
    interrogated = selected & np.where(scanning, True, np.logical_and(mine, tuned))
    due = selected & np.where(scanning, True, np.logical_and(mine, now))
    return interrogated, due, scanning | now


def inclusion_sines(north, east):
    """|sin| of the angles at the aircraft at which the lines to the stations of each pair cross, shape (10,).

    ``north``, ``east`` are components of vectors along the lines, of any length, shape (5,).
    """
    length = np.sqrt(north * north + east * east)
    crossed = north[_FIRST] * east[_SECOND] - east[_FIRST] * north[_SECOND]
    return np.abs(crossed) / np.maximum(length[_FIRST] * length[_SECOND], 1.0e-9)


def best_pair(north, east, usable, least_inclusion):
    """The pair of ``usable`` stations whose lines cross nearest to a right angle, truth values (5,).

    None where the angle is less than ``least_inclusion`` (rad) or more than pi less that: the error of a position
    from two ranges is as 1 / sin of it, and from 30 to 150 degrees are taken, RNAV practice (FAA AC 90-100A).
    """
    sines = np.where(usable[_FIRST] & usable[_SECOND], inclusion_sines(north, east), -1.0)
    best = np.argmax(sines)
    chosen = np.any(PAIRS & (np.arange(len(PAIRS)) == best)[:, None], axis=0)
    return chosen & (np.max(sines) >= np.sin(least_inclusion) - 1.0e-9)
