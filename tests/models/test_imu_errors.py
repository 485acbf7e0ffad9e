"""The errors of the IMU beyond the thesis's: each alone, against what it says it does."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from fmus.inertial.imu import Imu
from models.inertial import latency
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret
from tests.models.test_imu import QUIET, RECORD

RATE, FORCE = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -9.0])
TRUTH = {"rate": RATE, "specific_force": FORCE}


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def sample(**parameters):
    """The first reading of rate and specific force."""
    run = interpret(Imu, **{**QUIET, **TRUTH, **parameters})
    run.do_step(0.0, 0.01)
    return [np.array(run.get(name)) for name in RECORD]


def test_an_asymmetric_scale_factor_is_larger_where_the_input_is_positive():
    """The sign of the error is that of the asymmetry, whichever way the unit turns: to and fro does not cancel it."""
    rate, force = sample(gyro_scale_factor_asymmetry=(0.01, 0.02, 0.03), accelerometer_scale_factor_asymmetry=1e-3)
    np.testing.assert_allclose(rate, RATE + np.array([0.001, 0.004, 0.009]), rtol=1e-14)
    np.testing.assert_allclose(force, FORCE + np.array([0.001, 0.002, 0.009]), rtol=1e-14)


def test_temperature_changes_scale_factor_and_null_shift():
    parameters = {
        "gyro_scale_factor_temperature": 1e-4,
        "gyro_null_shift_temperature": (1e-5, 0.0, -1e-5),
        "accelerometer_null_shift_temperature": 1e-3,
    }
    rate, force = sample(**parameters, temperature=313.15)
    np.testing.assert_allclose(rate, RATE * 1.002 + (2e-4, 0.0, -2e-4), rtol=1e-13)
    np.testing.assert_allclose(force, FORCE + 0.02, rtol=1e-13)
    rate, force = sample(**parameters)  # at the temperature of calibration
    np.testing.assert_array_equal([rate, force], [RATE, FORCE])


def test_axes_that_lean_show_a_part_of_the_others():
    """Each triad has its own angles, and the mounting of both comes first: N C_m, not C_m N."""
    turn, lean = np.array([1e-3, -2e-3, 3e-3]), (0.01, 0.02, -0.03)
    rate, force = sample(misalignment=turn, gyro_nonorthogonality=lean)
    mounted = RATE - np.cross(turn, RATE)
    x, y, z = mounted
    np.testing.assert_allclose(rate, [x, y + 0.01 * x, z + 0.02 * x - 0.03 * y], rtol=1e-14)
    np.testing.assert_allclose(force, FORCE - np.cross(turn, FORCE), rtol=1e-14)


def test_gyros_feel_specific_force_by_a_matrix():
    """Row: gyro; column: axis of the force. A transposed matrix, or the axes of the accelerometers, would be seen."""
    matrix = np.arange(9.0).reshape(3, 3) * 1e-5
    rate, force = sample(gyro_g_sensitivity=matrix, accelerometer_nonorthogonality=0.1)
    np.testing.assert_allclose(rate, RATE + matrix @ FORCE, rtol=1e-14)
    np.testing.assert_allclose(force, FORCE + np.array([0.0, 0.1, 0.3]), rtol=1e-13)


def test_beyond_the_range_it_shows_the_range_in_readings_and_increments(native):
    """F12. The limit is for what is sensed with its noise: a reading is never above it, and far above it, it stays.

    Noise on top of a limited value would take half of the readings below it, and increments above it.
    """
    parameters = {**QUIET, "gyro_range": 0.25, "gyro_noise_sigma": 0.05, "accelerometer_range": (0.5, 9.0, 9.5)}
    truth = {"rate": (0.24, -0.5, 0.0), "specific_force": FORCE}
    run = native.run(2.0, 0.01, RECORD, {**parameters, **truth})
    rate = run["reading.rate"][1:]
    assert np.max(np.abs(rate)) == 0.25
    assert 0.2 < np.mean(rate[:, 0] == 0.25) < 0.6  # 0.42 expected, of 200
    truth["rate"] = (0.24, -0.6, 0.0)  # seven sigma beyond
    run = native.run(2.0, 0.01, [*RECORD, "increment.angle"], {**parameters, **truth, "coning_samples": 1})
    np.testing.assert_array_equal(run["reading.rate"][1:, 1], -0.25)
    np.testing.assert_array_equal(run["reading.specific_force"][1:], np.broadcast_to((0.5, 2.0, -9.0), (200, 3)))
    np.testing.assert_allclose(run["increment.angle"][1:, 1], -0.25 * 0.01, rtol=1e-12)
    assert np.max(run["increment.angle"][:, 0]) < 0.26 * 0.01  # of a reading of 0.25 after a noiseless 0.24


def test_whole_steps_do_not_leave_the_range():
    """The largest reading is the last whole step inside; rounded after the limit it would be half a step outside."""
    steps = {"gyro_range": 0.26, "gyro_resolution": 0.1, "accelerometer_range": 0.3, "accelerometer_resolution": 0.1}
    rate, force = sample(**steps, rate=(0.27, -0.3, 0.14), specific_force=(0.4, -0.4, 0.16))
    np.testing.assert_allclose(rate, [0.2, -0.2, 0.1], rtol=1e-12)
    np.testing.assert_allclose(force, [0.3, -0.3, 0.2], rtol=1e-12)


def test_readings_come_in_whole_steps_and_are_rounded_anew_each_time():
    """An error of half a step at most, also where the rate is a third of a step for ever: nothing is kept for later."""
    rate, force = sample(gyro_resolution=0.03, accelerometer_resolution=(0.4, 0.0, 4.0))
    np.testing.assert_allclose(rate, [0.09, -0.21, 0.3], rtol=1e-12)
    np.testing.assert_allclose(force, [0.8, 2.0, -8.0], rtol=1e-12)
    run = interpret(Imu, **QUIET, rate=(0.01, -0.01, 0.0), gyro_resolution=0.03)
    for k in range(50):
        run.do_step(0.01 * k, 0.01)
        np.testing.assert_array_equal(run.get("reading.rate"), 0.0)


def test_steps_that_do_not_fit_into_the_range_are_refused():
    """No reading but 0 would be possible, whatever the unit does."""
    with pytest.raises(NavfmuError, match="a resolution is larger than the range of its axis; expected steps that fit"):
        sample(accelerometer_range=(0.0, 0.0, 20.0), accelerometer_resolution=(1.0, 1.0, 50.0))
    sample(accelerometer_range=(0.0, 0.0, 20.0), accelerometer_resolution=(1.0, 1.0, 20.0))


@pytest.mark.parametrize("late", [0, 1, 3, latency.LONGEST])
def test_a_late_sample_carries_the_time_at_which_it_was_taken(native, late):
    """Its value is that of then: with the time of now it would be off by the rate of change times the latency."""
    run = native.run(
        0.5,
        0.01,
        [*RECORD, "reading.time_of_validity"],
        {**QUIET, "latency": late},
        lambda t: {"rate": (t, 2.0 * t, 0.0), "specific_force": (-t, 0.0, 3.0 * t)},
    )
    time, taken = 0.01 * np.arange(51), run["reading.time_of_validity"]
    np.testing.assert_array_equal(taken[: late + 1], 0.0)
    np.testing.assert_allclose(taken[late + 1 :], time[1 : 51 - late], atol=1e-12)
    held = taken[late + 1 :] - 0.01  # the inputs are those of the beginning of the step
    np.testing.assert_allclose(run["reading.rate"][late + 1 :], np.outer(held, (1.0, 2.0, 0.0)), atol=1e-12)
    np.testing.assert_allclose(run["reading.specific_force"][late + 1 :], np.outer(held, (-1.0, 0.0, 3.0)), atol=1e-12)


def test_nothing_is_announced_before_the_first_late_sample():
    run = interpret(Imu, latency=2)
    for k, (valid, sequence) in enumerate([(False, 0), (False, 0), (True, 1), (True, 2)]):
        run.do_step(0.01 * k, 0.01)
        assert (run.get("reading.valid"), run.get("reading.sequence")) == (valid, sequence)


def test_latency_does_not_change_the_samples_only_when_they_come(native):
    soon, late = (native.run(1.0, 0.01, RECORD, {"latency": n, "seed": 5}) for n in (0, 4))
    for name in RECORD:
        np.testing.assert_array_equal(late[name][5:], soon[name][1:-4])


def test_it_warms_itself_after_turn_on(native):
    """Thesis Fig 3.5: rise (1 - exp(-t / tau)), seen in null shift and output alike, at any period of the drift."""
    for period in (0.1, 10.0):
        parameters = {
            **QUIET,
            "self_heating": 10.0,
            "thermal_time": 600.0,
            "gyro_null_shift_temperature": 1e-5,
            "calibration_temperature": 303.15,
            "drift_period": period,
            "sample_period": 1.0,
        }
        run = native.run(3600.0, 60.0, ["reading.rate", "sensor_temperature"], parameters)
        time = run["time"]
        rise = 10.0 * (1.0 - np.exp(-time / 600.0))
        np.testing.assert_allclose(run["sensor_temperature"], 293.15 + rise, atol=1e-9)
        # the sample that falls on a step of the temperature comes after it
        np.testing.assert_allclose(run["reading.rate"][1:, 0], 1e-5 * (rise[1:] - 10.0), atol=1e-12)


DRAWN = {  # what is drawn, and how a truth of 1 on one axis shows it
    "null_shift_temperature": lambda readings: readings["warm"][:, 3] - readings["cold"][:, 3],
    "scale_factor_temperature": lambda readings: np.diagonal(
        (readings["warm"] - readings["warm"][:, 3:])[:, :3] - (readings["cold"] - readings["cold"][:, 3:])[:, :3],
        axis1=1,
        axis2=2,
    ),
    "scale_factor_asymmetry": lambda readings: (
        0.5 * np.diagonal(readings["cold"][:, :3] + readings["back"][:, :3], axis1=1, axis2=2)
    ),
    "nonorthogonality": lambda readings: np.stack(
        [readings["cold"][:, 0, 1], readings["cold"][:, 0, 2], readings["cold"][:, 1, 2]], axis=1
    ),
}


@pytest.mark.parametrize("error", DRAWN)
def test_what_is_drawn_at_turn_on_has_its_sigma(native, error):
    """200 turn-ons of both triads; bounds of chi-square at 1e-6. Drawn for all axes at once it would be correlated."""
    sigma, given = 1e-3, 0.05
    parameters = {**QUIET}
    for sensor in ("gyro", "accelerometer"):
        parameters |= {f"{sensor}_{error}_sigma": sigma, f"{sensor}_{error}": given}
    cases = {"cold": (1.0, 293.15), "back": (-1.0, 293.15), "warm": (1.0, 294.15)}
    readings = {name: {case: np.empty((200, 4, 3)) for case in cases} for name in RECORD}
    for seed in range(200):
        for case, (sign, temperature) in cases.items():
            for axis in range(4):  # the fourth time nothing is there to be measured
                truth = sign * np.eye(4)[axis, :3]
                start = {"rate": truth, "specific_force": truth, "temperature": temperature, "seed": seed}
                run = native.run(0.01, 0.01, RECORD, {**parameters, **start})
                for name in RECORD:
                    readings[name][case][seed, axis] = run[name][-1]
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 600) / 600
    drawn = np.hstack([DRAWN[error](readings[name]) - given for name in RECORD])
    for triad in (drawn[:, :3], drawn[:, 3:]):
        assert low < np.mean(triad**2) / sigma**2 < high
        assert np.max(np.abs(np.mean(triad, axis=0))) < 4.9 * sigma / np.sqrt(200)
    assert np.max(np.abs(np.corrcoef(drawn.T) - np.eye(6))) < 5.2 / np.sqrt(200)


def test_each_element_of_the_sensitivity_to_force_is_drawn(native):
    values = []
    for seed in range(200):
        parameters = {**QUIET, "gyro_g_sensitivity_sigma": 1e-4, "gyro_g_sensitivity": 0.0, "seed": seed}
        columns = []
        for axis in range(3):
            truth = {"specific_force": np.eye(3)[axis]}
            columns.append(native.run(0.01, 0.01, RECORD, {**parameters, **truth})["reading.rate"][-1])
        values.append(np.ravel(columns))
    values = np.array(values)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 1800) / 1800
    assert low < np.mean(values**2) / 1e-8 < high
    assert np.max(np.abs(np.corrcoef(values.T) - np.eye(9))) < 5.5 / np.sqrt(200)


def test_native_code_is_the_equations_with_all_errors_at_once(native):
    """What is off by default is off in the comparison of all twins: here everything acts, for 3 s of a shaken turn."""
    everything = {
        "seed": 9,
        "misalignment": (0.01, -0.02, 0.03),
        "gyro_g_sensitivity": np.arange(9.0).reshape(3, 3) * 1e-5,
        "gyro_g_sensitivity_sigma": 1e-5,
        "self_heating": 5.0,
        "thermal_time": 2.0,
        "temperature": 303.15,
        "calibration_temperature": 290.0,
        "wander_period": 0.25,
        "flicker_time": 0.4,
        "latency": 2,
        "misalignment_change": (0.001, 0.002, 0.003),
        "gyro_g_sensitivity_change": (1e-5, 0.0, 1e-5),
        "angle_quantum": 1e-5,
    }
    for sensor, unit, order in (("gyro", 1e-3, 1), ("accelerometer", 1e-2, 2)):
        everything |= {
            f"{sensor}_scale_factor_asymmetry": 0.01,
            f"{sensor}_scale_factor_temperature": 1e-3,
            f"{sensor}_null_shift_temperature_sigma": unit,
            f"{sensor}_nonorthogonality_sigma": 0.01,
            f"{sensor}_bandwidth": 8.0,
            f"{sensor}_lag_order": order,
            f"{sensor}_flicker": unit,
            f"{sensor}_walk_sigma": 10.0 * unit,
            f"{sensor}_range": 1e4 * unit,
            f"{sensor}_resolution": (0.0, unit, 0.0),
            f"{sensor}_scale_factor_change": 0.02,
        }

    def truth(t):
        return {"rate": (np.sin(5.0 * t), 0.2, np.cos(3.0 * t)), "specific_force": (np.cos(7.0 * t), 1.0, -9.0)}

    names = [*RECORD, "increment.angle", "increment.velocity", "sensor_temperature"]
    run, twin = native.run(3.0, 0.01, names, everything, truth), interpret(Imu, **everything)
    found = {name: [np.array(twin.get(name))] for name in names}
    for k in range(300):
        for name, value in truth(0.01 * k).items():
            twin.set(name, value)
        twin.do_step(0.01 * k, 0.01)
        for name in names:
            found[name].append(np.array(twin.get(name)))
    for name in names:
        assert np.ptp(run[name][10:]) > 0.0
        np.testing.assert_allclose(run[name], np.array(found[name]), rtol=1e-9, atol=1e-12, err_msg=name)
