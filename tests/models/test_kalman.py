"""The packed, sequential Kalman filter against the textbook's matrices."""

import numpy as np
import pytest

from models.filters import kalman


def covariance(rng, n):
    root = rng.standard_normal((n, n + 3))
    return root @ root.T


@pytest.mark.parametrize("n", [1, 2, 4, 6, 9])
def test_packing_keeps_the_matrix(n):
    matrix = covariance(np.random.default_rng(n), n)
    upper = kalman.pack(matrix)
    assert kalman.order(upper) == n
    np.testing.assert_array_equal(kalman.unpack(upper), matrix)
    np.testing.assert_array_equal(kalman.diagonal(upper), np.diag(matrix))
    np.testing.assert_array_equal(kalman.unpack(kalman.of_variances(np.diag(matrix))), np.diag(np.diag(matrix)))


def test_time_update_is_phi_p_phi():
    """Two filters at once; the first three of seven states are driven by the first five, the others by themselves."""
    rng = np.random.default_rng(5)
    p = np.stack([covariance(rng, 7), covariance(rng, 7)])
    rows, factor, noise = rng.standard_normal((3, 5)), rng.standard_normal(4), rng.uniform(0.1, 1.0, 7)
    phi = np.diag(np.concatenate([np.zeros(3), factor]))
    phi[:3, :5] = rows
    result = kalman.unpack(kalman.propagate(kalman.pack(p), rows, factor, noise))
    np.testing.assert_allclose(result, phi @ p @ phi.T + np.diag(noise), rtol=1e-13, atol=1e-12)


def test_sequential_updates_equal_the_matrix_update():
    """L = P H' (H P H' + R)^-1, P+ = (I - L H) P: thesis (4.50) with its misprint corrected, (6.42)."""
    rng = np.random.default_rng(6)
    n, m = 6, 4
    p, h, r = covariance(rng, n), rng.standard_normal((m, n)), rng.uniform(0.1, 2.0, m)
    residual = rng.standard_normal(m)
    gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + np.diag(r))
    correction, upper = np.zeros(n), kalman.pack(p)
    for row, variance, y in zip(h, r, residual, strict=True):
        correction, upper, taken = kalman.update(correction, upper, row, variance, y)
        assert taken
    np.testing.assert_allclose(correction, gain @ residual, rtol=1e-11)
    np.testing.assert_allclose(kalman.unpack(upper), (np.eye(n) - gain @ h) @ p, rtol=1e-10, atol=1e-12)


def test_unused_and_rejected_measurements_change_nothing():
    rng = np.random.default_rng(7)
    upper, row = kalman.pack(covariance(rng, 4)), rng.standard_normal(4)
    spread = float(np.sqrt(row @ kalman.unpack(upper) @ row + 2.0))
    for arguments, expected in (
        ({"use": False}, False),
        ({"gate": 4.0}, True),
        ({"gate": 2.9}, False),
        ({"gate": 0.0}, True),
    ):
        correction, after, taken = kalman.update(np.zeros(4), upper, row, 2.0, 3.0 * spread, **arguments)
        assert bool(taken) is expected
        assert np.array_equal(after, upper) is not expected
        assert np.any(correction) == expected


def test_many_filters_at_once_equal_one_by_one():
    rng = np.random.default_rng(8)
    uppers = np.stack([kalman.pack(covariance(rng, 4)) for _ in range(5)])
    rows, residuals = rng.standard_normal((5, 4)), rng.standard_normal(5)
    x, after, _ = kalman.update(np.zeros((5, 4)), uppers, rows, 1.5, residuals)
    for i in range(5):
        one = kalman.update(np.zeros(4), uppers[i], rows[i], 1.5, residuals[i])
        np.testing.assert_allclose(x[i], one[0], rtol=1e-14)
        np.testing.assert_allclose(after[i], one[1], rtol=1e-14)
