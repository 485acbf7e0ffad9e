"""A straight wire's field against Biot and Savart's integral and closed forms."""

import numpy as np
import pytest

from models.magnetic import wire


def integral(begin, end, current, count=20001):
    """mu_0 I / (4 pi) of dl x r / r^3, r from the wire to the origin: trapezoidal rule."""
    t = np.linspace(0.0, 1.0, count)
    way = -(begin + np.outer(t, end - begin))
    density = np.cross(end - begin, way) / np.linalg.norm(way, axis=1)[:, None] ** 3
    return 1e-7 * current * np.trapezoid(density, t, axis=0)


def test_field_is_the_integral_of_biot_and_savart():
    """At 50 wires: a field along the wire, one of a line without ends, or one turned the other way fail."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        begin, end = rng.uniform(-2.0, 2.0, (2, 3))
        if wire.distance(begin, end) < 0.05:
            continue
        found = wire.field(begin, end, 3.0)
        np.testing.assert_allclose(found, integral(begin, end, 3.0), rtol=1e-4, atol=1e-5 * np.linalg.norm(found))


def test_a_long_wire_has_the_field_of_amperes_law():
    """10 A to the front, 0.4 m below: 5 uT, by the right hand to the right."""
    field = wire.field(np.array([-1e3, 0.0, 0.4]), np.array([1e3, 0.0, 0.4]), 10.0)
    np.testing.assert_allclose(field, [0.0, 2e-7 * 10.0 / 0.4, 0.0], rtol=1e-6)


def test_a_return_wire_beside_it_leaves_the_field_of_a_pair():
    """mu_0 I s / (2 pi d^2) at d much larger than the space s between them."""
    far, space = 2.0, 0.002
    there = wire.field(np.array([-1e3, 0.0, far]), np.array([1e3, 0.0, far]), 10.0)
    back = wire.field(np.array([1e3, 0.0, far + space]), np.array([-1e3, 0.0, far + space]), 10.0)
    assert np.linalg.norm(there + back) == pytest.approx(2e-7 * 10.0 * space / far**2, rel=2e-3)


def test_distance_is_that_of_the_nearest_point():
    rng = np.random.default_rng(2)
    for _ in range(50):
        begin, end = rng.uniform(-2.0, 2.0, (2, 3))
        points = begin + np.outer(np.linspace(0.0, 1.0, 20001), end - begin)
        nearest = np.min(np.linalg.norm(points, axis=1))
        assert wire.distance(begin, end) == pytest.approx(nearest, abs=2e-4)
    assert wire.distance(np.array([0.0, 3.0, 4.0]), np.array([0.0, 3.0, 4.0])) == pytest.approx(5.0)
