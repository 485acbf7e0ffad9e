"""Position, velocity and time from pseudoranges and range rates: weighted least squares by Gauss and Newton.

Rows are measurements: one for each satellite, and last the altitude, which may take the place of a satellite
(AGARD CP-298 (1981), Peterson). A row that is not used has the weight 0. Unknowns are north, east, down and the
receiver's clock, all in m (or m/s).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from models.earth import earth
from models.satellite import saastamoinen, sight


class Measured(NamedTuple):
    """What was measured of satellites, and the altitude."""

    satellite_e: Any
    """Positions at transmission, m, shape (satellites, 3)."""
    values: Any
    """Pseudoranges free of satellite clocks and of the ionosphere, and last the altitude, m."""
    slant: Any
    """The troposphere's delay over that at the zenith, shape (satellites,); 0 where it is no part of the range."""
    humidity: Any


def design(unit_n):
    """H, shape (satellites + 1, 4): how the measurements change with north, east, down and clock.

    ``unit_n`` are unit vectors to the satellites in n, shape (satellites, 3). The last row is the altitude.
    """
    clock = np.ones((unit_n.shape[0], 1))
    altitude = np.array([[0.0, 0.0, -1.0, 0.0]])
    return np.concatenate([np.concatenate([-unit_n, clock], axis=1), altitude])


SINGULAR = 1e-12
"""Determinant of H' W H over the product of its diagonal, below which rows do not tell four unknowns: a GDOP of some
thousand."""


def covariance(h, weight):
    """(H' W H)^-1, shape (4, 4), of rows ``h`` with the diagonal ``weight`` of W; zeros where it has no inverse.

    Then nothing moves by an :func:`estimate`, and there is no dilution of precision. The inverse is that of blocks of
    north and east, and of down and clock.
    """
    normal = h.T @ (weight[:, None] * h)
    level, across, rest = normal[:2, :2], normal[:2, 2:], normal[2:, 2:]
    level, level_size = _inverse(level)
    taken = level @ across
    rest, rest_size = _inverse(rest - across.T @ taken)
    sizes = normal[0, 0] * normal[1, 1] * normal[2, 2] * normal[3, 3]
    solvable = np.logical_and(np.sum(weight > 0.0) > 3.5, level_size * rest_size > SINGULAR * sizes)
    between = -taken @ rest
    p = np.concatenate(
        [np.concatenate([level - between @ taken.T, between], axis=1), np.concatenate([between.T, rest], axis=1)]
    )
    return np.where(solvable, p, 0.0)


def _inverse(two):
    """Inverse of a symmetric matrix (2, 2), of zeros where it has none, and its determinant."""
    size = two[0, 0] * two[1, 1] - two[1, 0] * two[1, 0]
    turned = np.array([[two[1, 1], -two[1, 0]], [-two[1, 0], two[0, 0]]])
    return np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0) * turned, size


def estimate(p, h, weight, misfit):
    """Unknowns from what is measured beyond what is known, shape (rows,): P H' W y, P by :func:`covariance`."""
    return p @ (h.T @ (weight * misfit))


def start(satellite_e, used):
    """A point on the earth from which all used satellites are seen: below the middle of them."""
    middle = np.sum(np.where(used[:, None], satellite_e, 0.0), axis=0)
    size = np.sqrt(np.sum(middle * middle))
    below = middle * (earth.EQUATORIAL_RADIUS / np.where(size > 0.0, size, 1.0))
    return np.where(size > 0.0, below, np.array([earth.EQUATORIAL_RADIUS, 0.0, 0.0]))


def compare(position_e, clock, measured):
    """H at a position (m, shape (3,)) and clock (m), what is measured beyond that there, C_ne, and unit vectors in e.

    The troposphere's delay is that of the height of the position, which is first tens of metres off: a centimetre.
    """
    distance, unit_e = sight.ranges(position_e, measured.satellite_e)
    latitude, longitude, altitude = earth.from_ecef(position_e)
    rotation = earth.north_east_down(latitude, longitude)
    hydrostatic, wet = saastamoinen.zenith(latitude, altitude, measured.humidity)
    expected = distance + clock + measured.slant * (hydrostatic + wet)
    misfit = measured.values - np.concatenate([expected, np.array([altitude])])
    return design(unit_e @ rotation.T), misfit, rotation, unit_e


def step(position_e, clock, measured, weight):
    """Position and clock after one step of Gauss and Newton."""
    h, misfit, rotation, _ = compare(position_e, clock, measured)
    return moved(position_e, clock, estimate(covariance(h, weight), h, weight, misfit), rotation)


def moved(position_e, clock, by, rotation):
    """Position and clock that are moved by north, east, down and clock, (4,)."""
    return position_e + by[:3] @ rotation, clock + by[3]


def velocity(unit_e, position_e, satellite_velocity_e, range_rate, h, weight, rotation):
    """Velocity in n, m/s, and rate of the clock, m/s, from rates of the pseudoranges, m/s, free of satellite clocks.

    ``h`` and ``weight`` are those of the position; what has a weight counts as much as any other, for orbits and
    atmosphere do not spoil rates. Where an altitude takes the place of a satellite, level flight does so here; with
    four satellites it says nothing of a velocity. A satellite whose rate is no number has none here; where the others
    do not tell it, the velocity is no number either. The rates of the distances depend on the velocity by a product,
    but for 1 part in 1e5: two steps.
    """
    told = np.isfinite(range_rate + np.sum(satellite_velocity_e, axis=1))
    range_rate = np.where(told, range_rate, 0.0)
    satellite_velocity_e = np.where(told[:, None], satellite_velocity_e, 0.0)
    weight = np.where((weight > 0.0) & np.concatenate([told, np.array([True])]), 1.0, 0.0)
    enough = np.sum(weight[:-1]) > 3.5
    weight = np.concatenate([weight[:-1], np.array([np.where(enough, 0.0, weight[-1])])])
    p = covariance(h, weight)
    velocity_n, drift = np.zeros(3), 0.0
    for _ in range(2):
        left = range_rate - sight.range_rates(unit_e, position_e, velocity_n @ rotation, satellite_velocity_e) - drift
        moved = estimate(p, h, weight, np.concatenate([left, np.array([velocity_n[2]])]))
        velocity_n, drift = velocity_n + moved[:3], drift + moved[3]
    solvable = p[3, 3] > 0.0
    return np.where(solvable, velocity_n, np.nan), np.where(solvable, drift, np.nan)
