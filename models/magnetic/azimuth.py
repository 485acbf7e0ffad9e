"""Magnetic azimuth detector: a flux valve that hangs level, and what its heading is off by.

AGARD CP-298, P1, takes magnetic heading from such an instrument, and true heading with the variation of a table; its
error there is a first-order Markov process (7). The thesis has the same and white noise, (3.81)-(3.86), and the
deviation that iron aboard makes, (3.52).
"""

from __future__ import annotations

import numpy as np


def hanging(specific_force_b, vertical_b):
    """Unit vector down in b for what hangs on a thread: against the specific force.

    Where there is none, along the true vertical ``vertical_b``: not connected.
    """
    size = np.sqrt(np.sum(specific_force_b * specific_force_b))
    felt = size > 0.0
    return np.where(felt, -specific_force_b / np.where(felt, size, 1.0), vertical_b)


def heading(field_b, down_b):
    """Heading from magnetic north, rad: thesis (2.3) in the plane across ``down_b``, in which the detector measures.

    Its axes there are the forward axis laid into the plane, and what is to the right of it; ``down_b`` is a unit
    vector, the true vertical in unaccelerated flight.
    """
    forward_b = np.array([1.0, 0.0, 0.0])
    right_b = np.cross(down_b, forward_b)
    ahead_b = np.cross(right_b, down_b)
    return np.arctan2(-np.sum(field_b * right_b), np.sum(field_b * ahead_b))


def deviation(magnetic_heading, coefficients):
    """A + B sin psi + C cos psi + D sin 2 psi + E cos 2 psi, rad: what iron adds to the heading, thesis (3.52)."""
    a, b, c, d, e = (coefficients[i] for i in range(5))
    once, twice = magnetic_heading, 2.0 * magnetic_heading
    return a + b * np.sin(once) + c * np.cos(once) + d * np.sin(twice) + e * np.cos(twice)
