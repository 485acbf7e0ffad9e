"""The Allan deviations of thesis Table C.1, of the IMU at rest, judged with allantools.

Bounds: five standard deviations of what that many clusters scatter (tests.models.allan), two-sided 6e-7.
"""

from __future__ import annotations

import numpy as np
import pytest

from fmus.inertial.grades import INERTIAL
from fmus.inertial.imu import Imu
from models.inertial import flicker
from navfmu.errors import NavfmuError
from tests.models import allan
from tests.models.native import Native, interpret
from tests.models.test_imu import QUIET, RECORD

SAMPLES = 40000
SECOND = {"sample_period": 1.0, "drift_period": 1.0}
BOUND = 5.0
AT_REST = np.array([0.0, 0.0, -9.80665])


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def at_rest(native, parameters, samples=SAMPLES):
    """Errors of six axes over seconds: gyros, and accelerometers told the same numbers in their own unit."""
    both = {f"{sensor}_{name}": value for sensor in ("gyro", "accelerometer") for name, value in parameters.items()}
    run = native.run(samples, 1.0, RECORD, {**QUIET, **SECOND, **both})
    return np.hstack([run["reading.rate"][1:], run["reading.specific_force"][1:] - AT_REST])


def check(errors, spans, expected):
    """Every deviation is what it should be, and so is the slope from the shortest time to the longest."""
    found = allan.deviation(errors, 1.0, spans)
    spread = allan.spread(len(errors), errors.shape[1], spans)
    off = np.log(found / expected)
    assert np.all(np.abs(off) < BOUND * spread), off / spread
    return np.log(found[-1] / found[0]) / np.log(spans[-1] / spans[0]), BOUND * (spread[0] + spread[-1]) / np.log(
        spans[-1] / spans[0]
    )


def test_wide_band_noise_falls_with_one_half(native):
    """It would be flat if one number were drawn in a run, and fall with 1 if the noise were in the angle."""
    spans = np.array([1, 4, 16, 64, 256])
    slope, bound = check(at_rest(native, {"noise_sigma": 0.05}), spans, 0.05 / np.sqrt(spans))
    assert abs(slope + 0.5) < bound < 0.06


def test_rate_random_walk_rises_with_one_half(native):
    """K sqrt(T / 3), beyond 10 s, where the steps of a second do not show (they are 1 / (2 m^2) of the variance)."""
    spans = np.array([10, 40, 160, 640])
    walk = 0.01 / np.sqrt(3600.0)  # per root second
    expected = walk * np.sqrt(spans / 3.0 * (1.0 + 0.5 / spans**2))
    slope, bound = check(at_rest(native, {"walk_sigma": 0.01}), spans, expected)
    assert abs(slope - 0.5) < bound < 0.12


def test_random_walk_is_told_by_its_change_in_an_hour_at_any_period(native):
    changes = []
    for seed in range(100):
        parameters = {**QUIET, **SECOND, "gyro_walk_sigma": 2.0, "wander_period": 7.2, "seed": seed}
        run = native.run(3600.0, 1800.0, ["reading.rate"], parameters)["reading.rate"]
        np.testing.assert_array_equal(run[0], 0.0)
        changes.append(np.diff(run, axis=0))
    changes = np.array(changes)  # of two half hours
    for half in range(2):
        square = np.mean(changes[:, half] ** 2) / (4.0 / 2.0)
        assert abs(square - 1.0) < BOUND * np.sqrt(2.0 / 300)


def test_a_gauss_markov_process_rises_with_one_half_where_it_is_young(native):
    """At a fiftieth of its correlation time on, 1000 s; at 1.89 of it, it is highest, 0.62 sigma, and falls beyond."""
    spans = np.array([10, 20, 40, 2000])
    expected = allan.gauss_markov(spans, 0.01, 1000.0)
    check(at_rest(native, {"drift_sigma": 0.01, "drift_time": 1000.0}, samples=100000), spans, expected)
    young = np.log(expected[2] / expected[0]) / np.log(4.0)
    assert abs(young - 0.5) < 0.02


def test_flicker_noise_is_flat(native):
    """0.664 B within what five processes of a decade each can do (7 %, models.inertial.flicker)."""
    spans = np.array([30, 120, 480, 1920])
    errors = at_rest(native, {"flicker": 0.01}, samples=100000)
    found = allan.deviation(errors, 1.0, spans) / (0.664 * 0.01)
    bounds = BOUND * allan.spread(len(errors), 6, spans)
    assert np.all(np.abs(np.log(found)) < bounds + 0.07)


def test_flicker_noise_that_is_held_too_long_is_refused():
    """Of 0.1 s, advanced every second, it had 1.7 times its floor at a second; without flicker no period matters."""
    sentence = "flicker_time is 0.1 s and wander_period 1 s; expected a wander_period that is not longer"
    with pytest.raises(NavfmuError, match=sentence):
        interpret(Imu, flicker_time=0.1, accelerometer_flicker=(0.0, 0.0, 1e-3))
    interpret(Imu, flicker_time=0.1, accelerometer_flicker=(0.0, 0.0, 1e-3), wander_period=0.1)
    interpret(Imu, flicker_time=0.1)


def test_a_ramp_rises_with_one(native):
    """Of a temperature that rises by 1 K in 1000 s: R T / sqrt(2), IEEE Std 952, (C.22)."""
    parameters = {**QUIET, **SECOND, "gyro_null_shift_temperature": 1e-3, "thermal_time": 1.0}
    run = native.run(4000, 1.0, ["reading.rate"], parameters, lambda t: {"temperature": 293.15 + t / 1000.0})
    spans = np.array([1, 10, 100, 1000])
    found = allan.deviation(run["reading.rate"][20:], 1.0, spans)  # the first 20 s are those of thermal_time
    np.testing.assert_allclose(found, 1e-6 * spans / np.sqrt(2.0), rtol=1e-6)


def test_a_slow_oscillation_rises_with_one(native):
    """Omega sin^2(pi f T) / (pi f T), IEEE Std 952, (C.20), at times far below its period."""
    period, spans = 2000.0, np.array([1, 2, 4, 8, 16])
    run = native.run(
        20000,
        1.0,
        ["reading.rate"],
        {**QUIET, **SECOND},
        lambda t: {"rate": [0.1 * np.sin(2.0 * np.pi * t / period)] * 3},
    )
    found = allan.deviation(run["reading.rate"][1:], 1.0, spans)
    x = np.pi * spans / period
    np.testing.assert_allclose(found, 0.1 * np.sin(x) ** 2 / x, rtol=2e-3)
    np.testing.assert_allclose(np.diff(np.log(found)) / np.log(2.0), 1.0, atol=2e-3)


def test_whole_pulses_fall_with_one(native):
    """sqrt(3) Q / T, Q = quantum / sqrt(12): what made no pulse is kept. Rounded anew it would fall with one half."""
    quantum = 1e-5
    rng = np.random.default_rng(1)
    rates = rng.uniform(-100.0 * quantum, 100.0 * quantum, (SAMPLES + 1, 3))
    parameters = {**QUIET, **SECOND, "angle_quantum": quantum, "coning_samples": 1}
    run = native.run(SAMPLES, 1.0, ["increment.angle"], parameters, lambda t: {"rate": rates[round(t)].tolist()})
    truth = 0.5 * (rates[:-1] + np.vstack([np.zeros(3), rates[:-2]]))
    error = run["increment.angle"][1:] - truth
    spans = np.array([1, 4, 16, 64, 256])
    slope, bound = check(error, spans, 0.5 * quantum / spans)
    assert abs(slope + 1.0) < bound < 0.09


def test_the_horizon_turns_where_its_chart_does(native):
    """Thesis Fig 3.2, Fig C.4: -1/2 for the first 300 s or so, then up. 0.05 deg/s at 1 Hz, 0.01 deg/s over 1000 s.

    Table 3.1's 0.05 deg/s, which covers temperature, moves the low point to the left (p. 248), to a fifth.
    """
    degree = np.pi / 180.0
    spans = np.array([1, 4, 16, 64, 256, 1024])
    lowest = {}
    for name in ("horizon_warming", "horizon"):
        unit = INERTIAL[name].values
        sigma, time = unit["gyro_drift_sigma"], unit["gyro_drift_time"]
        assert (unit["gyro_noise_sigma"], time) == (pytest.approx(0.05 * degree), 1000.0)

        def expected(t, sigma=sigma, time=time):
            return np.hypot(0.05 * degree / np.sqrt(t), allan.gauss_markov(t, sigma, time))

        every = np.arange(1.0, 3000.0)
        lowest[name] = every[np.argmin(expected(every))]
        parameters = {"noise_sigma": 0.05 * degree, "drift_sigma": sigma, "drift_time": time}
        check(at_rest(native, parameters, samples=100000), spans, expected(spans))
    assert 200.0 < lowest["horizon_warming"] < 300.0
    assert lowest["horizon"] == pytest.approx(lowest["horizon_warming"] / 5.0, rel=0.35)


def test_at_a_hundred_samples_a_second_the_horizon_turns_earlier(native):
    """Its noise is that of a sample: more of them average sooner, and the low point is at 20 s instead of 245 s.

    As the set is bound to a unit of 100 Hz; with the noise of 1 Hz kept per root second it would still fall there.
    """
    degree = np.pi / 180.0
    unit = INERTIAL["horizon_warming"].values
    values = {**unit, **QUIET, "self_heating": 0.0, "calibration_temperature": 293.15}
    values |= {name: unit[name] for name in ("gyro_noise_sigma", "gyro_drift_sigma")}
    run = native.run(2000.0, 0.01, ["reading.rate"], values)["reading.rate"][1:] / degree
    spans = np.array([200, 1000, 2000])
    found, time = allan.deviation(run, 0.01, spans), 0.01 * spans
    expected = np.hypot(0.005 / np.sqrt(time), allan.gauss_markov(time, 0.01, 1000.0))
    assert np.all(np.abs(np.log(found / expected)) < BOUND * allan.spread(len(run), 3, spans))
    fine = np.arange(5.0, 100.0)
    closed = np.hypot(0.005 / np.sqrt(fine), allan.gauss_markov(fine, 0.01, 1000.0))
    assert fine[np.argmin(closed)] == pytest.approx(20.0, abs=1.0)


def test_flicker_is_stationary_from_the_first_sample(native):
    """Its variance at turn-on and 1000 s later, 200 turn-ons: DECADES processes of (0.856 B)^2 each."""
    firsts, lasts = [], []
    for seed in range(200):
        run = native.run(1000.0, 1000.0, ["gyro_wander"], {**QUIET, **SECOND, "gyro_flicker": 1.0, "seed": seed})
        firsts.append(run["gyro_wander"][0])
        lasts.append(run["gyro_wander"][-1])
    expected = flicker.DECADES * np.log(10.0) / np.pi
    for values in (firsts, lasts):
        assert abs(np.mean(np.square(values)) / expected - 1.0) < BOUND * np.sqrt(2.0 / 600)


def test_the_sum_of_decades_is_as_flat_as_it_is_said_to_be():
    """Closed form of each process: within 1.5 % from 18 to 1800 of the shortest time, within 7 % from 3 to 10^4."""
    times = np.geomspace(3.0, 1e4, 400)
    processes = [allan.gauss_markov(times, flicker.SHARE, t) for t in flicker.correlation_times(1.0).ravel()]
    flat = np.sqrt(np.sum(np.square(processes), axis=0)) / 0.6643
    assert np.max(np.abs(flat - 1.0)) < 0.07
    middle = (times > 18.0) & (times < 1800.0)
    assert np.max(np.abs(flat[middle] - 1.0)) < 0.015
