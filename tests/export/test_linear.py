"""Linear equations with traced matrices, judged by what is left over, within the bounds of backward stable methods."""

import numpy as np
import pytest
import scipy.linalg

from evidence.compiled import compiled
from navfmu.errors import NavfmuError

EPSILON = np.finfo(float).eps
SIZES = (1, 2, 3, 5, 8, 15, 24)


def matrices(n: int) -> list[np.ndarray]:
    """Matrices that are random, badly scaled, nearly singular, and in need of pivots."""
    rng = np.random.default_rng(n)
    random = rng.normal(size=(n, n))
    scaled = random * 10.0 ** rng.integers(-6, 7, size=(n, 1))
    turned = np.roll(np.eye(n), 1, axis=0) * 3.0 + np.triu(random, 2)
    return [random, scaled, scipy.linalg.hilbert(n) + 1e-9 * np.eye(n), turned, np.eye(n)[::-1].copy()]


def positive(n: int) -> list[np.ndarray]:
    """Covariances: well and badly conditioned ones."""
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n + 2))
    scale = 10.0 ** rng.integers(-4, 5, size=n)
    good = root @ root.T
    return [good, good * np.outer(scale, scale), scipy.linalg.hilbert(n) + 1e-12 * np.eye(n)]


@pytest.mark.parametrize("whole", [np.inf, 1], ids=["single", "whole"])
def test_solutions_leave_next_to_nothing(whole):
    """A method without pivots fails for the turned matrices, one that loses digits for the others."""
    cases = [(n, m) for n in SIZES for m in matrices(n)]
    right = {n: np.random.default_rng(100 + n).normal(size=(n, 3)) for n in SIZES}
    functions = [(np.linalg.solve, (np.eye(n), right[n])) for n in SIZES]
    functions += [(lambda a, b: np.linalg.solve(a, b[:, 0]), (np.eye(n), right[n])) for n in SIZES]
    functions += [(np.linalg.inv, (np.eye(n),)) for n in SIZES]
    made = compiled(functions, whole)
    for n, m in cases:
        k = SIZES.index(n)
        for x, b in ((made[k](m, right[n]), right[n]), (made[k + 7](m, right[n]), right[n][:, 0])):
            scale = np.linalg.norm(m, np.inf) * np.linalg.norm(x, np.inf) + np.linalg.norm(b, np.inf)
            assert np.linalg.norm(m @ x - b, np.inf) <= 8 * n * n * EPSILON * scale
        inverse = made[k + 14](m)
        scale = np.linalg.norm(m, np.inf) * np.linalg.norm(inverse, np.inf)
        assert np.linalg.norm(m @ inverse - np.eye(n), np.inf) <= 8 * n * n * EPSILON * scale


def test_determinants_are_those_of_numpy():
    made = compiled([(np.linalg.det, (np.eye(n),)) for n in SIZES])
    for n, one in zip(SIZES, made, strict=True):
        for m in [*matrices(n)[:2], *matrices(n)[3:]]:
            # Hadamard's bound is the scale of what cancels
            scale = np.prod(np.linalg.norm(m, axis=1))
            assert abs(one(m) - np.linalg.det(m)) <= 16 * n * n * EPSILON * scale


def test_a_factor_gives_the_covariance_back():
    """Only the lower triangle is read, as NumPy has it."""
    functions = [(np.linalg.cholesky, (np.eye(n),)) for n in SIZES]
    functions += [(lambda a: np.linalg.cholesky(a, upper=True), (np.eye(n),)) for n in SIZES]
    made = compiled(functions)
    for k, n in enumerate(SIZES):
        for m in positive(n):
            lower, upper = made[k](np.tril(m) + np.triu(np.full((n, n), 9.0), 1)), made[k + 7](np.triu(m))
            assert not np.any(np.triu(lower, 1)) and not np.any(np.tril(upper, -1))
            bound = 4 * n * EPSILON * np.sqrt(np.outer(np.diag(m), np.diag(m)))
            assert np.all(np.abs(lower @ lower.T - m) <= bound)
            assert np.all(np.abs(upper.T @ upper - m) <= bound)


def test_stacks_are_taken_one_by_one():
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 3, 3)), rng.normal(size=(3, 2))
    solve, inv, det = compiled([(np.linalg.solve, (a, b)), (np.linalg.inv, (a,)), (np.linalg.det, (a,))])
    np.testing.assert_allclose(solve(a, b), np.linalg.solve(a, b), rtol=1e-12)
    np.testing.assert_allclose(inv(a), np.linalg.inv(a), rtol=1e-12)
    np.testing.assert_allclose(det(a), np.linalg.det(a), rtol=1e-12)


def test_where_numpy_raises_an_error_nothing_that_looks_right_comes_out():
    made = compiled([(np.linalg.solve, (np.eye(2), np.ones(2))), (np.linalg.cholesky, (np.eye(2),))])
    assert not np.any(np.isfinite(made[0](np.ones((2, 2)), np.array([1.0, 2.0]))))
    assert np.isnan(made[1](np.array([[1.0, 2.0], [2.0, 1.0]]))[1, 1])


@pytest.mark.parametrize("shape", [(2, 3), (3,), (0, 0)])
def test_what_is_not_square_is_refused(shape):
    with pytest.raises(NavfmuError, match="square"):
        compiled([(lambda a: np.linalg.det(np.reshape(a, shape)), (np.zeros(int(np.prod(shape))),))])
