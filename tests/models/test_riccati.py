"""Covariances at rest against SciPy's solution of the discrete Riccati equation."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from models.attitude import gyro_axis
from models.filters import riccati


def at_rest(transition, noise, row, variance):
    return solve_discrete_are(transition.T, np.reshape(row, (-1, 1)), noise, np.array([[variance]]))


@pytest.mark.parametrize("seed", range(5))
def test_covariance_is_that_of_scipy(seed):
    """Four states that are driven by others, and one that grows without a measurement."""
    rng = np.random.default_rng(seed)
    transition = np.triu(0.3 * rng.standard_normal((4, 4)), 1) + np.diag([1.0, 0.9, 1.05, 0.5])
    half = rng.standard_normal((4, 4))
    noise, row, variance = half @ half.T, rng.standard_normal(4), 0.5
    expected = at_rest(transition, noise, row, variance)
    found = riccati.steady(transition, noise, row, variance)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(
        riccati.gain(found, row, variance), expected @ row / (row @ expected @ row + variance), rtol=1e-7, atol=1e-10
    )


@pytest.mark.parametrize("slowness", [1e-4, 1e-2, 1.0, 100.0])
def test_gains_of_an_axis_are_those_of_scipy(slowness):
    """Also of biases that take hours to settle: 1e5 updates of a recursion would not be enough for the slowest."""
    angle, bias, sigma = 3e-8, 1e-9 * slowness**2, np.radians(0.25)
    before = at_rest(gyro_axis.transition(0.5), gyro_axis.noise(angle, bias, 0.5), gyro_axis.ANGLE, sigma**2)
    gain, after = gyro_axis.scheduled(angle, bias, sigma, 0.5)
    np.testing.assert_allclose(gain, before[:, 0] / (before[0, 0] + sigma**2), rtol=1e-6)
    np.testing.assert_allclose(after, before - np.outer(gain, before[0]), rtol=1e-6)


def test_noise_is_that_of_the_two_integrals():
    """Van Loan, *IEEE Trans. Autom. Control* AC-23 (1978), p. 395, with SciPy's exponential."""
    from scipy.linalg import expm

    angle, bias, time = 0.3, 0.7, 2.0
    f = np.array([[0.0, -1.0], [0.0, 0.0]])
    block = expm(time * np.block([[-f, np.diag([angle, bias])], [np.zeros((2, 2)), f.T]]))
    np.testing.assert_allclose(gyro_axis.transition(time), block[2:, 2:].T)
    np.testing.assert_allclose(gyro_axis.noise(angle, bias, time), block[2:, 2:].T @ block[:2, 2:])
    driven = np.diag([0.5, 0.5, 0.5])
    whole = gyro_axis.noises(driven, angle * time * np.ones(3), bias, time)
    scale = np.diag([0.5, 1.0])
    np.testing.assert_allclose(whole[np.ix_([1, 4], [1, 4])], scale @ gyro_axis.noise(angle, bias, time) @ scale)
