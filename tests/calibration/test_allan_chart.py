"""Allan charts by allantools, and the closed forms of the terms by their definitions. Thesis Table C.1."""

from __future__ import annotations

import allantools
import numpy as np
import pytest

from navfmu.calibration.allan.chart import chart
from navfmu.calibration.allan.stretches import quiet
from navfmu.calibration.allan.terms import GAUSS_MARKOV, RANDOM_WALK, TERMS, gauss_markov


def test_the_chart_is_that_of_allantools():
    """Overlapping averages, at every octave. Wrong: averages that do not overlap, n of them too few, no half."""
    samples = np.cumsum(np.random.default_rng(1).standard_normal((1000, 2)), axis=0) + 1e6
    found = chart([samples], 0.02)
    for axis, column in enumerate(samples.T):
        times, expected, *_ = allantools.oadev(column, 50.0, "freq", found.time)
        np.testing.assert_allclose(times, found.time)
        np.testing.assert_allclose(found.deviation[:, axis], expected, rtol=1e-9)
    np.testing.assert_allclose(found.pairs, 1000 / (2 * 2.0 ** np.arange(7)))


def test_stretches_count_by_their_pairs():
    """Wrong: joined without a seam, where the step between them is a slow error; or the mean of the two charts."""
    one, two = np.random.default_rng(2).standard_normal((2, 4096, 1)) * [[[1.0]], [[3.0]]]
    both, first, second = chart([one, two[:2048] + 100.0], 1.0), chart([one], 1.0), chart([two[:2048]], 1.0)
    for level in range(8):
        span = 2**level
        counts = np.array([4096 - 2 * span + 1, 2048 - 2 * span + 1])
        parts = np.array([first.variance[level, 0], second.variance[level, 0]])
        assert both.variance[level, 0] == pytest.approx(counts @ parts / counts.sum(), rel=1e-9)


@pytest.mark.parametrize("correlation_time", [0.05, 1.0, 30.0, 3000.0])
def test_allan_variance_of_a_markov_process_is_that_of_its_covariance(correlation_time):
    """The definition: half the mean square of the difference of neighbouring averages, from exp(-|s - t|/tau)."""
    n, time = 400, 2.0
    t = (np.arange(2 * n) + 0.5) * time / n
    weight = np.repeat([1.0 / n, -1.0 / n], n)
    covariance = np.expm1(-np.abs(t[:, None] - t) / correlation_time)  # less 1, which the weights take out
    assert gauss_markov(time, correlation_time) == pytest.approx(0.5 * weight @ covariance @ weight, rel=1e-3)


def test_a_markov_process_has_no_step_where_the_series_ends():
    """Relative to 1e-12. The closed form alone is wrong by a part in 10^4 at T = 10^-6 tau."""
    below, above = gauss_markov(np.array([0.1 * (1.0 - 1e-15), 0.1 * (1.0 + 1e-15)]), 1.0)
    assert below == pytest.approx(above, rel=1e-12)
    assert gauss_markov(1e-9, 1.0) == pytest.approx(2e-9 / 3.0, rel=1e-8)


@pytest.mark.parametrize("count", [1, 2, 7, 100])
@pytest.mark.parametrize("correlation_time", [0.03, 0.19, 0.21, 10.0, 1e6])
def test_allan_variance_of_samples_is_that_of_their_covariance(count, correlation_time):
    """20 ms apart, by the definition, Gauss-Markov and random walk. Wrong: that of all that is between the samples; of
    one sample of a random walk it is two thirds, and the third was found as white noise."""
    k = np.arange(1, 2 * count + 1)
    weight = np.repeat([1.0 / count, -1.0 / count], count)
    markov = 0.5 * weight @ np.expm1(-0.02 * np.abs(k[:, None] - k) / correlation_time) @ weight
    assert GAUSS_MARKOV.variance(0.02 * count, 0.02, correlation_time) == pytest.approx(markov, rel=1e-8)
    walk = 0.5 * weight @ (0.02 * np.minimum.outer(k, k)) @ weight
    assert RANDOM_WALK.variance(0.02 * count, 0.02, 1.0) == pytest.approx(walk, rel=1e-10)


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.name)
def test_slopes_are_those_of_table_c1(term):
    """As printed; a Gauss-Markov process has its +1/2 while it is young, as section C.4 says."""
    printed = {"quantisation": -1.0, "white noise": -0.5, "flicker": 0.0, "rate random walk": 0.5, "ramp": 1.0}
    early, late = term.variance(np.array([1.0, 2.0]), 1e-6, 1e6)
    assert 0.5 * np.log2(late / early) == pytest.approx(printed.get(term.name, 0.5), abs=1e-6)
    assert term.slope == printed.get(term.name, 0.5)
    assert term.timed == (term is GAUSS_MARKOV)


def test_stretches_are_those_in_which_no_column_moves():
    """Catches one that looks at the first sensor alone, or keeps a moving second in the middle."""
    values = 0.01 * np.random.default_rng(1).standard_normal((6000, 6))
    values[1500:1600, 4] += np.linspace(0.0, 1.0, 100)
    values[3000:3600, 0] *= 10.0
    assert quiet(values, 0.01) == [slice(100, 1400), slice(1700, 2900), slice(3700, 5900)]
    assert quiet(values[:20], 0.01) == []
