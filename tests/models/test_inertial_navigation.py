"""The strapdown equations and their error model: derivatives by differentiation, closed forms, and known flights."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from models.attitude import quaternion
from models.earth import earth
from models.navigation import inertial
from navfmu.derivatives import value_and_jacobian

POSITION = np.array([0.7, -2.1, 1500.0])
VELOCITY_N = np.array([50.0, -30.0, 3.0])
FORCE, RATE = np.array([1.0, -2.0, -9.5]), np.array([0.02, -0.03, 0.05])
TURN = quaternion.of_euler(0.3, 0.1, 2.0)


def skewed(vector):
    """Of the derivatives' numbers as well."""
    x, y, z = vector
    zero = 0.0 * x
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def errors_change(error):
    """Derivatives of the nine errors by what the true state is and what the estimated one: the definitions."""
    dcm = quaternion.dcm(TURN)
    true = (np.eye(3) + skewed(error[inertial.TILT])) @ dcm
    force, rate = FORCE - error[inertial.FORCE], RATE - error[inertial.RATE]
    estimated = inertial.rates(POSITION, VELOCITY_N, dcm @ FORCE)
    position, velocity = POSITION + error[inertial.POSITION], VELOCITY_N + error[inertial.VELOCITY]
    actual = inertial.rates(position, velocity, true @ force)
    change_true = true @ skewed(rate) - skewed(actual[2]) @ true
    change = dcm @ skewed(RATE) - skewed(estimated[2]) @ dcm
    both = change_true @ dcm.T + true @ change.T
    tilt = np.array([both[2, 1] - both[1, 2], both[0, 2] - both[2, 0], both[1, 0] - both[0, 1]]) * 0.5
    return np.concatenate([actual[0] - estimated[0], actual[1] - estimated[1], tilt])


def test_error_model_is_the_derivative_of_the_mechanisation(monkeypatch):
    """Catches each misprint of (5.40)-(5.51): a diagonal of ones, h positive down, radii of the other direction, a tilt
    in the place of the specific force. Radii and the gravity of the ground are held, as the thesis does."""
    north_south, east_west = (float(radius) for radius in earth.radii(POSITION[0]))
    ground = float(earth.gravity(POSITION[0], 0.0))
    monkeypatch.setattr(earth, "radii", lambda latitude: (north_south, east_west))
    monkeypatch.setattr(
        earth, "gravity", lambda latitude, altitude: ground * (1.0 - 2.0 * altitude / earth.EQUATORIAL_RADIUS)
    )
    _, derivative = value_and_jacobian(errors_change, np.zeros(15))
    dcm = quaternion.dcm(TURN)
    written = inertial.dynamics(POSITION, VELOCITY_N, dcm @ FORCE, dcm)
    scale = np.concatenate([1.0 / inertial.metres(POSITION[0], POSITION[2]), np.ones(12)])
    here, there = (matrix * scale / scale[:9, None] for matrix in (derivative, written))
    np.testing.assert_allclose(there, here, rtol=1e-9, atol=1e-13)
    free_air = abs(derivative[5, 2])
    assert free_air == pytest.approx(2.0 * ground / earth.EQUATORIAL_RADIUS, rel=1e-3)


def test_transition_is_the_exponential_to_second_order():
    """Catches a transition of first order: a bias of the accelerometers moves the position by half its square time. The
    third order, a bias of the gyros that moves the position, is left out: g T^3 / 6."""
    dcm = quaternion.dcm(TURN)
    matrix = np.zeros((15, 15))
    matrix[:9] = inertial.dynamics(POSITION, VELOCITY_N, dcm @ FORCE, dcm)
    scale = np.concatenate([1.0 / inertial.metres(POSITION[0], POSITION[2]), np.ones(12)])
    exact, ours = (
        rows[:9] * scale / scale[:9, None] for rows in (expm(0.1 * matrix), inertial.transition(matrix[:9], 0.1))
    )
    np.testing.assert_allclose(ours, exact, atol=1.1 * 9.9 * 0.1**3 / 6.0)
    np.testing.assert_allclose(ours[:, 3:12], exact[:, 3:12], atol=1e-5)
    assert ours[0, 9] == pytest.approx(-0.005 * dcm[0, 0], rel=1e-9)


def flown(position, velocity_n, turn, rate, force, step, count):
    """Strapdown with the same rate and specific force over and over."""
    for _ in range(count):
        position, velocity_n, turn = inertial.strapdown(position, velocity_n, turn, rate, force, step)
    return position, velocity_n, turn


def test_what_stands_on_the_earth_stays_there():
    """An hour on the ground: the gyros see Earth's rate, the accelerometers gravity. Catches Earth's rate with the
    wrong sign (kilometres), and a transport rate that is left out once it moves."""
    turn = quaternion.of_euler(0.1, -0.2, 1.0)
    dcm = quaternion.dcm(turn)
    rate = dcm.T @ earth.earth_rate(POSITION[0])
    force = dcm.T @ np.array([0.0, 0.0, -earth.gravity(POSITION[0], POSITION[2])])
    position, velocity_n, _ = flown(POSITION, np.zeros(3), turn, rate, force, 1.0, 600)
    assert np.max(np.abs((position - POSITION) * inertial.metres(POSITION[0], POSITION[2]))) < 1e-3
    assert np.max(np.abs(velocity_n)) < 1e-5


def test_a_tilt_swings_with_schulers_period():
    """84.4 min: after half a period the position error is twice R times the tilt, less what Earth's rate does."""
    tilt = 1e-5
    turn = quaternion.of_euler(0.0, tilt, 0.0)
    rate = np.array([1.0, 0.0, 0.0]) * 0.0
    position = np.array([0.0, 0.0, 0.0])
    gravity = float(earth.gravity(0.0, 0.0))
    rate = earth.earth_rate(0.0)
    force = np.array([0.0, 0.0, -gravity])
    frequency = np.sqrt(gravity / float(earth.radii(0.0)[0]))
    velocity_n, least = np.zeros(3), 0.0
    for _ in range(round(np.pi / frequency)):
        position, velocity_n, turn = inertial.strapdown(position, velocity_n, turn, rate, force, 1.0)
        velocity_n = velocity_n * np.array([1.0, 1.0, 0.0])
        position = position * np.array([1.0, 1.0, 0.0])
        least = min(least, position[0] / tilt)
    assert least == pytest.approx(-2.0, abs=0.05)


def test_height_alone_runs_away():
    """With the time constant sqrt(R / 2 g) of 9.5 min, as every unaided vertical channel."""
    gravity = float(earth.gravity(0.8, 0.0))
    time_constant = np.sqrt(earth.EQUATORIAL_RADIUS / 2.0 / gravity)
    force = np.array([0.0, 0.0, -gravity])
    position, _, _ = flown(
        np.array([0.8, 0.0, 10.0]), np.zeros(3), quaternion.of_euler(0.0, 0.0, 0.0), earth.earth_rate(0.8), force, 1.0,
        round(time_constant),
    )  # fmt: skip
    assert position[2] == pytest.approx(10.0 * np.cosh(1.0), rel=0.01)


def test_second_order_in_the_step():
    """A turn with acceleration, against steps a tenth as long: halving the step quarters the error."""

    def ends(step):
        position, velocity_n, turn = POSITION, VELOCITY_N, TURN
        for k in range(round(20.0 / step)):
            middle = (k + 0.5) * step
            force = FORCE + np.array([0.0, 2.0 * np.sin(0.5 * middle), np.cos(0.7 * middle)])
            position, velocity_n, turn = inertial.strapdown(position, velocity_n, turn, RATE, force, step)
        return velocity_n, Rotation.from_quat(turn, scalar_first=True).as_matrix()

    fine = ends(0.0025)[0]
    apart = [np.linalg.norm(ends(step)[0] - fine) for step in (0.04, 0.02)]
    assert 3.5 < apart[0] / apart[1] < 4.6


def test_slow_process_gains_what_the_drift_gains():
    sigma, time = inertial.slow(0.3, 0.05, 100.0)
    assert 2.0 * sigma**2 / time == pytest.approx(2.0 * 0.05**2 / 100.0)
    assert sigma == pytest.approx(np.hypot(0.3, 0.05))
    assert inertial.slow(0.0, 0.05, 100.0)[1] == pytest.approx(100.0)
