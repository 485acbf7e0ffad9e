"""Attitude against SciPy's Rotation and against itself."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.attitude import attitude

RNG = np.random.default_rng(4)
ANGLES = np.column_stack([RNG.uniform(-np.pi, np.pi, 50), RNG.uniform(-1.5, 1.5, 50), RNG.uniform(-np.pi, np.pi, 50)])


@pytest.mark.parametrize("angles", ANGLES[:10])
def test_dcm_agrees_with_scipy(angles):
    roll, pitch, heading = angles
    reference = Rotation.from_euler("ZYX", [heading, pitch, roll])
    np.testing.assert_allclose(attitude.dcm(*angles), reference.as_matrix(), atol=1e-14)


def test_euler_angles_return():
    for angles in ANGLES:
        np.testing.assert_allclose(attitude.euler(attitude.dcm(*angles)), angles, atol=1e-12)


def test_body_rate_is_the_derivative_of_the_dcm():
    angles, rates, dt = np.array([0.4, -0.3, 2.0]), np.array([0.05, -0.02, 0.07]), 1e-5
    change = (attitude.dcm(*(angles + rates * dt)) - attitude.dcm(*(angles - rates * dt))) / (2 * dt)
    turning = attitude.dcm(*angles).T @ change  # C' = C [w x]
    roll, pitch, _ = angles
    rate = attitude.body_rate(*rates, np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch))
    np.testing.assert_allclose(attitude.skew(rate), turning, atol=1e-9)
    np.testing.assert_allclose(attitude.euler_rates(rate, roll, pitch), rates, atol=1e-14)


def test_a_right_turn_has_positive_roll_and_yaw_rate():
    """Right wing down lowers the right wing: the body's right axis has a positive down component."""
    assert attitude.dcm(0.2, 0.0, 0.0)[2, 1] > 0
    assert attitude.dcm(0.0, 0.2, 0.0)[2, 0] < 0  # nose up
    assert attitude.dcm(0.0, 0.0, 0.2)[1, 0] > 0  # nose to the east


def test_skew_is_the_cross_product():
    a, b = np.array([1.0, -2.0, 0.5]), np.array([0.3, 4.0, -1.0])
    np.testing.assert_allclose(attitude.skew(a) @ b, np.cross(a, b), atol=1e-15)


@pytest.mark.parametrize("turns", [-3, -1, 0, 2])
def test_wrap_takes_away_whole_turns(turns):
    for angle in (-3.14, -1.0, 0.0, 2.5, 3.14):
        assert attitude.wrap(angle + turns * 2 * np.pi) == pytest.approx(angle, abs=1e-13)
