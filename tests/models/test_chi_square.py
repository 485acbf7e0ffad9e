"""Chi square against SciPy: tails, thresholds, non-centralities."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import special, stats

from models.satellite import chi_square

FREEDOM = np.arange(1, 41)


@pytest.mark.parametrize("x", [0.5, 5.0, 40.0, 200.0])
def test_the_tail_is_scipys_to_the_last_places(x):
    np.testing.assert_allclose(chi_square.tail(x, FREEDOM), stats.chi2.sf(x, FREEDOM), rtol=5e-14)


def test_the_complement_of_the_error_function_is_scipys():
    """With and without the pole's part, which is cut at z = 6.3."""
    z = np.geomspace(0.01, 20.0, 500)
    np.testing.assert_allclose(chi_square.complement(z), special.erfc(z), rtol=5e-14)


@pytest.mark.parametrize("probability", [0.5, 0.1, 1e-3, 1e-5, 3.333e-7, 1e-12])
def test_thresholds_are_scipys(probability):
    found = chi_square.threshold(probability, FREEDOM)
    np.testing.assert_allclose(found, stats.chi2.isf(probability, FREEDOM), rtol=1e-13)


@pytest.mark.parametrize("alarm", [3.333e-7, 1e-5, 1e-2])
@pytest.mark.parametrize("missed", [0.4, 1e-2, 1e-3, 1e-5])
def test_non_centralities_are_missed_as_often_as_wanted(alarm, missed):
    threshold = chi_square.threshold(alarm, FREEDOM)
    found = chi_square.non_centrality(missed, threshold, FREEDOM)
    np.testing.assert_allclose(stats.ncx2.cdf(threshold, FREEDOM, found), missed, rtol=2e-9)


def test_multiples_of_sigma_are_scipys():
    assert chi_square.normal_threshold(1e-3) == pytest.approx(stats.norm.isf(1e-3), rel=1e-13)
