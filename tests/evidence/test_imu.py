"""The page of the inertial unit: its closed forms, and that a unit that is not so is called so."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.sensors import imu


@pytest.mark.parametrize("correlation_time", [0.5, 7.0, 400.0, 1e5])
def test_deviation_of_a_sampled_markov_process_is_that_of_its_covariance(correlation_time):
    """Half the mean square of w'x, w = +1/m, -1/m: from the matrix of covariances, sample by sample."""
    for span in (1, 2, 9, 64):
        weights = np.repeat([1.0, -1.0], span) / span
        lags = np.subtract.outer(np.arange(2 * span), np.arange(2 * span))
        expected = 0.5 * weights @ np.exp(-np.abs(lags) / correlation_time) @ weights
        assert imu.markov(np.array([span]), correlation_time)[0] == pytest.approx(expected, rel=1e-4)


def test_spread_is_that_of_white_and_of_walking_samples():
    """300 samples of the estimator: its logarithm scatters by no more than is allowed for, and by no less than half."""
    rng = np.random.default_rng(1)
    spans = np.array([1, 8, 64])
    for make in (lambda x: x, lambda x: np.cumsum(x, axis=0), lambda x: np.diff(x, axis=0)):
        found = [imu.deviation(make(rng.standard_normal((2001, 3))), 1.0, spans) for _ in range(300)]
        scatter = np.std(np.log(found), axis=0) / imu.spread(2000, spans)
        assert np.all(scatter < 1.0 + 4.0 / np.sqrt(600)) and np.all(scatter > 0.5)


def test_a_unit_that_is_not_so_is_called_so():
    unit = imu.Unit()
    closed = np.ones(len(imu.SPANS))
    for factor, text in ((1.0, "Each error has its slope"), (1.2, "An error does not have its slope")):
        unit.__dict__["errors"] = {"noise": (factor * closed, closed)}
        assert unit.tabled.sentence.startswith(text)
    fine = {name: (None, np.full(17, 10.0**-k)) for k, name in enumerate(imu.GRADES)}
    unit.__dict__["units"] = fine
    assert unit.ordered.holds
    unit.__dict__["units"] = fine | {"tactical": fine["consumer"]}
    assert unit.ordered.sentence.startswith("A grade is worse")
    time = np.linspace(0.0, 5.0, 300)
    for size, holds in ((0.1, True), (0.2, False)):
        unit.__dict__["warming"] = time, size * np.exp(-time)[:, None] * np.ones(3)
        assert unit.settles.holds == holds
