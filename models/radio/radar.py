"""A position that a secondary surveillance radar has measured, sent up to the aircraft: thesis section 8.2.1."""

from __future__ import annotations

import numpy as np


def displacement(north, east, range_error, azimuth_error):
    """North and east error in m of a position by distance and azimuth.

    ``north``, ``east`` are the aircraft's horizontal place seen from the radar, m; errors in m and rad. Too long a
    distance displaces outward, too large an azimuth to the right of it by distance times angle.
    """
    far = np.maximum(np.sqrt(north * north + east * east), 1.0)
    along, across = range_error, far * azimuth_error
    return (along * north - across * east) / far, (along * east + across * north) / far
