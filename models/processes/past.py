"""A short past of what goes on between samples: what a measurement is compared with that comes late.

A ring of a few moments, the newest first. Between them it is linear, before the oldest it holds. Moments are kept
`spacing` apart, so a few reach as far back as is asked for, whatever the period of what is remembered.
"""

from __future__ import annotations

import numpy as np

SAME = 1.0e-6
"""Times that differ by less are one, s."""


def remember(times, values, time, value, spacing):
    """The past with a ``value`` (quantities) at a ``time``, s, as its newest moment.

    The newest so far stays where it is at least ``spacing`` s later than the one before it; else the new one takes its
    place.

    Parameters
    ----------
    times
        Of the moments, s, shape (moments,), the newest first.
    values
        At these, shape (moments, quantities).

    Returns
    -------
    Times and values, with as many moments.
    """
    stays = times[0] - times[1] >= spacing - SAME
    older = np.where(stays, times[:-1], times[1:])
    older_values = np.where(stays, values[:-1], values[1:])
    return np.concatenate([np.stack([time]), older]), np.concatenate([np.stack([value]), older_values])


def at(times, values, moment):
    """What it was at a ``moment``, s, shape (quantities,): the bits of the newest value from its moment on."""
    back, _ = _reach(times, moment)
    return values[0] + np.sum(back[:, None] * (values[1:] - values[:-1]), axis=0)


def since(times, values, moment):
    """Integral of what it was less what it is by its newest value, from a ``moment`` to the newest, in units of the
    values times s: what carrying the newest value back over that time leaves out. 0 for what does not change."""
    back, interval = _reach(times, moment)
    less = values - values[0]
    within = (back * interval)[:, None] * (less[:-1] + 0.5 * back[:, None] * (less[1:] - less[:-1]))
    return np.sum(within, axis=0) + np.maximum(times[-1] - moment, 0.0) * less[-1]


def _reach(times, moment):
    """How much of each interval lies after a ``moment``, in parts of it, and its length, s; shape (moments - 1,)."""
    interval = np.maximum(times[:-1] - times[1:], SAME)
    return np.minimum(np.maximum((times[:-1] - moment) / interval, 0.0), 1.0), interval
