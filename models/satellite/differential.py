"""Differential corrections: what a receiver at a known place finds wrong with satellites, for receivers near it.

What is wrong with a satellite's orbit and clock is the same for both, and delays of the air nearly so: AGARD CP-298
(1981), Peterson, there of positions; of pseudoranges, as here, both need not see the same satellites.
"""

from __future__ import annotations

import numpy as np

from models.satellite import sight


def corrections(place_e, satellite_e, satellite_velocity_e, pseudorange, range_rate, used):
    """What another receiver adds to its pseudoranges, m, and the rate of that, m/s; shape (satellites,), 0 where not
    ``used``.

    Parameters
    ----------
    place_e
        Where the antenna of the reference station stands, m.
    satellite_e, satellite_velocity_e
        Satellites when their signals left, m and m/s, rows.
    pseudorange, range_rate
        As measured there, free of the satellites' clocks, m and m/s.

    Delays of the air are in them, so who takes them applies no model of these. The station's clock goes with the mean
    of its satellites, and what is left of it is the same for all and so in the clock of the other receiver.
    """
    velocity_e = sight.turned(satellite_velocity_e, sight.travel_time(place_e, satellite_e))
    distance, unit_e = sight.ranges(place_e, satellite_e)
    rate = sight.range_rates(unit_e, place_e, np.zeros(3), velocity_e)
    return _without_clock(distance - pseudorange, used), _without_clock(rate - range_rate, used)


def _without_clock(wrong, used):
    count = np.maximum(np.sum(np.where(used, 1.0, 0.0)), 1.0)
    return np.where(used, wrong - np.sum(np.where(used, wrong, 0.0)) / count, 0.0)
