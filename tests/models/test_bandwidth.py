"""The lag of an inertial sensor, against SciPy's simulation of the same transfer function."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy import signal

from fmus.inertial.imu import Imu
from models.inertial import bandwidth
from tests.models.native import Native, interpret
from tests.models.test_imu import QUIET


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def system(frequency, order, damping=0.7):
    w = 2.0 * np.pi * frequency
    return ([w], [1.0, w]) if order == 1 else ([w * w], [1.0, 2.0 * damping * w, w * w])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("damping", [0.15, 0.7071, 0.98])
@pytest.mark.parametrize("frequency", [0.5, 10.0, 300.0])  # Hz, sampled at 100 Hz
def test_it_is_exact_for_an_input_that_is_linear_between_samples(order, damping, frequency):
    """Held inputs, Euler steps or a wrong sign in Phi are off by per cents; below and far above the sample rate."""
    period = 0.01
    u = np.random.default_rng(3).normal(size=(200, 3))
    phi, times = bandwidth.transition(frequency, order, damping, period), bandwidth.times(frequency, order, damping)
    x, shown = np.stack([u[0], np.zeros(3)]), [u[0]]
    for before, now in pairwise(u):
        x = bandwidth.follow(x, before, now, period, phi, times)
        shown.append(x[0])
    # SciPy too takes the input as linear; it begins at rest in 0, so what is seen is the way from the first input
    for axis in range(3):
        _, y, _ = signal.lsim(system(frequency, order, damping), u[:, axis] - u[0, axis], period * np.arange(200))
        np.testing.assert_allclose(np.array(shown)[:, axis], y + u[0, axis], rtol=1e-9, atol=1e-9)


def test_without_a_bandwidth_it_shows_the_input():
    phi, times = bandwidth.transition(0.0, 2, 0.7, 0.01), bandwidth.times(0.0, 2, 0.7)
    now = np.array([0.1, -3.0, 7e-9])
    np.testing.assert_array_equal(bandwidth.follow(np.ones((2, 3)), 5.0 * now, now, 0.01, phi, times)[0], now)


@pytest.mark.parametrize("order", [1, 2])
def test_an_oscillation_at_the_bandwidth_comes_3_db_down_and_late(native, order):
    """At 5 Hz, sampled at 1 kHz: 1 / sqrt(2), and 45 or 90 degrees. (Straight lines between samples: 1e-4.)"""
    time = 0.001 * np.arange(3001)
    parameters = {**QUIET, "sample_period": 0.001, "gyro_bandwidth": 5.0, "gyro_lag_order": order}
    run = native.run(
        3.0, 0.001, ["reading.rate"], parameters, lambda t: {"rate": [np.sin(10.0 * np.pi * (t + 0.001))] * 3}
    )
    seen = run["reading.rate"][2001:, 0]  # two seconds later nothing is left of the beginning
    phases = 10.0 * np.pi * time[2001:]
    fitted = 2.0 * np.array([np.mean(seen * np.sin(phases)), np.mean(seen * np.cos(phases))])
    expected = np.array([0.5, -0.5]) if order == 1 else np.array([0.0, -np.sqrt(0.5)])
    np.testing.assert_allclose(fitted, expected, atol=2e-4)


def test_both_triads_have_lags_of_their_own_and_begin_at_rest(native):
    """A unit that is turned on while it turns shows no transient; a step comes as 1 - exp(-2 pi f t)."""
    parameters = {**QUIET, "gyro_bandwidth": 2.0, "gyro_lag_order": 1, "rate": (0.5, 0.0, -0.1)}
    still = native.run(1.0, 0.01, ["reading.rate"], parameters)["reading.rate"][1:]
    np.testing.assert_allclose(still, np.broadcast_to((0.5, 0.0, -0.1), still.shape), rtol=1e-14, atol=1e-16)

    parameters = {**QUIET, "accelerometer_bandwidth": 2.0, "accelerometer_lag_order": 1, "gyro_bandwidth": 0.0}
    run = interpret(Imu, **parameters, specific_force=(0.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0))
    run.set("specific_force", (1.0, 0.0, 0.0))
    run.set("rate", (1.0, 0.0, 0.0))
    run.do_step(0.0, 0.01)
    assert run.get("reading.rate")[0] == 1.0
    angle = 2.0 * np.pi * 2.0 * 0.01
    ramp = 1.0 - (1.0 - np.exp(-angle)) / angle  # the first sample comes at the end of a straight line
    assert run.get("reading.specific_force")[0] == pytest.approx(ramp, rel=1e-12)
    for k in range(1, 20):
        run.do_step(0.01 * k, 0.01)
        left = (1.0 - ramp) * np.exp(-k * angle)
        assert run.get("reading.specific_force")[0] == pytest.approx(1.0 - left, rel=1e-12)
