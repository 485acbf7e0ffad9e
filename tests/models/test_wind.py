"""The Berman-Powell wind: stationary from the first moment, with its correlation over travelling time."""

import numpy as np
import pytest
from scipy import stats

from fmus.air.wind import Wind
from tests.models.native import Native, interpret

COUNT = 400


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Wind, tmp_path_factory.mktemp("wind"))


def ensemble(native, ratio, stop=400.0):
    """North and east wind of many seeds at the begin and the end."""
    runs = []
    for seed in range(COUNT):
        values = native.run(
            stop, stop, ["wind_n"], {"seed": seed, "travelling_time_ratio": ratio, "mean_n": (3.0, -7.0, 0.5)}
        )["wind_n"]
        runs.append(values)
    return np.array(runs)


def test_the_wind_has_5_metres_per_second_and_400_seconds(native):
    """Mean, sigma at t = 0 and 400 s later, correlation e^-1 between; north and east independent. Bounds at 1e-6."""
    runs = ensemble(native, 1.0)
    np.testing.assert_array_equal(runs[:, :, 2], 0.5)  # no vertical variation
    variation = runs[:, :, :2] - (3.0, -7.0)
    assert np.max(np.abs(np.mean(variation, axis=0))) < 4.9 * 5.0 / np.sqrt(COUNT)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], COUNT) / COUNT
    for moment in (0, 1):
        for axis in (0, 1):
            assert low < np.mean(variation[:, moment, axis] ** 2) / 25.0 < high
    bound = 4.9 / np.sqrt(COUNT - 3)
    for axis in (0, 1):
        r = np.corrcoef(variation[:, 0, axis], variation[:, 1, axis])[0, 1]
        assert abs(np.arctanh(r) - np.arctanh(np.exp(-1.0))) < bound
    assert abs(np.arctanh(np.corrcoef(variation[:, 0, 0], variation[:, 0, 1])[0, 1])) < bound


def test_travelling_time_shortens_the_correlation(native):
    """In a climb the travelling time is twice the time: the correlation over 400 s is e^-2."""
    variation = ensemble(native, 2.0)[:, :, :2] - (3.0, -7.0)
    r = np.corrcoef(variation[:, 0].ravel(), variation[:, 1].ravel())[0, 1]
    assert abs(np.arctanh(r) - np.arctanh(np.exp(-2.0))) < 4.9 / np.sqrt(2 * COUNT - 3)


def test_steps_have_the_exact_size(native):
    """Squared steps over 0.1 s average to 2 sigma^2 (1 - phi)."""
    values = native.run(2000.0, 0.1, ["wind_n"], {"sigma": (4.0, 4.0, 4.0)})["wind_n"]
    steps = np.diff(values, axis=0).ravel()
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], steps.size) / steps.size
    assert low < np.mean(steps**2) / (2 * 16.0 * (1 - np.exp(-0.1 / 400.0))) < high


def test_the_wind_is_held_between_samples():
    run = interpret(Wind)
    first = run.get("wind_n")
    run.do_step(0.0, 0.05)
    np.testing.assert_array_equal(run.get("wind_n"), first)
    run.do_step(0.05, 0.05)
    assert np.all(run.get("wind_n")[:2] != first[:2])
