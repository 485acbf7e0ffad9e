"""The inertial sensors: the error model of the thesis, term by term."""

import numpy as np
import pytest
from scipy import stats

from fmus.grades import GRADES
from fmus.inertial.imu import Imu
from navfmu.export.noise import Normals
from tests.models.native import Native, interpret

CALIBRATED = {
    "misalignment_sigma": 0.0,
    "gyro_null_shift_sigma": 0.0,
    "gyro_scale_factor_sigma": 0.0,
    "accelerometer_null_shift_sigma": 0.0,
    "accelerometer_scale_factor_sigma": 0.0,
}
"""Nothing is left that would be drawn at turn-on."""
QUIET = {
    **CALIBRATED,
    "gyro_drift_sigma": 0.0,
    "gyro_noise_sigma": 0.0,
    "accelerometer_drift_sigma": 0.0,
    "accelerometer_noise_sigma": 0.0,
}
RECORD = ["reading.rate", "reading.specific_force"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def test_perfect_sensors_show_the_truth():
    truth = {"rate": (0.01, -0.02, 0.3), "specific_force": (0.1, -0.2, -9.7)}
    run = interpret(Imu, **QUIET, **truth)
    run.do_step(0.0, 0.01)
    np.testing.assert_array_equal(run.get("reading.rate"), truth["rate"])
    np.testing.assert_array_equal(run.get("reading.specific_force"), truth["specific_force"])
    assert (run.get("reading.valid"), run.get("reading.sequence"), run.get("reading.time_of_validity")) == (
        True,
        1,
        0.01,
    )


def test_scale_factor_and_null_shift_enter_as_in_3_2():
    run = interpret(
        Imu,
        **QUIET,
        rate=(0.1, -0.2, 0.3),
        specific_force=(1.0, 2.0, -9.0),
        gyro_scale_factor=(0.01, 0.02, -0.026),
        gyro_null_shift=(1e-3, -2e-3, 3e-3),
        accelerometer_scale_factor=(0.001, 0.0, -0.002),
        accelerometer_null_shift=(0.01, -0.02, 0.03),
    )
    run.do_step(0.0, 0.01)
    np.testing.assert_allclose(run.get("reading.rate"), [0.102, -0.206, 0.2952], rtol=1e-14)
    np.testing.assert_allclose(run.get("reading.specific_force"), [1.011, 1.98, -8.952], rtol=1e-14)


def test_nothing_is_measured_before_the_first_sample():
    run = interpret(Imu, rate=(1.0, 1.0, 1.0))
    assert not run.get("reading.valid") and run.get("reading.sequence") == 0
    np.testing.assert_array_equal(run.get("reading.rate"), 0.0)
    run.do_step(0.0, 0.009)
    assert run.get("reading.sequence") == 0


@pytest.mark.parametrize("grade", GRADES)
def test_a_grade_has_the_noise_and_drift_of_table_3_2(native, grade):
    """Noise from differences of successive samples, drift from 200 turn-ons; bounds at a probability of 1e-6."""
    wanted = {**GRADES[grade], **CALIBRATED}
    still = native.run(40.0, 0.01, RECORD, wanted)
    for signal, name in (("reading.rate", "gyro"), ("reading.specific_force", "accelerometer")):
        steps = np.diff(still[signal][1:], axis=0)[::2].ravel()
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], steps.size) / steps.size
        # every fifth of these differences spans a step of the drift
        drift_step = 2 * wanted[f"{name}_drift_sigma"] ** 2 * 0.1 / wanted[f"{name}_drift_time"]
        expected = 2 * wanted[f"{name}_noise_sigma"] ** 2 + drift_step / 5
        assert low < np.mean(steps**2) / expected < high
    drifts = []
    for seed in range(200):
        once = {**wanted, "gyro_noise_sigma": 0.0, "accelerometer_noise_sigma": 0.0, "seed": seed, "sample_period": 1.0}
        run = native.run(wanted["gyro_drift_time"], wanted["gyro_drift_time"], RECORD, once)
        drifts.append([run["reading.rate"][-1], run["reading.specific_force"][-1] + (0.0, 0.0, 9.80665)])
    drifts = np.array(drifts)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 600) / 600
    assert low < np.mean(drifts[:, 0] ** 2) / wanted["gyro_drift_sigma"] ** 2 < high
    assert low < np.mean(drifts[:, 1] ** 2) / wanted["accelerometer_drift_sigma"] ** 2 < high


def test_drift_is_correlated_over_its_time_constant(native):
    """One long run: the autocorrelation of the gyro drift at lag tau is 1/e, and 1 at lag 0, of three axes."""
    tau = 20.0
    parameters = {**QUIET, "gyro_drift_sigma": 1e-3, "gyro_drift_time": tau}
    drift = native.run(20000.0, tau / 4, ["reading.rate"], {**parameters, "sample_period": 1.0})["reading.rate"][1:]
    variance = np.mean(drift**2, axis=0)
    count = len(drift) / 8.0  # effective number of independent values, two time constants apart
    assert np.max(np.abs(variance / 1e-6 - 1.0)) < 4.9 * np.sqrt(2.0 / count)
    r = np.mean(drift[4:] * drift[:-4], axis=0) / variance
    assert np.max(np.abs(r - np.exp(-1.0))) < 4.9 / np.sqrt(count)


def test_drift_does_not_depend_on_how_often_it_is_advanced(native):
    """sigma stays the same at another drift_period: 300 seeds, 1000 s after turn-on."""
    ends = []
    for seed in range(300):
        parameters = {
            **QUIET,
            "gyro_drift_sigma": 1e-3,
            "gyro_drift_time": 300.0,
            "drift_period": 10.0,
            "sample_period": 1.0,
            "seed": seed,
        }
        ends.append(native.run(1000.0, 1000.0, ["reading.rate"], parameters)["reading.rate"][-1])
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 900) / 900
    assert low < np.mean(np.square(ends)) / 1e-6 < high


def test_null_shift_is_drawn_once_per_turn_on(native):
    shifts = []
    for seed in range(300):
        parameters = {**QUIET, "gyro_null_shift": 0.5, "gyro_null_shift_sigma": (0.1, 0.2, 0.3), "seed": seed}
        rates = native.run(2.0, 1.0, ["reading.rate"], parameters)["reading.rate"]
        np.testing.assert_array_equal(rates[1], rates[2])
        shifts.append((rates[1] - 0.5) / (0.1, 0.2, 0.3))
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 900) / 900
    assert low < np.mean(np.square(shifts)) < high
    assert np.max(np.abs(np.mean(shifts, axis=0))) < 4.9 / np.sqrt(300)


@pytest.mark.parametrize("grade", GRADES)
def test_turn_on_errors_have_the_sigma_of_their_grade(native, grade):
    """400 turn-ons: what a truth of g on one axis and 1 rad/s on one axis makes of each error; bounds at 1e-6.

    A default of zero, a scale factor that is drawn for all axes at once, a misalignment of the wrong sign in one of the
    two triads and errors that do not depend on the seed all fail.
    """
    wanted = GRADES[grade]
    silent = {f"{sensor}_{error}_sigma": 0.0 for sensor in ("gyro", "accelerometer") for error in ("drift", "noise")}
    truths = {name: np.eye(3) for name in ("rate", "specific_force")}
    readings = {name: np.empty((400, 4, 3)) for name in truths}
    for seed in range(400):
        for axis in range(4):  # the fourth time nothing is there to be measured
            truth = {name: list(matrix[axis]) if axis < 3 else [0.0] * 3 for name, matrix in truths.items()}
            run = native.run(0.01, 0.01, RECORD, {**wanted, **silent, "seed": seed}, lambda t, truth=truth: truth)
            for name in truths:
                readings[name][seed, axis] = run[f"reading.{name}"][-1]
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 1200) / 1200
    turned = {}
    for name, sensor in (("rate", "gyro"), ("specific_force", "accelerometer")):
        shifts = readings[name][:, 3]
        matrix = readings[name][:, :3] - shifts[:, None] - np.eye(3)  # row: axis of the truth, column: of the sensor
        gains = np.diagonal(matrix, axis1=1, axis2=2)
        turned[name] = np.stack([matrix[:, 2, 1], matrix[:, 0, 2], matrix[:, 1, 0]], axis=1)
        assert low < np.mean(shifts**2) / wanted[f"{sensor}_null_shift_sigma"] ** 2 < high
        assert low < np.mean(gains**2) / wanted[f"{sensor}_scale_factor_sigma"] ** 2 < high
        # to first order; the scale factor of the sensor's axis multiplies it
        assert low < np.mean(turned[name] ** 2) / wanted["misalignment_sigma"] ** 2 < high
        everything = np.hstack([shifts, gains, turned[name]])
        correlation = np.corrcoef(everything.T) - np.eye(9)
        assert np.max(np.abs(correlation)) < 5.3 / np.sqrt(400)
    np.testing.assert_allclose(turned["rate"], turned["specific_force"], atol=0.2 * wanted["misalignment_sigma"])


def test_axes_and_sensors_have_noise_of_their_own(native):
    run = native.run(30.0, 0.01, RECORD)
    noise = np.hstack([np.diff(run[name][1:], axis=0)[::2] for name in RECORD])
    correlation = np.corrcoef(noise.T) - np.eye(6)
    assert np.max(np.abs(correlation)) < 5.5 / np.sqrt(len(noise))


def test_integrated_noise_is_the_angle_random_walk_of_appendix_b(native):
    """(B.10): after T the angle has sigma_w sqrt(T / f_s)."""
    angles = []
    for seed in range(60):
        parameters = {**QUIET, "gyro_noise_sigma": 1e-3, "seed": seed}
        angles.append(np.sum(native.run(10.0, 0.01, ["reading.rate"], parameters)["reading.rate"][1:], axis=0) * 0.01)
    expected = 1e-3 * np.sqrt(10.0 / 100.0)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 180) / 180
    assert low < np.mean(np.square(angles)) / expected**2 < high


def test_grades_are_the_numbers_of_the_thesis():
    degree, g = np.pi / 180, 9.80665
    assert GRADES["tactical"]["gyro_drift_sigma"] == pytest.approx(0.35 * degree / 3600)
    assert GRADES["automotive"]["gyro_drift_sigma"] == pytest.approx(0.05 * degree)  # of the Crossbow DMU-6X
    assert GRADES["tactical"]["accelerometer_noise_sigma"] == pytest.approx(0.5e-3 * g)
    for name in ("gyro_drift_sigma", "accelerometer_drift_sigma"):  # twice as bad, section 3.5
        assert GRADES["consumer"][name] == pytest.approx(2 * GRADES["automotive"][name])
    for grade in GRADES.values():
        assert set(grade) <= set(Imu.layout.fields)


def test_which_number_is_whose_is_kept():
    """Readings of the start values, from (3.2)-(3.5) with the numbers in their places; whoever adds an error adds its
    numbers behind these, or all recorded figures of the systems change for nothing."""
    run = interpret(Imu, seed=7, rate=(0.1, -0.2, 0.3))
    p = {name: np.array(run.get(name)) for name in Imu.layout.fields if name.endswith(("_sigma", "_time"))}
    stream = run.get("stream")
    n = Normals(7, stream, 0, 0)(21)
    turn = p["misalignment_sigma"] * n[12:15]
    decay = np.exp(-0.1 / p["gyro_drift_time"])
    drift = p["gyro_drift_sigma"] * n[6:9]
    gain, shift = 1.0 + p["gyro_scale_factor_sigma"] * n[15:18], p["gyro_null_shift_sigma"] * n[0:3]
    true = np.array([0.1, -0.2, 0.3])
    for k in range(1, 25):
        run.do_step(0.01 * (k - 1), 0.01)
        if k % 10 == 0:
            drive = p["gyro_drift_sigma"] * np.sqrt(1.0 - decay**2)
            drift = decay * drift + drive * Normals(7, stream, k // 10, 1)(6)[:3]
        noise = p["gyro_noise_sigma"] * Normals(7, stream, k, 2)(6)[:3]
        expected = gain * (true - np.cross(turn, true)) + shift + drift + noise
        np.testing.assert_allclose(run.get("reading.rate"), expected, rtol=1e-12)
