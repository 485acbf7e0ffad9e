"""The DME-aided dead reckoning filter of full order, thesis section 6.4.

To the states (5.11) of :mod:`models.navigation.reckoning` (6.24) adds the bias of each station's ranges:

    [dp_n, dp_e, dh, dV_NS, dV_EW, dpsi, dV, dR_1 .. dR_m]

nine with the thesis's two stations. F (6.26) is F_DR with -1/tau_r for each; the biases drive nothing.

Misprints: (6.35) has zeros for the biases in H, so that no range would ever tell of a bias: all that is left of (6.24)
is seven states and ranges of 7 m. Derived, H has a one in the column of its station's bias. (6.36) is that of ranges
projected on the horizontal plane; here they are slant ranges, and H has the vertical cosine beside dh. (6.39) prints
H' P H. Table 6.1 has (5 miles) / V for tau_r, (3.38) 0.5 nmi / V; (6.23) is printed a second time as (6.22).
"""

from __future__ import annotations

import numpy as np

from models.navigation import reckoning


def range_rows(north, east, up, seen):
    """H of slant ranges (6.34)-(6.36), shape (stations, states).

    Parameters
    ----------
    north, east, up
        Direction cosines of the lines of sight from the stations, shape (stations,).
    seen
        Whether a range tells of its station's bias, or (6.35) as it is printed.
    """
    stations = len(north)
    position = np.stack([north, east, up], -1)
    others = np.zeros((stations, reckoning.STATES - 3))
    return np.concatenate([position, others, np.eye(stations) * np.where(seen, 1.0, 0.0)], -1)
