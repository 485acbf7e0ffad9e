"""Allan variance and spectrum of each term belong together, and charts scatter as they are said to."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.calibration.allan.chart import chart
from navfmu.calibration.allan.scatter import covariance, filters, frequencies
from navfmu.calibration.allan.terms import FLICKER, GAUSS_MARKOV, QUANTISATION, RAMP, RANDOM_WALK, WHITE
from tests.calibration import made

RUNS = 100


@pytest.mark.parametrize("term", [QUANTISATION, WHITE, FLICKER, RANDOM_WALK, GAUSS_MARKOV], ids=lambda term: term.name)
def test_the_spectrum_through_the_filter_is_the_variance(term):
    """Thesis section C.3, of samples; of flicker noise from 16 on, where samples and averages are the same. A part in
    100; at the longest times the lowest frequencies lack, of a random walk 8 parts. Wrong: one side of the spectrum, no
    period, the variance of all that is between the samples (of one sample of a random walk two thirds)."""
    one = chart([np.random.default_rng(1).standard_normal((20000, 1))], 0.5)
    frequency, width = frequencies(one)
    passed = 2.0 * filters(one, frequency) @ (term.spectrum(frequency, 0.5, 300.0) * width)
    ratio = passed / term.variance(one.time, 0.5, 300.0)
    np.testing.assert_allclose(ratio[4 if term is FLICKER else 0 : 9], 1.0, rtol=0.01)
    np.testing.assert_allclose(ratio[9:], 1.0, rtol=0.08)


@pytest.mark.parametrize(
    ("make", "term"), [(made.white, WHITE), (made.walk, RANDOM_WALK)], ids=["white noise", "random walk"]
)
def test_charts_scatter_as_they_are_said_to(make, term):
    """Of 100 seeds and three axes, from 4 to 512 samples: variances and correlations with the next octave.

    Bounds are five standard errors of 300 samples of nearly normal numbers, sqrt(2 / 300) and 1 / sqrt(300), and the
    skewness of a mean of few squares, which adds a fifth. Wrong: averages that do not overlap (2 to 3 times as much),
    averaging times taken for independent (correlations 0 for 0.5 to 0.9).
    """
    charts = [chart([make(np.random.default_rng(seed), 1.0)], 1.0) for seed in range(RUNS)]
    one, expected = charts[0], term.variance(charts[0].time, 1.0, 1.0)
    seen = np.cov(np.hstack([c.variance for c in charts]) / expected[:, None])[2:10, 2:10]
    frequency, _ = frequencies(one)
    said = covariance(one, term.spectrum(frequency, 1.0, 1.0), expected, np.zeros(len(expected)))[2:10, 2:10]
    np.testing.assert_allclose(np.diag(seen) / np.diag(said), 1.0, atol=1.2 * 5.0 * np.sqrt(2.0 / 300.0))
    together = [np.diag(c, 1) / np.sqrt(np.diag(c)[1:] * np.diag(c)[:-1]) for c in (seen, said)]
    np.testing.assert_allclose(*together, atol=1.2 * 5.0 / np.sqrt(300.0))


def test_white_noise_scatters_as_the_closed_form_for_neighbours():
    """Var(s) / v^2 = 3 / N at one sample: the differences of neighbours, correlated by -1/2."""
    one = chart([np.random.default_rng(1).standard_normal((20000, 1))], 1.0)
    frequency, _ = frequencies(one)
    said = covariance(one, np.ones_like(frequency), 1.0 / one.time, np.zeros(len(one.time)))
    assert said[0, 0] == pytest.approx(3.0 / 19999.0, rel=1e-3)


def test_a_ramp_scatters_as_pairs_that_do_not_overlap():
    one = chart([np.random.default_rng(1).standard_normal((4096, 1))], 1.0)
    frequency, _ = frequencies(one)
    variance = RAMP.variance(one.time, 1.0, 1.0)
    said = covariance(one, RAMP.spectrum(frequency, 1.0, 1.0), variance, variance)
    np.testing.assert_allclose(said, np.diag(2.0 / one.pairs))
