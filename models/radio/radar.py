"""A position that a secondary surveillance radar has measured, sent up to the aircraft: thesis section 8.2.1."""

from __future__ import annotations

import numpy as np


def displacement(north, east, up, range_error, azimuth_error):
    """North and east error in m of a position by distance, azimuth and a height that is told.

    ``north``, ``east``, ``up`` are the aircraft's place seen from the radar, m; errors in m and rad. The level distance
    is sqrt(R^2 - up^2) of the measured R: too long a one displaces outward, by R / far of its error, too large an
    azimuth to the right of it by the level distance times the angle.
    """
    far = np.maximum(np.sqrt(north * north + east * east), 1.0)
    measured = np.sqrt(far * far + up * up) + range_error
    along = np.sqrt(np.maximum(measured * measured - up * up, 0.0)) - far
    across = far * azimuth_error
    return (along * north - across * east) / far, (along * east + across * north) / far
