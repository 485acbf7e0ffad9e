"""Dryden turbulence sampled exactly: MIL-F-8785C's spectra, correlations and heights, at any period, from the start."""

import numpy as np
import pytest
from scipy import stats

from fmus.air.wind import Wind
from models.air import turbulence
from tests.models.native import Native

CALM = {"sigma": np.zeros(3)}
SPEED, LENGTH = 50.0, 533.4
AXES = ("along", "across", "down")


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Wind, tmp_path_factory.mktemp("wind"))


def columns(function):
    """Matrix of a linear function of two numbers, on the axis across."""
    return np.stack([function(np.repeat(np.eye(2)[:, [k]], 3, axis=1))[:, 1] for k in (0, 1)], axis=1)


def correlation(axis, x):
    """Over the distance x L, of the spectra of MIL-F-8785C: exp(-x), and exp(-x) (1 - x / 2)."""
    return np.exp(-x) * (1.0 if axis == 0 else 1.0 - 0.5 * x)


def spectrum(axis, frequency, period):
    """Of samples, per Hz from 0 to half the rate: the spectra of MIL-F-8785C in the time domain, folded."""
    total = 0.0
    for k in range(-200, 201):
        reduced = LENGTH * 2.0 * np.pi * np.abs(frequency + k / period) / SPEED  # Omega L
        one = 1.0 + reduced**2
        total = total + 2.0 * LENGTH / SPEED * (1.0 / one if axis == 0 else 0.5 * (1.0 + 3.0 * reduced**2) / one**2)
    return 2.0 * total


@pytest.mark.parametrize("ratio", [1e-5, 0.009, 0.3, 4.0, 60.0])
def test_the_levels_keep_their_distribution_over_any_period(ratio):
    """P = A P A' + Q to rounding: noise that is held for the period misses this by theta^2 / 12."""
    theta = np.full(3, ratio)
    drawn = columns(turbulence.stationary)
    p = drawn @ drawn.T
    a = columns(lambda levels: turbulence.advance(levels, theta, np.zeros((2, 3))))
    root = columns(lambda normals: turbulence.advance(np.zeros((2, 3)), theta, normals))
    np.testing.assert_allclose(a @ p @ a.T + root @ root.T, p, rtol=0, atol=1e-14)
    np.testing.assert_allclose(p, [[1.0, 0.5], [0.5, 0.5]], rtol=0, atol=1e-15)


def test_an_aircraft_that_stands_still_keeps_its_gust():
    levels = turbulence.stationary(np.arange(6.0).reshape(2, 3))
    np.testing.assert_array_equal(turbulence.advance(levels, np.zeros(3), np.ones((2, 3))), levels)


@pytest.mark.parametrize("x", [0.01, 0.5, 2.0, 3.0, 7.0])
def test_correlations_over_distance(x):
    """From the transition itself; one in a single step and in ten are the same."""
    for steps in (1, 10):
        theta = np.full(3, x / steps)
        levels = [np.repeat(np.eye(2)[:, [k]], 3, axis=1) for k in (0, 1)]
        later = levels
        for _ in range(steps):
            later = [turbulence.advance(one, theta, np.zeros((2, 3))) for one in later]
        before, after = (np.stack([turbulence.gust(one, np.ones(3)) for one in of]) for of in (levels, later))
        p = np.array([[1.0, 0.5], [0.5, 0.5]])
        for axis in (0, 1, 2):
            assert before[:, axis] @ p @ before[:, axis] == pytest.approx(1.0, abs=1e-14)
            assert after[:, axis] @ p @ before[:, axis] == pytest.approx(correlation(axis, x), abs=1e-13)


def test_sigma_at_the_first_sample_and_after_it(native):
    """Over 400 seeds at t = 0 and a correlation length later; bounds of chi-square at 1e-6 each."""
    sigma = (2.0, 3.0, 1.5)
    parameters = {**CALM, "turbulence_sigma": sigma, "true_airspeed": SPEED}
    stop = round(LENGTH / SPEED, 1)
    runs = np.array([native.run(stop, stop, ["wind_n"], {**parameters, "seed": s})["wind_n"] for s in range(400)])
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 400) / 400
    ratio = np.mean(runs**2, axis=0) / np.square(sigma)
    assert np.all((ratio > low) & (ratio < high)), ratio
    for axis in (0, 1, 2):
        r = np.corrcoef(runs[:, 0, axis], runs[:, 1, axis])[0, 1]
        expected = correlation(axis, stop * SPEED / LENGTH)
        assert abs(np.arctanh(r) - np.arctanh(expected)) < 4.9 / np.sqrt(400 - 3), AXES[axis]


@pytest.mark.parametrize(
    ("period", "speed", "count"), [(0.1, SPEED, 4000), (1.0, SPEED, 4000), (8.0, SPEED, 4000), (10.0, 300.0, 40000)]
)
def test_sigma_does_not_depend_on_the_period(native, period, speed, count):
    """Of 4000 or 40 000 samples, in the bounds of as many independent ones as the correlations leave.

    The mean square has the variance 2 / n_eff, n_eff = n / (1 + 2 sum rho^2); 4.9 standard deviations.

    At 300 m/s and 10 s all is new at each sample: the noise that only the second lag has is 7 % of the variance there.
    """
    parameters = {**CALM, "turbulence_sigma": np.ones(3), "true_airspeed": speed, "sample_period": period}
    values = native.run(count * period, period, ["wind_n"], {**parameters, "seed": 12})["wind_n"][1:]
    for axis in (0, 1, 2):
        rho = correlation(axis, np.arange(1, count) * period * speed / LENGTH)
        effective = count / (1.0 + 2.0 * np.sum(rho**2))
        assert abs(np.mean(values[:, axis] ** 2) - 1.0) < 4.9 * np.sqrt(2.0 / effective), AXES[axis]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_spectra_of_the_specification(native, axis):
    """Periodograms of 300 seeds of 51.2 s at 10 Hz against the spectrum, in bands of 16 lines: chi-square at 1e-6.

    A Hann window, of which every other line is taken, so that lines are as good as independent. The spectrum across is
    0.5 of that along at low and 1.5 at high frequencies, so either in place of the other fails.
    """
    period, count, seeds = 0.1, 512, 300
    parameters = {**CALM, "turbulence_sigma": np.ones(3), "true_airspeed": SPEED}
    window = np.hanning(count + 1)[:-1]
    power = np.zeros(count // 2 + 1)
    for seed in range(seeds):
        run = native.run((count - 1) * period, period, ["wind_n"], {**parameters, "seed": seed})["wind_n"]
        power += np.abs(np.fft.rfft(window * run[:, axis])) ** 2
    power *= 2.0 * period / np.sum(window**2) / seeds
    lines = np.arange(4, count // 2 - 1, 2)
    measured = power[lines] / spectrum(axis, lines / (count * period), period)
    bands = [measured[k : k + 8] for k in range(0, len(measured) - 7, 8)]
    for band in bands:
        degrees = 2 * seeds * len(band)
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], degrees) / degrees
        assert low < np.mean(band) < high
    assert len(bands) >= 15


def test_intensities_and_lengths_near_the_ground():
    """At 100 ft by hand: 0.177 + 0.0823 = 0.2593, to the power -1.2 5.052, to the power -0.4 1.716. At 1000 ft all are
    alike, at 1500 ft half-way to what is given, above 2000 ft as given, below 10 ft as at 10 ft."""
    foot, given, scale = 0.3048, np.array([2.0, 3.0, 4.0]), 533.4
    sigma, length = turbulence.by_height(100 * foot, 15.0, given, scale)
    np.testing.assert_allclose(sigma, [1.5 * 1.716, 1.5 * 1.716, 1.5], rtol=3e-4)
    np.testing.assert_allclose(length, np.array([505.2, 505.2, 100.0]) * foot, rtol=3e-4)
    sigma, length = turbulence.by_height(1000 * foot, 15.0, given, scale)
    np.testing.assert_allclose(sigma, 1.5, rtol=1e-12)
    np.testing.assert_allclose(length, 1000 * foot, rtol=1e-12)
    sigma, length = turbulence.by_height(1500 * foot, 15.0, given, scale)
    np.testing.assert_allclose(sigma, 0.5 * (1.5 + given), rtol=1e-12)
    np.testing.assert_allclose(length, 0.5 * (1000 * foot + scale), rtol=1e-12)
    sigma, length = turbulence.by_height(9000 * foot, 15.0, given, scale)
    np.testing.assert_allclose(sigma, given, rtol=1e-12)
    np.testing.assert_allclose(length, scale, rtol=1e-12)
    for low, ten in zip(
        turbulence.by_height(-5.0, 15.0, given, scale), turbulence.by_height(10 * foot, 15.0, given, scale), strict=True
    ):
        np.testing.assert_array_equal(low, ten)


def test_axes_follow_the_track(native):
    """Flying to the south-west a gust along the track is as much south as west, one to the right north-west."""
    velocity = {"velocity_n": (-30.0, -30.0, 2.0)}
    for axis, direction in ((0, (-1.0, -1.0, 0.0)), (1, (1.0, -1.0, 0.0)), (2, (0.0, 0.0, np.sqrt(2.0)))):
        sigma = 2.0 * np.eye(3)[axis]
        run = native.run(20.0, 0.1, ["wind_n", "turbulence_levels"], {**CALM, **velocity, "turbulence_sigma": sigma})
        gusts = np.array([turbulence.gust(levels.reshape(2, 3), sigma)[axis] for levels in run["turbulence_levels"]])
        np.testing.assert_allclose(run["wind_n"], gusts[:, None] * np.array(direction) / np.sqrt(2.0), atol=1e-12)
        assert np.std(gusts) > 0.2
