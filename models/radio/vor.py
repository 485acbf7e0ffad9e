"""VHF omnidirectional range: the radial of a station on which the aircraft is, and what it is off by.

Thesis section 1.2.2 (a wheel of courses) and 7.3 (errors of 1 to 5 degrees). Brokof and Hurrass (AGARD CP-298) say of
azimuth by VOR that its standard deviation is nearly 2 degrees.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude

STATION_SIGMA, BEND_SIGMA, RECEIVER_SIGMA, NOISE_SIGMA = np.radians([1.0, 1.0, 1.4, 0.2])
"""Alignment of a station, bends of its courses, receiver, noise of a reading, rad: together 2 degrees; the split is own
choice."""
HIGHEST = np.radians(40.0)
"""Elevation up to which a station is to be received (ICAO Annex 10, volume I, 3.3.4); above is its cone, rad."""


def radial(azimuth, zero, station_error, bends, receiver_error, noise):
    """Radials shown, -pi to pi, rad: ``azimuth`` at each station from true north, less where its zero radial points."""
    return attitude.wrap(azimuth - zero + station_error + bends + receiver_error + noise)
