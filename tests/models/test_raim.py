"""Integrity monitoring of one geometry: slopes and protection levels, and alarms and misses that are counted."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from models.satellite import chi_square, dilution, least_squares, protection_level, raim, solution

AZIMUTH, ELEVATION = np.radians([(30, 80), (60, 35), (120, 20), (170, 50), (230, 15), (290, 40), (340, 10)]).T
ACROSS = np.cos(ELEVATION)
UNIT_N = np.stack([ACROSS * np.cos(AZIMUTH), ACROSS * np.sin(AZIMUTH), -np.sin(ELEVATION)], axis=1)
H = least_squares.design(UNIT_N)
USED = np.append(np.ones(7), 0.0)


def projected(weight):
    """I - H (H' W H)^-1 H' W of the satellites, by NumPy's pseudoinverse: independent of the models."""
    root = np.sqrt(weight[:-1])
    turned = root[:, None] * H[:-1]
    return np.eye(7) - turned @ np.linalg.pinv(turned)


@pytest.mark.parametrize(
    ("sigma", "levels"),
    [
        (np.full(7, 33.3), (261.59186, 410.11265, 246.95205, 399.36394)),
        (5.0 / np.sqrt(np.sin(ELEVATION)), (55.45764, 101.99777, 48.81895, 105.95282)),
    ],
)
def test_protection_levels_are_those_of_an_independent_calculation(sigma, levels):
    """Walter and Enge's, then Brown's, horizontal and vertical, at 3.333e-7 and 1e-3 with three degrees of freedom."""
    weight = np.append(sigma**-2.0, 0.0)
    p = least_squares.covariance(H, weight)
    slopes = raim.slopes(p, H, weight, raim.redundancy(p, H, weight))
    threshold = chi_square.threshold(3.333e-7, np.array([3]))
    non_centrality = chi_square.non_centrality(1e-3, threshold, np.array([3]))[0]
    sigmas = np.sqrt([p[0, 0] + p[1, 1], p[2, 2]])
    multiple = chi_square.normal_threshold(1e-3)
    found = [
        protection_level.of_slope_and_noise(slope, np.sqrt(threshold[0]), size, multiple)
        for slope, size in zip(slopes, sigmas, strict=True)
    ]
    found += [protection_level.of_slope(slope, non_centrality) for slope in slopes]
    np.testing.assert_allclose(found, levels, rtol=1e-6)


def test_dilutions_are_those_of_an_independent_calculation():
    found = dilution.dilutions(least_squares.covariance(H, USED))
    np.testing.assert_allclose(found, (1.91312, 1.713893, 0.956914, 1.42188, 0.850059), rtol=1e-5)


def test_a_geometry_without_a_solution_has_no_dilution():
    """Three satellites, and four on a cone: 9999, and no number that could be taken for one."""
    three = np.append(np.array([1.0, 1.0, 1.0, 0, 0, 0, 0]), 0.0)
    angles = np.array([0.0, 1.5, 3.0, 4.5])
    cone = np.stack([0.5 * np.cos(angles), 0.5 * np.sin(angles), np.full(4, -np.sqrt(0.75))], axis=1)
    four = np.append(np.ones(4), 0.0)
    for q in (least_squares.covariance(H, three), least_squares.covariance(least_squares.design(cone), four)):
        np.testing.assert_array_equal(dilution.dilutions(q), dilution.NONE)


def test_growth_is_what_leaving_out_makes():
    q = least_squares.covariance(H, USED)
    found = dilution.growth(q, H, USED)
    for i in range(7):
        left = USED.copy()
        left[i] = 0.0
        exact = np.trace(np.linalg.inv(H[left > 0].T @ H[left > 0])) - np.trace(q)
        assert found[i] == pytest.approx(exact, rel=1e-9)


def test_the_best_four_are_not_the_highest_four():
    """Leaving out what dilutes least gives 1.2 times the best of all 35 fours at most; the highest four give 4.2."""
    kept = solution.choose(H, USED, 4)
    rows = H[kept > 0]
    assert len(rows) == 4
    dilutions = []
    for i in range(7):
        for j in range(i):
            for k in range(j):
                left = np.delete(H[:-1], [i, j, k], axis=0)
                dilutions.append(np.sqrt(np.trace(np.linalg.inv(left.T @ left))))
    highest = H[np.argsort(-ELEVATION)[:4]]
    assert np.sqrt(np.trace(np.linalg.inv(rows.T @ rows))) < 1.2 * min(dilutions)
    assert np.sqrt(np.trace(np.linalg.inv(highest.T @ highest))) > 1.5 * min(dilutions)


def squares(noise, weight):
    """Sums of squares by the models, of errors (samples, 7)."""
    p = least_squares.covariance(H, weight)
    errors = np.concatenate([noise, np.zeros((len(noise), 1))], axis=1)
    residuals = errors - (H @ (p @ (H.T @ (weight[:, None] * errors.T)))).T
    return np.array([raim.squares(residual, weight) for residual in residuals]), residuals, p


@pytest.mark.parametrize("alarm", [1e-2, 1e-3])
def test_false_alarms_come_as_often_as_they_should(alarm):
    """Counted in 100 000 epochs, binomial bounds at 1e-6; seven degrees of freedom for three would give none at all."""
    sigma = 5.0 / np.sqrt(np.sin(ELEVATION))
    noise = sigma * np.random.default_rng(5).standard_normal((100_000, 7))
    found, _, _ = squares(noise, np.append(sigma**-2.0, 0.0))
    count = np.count_nonzero(found > chi_square.threshold(alarm, np.array([3]))[0])
    low, high = stats.binom.ppf([5e-7, 1 - 5e-7], len(noise), alarm)
    assert low <= count <= high


@pytest.mark.parametrize(("alarm", "missed", "satellite"), [(1e-3, 1e-2, 4), (3.333e-7, 1e-3, 2), (1e-2, 1e-3, 6)])
def test_biases_are_missed_as_often_as_they_should(alarm, missed, satellite):
    """The bias is sigma sqrt(lambda / share), share from the pseudoinverse; counted as above."""
    sigma = 5.0 / np.sqrt(np.sin(ELEVATION))
    weight = np.append(sigma**-2.0, 0.0)
    threshold = chi_square.threshold(alarm, np.array([3]))
    non_centrality = chi_square.non_centrality(missed, threshold, np.array([3]))[0]
    noise = sigma * np.random.default_rng(6).standard_normal((100_000, 7))
    noise[:, satellite] += sigma[satellite] * np.sqrt(non_centrality / projected(weight)[satellite, satellite])
    found, _, _ = squares(noise, weight)
    count = np.count_nonzero(found <= threshold[0])
    low, high = stats.binom.ppf([5e-7, 1 - 5e-7], len(noise), missed)
    assert low <= count <= high


def test_what_is_standardised_is_the_gain_of_leaving_out():
    """The sum of squares is less by just that without the row, solved anew without it."""
    weight = np.append((5.0 / np.sqrt(np.sin(ELEVATION))) ** -2.0, 0.0)
    noise = 10.0 * np.random.default_rng(7).standard_normal((1, 7))
    (total,), (residual,), p = squares(noise, weight)
    found = raim.standardised(residual, weight, raim.redundancy(p, H, weight))
    for i in range(7):
        left = weight.copy()
        left[i] = 0.0
        (without,), _, _ = squares(noise, left)
        assert found[i] == pytest.approx(total - without, rel=1e-9, abs=1e-12)


def test_the_worst_slope_bounds_every_bias():
    """Of a bias on each satellite without noise: position error over the root of the sum of squares is its slope."""
    weight = np.append((5.0 / np.sqrt(np.sin(ELEVATION))) ** -2.0, 0.0)
    p = least_squares.covariance(H, weight)
    horizontal, vertical = raim.slopes(p, H, weight, raim.redundancy(p, H, weight))
    for i in range(7):
        bias = np.zeros((1, 7))
        bias[0, i] = 100.0
        (total,), _, _ = squares(bias, weight)
        moved = np.linalg.lstsq(np.sqrt(weight[:-1, None]) * H[:-1], np.sqrt(weight[:-1]) * bias[0], rcond=None)[0]
        assert horizontal[i] == pytest.approx(np.hypot(*moved[:2]) / np.sqrt(total), rel=1e-9)
        assert vertical[i] == pytest.approx(abs(moved[2]) / np.sqrt(total), rel=1e-9)
