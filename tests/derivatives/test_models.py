"""Matrices that stand in the models, written by hand, are the derivatives of the equations beside them."""

import numpy as np
import pytest

from models.attitude import ahrs, attitude
from models.earth import earth
from models.navigation import navigator
from models.radio import dme
from navfmu.constants import STANDARD_GRAVITY
from navfmu.derivatives import jacobian, value_and_jacobian

SEEDS = range(5)


def close(found, truth, relative=1e-12):
    np.testing.assert_allclose(found, truth, rtol=0.0, atol=relative * np.max(np.abs(truth)))


@pytest.mark.parametrize("seed", SEEDS)
def test_ranges_have_direction_cosines_as_derivatives(seed):
    """By latitude and longitude times the radii, and by height: rows of H (6.36)."""
    rng = np.random.default_rng(seed)
    latitude, longitude, altitude = rng.uniform(-1.3, 1.3), rng.uniform(-3.0, 3.0), rng.uniform(0.0, 1e4)
    stations = latitude + rng.normal(size=4) * 0.01, longitude + rng.normal(size=4) * 0.01, rng.uniform(0, 2e3, 4)
    ranges, found = value_and_jacobian(
        lambda p: dme.slant_range(*p, *stations), np.array([latitude, longitude, altitude])
    )
    sight = dme.line_of_sight(latitude, longitude, altitude, *stations)
    north, east, length = navigator.direction_cosines(latitude, longitude, sight)
    meridian, vertical = earth.radii(latitude)
    close(ranges, length)
    close(found[:, 0], north * (meridian + altitude), 1e-10)  # cosines of differences of 1e5 m in 6e6 m
    close(found[:, 1], east * (vertical + altitude) * np.cos(latitude), 1e-10)
    close(found[:, 2] ** 2, 1.0 - north**2 - east**2, 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_velocity_has_the_rows_of_the_navigator(seed):
    """By wind, its mean, and the air velocity along and across the nose: V for the speed, V psi for the heading."""
    rng = np.random.default_rng(seed)
    heading, speed = rng.uniform(-3.0, 3.0), 60.0

    def velocity(x):
        wind, mean, along, across = x[:2], x[2:4], x[4], x[5]
        return wind + mean + navigator.air_velocity(speed + along, heading + across / speed)

    close(jacobian(velocity, np.zeros(6)), navigator.velocity_rows(heading))


@pytest.mark.parametrize("seed", SEEDS)
def test_position_after_a_time_and_its_inverse(seed):
    """Metres that are flown come back as metres: offset of advance is the time, for a short one."""
    rng = np.random.default_rng(seed)
    here = np.array([rng.uniform(-1.2, 1.2), rng.uniform(-3.0, 3.0)])

    def flown(velocity):
        latitude, longitude = navigator.advance(*here, 1e3, velocity, 2.0)
        return navigator.offset(*here, 1e3, latitude, longitude)

    close(jacobian(flown, rng.normal(size=2) * 50.0), 2.0 * np.eye(2), 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_ahrs_propagates_by_the_derivatives_of_eulers_rates(seed):
    rng = np.random.default_rng(seed)
    angles, rate, time = rng.normal(size=3) * 0.4, rng.normal(size=3) * 0.1, 0.02

    def later(x):
        return x[:3] + time * attitude.euler_rates(rate - x[3:], x[0], x[1])

    found = jacobian(later, np.concatenate([angles, np.zeros(3)]))
    close(found, ahrs.dynamics(angles[0], angles[1], rate, time), 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_tilt_rows_are_derivatives_of_the_specific_force(seed):
    rng = np.random.default_rng(seed)
    roll, pitch, airspeed, rate = 0.3 * rng.normal(), 0.3 * rng.normal(), 60.0, 0.1 * rng.normal(size=3)

    def expected(x):
        """(2) over g: angles plus their errors; rate and airspeed, which are measured, minus theirs."""
        turning = (airspeed - x[10]) * (rate[2] - x[5]) / STANDARD_GRAVITY
        return np.array([turning - np.sin(roll + x[0]) * np.cos(pitch + x[1]), np.sin(pitch + x[1])])

    close(jacobian(expected, np.zeros(11)), ahrs.tilt_rows(airspeed, rate[2], roll, pitch))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_field_rows_are_derivatives_of_the_direction_of_the_field(seed):
    rng = np.random.default_rng(seed)
    roll, pitch, heading, dip = rng.normal(size=4) * 0.5
    iron = 0.1 * rng.normal(size=3)

    def direction(x):
        field = (
            attitude.dcm(roll + x[0], pitch + x[1], heading + x[2]).T @ ahrs.field_n(dip + x[6], 0.2) + iron + x[7:10]
        )
        return field / np.sqrt(np.sum(field * field))

    unit, rows = ahrs.field_rows(roll, pitch, heading, dip, 0.2, iron)
    value, found = value_and_jacobian(direction, np.zeros(11))
    close(value, unit, 1e-15)
    close(found, rows, 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_body_rates_are_linear_in_the_rates_of_the_angles(seed):
    """body_rate is the inverse of euler_rates (4.4), so their derivatives are inverse matrices."""
    rng = np.random.default_rng(seed)
    roll, pitch = rng.normal(size=2) * 0.4
    sines = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    there = jacobian(lambda r: attitude.body_rate(*r, *sines), np.zeros(3))
    back = jacobian(lambda r: attitude.euler_rates(r, roll, pitch), np.zeros(3))
    np.testing.assert_allclose(there @ back, np.eye(3), atol=1e-15)
