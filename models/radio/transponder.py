"""DME ground transponder: its delay, what it can answer, and what a wrong delay is to a range.

Thesis section 2.5.5 (50 us, 3000 pulse pairs a second, some 100 aircraft: 95 that track and 5 that search) and 3.9
(self-check); ICAO Annex 10, volume I, section 3.5 (dead time, monitor, DME/P). Stations are arrays over their number.
"""

from __future__ import annotations

import numpy as np

from models.radio import interrogator
from navfmu.constants import NAUTICAL_MILE, SPEED_OF_LIGHT

CAPACITY = 3000.0
"""Replies that a transponder can give, pulse pairs a second, thesis section 2.5.5."""
SEARCHING_SHARE = 0.05
"""Of the aircraft at a transponder, those that search: 5 of 100, thesis section 2.5.5."""
DEAD_TIME = 60.0e-6
"""How long a transponder is deaf after an interrogation, s; it keeps echoes of its own replies out."""
MONITOR_LIMIT = 1.0e-6
"""Error of the delay at which the monitor takes a station off the air, s, Annex 10, 3.5.4.7.2.2."""
PRECISE_RANGE = 7.0 * NAUTICAL_MILE
"""Distance within which DME/P is precise, m, thesis section 3.9 and Annex 10, 3.5.3.7.1."""


def range_of(time):
    """Range in m that is read of a ``time`` in s: one of 1 us is 150 m. Of a round trip take the 50 us of
    the transponder off before."""
    return 0.5 * SPEED_OF_LIGHT * time


def drifted(before, rate, period):
    """Delay in s that has drifted at ``rate`` (s/s) for another ``period``; at no rate it is set right."""
    return np.where(rate != 0.0, before + rate * period, 0.0)


def load(aircraft, searching_share=SEARCHING_SHARE):
    """Interrogations of so many ``aircraft``, pulse pairs a second: 135 of those that search, 25 of those that
    track."""
    rate = searching_share * interrogator.SEARCH_RATE + (1.0 - searching_share) * interrogator.TRACK_RATE
    return aircraft * rate


def efficiency(interrogations, capacity=CAPACITY, dead_time=DEAD_TIME):
    """Share of ``interrogations`` (pulse pairs a second) that are answered.

    They come at random. Each that is heard makes the transponder deaf for ``dead_time``, so that 1 / (1 + rate dead
    time) are heard; and of those, replies at ``capacity`` are given at most. That a transponder in such need turns its
    sensitivity down, and so answers those who are near, is not modelled: all fare alike.
    """
    heard = 1.0 / (1.0 + interrogations * dead_time)
    return np.minimum(heard, capacity / np.maximum(interrogations, 1.0e-9))


def precise_sigma(distance):
    """Standard deviation in m of what varies slowly in DME/P: half of 30 m + 11 m a nautical mile.

    Annex 10, table B, standard 1: 250 m at 20 nmi, 85 m at 5 nmi, 30 m at the threshold (95 %), which is one line.
    """
    return 0.5 * (30.0 + 11.0 * distance / NAUTICAL_MILE)
