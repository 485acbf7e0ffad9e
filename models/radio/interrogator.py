"""DME interrogator in the aircraft: search, lock-in, track, memory and loss, for each station.

Thesis section 2.5.5 and Fig 2.10: 135 pulse pairs a second until it has locked in, which takes 4 s, then 25. Stations
are arrays over their number.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from navfmu.constants import KNOT

SEARCH_RATE = 135.0
"""Interrogations of a receiver that searches, pulse pairs a second, thesis section 2.5.5."""
TRACK_RATE = 25.0
"""Interrogations of a receiver that tracks, pulse pairs a second, thesis section 2.5.5."""
TIRED_RATE = 30.0
"""Interrogations of a receiver that has searched for TIRED_AFTER, Annex 10, volume I, 3.5.3.4.4."""
TIRED_AFTER = 30.0
TRACKING_SPEED = 1000.0 * KNOT
"""How fast a range may change and be followed, m/s (own choice: 1000 kn)."""


class Phase(IntEnum):
    """What a receiver does about a station."""

    IDLE = 1
    SEARCH = 2
    TRACK = 3
    MEMORY = 4


def rate(interrogated, tracking, searching, lock_in):
    """Interrogations of each station, pulse pairs a second; ``tracking`` and ``searching`` tell for how long, s."""
    search = np.where(searching < TIRED_AFTER - 1.0e-9, SEARCH_RATE, TIRED_RATE)
    return np.where(interrogated, np.where(tracking < lock_in - 1.0e-6, search, TRACK_RATE), 0.0)


def replied(efficiency, interrogations, window, luck):
    """Share of replies that a receiver finds which averages them over ``window`` (s), exponentially.

    Each of ``interrogations`` (pulse pairs a second) is answered with the chance p = ``efficiency``. The average has
    the variance p (1 - p) / (2 rate window) and forgets with exp(-t / window); ``luck`` is a Gauss-Markov process of
    that time and sigma 1. Its mean is taken to follow p at once: a receiver sees in no time that nothing comes.
    """
    count = np.maximum(2.0 * interrogations * window, 1.0)
    return efficiency + np.sqrt(efficiency * (1.0 - efficiency) / count) * luck


def in_gate(distance, followed, gate, since):
    """Whether replies at ``distance`` come where the receiver looks for them: ``gate`` to either side of where it had
    ``followed`` them to, and what an aircraft can fly in the time ``since``, s."""
    return np.abs(distance - followed) <= gate + TRACKING_SPEED * since


def tracking_time(before, kept, period):
    """How long each station has been interrogated and has answered, or been remembered, without a break, s."""
    return np.where(kept, before + period, 0.0)


def remembered(interrogated, tracking, silent, lock_in, memory):
    """Where a receiver that had locked in waits for replies, which have been missing for ``silent``, s."""
    locked = (tracking > 0.0) & (tracking >= lock_in - 1.0e-6)
    return interrogated & locked & (silent <= memory + 1.0e-9)


def phase(interrogated, before, kept, waiting, lock_in):
    """What was done about each station in a step: ``before`` for how long it had been tracked, s, and whether it was
    ``kept``, ``waiting`` for replies or not."""
    locked = kept & (before >= lock_in - 1.0e-6)
    return np.where(
        interrogated, np.where(waiting, Phase.MEMORY, np.where(locked, Phase.TRACK, Phase.SEARCH)), Phase.IDLE
    )
