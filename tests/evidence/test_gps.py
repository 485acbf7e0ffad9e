"""Flights with GPS at two levels: what differs, or is not as honest as it says, is said by its own claim."""

from __future__ import annotations

import numpy as np

from evidence.sensors import gps

SECONDS = 1000


def flown(error=100.0, after=None, heading=0.1, sigma=1.0, position_sigma=70.7):
    """Two flights with constant errors, m and deg, those of the heading another one ``after`` GPS is lost."""
    shape = (2, SECONDS)
    turned = np.full(shape, heading)
    turned[:, gps.LOST :] = heading if after is None else after
    values = {
        "evaluation.north_error": error, "evaluation.east_error": 0.0, gps.NORTH_EAST: 0.0,
        "navigator.north_sigma": position_sigma, "navigator.east_sigma": position_sigma,
        "aircraft.heading": np.pi - 0.001, "ahrs.attitude.heading_sigma": np.radians(sigma),
    }  # fmt: skip
    made = {name: np.full(shape, value) for name, value in values.items()}
    told = made["aircraft.heading"] + np.radians(turned)
    return gps.Flights(made | {"ahrs.attitude.heading": (told + np.pi) % (2.0 * np.pi) - np.pi})


def held(**changed):
    flights = {name: flown() for name in gps.VARIANTS} | changed
    return [claim.holds for claim in gps.claims(flights)]


def test_each_claim_is_missed_by_what_it_speaks_of_and_by_nothing_else():
    assert all(held())
    wrong = {
        0: {"signals": flown(error=110.0, position_sigma=77.8)},
        1: {"three antennas": flown(heading=0.3, after=0.1)},
        2: {"positions": flown(after=4.0)},
        6: {"signals": flown(position_sigma=50.0)},
        10: {"three antennas": flown(position_sigma=100.0)},
    }
    for missed, changed in wrong.items():
        assert held(**changed) == [k != missed for k in range(11)], missed


def test_heading_is_told_apart_across_the_seam():
    np.testing.assert_allclose(flown(heading=2.0).heading, 2.0, rtol=1e-9)
