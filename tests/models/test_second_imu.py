"""The unit with all errors at once beside a second one, written from its documents (tests.models.second_imu)."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.everything_on import EVERYTHING
from fmus.inertial.imu import Imu
from tests.models.native import Native
from tests.models.second_imu import SecondImu

RECORD = [
    "reading.rate",
    "reading.specific_force",
    "increment.angle",
    "increment.velocity",
    "sensor_temperature",
]
SEED, STREAM = 77, 5
CASES = {
    "everything": {"coning_fits_lag": False},
    "fast": {"sample_period": 0.002, "coning_samples": 3, "accelerometer_bandwidth": 0.0, "coning_fits_lag": False},
    "slow": {"sample_period": 0.05, "coning_samples": 2, "increment_samples": 3, "coning_fits_lag": False},
    "at its limits": {
        "gyro_range": (0.3, 0.2, 0.25),
        "accelerometer_range": (2.0, 2.0, 9.5),
        "gyro_resolution": (0.007, 0.0, 0.011),
        "accelerometer_bandwidth": 0.0,
        "coning_samples": 1,
        "coning_fits_lag": False,
    },
}


def truth(time: float) -> dict:
    """A turn on a rough road, with every fault for two seconds."""
    fails = 2.0 - 1e-9 < time < 4.0 - 1e-9
    return {
        "rate": (0.3 * np.sin(3.0 * time), 0.2 * np.cos(2.0 * time), 0.25 + 0.3 * np.sin(time)),
        "specific_force": (2.0 * np.sin(time), 3.0 * np.cos(1.3 * time), -9.8 + np.sin(5.0 * time)),
        "temperature": 293.15 + 5.0 * np.sin(0.2 * time),
        "vibrating": fails,
        "misalignment_change": (0.1 * fails, 0.0, 0.2 * fails),
        "gyro_g_sensitivity_change": (1e-4 * fails, 0.0, 2e-4 * fails),
        "gyro_scale_factor_change": (0.01 * fails, 0.0, -0.01 * fails),
        "accelerometer_scale_factor_change": (0.0, 0.02 * fails, 0.0),
    }


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


@pytest.mark.parametrize("case", CASES)
def test_it_is_the_same_to_rounding(native, case):
    """Twelve seconds: what leans before it is turned, noise on top of a range, steps beyond it, a lost remainder, a
    held input of the lag, sculling without its second product: each is off by far more than 1e-12.
    """
    first = {name: field.start for name, field in Imu.layout.fields.items() if field.causality == "parameter"}
    first = {name: value[0] if Imu.layout.fields[name].shape == () else value for name, value in first.items()}
    first["gyro_g_sensitivity"] = np.reshape(first["gyro_g_sensitivity"], (3, 3))
    parameters = {name: value for name, value in EVERYTHING["imu"].items() if name in first} | CASES[case]
    whole = {**first, **parameters, "vibration_shake_sine": (0.0, 2.0, 0.5)}
    parameters = {name: whole[name] for name in [*parameters, "vibration_shake_sine"]}
    period, late = whole["sample_period"], parameters["latency"]
    count = round(12.0 / period)
    told = {**parameters, **truth(0.0), "seed": SEED, "stream": STREAM}
    run = native.run(count * period, period, RECORD, told, truth)
    second, temperatures = SecondImu(whole, truth(0.0), SEED, STREAM), [293.15]
    for k in range(count):
        second.tick(truth(k * period))
        temperatures.append(second.temperature)
    rates, forces = (np.array([reading[i] for reading in second.readings]) for i in (1, 2))
    np.testing.assert_allclose(run["reading.rate"][late + 1 :], rates[:-late], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(run["reading.specific_force"][late + 1 :], forces[:-late], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(run["sensor_temperature"], temperatures, rtol=1e-12)
    each = parameters.get("increment_samples", 1)
    angles, velocities = (np.array([increment[i] for increment in second.increments]) for i in (0, 1))
    assert len(angles) == count // each
    np.testing.assert_allclose(run["increment.angle"][each::each], angles, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(run["increment.velocity"][each::each], velocities, rtol=1e-11, atol=1e-14)
    for values in (rates, forces, angles, velocities):
        assert np.all(np.ptp(values, axis=0) > 0.0)
