"""The exact discretisation: stationary, independent of the period, with the right correlation."""

import numpy as np
import pytest
from scipy import stats

from models.processes import gauss_markov


@pytest.mark.parametrize("period", [0.01, 1.0, 100.0, 4000.0])
def test_the_variance_stands(period):
    sigma, phi = 2.6, gauss_markov.decay(period, 400.0)
    assert phi**2 * sigma**2 + gauss_markov.drive(sigma, phi) ** 2 == pytest.approx(sigma**2, rel=1e-12)


def test_two_half_periods_are_one_period():
    whole, half = gauss_markov.decay(2.0, 400.0), gauss_markov.decay(1.0, 400.0)
    assert half**2 == pytest.approx(whole, rel=1e-14)
    variance = gauss_markov.drive(5.0, half) ** 2 * (1 + half**2)
    assert variance == pytest.approx(gauss_markov.drive(5.0, whole) ** 2, rel=1e-12)


def test_the_driving_noise_has_the_density_of_the_thesis():
    """For periods much shorter than tau, (3.5): variance per period = 2 sigma^2 / tau * period."""
    phi = gauss_markov.decay(1e-3, 300.0)
    assert gauss_markov.drive(0.05, phi) ** 2 == pytest.approx(2 * 0.05**2 / 300.0 * 1e-3, rel=1e-5)


def test_simulated_process_has_its_sigma_and_correlation():
    """4000 independent processes; bounds at a probability of 1e-6 from chi-square and Fisher's z."""
    rng, count = np.random.default_rng(11), 4000
    phi = gauss_markov.decay(50.0, 400.0)
    first = gauss_markov.stationary(5.0, rng.standard_normal(count))
    x = first
    for _ in range(8):
        x = gauss_markov.advance(x, phi, gauss_markov.drive(5.0, phi), rng.standard_normal(count))
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], count) / count
    for sample in (first, x):
        assert low < np.mean(sample**2) / 25.0 < high
    z = np.arctanh(np.corrcoef(first, x)[0, 1]) - np.arctanh(np.exp(-1.0))
    assert abs(z) < 4.9 / np.sqrt(count - 3)


@pytest.mark.parametrize("since", [0.5, 15.0, 30.0, 100.0])
def test_the_white_equivalent_carries_the_information_of_the_correlated_process(since):
    """Variance of the mean of many samples of the process, from its covariance matrix, times their number."""
    tau, n = 20.0, 4000
    rho = np.exp(-since / tau)
    lags = np.arange(1, n)
    mean_variance = (n + 2.0 * np.sum((n - lags) * rho**lags)) / n**2
    assert gauss_markov.white_equivalent(1.0, since, tau) == pytest.approx(mean_variance * n, rel=0.03)
    # its limits: max(1, 2 tau / since) to within the width of the transition
    assert gauss_markov.white_equivalent(1.0, 1e4, tau) == pytest.approx(1.0)
    assert gauss_markov.white_equivalent(1.0, 0.01, tau) == pytest.approx(2.0 * tau / 0.01, rel=1e-4)
