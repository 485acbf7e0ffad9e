"""A receiver with fewer channels than satellites, which follows them in turn: whose turn it is, and what is held."""

from __future__ import annotations

import numpy as np


def following(tracked, last, channels):
    """Whose turn is next: so many of the ``tracked`` places as there are channels, in a circle from behind ``last``.

    All have their turn at once where there are channels enough. Returns truth values, shape (places,), and the last of
    them.
    """
    place = np.arange(tracked.shape[0])
    behind = np.mod(place - last - 1, tracked.shape[0])
    rank = np.sum(np.where(tracked & (behind < behind[:, None]), 1, 0), axis=1)
    turn = tracked & (rank < channels)
    farthest = np.argmax(np.where(turn, behind, -1))
    return turn, np.where(np.any(turn), farthest, last)


def carried(pseudorange, range_rate, age):
    """A pseudorange, m, measured ``age`` s ago, where its rate (m/s) has taken it: an acceleration a along the line of
    sight leaves a age^2 / 2."""
    return pseudorange + range_rate * age
