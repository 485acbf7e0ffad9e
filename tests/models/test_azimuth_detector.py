"""The magnetic azimuth detector: level, hanging askew, off by iron, and its random errors."""

import numpy as np
import pygeomag
import pytest
from scipy import stats

from fmus.magnetic.azimuth_detector import AzimuthDetector
from models.attitude import attitude
from models.magnetic import magnetic_field
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret

DEG = np.pi / 180.0
G = 9.80665
PLACE = {"latitude": 37.72 * DEG, "longitude": -121.61 * DEG, "altitude": 1500.0}
QUIET = {"drift_sigma": 0.0, "noise_sigma": 0.0}
FIELD_N = magnetic_field.field(*PLACE.values(), 2026.0)
H, Z = np.hypot(FIELD_N[0], FIELD_N[1]), FIELD_N[2]
DECLINATION = np.arctan2(FIELD_N[1], FIELD_N[0])
HEADINGS = np.arange(12) * 30.0 * DEG


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(AzimuthDetector, tmp_path_factory.mktemp("azimuth_detector"))


def shown(native, parameters=None, **inputs):
    """Magnetic heading in rad after 2 s."""
    given = {**PLACE, **inputs}
    run = native.run(2.0, 1.0, ["azimuth.magnetic_heading"], {**QUIET, **(parameters or {})}, lambda t: given)
    return run["azimuth.magnetic_heading"][-1]


@pytest.mark.parametrize(("date", "name"), [(2012.8, "2010"), (2018.5, "2015v2"), (2021.0, "2020"), (2026.0, "2025")])
def test_level_it_shows_the_heading_from_magnetic_north(native, date, name):
    """Less the declination by pygeomag, also where pitch and roll are not zero; one added, or a mirrored one, fails."""
    chart = pygeomag.GeoMag(coefficients_file=f"wmm/WMM_{name}.COF")
    declination = chart.calculate(glat=37.72, glon=-121.61, alt=1.5, time=date).d * DEG
    for heading in HEADINGS:
        for tilt in ({}, {"roll": 0.3, "pitch": -0.2}):
            error = attitude.wrap(shown(native, {"date": date}, heading=heading, **tilt) - (heading - declination))
            assert abs(error) < 1e-8


@pytest.mark.parametrize("bank", [-15.0 * DEG, 15.0 * DEG, 30.0 * DEG])
def test_in_a_coordinated_turn_it_measures_of_the_steep_field(native, bank):
    """Across the aircraft's own z axis: tan = (H sin psi cos phi - Z sin phi) / (H cos psi).

    On magnetic north that is -24 degrees at 15 degrees of bank and a dip of 60: against the turn.
    """
    force = [0.0, 0.0, -G / np.cos(bank)]
    for heading in HEADINGS:
        psi = heading - DECLINATION
        expected = np.arctan2(H * np.sin(psi) * np.cos(bank) - Z * np.sin(bank), H * np.cos(psi))
        seen = shown(native, heading=heading, roll=bank, specific_force=force)
        assert abs(attitude.wrap(seen - expected)) < 1e-9
    north = attitude.wrap(shown(native, heading=DECLINATION, roll=bank, specific_force=force))
    assert north == pytest.approx(-np.arctan(Z / H * np.sin(bank)), abs=1e-9) and north * bank < 0.0


def test_accelerating_it_turns_to_the_north_and_slowing_down_to_the_south(native):
    """Level with 1 m/s2: tan = H sin psi / (H cos psi cos gamma + Z sin gamma), tan gamma = a / g."""
    for acceleration in (1.0, -1.0):
        gamma = np.arctan(acceleration / G)
        for heading in HEADINGS:
            psi = heading - DECLINATION
            expected = np.arctan2(H * np.sin(psi), H * np.cos(psi) * np.cos(gamma) + Z * np.sin(gamma))
            seen = shown(native, heading=heading, specific_force=[acceleration, 0.0, -G])
            assert abs(attitude.wrap(seen - expected)) < 1e-9
        east = shown(native, heading=90.0 * DEG + DECLINATION, specific_force=[acceleration, 0.0, -G])
        assert (east < 80.0 * DEG) if acceleration > 0 else (east > 100.0 * DEG)


def test_the_deviation_is_the_series_of_the_swing(native):
    """A ... E over the magnetic heading, thesis (3.52): found again by least squares (3.53)."""
    told = np.array([1.0, -2.0, 3.0, 0.5, -0.7]) * DEG
    for name, parameters, inputs in (
        ("given", {"deviation": told}, {}),
        ("fault", {}, {"deviation_change": told}),
        ("both", {"deviation": 0.25 * told}, {"deviation_change": 0.75 * told}),
    ):
        errors = [
            attitude.wrap(shown(native, parameters, heading=psi + DECLINATION, **inputs) - psi) for psi in HEADINGS
        ]
        columns = [np.ones(12), *(f(n * HEADINGS) for n in (1, 2) for f in (np.sin, np.cos))]
        found = np.linalg.lstsq(np.stack(columns, axis=1), errors, rcond=None)[0]
        np.testing.assert_allclose(found, told, atol=1e-9, err_msg=name)


def test_a_change_of_the_deviation_acts_at_once_and_leaves_nothing_behind(native):
    """F16, F17: a magnet beside it from 2 to 4 s. Bit for bit the same before and after."""

    def flown(change):
        def inputs(t):
            acts = 2.0 - 1e-9 < t < 4.0 - 1e-9
            return {**PLACE, "heading": 1.0, "deviation_change": [0.0, change if acts else 0.0, 0.0, 0.0, 0.0]}

        return native.run(6.0, 0.05, ["azimuth.magnetic_heading"], {"seed": 4}, inputs)["azimuth.magnetic_heading"][1:]

    changed, sound = flown(0.1), flown(0.0)
    np.testing.assert_array_equal(changed[:40], sound[:40])
    np.testing.assert_array_equal(changed[80:], sound[80:])
    expected = 0.1 * np.sin(1.0 - DECLINATION)
    np.testing.assert_allclose(changed[40:80] - sound[40:80], expected, rtol=1e-9)


def test_slow_error_and_noise_have_their_sigmas_and_the_slow_one_its_time(native):
    """Over 400 seeds, at 1 s and at 121 s: the slow error is stationary from the first sample, a correlation of exp(-1)
    between the two. Bounds at 1e-6 of chi squared and of Fisher's z."""
    truth = attitude.wrap(1.0 - DECLINATION)
    slow = []
    for seed in range(400):
        values = {"noise_sigma": 0.0, "seed": seed, "sample_period": 1.0, "field_period": 1.0}
        given = {**PLACE, "heading": 1.0}
        run = native.run(121.0, 1.0, ["azimuth.magnetic_heading"], values, lambda t, given=given: given)
        slow.append(run["azimuth.magnetic_heading"][[1, 121]] - truth)
    slow = np.array(slow) / (2.5 * DEG)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 400) / 400
    assert low < np.min(np.mean(slow**2, axis=0)) and np.max(np.mean(slow**2, axis=0)) < high
    rho = np.corrcoef(slow.T)[0, 1]
    assert abs(np.arctanh(rho) - np.arctanh(np.exp(-1.0))) < stats.norm.isf(5e-7) / np.sqrt(397)


def test_twenty_samples_of_the_noise_are_the_thesis_eight_tenths_of_a_degree(native):
    """3.5 degrees a sample at 20 Hz; means over a second have 0.78, which (3.86) rounds. 400 s, bounds at 1e-6."""
    given = {**PLACE, "heading": 1.0}
    run = native.run(
        401.0, 0.05, ["azimuth.magnetic_heading"], {"drift_sigma": 0.0, "seed": 8}, lambda t: given
    )["azimuth.magnetic_heading"][21:]  # fmt: skip
    noise = run - attitude.wrap(1.0 - DECLINATION)
    for values, sigma in ((noise, 3.5 * DEG), (noise.reshape(-1, 20).mean(axis=1), 3.5 / np.sqrt(20.0) * DEG)):
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], len(values)) / len(values)
        assert low < np.mean(values**2) / sigma**2 < high
    assert 3.5 / np.sqrt(20.0) == pytest.approx(0.8, abs=0.05)


def test_near_the_magnetic_pole_the_heading_is_not_valid():
    """At 86 degrees north, 140 east in 2026 the horizontal field is some 200 nT; new samples come all the same."""
    run = interpret(AzimuthDetector, **{**QUIET, "latitude": 86.0 * DEG, "longitude": 140.0 * DEG})
    run.do_step(0.0, 2.0)
    assert not run.get("azimuth.valid") and run.get("azimuth.sequence") == 21
    run = interpret(AzimuthDetector, **{**QUIET, "latitude": 80.0 * DEG, "longitude": 0.0})
    run.do_step(0.0, 2.0)
    assert run.get("azimuth.valid")


def test_a_date_without_a_model_is_refused_with_a_sentence():
    with pytest.raises(NavfmuError, match=r"the date 2009.5 is outside .*are valid from 2010.0 to 2030.0"):
        interpret(AzimuthDetector, date=2009.5)
