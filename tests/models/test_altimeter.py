"""The altimeter's errors over distance and per reading: sigmas, correlation, independence; bounds at 1e-6.

Dyment and Liang (AGARD CP-298, p. 15-10 f.): 10 m, 100 km, and 2.7^2 + (0.0035 h)^2 m2.
"""

import numpy as np
import pytest
from scipy import stats

from fmus.air.air_data import AirData
from tests.models.native import Native
from tests.models.test_pitot_static import QUIET

FIELD = {**QUIET, "altitude_field_sigma": 10.0, "altitude_field_distance": 100e3}
COUNT = 300


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(AirData, tmp_path_factory.mktemp("air_data"))


def altitudes(native, stop, step, parameters, speed=(0.0, 0.0, 0.0), altitude=3000.0):
    inputs = {"altitude": altitude, "velocity_n": speed}
    return native.run(stop, step, ["air.pressure_altitude"], parameters, lambda t: inputs)["air.pressure_altitude"][1:]


@pytest.mark.parametrize("speed", [(30.0, -40.0, 20.0), (0.0, 200.0, 0.0)])
def test_bias_is_correlated_over_the_distance_flown(native, speed):
    """300 seeds, the first sample and 50 km later, 1000 s or 250 s: sigma both times and correlation exp(-1/2).

    One over time is not the same at both speeds; one with the wrong drive is off at the second time; one that starts
    from 0 at the first.
    """
    true = altitudes(native, 0.1, 0.1, QUIET, speed)[0]
    stop = 50e3 / np.hypot(speed[0], speed[1])
    errors = []
    for seed in range(COUNT):
        found = altitudes(native, stop, stop, {**FIELD, "seed": seed, "sample_period": 1.0}, speed)
        first = altitudes(native, 1.0, 1.0, {**FIELD, "seed": seed, "sample_period": 1.0}, speed)
        errors.append((first[0] - true, found[0] - true))
    errors = np.array(errors)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], COUNT) / COUNT
    for moment in (0, 1):
        assert low < np.mean(errors[:, moment] ** 2) / 10.0**2 < high
    r = np.corrcoef(errors.T)[0, 1]
    distance = 50e3 - np.hypot(speed[0], speed[1])
    assert abs(np.arctanh(r) - np.arctanh(np.exp(-distance / 100e3))) < 4.9 / np.sqrt(COUNT - 3)


def test_straight_up_the_bias_stays(native):
    """No distance over the ground; one of the whole velocity goes 5 km in these 100 s."""
    found = altitudes(native, 100.0, 1.0, {**FIELD, "seed": 3}, (0.0, 0.0, -50.0))
    assert np.ptp(found) < 1e-9 and abs(found[0] - altitudes(native, 0.1, 0.1, QUIET)[0]) > 0.1


def test_noise_of_a_reading_grows_with_height(native):
    """2.7 m at sea level, hypot(2.7, 10.5) m at 3 km; independent from reading to reading."""
    noise = {**QUIET, "altitude_noise_sigma": 2.7, "altitude_noise_slope": 0.0035}
    count = 2000
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], count - 1) / (count - 1)
    for height, sigma in ((0.0, 2.7), (3000.0, np.hypot(2.7, 10.5))):
        found = altitudes(native, 0.1 * count, 0.1, noise, altitude=height)
        assert low < np.var(found, ddof=1) / sigma**2 < high
        assert abs(np.corrcoef(found[1:], found[:-1])[0, 1]) < 4.9 / np.sqrt(count)


def test_every_step_size_has_the_same_errors_and_every_seed_others(native):
    """At 1 s, 2 s and 5 s: what is shown every 10 s is the same to the last bit."""
    everything = {"altitude_field_sigma": 10.0, "altitude_noise_sigma": 2.7, "airspeed_noise_sigma": 1.0}
    speed = (60.0, 0.0, 0.0)
    at_one, at_two, at_five = (
        altitudes(native, 200.0, step, {**everything, "seed": 5}, speed)[round(10 / step) - 1 :: round(10 / step)]
        for step in (1.0, 2.0, 5.0)
    )
    assert np.array_equal(at_one, at_two) and np.array_equal(at_one, at_five)
    other = altitudes(native, 200.0, 1.0, {**everything, "seed": 6}, speed)[9::10]
    assert np.all(at_one != other)
