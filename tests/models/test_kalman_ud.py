"""The Kalman filter on U-D factors against the textbook's matrices; in rational numbers where rounding is at stake."""

from fractions import Fraction

import numpy as np
import pytest

from models.filters import kalman, kalman_ud


def random_covariance(rng, n):
    root = rng.standard_normal((n, n + 3))
    return root @ root.T


def exact_update(p, row, variance):
    """(I - K H) P in rational numbers; ``p`` is a list of rows."""
    n = len(row)
    cross = [sum(p[i][k] * row[k] for k in range(n)) for i in range(n)]
    spread = sum(row[i] * cross[i] for i in range(n)) + variance
    return [[p[i][j] - cross[i] * cross[j] / spread for j in range(n)] for i in range(n)]


def rational(numbers):
    return [Fraction(float(x)) for x in numbers]


def is_factored(columns, n):
    """U is upper triangular with ones, and nothing is lost in packing."""
    u = kalman_ud.unit(columns)
    np.testing.assert_array_equal(np.tril(u), np.eye(n))
    packed = np.concatenate([np.append(u[:i, i], d) for i, d in enumerate(kalman_ud.diagonal(columns))])
    np.testing.assert_array_equal(packed, columns)


@pytest.mark.parametrize("n", [1, 2, 6, 15])
def test_factors_are_triangular_and_give_the_matrix_back(n):
    matrix = random_covariance(np.random.default_rng(n), n)
    columns = kalman_ud.factors(matrix)
    is_factored(columns, n)
    assert kalman_ud.order(columns) == n
    np.testing.assert_allclose(kalman_ud.covariance(columns), matrix, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(kalman_ud.variances(columns), np.diag(matrix), rtol=1e-13)
    independent = kalman_ud.of_variances(np.diag(matrix))
    np.testing.assert_array_equal(kalman_ud.covariance(independent), np.diag(np.diag(matrix)))


@pytest.mark.parametrize(("driven", "driving"), [(3, 5), (7, 7), (1, 7), (3, 3)])
def test_time_update_is_phi_p_phi(driven, driving):
    """Catches a Gram-Schmidt from the first state to the last, and one that forgets the noise of driven states."""
    rng = np.random.default_rng(5)
    n = 7
    p = random_covariance(rng, n)
    rows = rng.standard_normal((driven, driving))
    factor, noise = rng.standard_normal(n - driven), rng.uniform(0.1, 1.0, n)
    phi = np.diag(np.concatenate([np.zeros(driven), factor]))
    phi[:driven, :driving] = rows
    columns = kalman_ud.propagate(kalman_ud.factors(p), rows, factor, noise)
    is_factored(columns, n)
    np.testing.assert_allclose(kalman_ud.covariance(columns), phi @ p @ phi.T + np.diag(noise), rtol=1e-13, atol=1e-12)


def test_states_without_variance_stay_so():
    """A state that is switched off, and one that follows from another: no division by the nothing that they have."""
    start = np.array([2.0, 0.0, 3.0, 0.0])
    rows, factor, noise = np.array([[1.0, 0.5, 0.25, 0.0]]), np.array([1.0, 0.9, 1.0]), np.array([0.0, 0.0, 0.1, 0.0])
    columns = kalman_ud.propagate(kalman_ud.of_variances(start), rows, factor, noise)
    phi = np.array([[1.0, 0.5, 0.25, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.9, 0.0], [0.0, 0.0, 0.0, 1.0]])
    expected = phi @ np.diag(start) @ phi.T + np.diag(noise)
    np.testing.assert_allclose(kalman_ud.covariance(columns), expected, rtol=1e-14, atol=1e-15)
    _, columns, _ = kalman_ud.update(np.zeros(4), columns, np.array([1.0, 1.0, 0.0, 1.0]), 0.5, 1.0)
    assert np.all(np.isfinite(columns))
    assert list(kalman_ud.diagonal(columns)[[1, 3]]) == [0.0, 0.0]


def test_sequential_updates_equal_the_matrix_update():
    """K = P H' (H P H' + R)^-1, P+ = (I - K H) P. Catches the variance of the innovation before a state where that
    after it is due, and the column of U after its change where the gain takes that before it."""
    rng = np.random.default_rng(6)
    n, m = 6, 4
    p, h, r = random_covariance(rng, n), rng.standard_normal((m, n)), rng.uniform(0.1, 2.0, m)
    residual = rng.standard_normal(m)
    gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + np.diag(r))
    correction, columns = np.zeros(n), kalman_ud.factors(p)
    for row, variance, y in zip(h, r, residual, strict=True):
        correction, columns, taken = kalman_ud.update(correction, columns, row, variance, y)
        assert taken
    np.testing.assert_allclose(correction, gain @ residual, rtol=1e-11)
    np.testing.assert_allclose(kalman_ud.covariance(columns), (np.eye(n) - gain @ h) @ p, rtol=1e-10, atol=1e-12)


def test_unused_and_rejected_measurements_change_nothing():
    rng = np.random.default_rng(7)
    p, row = random_covariance(rng, 4), rng.standard_normal(4)
    columns = kalman_ud.factors(p)
    spread = float(np.sqrt(row @ p @ row + 2.0))
    for arguments, expected in (
        ({"use": False}, False),
        ({"gate": 4.0}, True),
        ({"gate": 2.9}, False),
        ({"gate": 0.0}, True),
    ):
        x, after, taken = kalman_ud.update(np.zeros(4), columns, row, 2.0, 3.0 * spread, **arguments)
        assert bool(taken) is expected
        assert np.array_equal(after, columns) is not expected
        assert np.any(x) == expected


def test_nearly_parallel_measurements_of_a_wide_prior_are_kept_apart():
    """Two states known to 1 / e, measured along (1, e) and then (1, 1) with variance 1, where 1 + e^2 rounds to 1: the
    plain form keeps no variance, or has a negative one."""
    e = 2.0**-28
    wide = np.full(2, e**-2)
    exact = [[Fraction(wide[0]), Fraction(0)], [Fraction(0), Fraction(wide[1])]]
    columns, plain = kalman_ud.of_variances(wide), kalman.of_variances(wide)
    for row in (np.array([1.0, e]), np.array([1.0, 1.0])):
        exact = exact_update(exact, rational(row), Fraction(1))
        _, columns, _ = kalman_ud.update(np.zeros(2), columns, row, 1.0, 0.0)
        _, plain, _ = kalman.update(np.zeros(2), plain, row, 1.0, 0.0)
    np.testing.assert_allclose(kalman_ud.covariance(columns), np.array(exact, float), rtol=1e-7)
    assert np.min(np.linalg.eigvalsh(kalman.unpack(plain))) <= 0.0


def test_factors_stay_those_of_a_covariance_where_the_matrix_does_not():
    """Eight states of very different size, 60 precise measurements along nearly the same direction, against rational
    numbers: every element of D stays positive and every variance is right to 1e-8, where the matrix has negative
    eigenvalues on its way and ends wrong by more than a tenth."""
    rng = np.random.default_rng(8)
    n, variance = 8, 2.0**-30
    start, direction = 10.0 ** rng.uniform(0.0, 8.0, n), rng.standard_normal(n)
    exact = [[Fraction(float(start[i])) if i == j else Fraction(0) for j in range(n)] for i in range(n)]
    columns, plain = kalman_ud.of_variances(start), kalman.of_variances(start)
    lowest = []
    for _ in range(60):
        row = direction + 1e-6 * rng.standard_normal(n)
        exact = exact_update(exact, rational(row), Fraction(variance))
        _, columns, _ = kalman_ud.update(np.zeros(n), columns, row, variance, 0.0)
        _, plain, _ = kalman.update(np.zeros(n), plain, row, variance, 0.0)
        assert np.all(kalman_ud.diagonal(columns) > 0.0)
        lowest.append(np.linalg.eigvalsh(kalman.unpack(plain))[0])
    expected = np.array([float(exact[i][i]) for i in range(n)])
    np.testing.assert_allclose(kalman_ud.variances(columns), expected, rtol=1e-8)
    assert min(lowest) < 0.0
    assert np.max(np.abs(kalman.diagonal(plain) / expected - 1.0)) > 0.1
