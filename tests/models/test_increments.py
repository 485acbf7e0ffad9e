"""Increments of angle and velocity: sums, whole quanta, noise, and their place beside the readings."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from fmus.inertial.imu import Imu
from models.inertial import increments
from tests.models.native import Native, interpret
from tests.models.test_imu import QUIET

RECORD = ["increment.angle", "increment.velocity", "reading.rate", "reading.specific_force"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def test_whole_quanta_never_leave_more_than_half_a_quantum():
    """A remainder that is dropped would walk away, by 0.29 quanta times the root of the count: 29 at the end."""
    rng = np.random.default_rng(5)
    quantum, rest, total, out = 1e-5, np.zeros(3), np.zeros(3), np.zeros(3)
    for _ in range(10000):
        step = 3e-5 * rng.standard_normal(3)
        put, rest = increments.counted(step, rest, quantum)
        assert np.max(np.abs(put / quantum - np.rint(put / quantum))) < 1e-9
        total, out = total + step, out + put
        assert np.max(np.abs(total - out)) < 0.5000001 * quantum


def test_without_a_quantum_all_is_put_out():
    put, rest = increments.counted(np.array([0.1, -0.2, 0.3]), np.zeros(3), 0.0)
    np.testing.assert_array_equal(put, [0.1, -0.2, 0.3])
    np.testing.assert_array_equal(rest, 0.0)


def test_an_increment_spans_its_samples_and_is_announced_once():
    run = interpret(Imu, **QUIET, rate=(0.1, 0.0, 0.0), specific_force=(0.0, 0.0, -10.0), increment_samples=4)
    seen = []
    for k in range(9):
        run.do_step(k * 0.01, 0.01)
        seen.append(int(run.get("increment.sequence")))
    assert seen == [0, 0, 0, 1, 1, 1, 1, 2, 2]
    assert (run.get("increment.valid"), run.get("increment.time_of_validity")) == (True, 0.08)
    assert run.get("increment.interval") == pytest.approx(0.04, rel=1e-15)
    np.testing.assert_allclose(run.get("increment.angle"), [0.004, 0.0, 0.0], atol=1e-17)
    # turned by 4 mrad on the whole: the force has stayed in b, and so the increment has
    np.testing.assert_allclose(run.get("increment.velocity"), [0.0, 0.0, -0.4], atol=1e-15)


def test_errors_of_the_sensors_are_in_the_increments():
    run = interpret(Imu, **QUIET, gyro_null_shift=(1e-3, 0.0, 0.0), accelerometer_scale_factor=(0.0, 0.0, 0.01))
    run.do_step(0.0, 0.01)
    np.testing.assert_allclose(run.get("increment.angle"), [1e-5, 0.0, 0.0], rtol=1e-12)
    np.testing.assert_allclose(run.get("increment.velocity"), [0.0, 0.0, -0.0980665 * 1.01], rtol=1e-12)


def test_increments_of_single_samples_are_those_readings_integrated(native):
    """Drift and noise and all: T times the noise of the sample's reading, and trapezoids of the rest."""
    run = native.run(2.0, 0.01, RECORD, {"drift_period": 0.05, "seed": 3, "coning_samples": 1})
    quiet = native.run(
        2.0,
        0.01,
        RECORD,
        {"drift_period": 0.05, "seed": 3, "gyro_noise_sigma": 0.0, "accelerometer_noise_sigma": 0.0},
    )
    for increment, reading in (("angle", "rate"), ("velocity", "specific_force")):
        sensed, noise = quiet[f"reading.{reading}"], run[f"reading.{reading}"] - quiet[f"reading.{reading}"]
        expected = 0.005 * (sensed[2:] + sensed[1:-1]) + 0.01 * noise[2:]
        np.testing.assert_allclose(run[f"increment.{increment}"][2:], expected, rtol=1e-12, atol=1e-15)


def test_a_closed_motion_about_one_axis_sums_to_nothing(native):
    """Two seconds of turning to and fro, pulses of 2 arcsec: what is left is less than half of one on each axis."""
    quantum, axis = np.radians(2.0 / 3600.0), np.array([0.6, 0.0, -0.8])
    run = native.run(
        4.0,
        0.01,
        ["increment.angle"],
        {**QUIET, "angle_quantum": quantum, "increment_samples": 5},
        lambda t: {"rate": (0.3 * np.sin(np.pi * t) if t < 2.0 else 0.0) * axis},
    )
    left = run["increment.angle"][5::5].sum(axis=0)
    # pulses of three axes are not quite about one axis: their products are below a quantum times the angle of 0.2 rad
    assert np.max(np.abs(left)) < quantum * (0.5 + 0.2)
    assert np.max(np.abs(run["increment.angle"])) > 100 * quantum


def test_noise_walks_as_b_10_says(native):
    """sigma sqrt(T t) after a time t: 3 x 2000 increments of 10 samples, chi-square bounds at a probability of 1e-6."""
    sigma, each = 1e-3, 10
    parameters = {**QUIET, "gyro_noise_sigma": sigma, "increment_samples": each, "seed": 11}
    run = native.run(200.0, 0.01, ["increment.angle"], parameters)
    angles = run["increment.angle"][each::each]
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], angles.size)
    assert low < np.sum(angles**2) / (sigma**2 * 0.01 * (each * 0.01)) < high


def test_noise_is_the_same_for_every_communication_step(native):
    parameters = {"seed": 5, "increment_samples": 2, "angle_quantum": 1e-5}
    fine = native.run(2.0, 0.01, RECORD, parameters)
    coarse = native.run(2.0, 0.1, RECORD, parameters)
    for name in RECORD:
        np.testing.assert_array_equal(fine[name][::10], coarse[name])
