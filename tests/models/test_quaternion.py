"""Quaternions against SciPy's Rotation and closed forms."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.attitude import attitude, quaternion
from models.inertial import cone

RNG = np.random.default_rng(9)
VECTORS = RNG.standard_normal((20, 3)) * np.logspace(-7, np.log10(1.5), 20)[:, None]


def scalar_first(rotation):
    return np.roll(rotation.as_quat(), 1)


def same(got, wanted, atol=1e-15):
    """Two quaternions of one rotation: q and -q are the same."""
    np.testing.assert_allclose(got * np.sign(got @ wanted), wanted, rtol=0, atol=atol)


@pytest.mark.parametrize("vector", VECTORS)
def test_rotation_vectors_agree_with_scipy_and_return(vector):
    """Small ones too: a series of the wrong order, or half the angle, would show."""
    q = quaternion.of_rotation(vector)
    same(q, scalar_first(Rotation.from_rotvec(vector)))
    np.testing.assert_allclose(quaternion.dcm(q), Rotation.from_rotvec(vector).as_matrix(), rtol=0, atol=1e-15)
    back = Rotation.from_rotvec(vector).as_rotvec()
    np.testing.assert_allclose(quaternion.rotation(q), back, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(quaternion.rotation(-q), back, rtol=1e-12, atol=1e-15)


def test_no_rotation_is_the_identity():
    assert quaternion.of_rotation(np.zeros(3)).tolist() == [1.0, 0.0, 0.0, 0.0]
    assert quaternion.rotation(np.array([1.0, 0.0, 0.0, 0.0])).tolist() == [0.0, 0.0, 0.0]


def test_products_are_rotations_one_after_the_other():
    """The order matters: right first. The inverse takes the rotation back."""
    for one, other in zip(VECTORS[10:], VECTORS[9::-1], strict=True):
        a, b = Rotation.from_rotvec(one), Rotation.from_rotvec(other + 1.0)
        p, q = scalar_first(a), scalar_first(b)
        same(quaternion.product(p, q), scalar_first(a * b))
        same(quaternion.product(quaternion.inverse(p), quaternion.product(p, q)), q)


def test_euler_angles_and_matrices_are_those_of_the_direction_cosines():
    """At 90 degrees of pitch, too."""
    for angles in [*RNG.uniform(-3.0, 3.0, (20, 3)), (0.3, 0.5 * np.pi, -2.0), (0.0, -0.5 * np.pi, 1.0)]:
        q = quaternion.of_euler(*(np.float64(a) for a in angles))
        np.testing.assert_allclose(quaternion.dcm(q), attitude.dcm(*angles), rtol=0, atol=2e-15)
        assert np.sum(q * q) == pytest.approx(1.0, abs=1e-15)
    assert np.linalg.norm(quaternion.unit(np.array([3.0, -2.0, 0.5, 1.0]))) == pytest.approx(1.0, abs=1e-15)


def test_rates_of_a_cone_integrate_to_its_attitude():
    """A product in the wrong order turns about axes of n: after one round of the cone it is off by degrees.

    Each step is a constant rate, the mean of two: the error goes with the square of the step.
    """
    half, frequency = np.radians(20.0), 2.0 * np.pi
    errors = []
    for step in (1e-3, 5e-4):
        times = np.arange(0.0, 1.0 + 0.5 * step, step)
        rates = cone.rate(half, frequency, times)
        q = cone.quaternion(half, frequency, 0.0)
        for before, after in itertools.pairwise(rates):
            q = quaternion.product(q, quaternion.of_rotation(0.5 * (before + after) * step))
        left = quaternion.product(cone.quaternion(half, frequency, times[-1]), quaternion.inverse(q))
        errors.append(np.linalg.norm(quaternion.rotation(left)))
    assert errors[0] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
