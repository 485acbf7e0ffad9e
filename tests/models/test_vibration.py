"""Vibration: it leads nowhere, it is rectified as the closed forms say, and what order of coning does about it."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.inertial.imu import Imu
from models.inertial import coning, sculling, vibration
from tests.models.native import Native
from tests.models.rotation import matrix, together
from tests.models.test_coning import error_by_formula
from tests.models.test_imu import QUIET

S, C = np.array([1e-3, 2e-4, 0.0]), np.array([-3e-4, 8e-4, 2e-4])
P, Q = np.array([0.0, 2.0, 1.0]), np.array([0.5, 0.0, -1.0])
W = 2 * np.pi * 40.0
STILL = {
    "vibration_swing_sine": 0.0,
    "vibration_swing_cosine": 0.0,
    "vibration_shake_sine": 0.0,
    "vibration_shake_cosine": 0.0,
    "accelerometer_rectification": 0.0,
}


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def gauss(turns: int, steps: int):
    """Intervals of whole turns, with nodes and weights of Gauss's rule in each."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    edges = np.linspace(0.0, turns * 2 * np.pi / W, turns * steps + 1)
    half = 0.5 * (edges[1] - edges[0])
    return [(edge + half + half * nodes, half * weights) for edge in edges[:-1]]


def test_a_vibrating_unit_goes_nowhere():
    """Its rate and force, put together over ten turns in 400 steps each, leave it where it was and at rest.

    What is left is of higher order in the swing of 1e-3 rad: 1e-3 of coning and sculling. Either constant term left
    out, or with the other sign, would leave all of it.
    """
    attitude, velocity = [np.zeros(3)], np.zeros(3)
    matrix_now = matrix(S * np.sin(0.0) + C * np.cos(0.0))
    start = matrix_now.copy()
    for times, weights in gauss(10, 400):
        rates = np.array([vibration.rate(S, C, W, W * t) for t in times])
        forces = np.array([vibration.specific_force(S, C, P, Q, W * t) for t in times])
        angle, change = weights @ rates, weights @ forces
        velocity = velocity + matrix_now @ sculling.at_the_beginning(angle, change)
        matrix_now = matrix_now @ matrix(angle)
        attitude.append(angle)
    duration = 10 * 2 * np.pi / W
    left = together(np.array(attitude))
    coned = 0.5 * W * np.linalg.norm(np.cross(S, C)) * duration
    sculled = 0.5 * np.linalg.norm(np.cross(S, P) + np.cross(C, Q)) * duration
    assert np.linalg.norm(left) < 2e-3 * coned
    assert np.max(np.abs(matrix_now - start)) < 2e-3 * coned
    assert np.linalg.norm(velocity) < 3e-3 * sculled


def test_a_cone_is_that_of_the_closed_form():
    """Half-angle eps: eps^2 w / 2 about its axis, (A-6) of RTO MP-43 (1999), Mark and Tazartes."""
    found = vibration.rate(np.array([1e-3, 0.0, 0.0]), np.array([0.0, 1e-3, 0.0]), W, 0.3)
    np.testing.assert_allclose(found, W * np.array([1e-3 * np.cos(0.3), -1e-3 * np.sin(0.3), 0.5e-6]), rtol=1e-12)


def test_rectification_is_the_mean_of_the_square():
    turn = np.linspace(0.0, 2 * np.pi, 1001)[:-1]
    shake = np.outer(np.sin(turn), P) + np.outer(np.cos(turn), Q)
    np.testing.assert_allclose(vibration.rectified(P, Q, 2e-4), 2e-4 * np.mean(shake**2, axis=0), rtol=1e-12)


def test_readings_shift_while_the_unit_vibrates_and_come_back(native):
    """F15, from 2 to 6 s at 40 Hz and 100 samples a second: five samples are two periods, whose means are exact."""
    record = ["reading.rate", "reading.specific_force"]
    parameters = {"seed": 8, "accelerometer_rectification": 2e-4}
    parameters |= {"vibration_swing_sine": S, "vibration_swing_cosine": C}
    parameters |= {"vibration_shake_sine": P, "vibration_shake_cosine": Q}
    healthy = native.run(10.0, 0.01, record, parameters)
    shaken = native.run(10.0, 0.01, record, parameters, lambda t: {"vibrating": 1.995 < t < 5.995})
    for name in record:
        more = shaken[name] - healthy[name]
        np.testing.assert_array_equal(more[:201], 0.0)
        np.testing.assert_array_equal(more[601:], 0.0)
        assert np.all(np.any(more[201:601] != 0.0, axis=1))
    # scale factors of 0.75 % and mounting of 0.25 deg, five sigma, are in what is added
    rate = np.mean((shaken["reading.rate"] - healthy["reading.rate"])[201:601], axis=0)
    force = np.mean((shaken["reading.specific_force"] - healthy["reading.specific_force"])[201:601], axis=0)
    expected_rate = 0.5 * W * np.cross(S, C)
    expected_force = 0.5 * 2e-4 * (P**2 + Q**2) - 0.5 * (np.cross(S, P) + np.cross(C, Q))
    np.testing.assert_allclose(rate, expected_rate, atol=0.06 * np.linalg.norm(expected_rate))
    np.testing.assert_allclose(force, expected_force, atol=0.06 * np.linalg.norm(expected_force))


@pytest.mark.parametrize("samples", [1, 2, 3, 4])
def test_coning_is_taken_away_as_far_as_the_order_goes(native, samples):
    """A cone of 0.1 milliradians at 40 Hz, read 600 times a second: the drift is that of the closed form."""
    half_angle, step, around, each = 1e-4, 1.0 / 600.0, 15, 5
    parameters = {**QUIET, **STILL, "sample_period": step, "increment_samples": each, "coning_samples": samples}
    parameters |= {"vibration_swing_sine": (half_angle, 0.0, 0.0), "vibration_swing_cosine": (0.0, half_angle, 0.0)}
    run = native.run(10 * around * step, step, ["increment.angle"], parameters, lambda t: {"vibrating": True})
    angles = run["increment.angle"][each::each][around // each :]
    turns = len(angles) * each / around
    expected = error_by_formula(coning.before(samples - 1, "trapezoid"), 1, "trapezoid", 2 * np.pi / around)
    assert together(angles)[2] / (turns * np.pi * half_angle**2) == pytest.approx(expected, abs=3e-8)
