"""Faults of the IMU: onset, signature, recovery. F numbers are those of docs/sensors/imu.md."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.inertial.imu import Imu
from tests.models.native import Native
from tests.models.test_imu import QUIET, RECORD

RATE, FORCE = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -9.0])
ON, OFF = 1.0, 2.0


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def fly(native, parameters, fault=None, value=0.0, stop=3.0, step=0.01):
    """Readings with a fault from ON to OFF, and without it; the grade of the start values, in a turn."""

    def inputs(t):
        acts = ON - 1e-9 < t < OFF - 1e-9
        start = np.zeros_like(value) if fault != "temperature" else 293.15
        return {"rate": RATE, "specific_force": FORCE} | ({} if fault is None else {fault: value if acts else start})

    return native.run(stop, step, RECORD, parameters, inputs)


CHANGES = {  # F13: input, value, and what the readings of the truth become
    "gyro_scale_factor_change": (np.array([0.01, 0.0, -0.02]), RATE * (0.01, 0.0, -0.02), 0.0 * FORCE),
    "accelerometer_scale_factor_change": (np.array([0.0, 0.05, 0.0]), 0.0 * RATE, FORCE * (0.0, 0.05, 0.0)),
    "misalignment_change": (
        np.array([0.0, 0.0, 0.1]),
        -np.cross((0.0, 0.0, 0.1), RATE),
        -np.cross((0.0, 0.0, 0.1), FORCE),
    ),
    "gyro_g_sensitivity_change": (np.array([1e-3, 2e-3, 0.0]), FORCE * (1e-3, 2e-3, 0.0), 0.0 * FORCE),
}


@pytest.mark.parametrize("fault", CHANGES)
def test_f13_a_change_shows_at_once_and_leaves_nothing_behind(native, fault):
    """With all noise and drift of the automotive grade; the signature is exact without, the recovery bit for bit with.

    A fault that is drawn into a state, or that moves the noise, would leave something.
    """
    value, *signature = CHANGES[fault]
    for parameters in (QUIET, {"seed": 4}):
        sound, failed = fly(native, parameters), fly(native, parameters, fault, value)
        for name, expected in zip(RECORD, signature, strict=True):
            np.testing.assert_array_equal(failed[name][:101], sound[name][:101])
            np.testing.assert_array_equal(failed[name][201:], sound[name][201:])
            difference = failed[name][101:201] - sound[name][101:201]
            off = 1e-12 if parameters is QUIET else 0.1 * np.max(np.abs(value))  # errors of scale and mounting on it
            np.testing.assert_allclose(difference, np.broadcast_to(expected, difference.shape), atol=off)


INCREMENTS = ["increment.angle", "increment.velocity"]


@pytest.mark.parametrize("fault", ["vibrating", *CHANGES])
@pytest.mark.parametrize("samples", [1, 2, 4])
def test_increments_come_back_when_trapezoid_and_products_have_passed_the_fault(native, fault, samples):
    """Bit for bit from ``samples`` samples on, and not before; pulses differ by one at most in their sum.

    A remainder that grew, or products that reach further, would be seen.
    """
    value = CHANGES[fault][0] if fault in CHANGES else 1.0
    for quantum in (0.0, 1e-5):
        parameters = {"seed": 4, "coning_samples": samples, "angle_quantum": quantum, "velocity_quantum": quantum}
        none, some = (
            native.run(
                3.0,
                0.01,
                INCREMENTS,
                parameters,
                lambda t, on=on: (
                    {"rate": RATE, "specific_force": FORCE}
                    | {fault: value if on and ON - 1e-9 < t < OFF - 1e-9 else 0.0 * np.asarray(value)}
                ),
            )
            for on in (False, True)
        )
        for name in INCREMENTS:
            difference = (some[name] - none[name])[201:]
            if quantum:
                sums = np.cumsum(difference[samples:], axis=0)
                assert np.max(np.abs(sums)) < 1.1 * quantum
            else:
                np.testing.assert_array_equal(difference[samples:], 0.0)
        if not quantum:
            assert any(np.any(some[name][200 + samples] != none[name][200 + samples]) for name in INCREMENTS)


def test_f13_a_unit_that_turns_takes_its_leaning_axes_along(native):
    """It turns first and then leans: of a force along z, z shows a tenth of what x does. The other way it does not."""
    parameters = {**QUIET, "accelerometer_nonorthogonality": (0.0, 0.1, 0.0), "misalignment_change": (0.0, 0.05, 0.0)}
    force = native.run(0.01, 0.01, RECORD, {**parameters, "specific_force": (0.0, 0.0, -9.0)})["reading.specific_force"]
    x, z = -np.cross((0.0, 0.05, 0.0), (0.0, 0.0, -9.0))[0], -9.0
    np.testing.assert_allclose(force[1], [x, 0.0, z + 0.1 * x], atol=1e-14)


def test_f13_a_scale_factor_that_jumps_is_seen_in_turns_only(native):
    parameters = {**QUIET, "gyro_scale_factor_change": 0.05}
    still = native.run(0.1, 0.01, RECORD, {**parameters, "rate": (0.0, 0.0, 0.0)})["reading.rate"]
    np.testing.assert_array_equal(still, 0.0)


def test_f14_a_hot_minute_is_hardly_felt_and_forgotten_with_the_thermal_time(native):
    """40 K for a second, tau 600 s: 40 (1 - exp(-1/600)) of 66 mK, which decays; thesis p. 47 saw nothing in 15 min."""
    parameters = {
        **QUIET,
        "thermal_time": 600.0,
        "drift_period": 0.01,
        "accelerometer_null_shift_temperature": 0.1,
        "gyro_null_shift_temperature": (1e-3, 0.0, 0.0),
    }
    sound = fly(native, parameters, stop=30.0)
    failed = fly(native, parameters, "temperature", 333.15, stop=30.0)
    time = failed["time"][1:]
    heating = np.clip(time - ON, 0.0, OFF - ON)
    warmer = 40.0 * (1.0 - np.exp(-heating / 600.0)) * np.exp(-np.clip(time - OFF, 0.0, None) / 600.0)
    difference = {name: (failed[name] - sound[name])[1:] for name in RECORD}
    np.testing.assert_allclose(difference["reading.specific_force"], 0.1 * warmer[:, None] * np.ones(3), atol=1e-9)
    np.testing.assert_allclose(difference["reading.rate"][:, 0], 1e-3 * warmer, atol=1e-11)
    np.testing.assert_array_equal(difference["reading.rate"][:, 1:], 0.0)
    assert np.all(difference["reading.rate"][:100] == 0.0)
