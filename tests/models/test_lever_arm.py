"""Accelerometers away from the reference point: closed forms of spinning and of swinging."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.inertial.imu import Imu
from models.inertial import lever_arm
from tests.models.native import Native
from tests.models.test_imu import QUIET

ARM = np.array([2.0, -0.5, 0.3])


def test_spinning_pulls_inwards():
    """Turning at 2 rad/s about the third axis: specific force is towards the axis, 4 m/s2 for each metre."""
    found = lever_arm.moved(np.zeros(3), np.array([0.0, 0.0, 2.0]), np.zeros(3), ARM)
    np.testing.assert_allclose(found, [-8.0, 2.0, 0.0], atol=1e-15)


def test_spinning_up_pulls_along_the_way():
    """w' x r: with the nose going right, what sits ahead is accelerated to the right."""
    found = lever_arm.moved(np.zeros(3), np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([2.0, 0.0, 0.0]))
    np.testing.assert_allclose(found, [0.0, 2.0, 0.0], atol=1e-15)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 3.0])
def test_three_rates_show_an_oscillation_as_the_formula_says(frequency):
    """a^2 / 3 too much and a^3 / 4 late, but for two powers of a more; the difference of two is a / 2 late."""
    period = 0.01
    a = 2 * np.pi * frequency * period
    times = np.arange(1000) * period
    rate = np.sin(2 * np.pi * frequency * times)
    found = lever_arm.acceleration(rate[2:], rate[1:-1], rate[:-2], period) / (2 * np.pi * frequency)
    z = np.exp(-1j * a)
    passed = (1 - z) * (3 - z) / (2j * a)
    np.testing.assert_allclose(found, np.real(passed * np.exp(2j * np.pi * frequency * times[2:])), atol=1e-12)
    assert abs(passed) - 1.0 == pytest.approx(a**2 / 3, rel=a**2)
    assert -np.angle(passed) == pytest.approx(a**3 / 4, rel=a**2)


def test_a_quadratic_rate_has_an_exact_derivative():
    t = np.array([1.0, 0.9, 0.8])
    assert lever_arm.acceleration(*(3.0 * t * t - 5.0 * t), 0.1) == pytest.approx(1.0, rel=1e-13)


def test_the_fmu_feels_what_the_arm_goes_through(tmp_path_factory):
    """The unit swings by 0.2 rad at 0.7 Hz, 2 m from the axis: f = r'' of the arm, turned into b, by differences.

    Held inputs are a step old. The error of the derivative is a^2 / 3 of 7.7 m/s2, 5 mm/s2.
    """
    native = Native(Imu, tmp_path_factory.mktemp("imu"))
    w, swing, step, h = 2 * np.pi * 0.7, 0.2, 0.01, 1e-4

    def angle(t):
        return swing * np.sin(w * t)

    def inputs(t):
        return {"rate": (0.0, 0.0, swing * w * np.cos(w * t)), "specific_force": 0.0}

    parameters = {**QUIET, "lever_arm": ARM}
    run = native.run(5.0, step, ["reading.specific_force", "increment.velocity"], parameters, inputs)

    def place(t):
        return np.array([[np.cos(angle(t)), -np.sin(angle(t))], [np.sin(angle(t)), np.cos(angle(t))]]) @ ARM[:2]

    for k in range(10, 500, 7):
        t = (k - 1) * step
        acceleration = (place(t + h) - 2 * place(t) + place(t - h)) / h**2
        c, s = np.cos(angle(t)), np.sin(angle(t))
        expected = np.array([[c, s], [-s, c]]) @ acceleration
        found = run["reading.specific_force"][k]
        a = w * step
        assert np.linalg.norm(found[:2] - expected) < 1.1 * a**2 / 3 * swing * w**2 * np.linalg.norm(ARM[:2]) + 1e-5
        assert found[2] == 0.0


def test_an_arm_of_nothing_changes_no_bit(tmp_path_factory):
    native = Native(Imu, tmp_path_factory.mktemp("imu"))
    record = ["reading.specific_force"]
    turning = {"rate": (0.1, -0.3, 0.5), "specific_force": (0.3, -0.2, -9.7)}
    here = native.run(1.0, 0.01, record, {"seed": 2}, lambda t: turning)
    steady = native.run(1.0, 0.01, record, {"seed": 2}, lambda t: {**turning, "rate": 0.0})
    np.testing.assert_array_equal(here[record[0]], steady[record[0]])
