"""Joseph's and Carlson's forms of the filter against the textbook's matrices, rational numbers, and a printed count."""

from fractions import Fraction

import numpy as np
import pytest

from benchmarks.kernels import KERNELS, counts
from models.filters import kalman, kalman_carlson
from tests.models.test_kalman_ud import exact_update, random_covariance, rational

STABLE = ("Joseph", "Carlson", "U-D")
PRINTED = {
    "conventional": (258, 270, 1, 0, 31870),
    "Joseph": (714, 666, 1, 0, 82390),
    "Carlson": (336, 426, 24, 12, 60300),
    "U-D": (300, 414, 12, 0, 44820),
}
"""AGARD CP-298, p. 15-6, Table 4-1, 12 states: additions, multiplications, divisions, square roots, us."""
COSTS = np.array([50, 70, 70, 1000])
"""The table's own, us."""


@pytest.mark.parametrize("name", KERNELS)
def test_each_gives_the_textbooks_gain_and_covariance(name):
    module, packing, back = KERNELS[name]
    rng = np.random.default_rng(11)
    n, variance = 7, 0.4
    p, row, correction = random_covariance(rng, n), rng.standard_normal(n), rng.standard_normal(n)
    gain = p @ row / (row @ p @ row + variance)
    x, after, taken = module.update(correction, packing(p), row, variance, 1.3)
    assert bool(taken)
    np.testing.assert_allclose(x, correction + gain * (1.3 - row @ correction), rtol=1e-12)
    np.testing.assert_allclose(back(after), p - np.outer(gain, row @ p), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", KERNELS)
def test_unused_and_rejected_measurements_change_nothing(name):
    """Catches a gate in variances instead of standard deviations, and factors that shrink without a measurement."""
    module, packing, _ = KERNELS[name]
    rng = np.random.default_rng(7)
    p, row = random_covariance(rng, 4), rng.standard_normal(4)
    packed, spread = packing(p), float(np.sqrt(row @ p @ row + 2.0))
    for arguments, expected in (({"use": False}, False), ({"gate": 3.1}, True), ({"gate": 2.9}, False)):
        x, after, taken = module.update(np.zeros(4), packed, row, 2.0, 3.0 * spread, **arguments)
        assert bool(taken) is expected
        assert np.array_equal(after, packed) is not expected
        assert np.any(x) == expected


@pytest.mark.parametrize("name", KERNELS)
def test_time_update_is_phi_p_phi(name):
    module, packing, back = KERNELS[name]
    rng = np.random.default_rng(5)
    p, rows, factor = random_covariance(rng, 6), rng.standard_normal((3, 5)), rng.standard_normal(3)
    noise = rng.uniform(0.1, 1.0, 6)
    phi = np.diag(np.concatenate([np.zeros(3), factor]))
    phi[:3, :5] = rows
    moved = back(module.propagate(packing(p), rows, factor, noise))
    np.testing.assert_allclose(moved, phi @ p @ phi.T + np.diag(noise), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", STABLE)
def test_a_covariance_stays_one_where_the_plain_form_has_none(name):
    """Two states known to 1 / e, measured along (1, e) and then (1, 1), where 1 + e^2 rounds to 1: the rounded gain of
    Joseph's form leaves a covariance that is not the exact one, but one; the roots keep half of the digits."""
    e = 2.0**-28
    wide = np.diag([e**-2, e**-2])
    module, packing, back = KERNELS[name]
    packed, plain = packing(wide), kalman.pack(wide)
    exact = [[Fraction(float(x)) for x in row] for row in wide]
    for row in (np.array([1.0, e]), np.array([1.0, 1.0])):
        exact = exact_update(exact, rational(row), Fraction(1))
        packed = module.update(np.zeros(2), packed, row, 1.0, 0.0)[1]
        plain = kalman.update(np.zeros(2), plain, row, 1.0, 0.0)[1]
    assert np.min(np.linalg.eigvalsh(kalman.unpack(plain))) <= 0.0
    if name == "Joseph":
        assert np.all(np.diag(back(packed)) > 0.0)
    else:
        np.testing.assert_allclose(back(packed), np.array(exact, float), rtol=1e-7)


def test_root_of_a_known_state_has_no_number_that_is_none():
    """A state without variance: to U-D and back."""
    columns = kalman_carlson.of_variances(np.array([4.0, 0.0, 9.0]))
    np.testing.assert_array_equal(kalman_carlson.of_ud(kalman_carlson.to_ud(columns)), columns)
    np.testing.assert_array_equal(kalman_carlson.variances(columns), [4.0, 0.0, 9.0])


def test_printed_times_are_the_printed_operations():
    for *count, microseconds in PRINTED.values():
        assert np.dot(count, COSTS) == microseconds


@pytest.mark.parametrize("name", KERNELS)
def test_no_kernel_takes_more_operations_than_printed(name):
    """By the table's own costs; a kernel that forgets the structure of its factors takes n / 2 times as many. Ours has
    2 n roots and n divisions more in Carlson's form, whose ratios are taken one by one."""
    ours = counts(12)[name]
    count = [ours.get(kind, 0) for kind in ("additions", "multiplications", "divisions", "square roots")]
    assert np.dot(count[:2], COSTS[:2]) <= np.dot(PRINTED[name][:2], COSTS[:2])
    assert count[2] <= 25 and count[3] <= 24
