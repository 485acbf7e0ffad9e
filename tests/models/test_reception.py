"""Satellites at sending, carried on from one state, beside the orbit itself at that time."""

from __future__ import annotations

import numpy as np

from models.earth import earth
from models.satellite import broadcast, reception, sight, slots
from models.satellite.ephemeris import Ephemeris


def test_a_state_carried_on_is_that_of_the_time_of_sending():
    """Orbits with an eccentricity of 0.02 and clocks that drift. Without acceleration velocities are 5 mm/s off,
    without the time of travel positions 40 m."""
    orbits = Ephemeris.of(slots.constellation())._replace(
        eccentricity=np.full(24, 0.02), clock_bias=np.full(24, 1e-4), clock_drift=np.full(24, 1e-9)
    )
    week, second = 703, 4 * 86400.0 + 5000.0
    here = earth.to_ecef(0.66, -2.1, 1500.0)
    time, position, velocity, clock, rate = reception.received(orbits, week, second, here)
    distance, unit_e = sight.ranges(here, position)
    seen = unit_e @ (here / np.linalg.norm(here)) > 0.0
    assert 6 <= np.sum(seen) <= 14
    np.testing.assert_allclose(time[seen], distance[seen] / 299792458.0, rtol=0.0, atol=1e-12)
    truth = broadcast.at(orbits, week, second - time)
    np.testing.assert_allclose(position[seen], truth[0][seen], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(velocity[seen], truth[1][seen], rtol=0.0, atol=2e-5)
    np.testing.assert_allclose(clock[seen], truth[2][seen], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(rate[seen], truth[3][seen], rtol=0.0, atol=1e-14)
