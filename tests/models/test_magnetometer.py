"""The triad's errors in closed form."""

import numpy as np
import pygeomag
import pytest
from scipy import stats

from fmus.grades import CRUSTAL_LENGTH, MAGNETOMETER
from fmus.magnetic.magnetometer import Magnetometer
from models.attitude import attitude
from models.earth import earth
from models.magnetic import magnetic_field, magnetometer
from tests.models.native import Native, interpret

MG = 1e-7
PLAIN = {"crustal_level": 0.0}
CALIBRATED = {**PLAIN, "soft_iron_sigma": 0.0, "scale_factor_sigma": 0.0, "misalignment_sigma": 0.0}
QUIET = {**CALIBRATED, "hard_iron_sigma": 0.0, "noise_sigma": 0.0}
PLACE = {"latitude": 0.6583, "longitude": -2.1225, "altitude": 1500.0}


@pytest.fixture(scope="module")
def reference():
    return pygeomag.GeoMag(coefficients_file="wmm/WMM_2025.COF")


def reference_field(reference, latitude, longitude, altitude, date):
    r = reference.calculate(glat=np.degrees(latitude), glon=np.degrees(longitude), alt=altitude / 1e3, time=date)
    return np.array([r.x, r.y, r.z]) * 1e-9


def test_a_perfect_triad_measures_the_field_in_body_axes(reference):
    angles = {"roll": 0.3, "pitch": -0.1, "heading": 2.2}
    run = interpret(Magnetometer, **QUIET, **PLACE, **angles, date=2027.5)
    run.do_step(0.0, 1.0)
    expected = attitude.dcm(**angles).T @ reference_field(reference, *PLACE.values(), 2027.5)
    np.testing.assert_allclose(run.get("field.field_b"), expected, atol=1e-12)


def test_errors_enter_as_in_3_28():
    """C_m C_sf C_si (B + dB), the product written out, not the model's own function."""
    soft = np.array([[0.02, 0.01, 0.0], [-0.01, 0.03, 0.005], [0.0, 0.02, -0.02]])
    scale, tilt, hard, change = (
        np.array(v)
        for v in ([0.1, -0.05, 0.02], [0.01, -0.02, 0.03], [20 * MG, -30 * MG, 10 * MG], [5 * MG, 0.0, -8 * MG])
    )
    place = {**PLACE, "roll": 0.1, "pitch": 0.2, "heading": -1.0}
    errors = {"soft_iron": soft, "scale_factor": scale, "misalignment": tilt, "hard_iron": hard}
    run = interpret(Magnetometer, **QUIET, **place, **errors, hard_iron_change=change)
    run.do_step(0.0, 1.0)
    b = attitude.dcm(0.1, 0.2, -1.0).T @ magnetic_field.field(*PLACE.values(), 2026.0) + hard + change
    b = b + soft @ b
    b = b * (1 + scale)
    b = b - np.cross(tilt, b)
    np.testing.assert_allclose(run.get("field.field_b"), b, rtol=1e-13)


def test_residual_hard_iron_of_the_thesis_turns_the_heading_by_about_a_degree():
    """4 to 7 mG left by the calibration give up to 2.5 degrees (Fig 3.30): 7 mG across the horizontal field."""
    field = magnetic_field.field(*PLACE.values(), 2026.0)
    horizontal = np.hypot(field[0], field[1])
    assert 1.0 < np.degrees(np.arctan(7 * MG / horizontal)) < 2.5


def test_first_sample_follows_the_first_field():
    run = interpret(Magnetometer, **QUIET, **PLACE)
    run.do_step(0.0, 0.95)
    assert run.get("field.sequence") == 0 and not run.get("field.valid")
    run.do_step(0.95, 0.05)
    assert run.get("field.sequence") == 1 and run.get("field.valid")
    assert run.get("field.time_of_validity") == pytest.approx(1.0)
    run.do_step(1.0, 1.0)
    assert run.get("field.sequence") == 21


def test_noise_and_turn_on_have_their_sigma(tmp_path):
    native = Native(Magnetometer, tmp_path)
    place = {**PLACE, "roll": 0.0}
    run = native.run(100.0, 0.05, ["field.field_b"], {"noise_sigma": 3 * MG, "field_period": 0.05}, lambda t: place)
    noise = np.diff(run["field.field_b"][1:], axis=0)[::2].ravel() / (3 * MG)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], noise.size) / noise.size
    assert low < np.mean(noise**2) / 2.0 < high
    truth = magnetic_field.field(*PLACE.values(), 2026.0)
    left = []
    for seed in range(150):
        run = native.run(1.0, 1.0, ["field.field_b"], {**CALIBRATED, "noise_sigma": 0.0, "seed": seed}, lambda t: place)
        left.append((run["field.field_b"][-1] - truth) / (5 * MG))
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 450) / 450
    assert low < np.mean(np.square(left)) < high


def test_the_distortion_left_by_the_calibration_has_its_sigma(tmp_path):
    """400 turn-ons, each in three attitudes that turn the field through the axes; bounds at 1e-6.

    To first order the elements of C_m C_sf C_si - I off the diagonal are soft iron and misalignment, those on it soft
    iron and scale factor; a default of zero, one number for all elements, or a draw of the noise sequence fail.
    """
    native = Native(Magnetometer, tmp_path)
    truth_n = magnetic_field.field(*PLACE.values(), 2026.0)
    attitudes = [(0.0, 0.0, 0.0), (0.0, 0.0, np.pi / 2), (np.pi / 2, 0.0, 0.3)]
    truth = np.stack([attitude.dcm(*angles).T @ truth_n for angles in attitudes], axis=1)
    left = []
    for seed in range(400):
        quiet = {**PLAIN, "hard_iron_sigma": 0.0, "noise_sigma": 0.0, "seed": seed}
        measured = []
        for angles in attitudes:
            place = {**PLACE, **dict(zip(("roll", "pitch", "heading"), angles, strict=True))}
            run = native.run(1.0, 1.0, ["field.field_b"], quiet, lambda t, place=place: place)
            measured.append(run["field.field_b"][-1])
        left.append(np.stack(measured, axis=1) @ np.linalg.inv(truth) - np.eye(3))
    left = np.array(left)
    soft, scale, turned = (MAGNETOMETER[f"{name}_sigma"] for name in ("soft_iron", "scale_factor", "misalignment"))
    on = np.diagonal(left, axis1=1, axis2=2)
    off = left[:, ~np.eye(3, dtype=bool)].reshape(-1, 6)
    for values, sigma in ((on, np.hypot(soft, scale)), (off, np.hypot(soft, turned))):
        # each column has 400 independent values; columns of one pair share a misalignment
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 400) / 400
        variance = np.mean(values**2, axis=0) / sigma**2
        assert low < np.min(variance) and np.max(variance) < high
        assert np.max(np.abs(np.mean(values, axis=0))) < 4.9 * sigma / 20.0
    turn = (left[:, 0, 1] - left[:, 1, 0]) / 2.0
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 400) / 400
    assert low < np.mean(turn**2) / (turned**2 + soft**2 / 2.0) < high


def fly(native, seed, speed, longitude, count):
    """The anomaly over its standard deviation before and after a flight to the east: shape (2, 3)."""
    across = earth.radii(PLACE["latitude"])[1] + PLACE["altitude"]
    rate = speed / across / np.cos(PLACE["latitude"])

    def place(t):
        return {**PLACE, "longitude": attitude.wrap(longitude + rate * t)}

    period = 1000.0 / speed
    values = {**QUIET, "crustal_level": 1.0, "field_period": period, "sample_period": 10.0, "seed": seed}
    run = native.run((count + 1) * period, period, ["field_n"], values, place)["field_n"][[1, -1]]
    left = []
    for k, field_n in ((0, run[0]), (count, run[1])):
        # inputs are those of the begin of a step
        here = place(k * period)
        truth = magnetic_field.field(here["latitude"], here["longitude"], here["altitude"], 2026.0)
        left.append((field_n - truth) / magnetic_field.left_out(truth, 2026.0))
    return np.array(left)


@pytest.mark.parametrize(("speed", "longitude"), [(50.0, 0.3), (200.0, np.pi - 1e-4)])
def test_the_crustal_anomaly_is_correlated_over_the_distance_flown(tmp_path, speed, longitude):
    """400 flights of 10 km at two speeds, one over the date line: variance 1 before and after, correlation exp(-1) on
    each axis, none between axes. Bounds at 1e-6.

    What is correlated over time has another correlation at one of the speeds; a distance from differences of longitude
    has none over the date line, or too much without cos(latitude).
    """
    native, count = Native(Magnetometer, tmp_path), 400
    runs = np.array([fly(native, seed, speed, longitude, 10) for seed in range(count)])
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], count) / count
    variance = np.mean(runs**2, axis=0)
    assert low < np.min(variance) and np.max(variance) < high
    assert np.max(np.abs(np.mean(runs, axis=0))) < 4.9 / np.sqrt(count)
    bound = 4.9 / np.sqrt(count - 3)
    together = np.corrcoef(runs.reshape(count, 6).T)
    for a in range(6):
        for b in range(a):
            expected = np.exp(-1.0) if a - b == 3 else 0.0
            assert abs(np.arctanh(together[a, b]) - np.arctanh(expected)) < bound


def test_the_crustal_anomaly_of_an_aircraft_that_stands_does_not_change():
    run = interpret(Magnetometer, **{**QUIET, "crustal_level": 1.0}, **PLACE)
    run.do_step(0.0, 1.0)
    first = run.get("field_n")
    run.do_step(1.0, 60.0)
    np.testing.assert_array_equal(run.get("field_n"), first)
    assert np.linalg.norm(first - magnetic_field.field(*PLACE.values(), 2026.0)) > 10e-9


def test_the_crustal_length_leaves_to_long_waves_what_the_high_resolution_model_finds_in_them(reference):
    """Of degrees 13 to 133, waves beyond 300 km: the share of a Gauss-Markov process with the length is 2 / pi
    atan(2 pi L / 300 km), and that length is the least, for the aircraft is above the ground."""
    fine = pygeomag.GeoMag(coefficients_file="wmm/WMMHR_2025.COF", high_resolution=True)
    rng, squares = np.random.default_rng(3), []
    for _ in range(200):
        place = {"glat": np.degrees(np.arcsin(rng.uniform(-1, 1))), "glon": rng.uniform(-180, 180), "alt": 0.0}
        a, b = (model.calculate(**place, time=2026.0) for model in (fine, reference))
        squares.append((a.x - b.x) ** 2 + (a.y - b.y) ** 2 + (a.z - b.z) ** 2)
    told = b.calculate_uncertainty()
    share = np.mean(squares) / (told.x**2 + told.y**2 + told.z**2)
    least = 300e3 / (2.0 * np.pi) * np.tan(0.5 * np.pi * share)
    assert 0.5 * CRUSTAL_LENGTH < least < CRUSTAL_LENGTH


def test_misalignment_is_a_rotation_of_the_triad():
    """A triad turned to the right by a small angle sees the north field on its left: -angle * B on y."""
    matrix = magnetometer.distortion(np.zeros((3, 3)), np.zeros(3), np.array([0.0, 0.0, 0.01]))
    np.testing.assert_allclose(matrix @ [1.0, 0.0, 0.0], [1.0, -0.01, 0.0], atol=1e-15)
