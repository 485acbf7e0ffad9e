"""Derivatives that stand in books."""

import numpy as np
import pytest

from navfmu.derivatives import jacobian, value_and_jacobian

from . import strapdown
from .differences import complex_step

RNG = np.random.default_rng(11)


def close(found, truth, last_places=8):
    scale = np.max(np.abs(truth))
    np.testing.assert_allclose(found, truth, rtol=0.0, atol=last_places * np.finfo(float).eps * scale)


def test_a_range_has_the_line_of_sight_as_derivatives():
    stations, position = RNG.normal(size=(5, 3)) * 1e5, RNG.normal(size=3) * 1e4
    ranges, rows = value_and_jacobian(lambda p: np.linalg.norm(p - stations, axis=1), position)
    sight = position - stations
    np.testing.assert_array_equal(ranges, np.linalg.norm(sight, axis=1))
    close(rows, sight / ranges[:, None])


def test_a_range_has_the_curvature_across_the_line_of_sight_as_second_derivative():
    x = RNG.normal(size=3) * 1e3
    unit, distance = x / np.linalg.norm(x), np.linalg.norm(x)
    found = jacobian(lambda x: jacobian(lambda x: np.sqrt(np.sum(x * x)), x), x)
    close(found, (np.eye(3) - np.outer(unit, unit)) / distance)


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def test_a_rotation_turns_its_vector_across():
    """d(R v)/da = z x (R v), dR/da = [z x] R; by the vector it is R."""
    v, a = RNG.normal(size=3), 0.7
    close(jacobian(lambda a: rotation(a) @ v, a), np.cross([0.0, 0.0, 1.0], rotation(a) @ v))
    close(jacobian(rotation, a), strapdown.cross(np.array([0.0, 0.0, 1.0])) @ rotation(a))
    close(jacobian(lambda v: rotation(a) @ v, v), rotation(a))


def test_a_rotation_by_a_quaternion():
    """d(q v q*)/dq, scalar first: 2 [s v + u x v, (u.v) I + u v' - v u' - s [v x]] (Sola, arXiv 1711.02508, (174))."""

    def rotated(q, v):
        s, u = q[0], q[1:]
        return (s * s - u @ u) * v + 2.0 * (u @ v) * u + 2.0 * s * np.cross(u, v)

    q, v = RNG.normal(size=4), RNG.normal(size=3)
    s, u = q[0], q[1:]
    by_vector = (u @ v) * np.eye(3) + np.outer(u, v) - np.outer(v, u) - s * strapdown.cross(v)
    close(jacobian(rotated, q, v), 2.0 * np.column_stack([s * v + np.cross(u, v), by_vector]), 20)


@pytest.mark.parametrize("seed", range(5))
def test_strapdown_errors_follow_the_matrix_of_the_books(seed):
    arguments = strapdown.example(seed)
    found, truth = jacobian(strapdown.derivatives, *arguments), strapdown.by_hand(*arguments)
    assert found.shape == truth.shape == (15, 15)
    size = np.abs(truth) + 1e-3 * np.abs(truth).max(axis=1, keepdims=True)  # units differ from row to row
    assert np.all(np.abs(found - truth) <= 1e-12 * size)
    assert 60 < np.count_nonzero(found) <= np.count_nonzero(truth)


def anomaly(mean, eccentricity):
    """E - e sin E = M (Kepler), by Newton's method from M."""
    eccentric = mean
    for _ in range(12):
        wrong = eccentric - eccentricity * np.sin(eccentric) - mean
        eccentric = eccentric - wrong / (1.0 - eccentricity * np.cos(eccentric))
    return eccentric


@pytest.mark.parametrize("eccentricity", [0.0, 0.01, 0.3, 0.7])
@pytest.mark.parametrize("mean", [0.1, 1.0, 2.5, 4.0])
def test_keplers_equation_has_the_derivatives_of_its_solution(mean, eccentricity):
    """Those of an implicit function, although an iteration is differentiated."""
    e, found = value_and_jacobian(lambda x: anomaly(x[0], x[1]), np.array([mean, eccentricity]))
    steep = 1.0 - eccentricity * np.cos(e)
    close(found, np.array([1.0, np.sin(e)]) / steep, 20)


def test_a_step_of_mechanics_is_symplectic():
    """J' S J = S for a step of the leapfrog method, whatever the forces are."""

    def leapfrog(x, step=0.1, steps=10):
        position, momentum = x[:2], x[2:]
        for _ in range(steps):
            momentum = momentum - 0.5 * step * position / np.sum(position * position) ** 1.5
            position = position + step * momentum
            momentum = momentum - 0.5 * step * position / np.sum(position * position) ** 1.5
        return np.concatenate([position, momentum])

    j = jacobian(leapfrog, np.array([1.0, 0.2, -0.1, 0.9]))
    s = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    np.testing.assert_allclose(j.T @ s @ j, s, atol=1e-13)
    assert np.all(np.abs(j) > 1e-3)


def test_the_logarithm_of_a_determinant_has_the_inverse_as_derivative():
    a = RNG.normal(size=(4, 4)) + 4.0 * np.eye(4)
    close(jacobian(lambda a: np.log(np.linalg.det(a)), a), np.linalg.inv(a).T, 50)


def test_a_determinant_of_a_matrix_without_inverse_has_derivatives():
    """Those of [[a, b], [c, d]] are [[d, -c], [-b, a]]; of a matrix of rank 1, 3 by 3, they are 0."""
    np.testing.assert_array_equal(
        jacobian(np.linalg.det, np.array([[1.0, 2.0], [2.0, 4.0]])), [[4.0, -2.0], [-2.0, 1.0]]
    )
    np.testing.assert_array_equal(jacobian(np.linalg.det, np.outer([1.0, 2.0, 4.0], [1.0, 8.0, 2.0])), np.zeros((3, 3)))
    np.testing.assert_array_equal(jacobian(np.linalg.det, np.array([[0.0]])), [[1.0]])


def test_roots_of_a_polynomial_by_its_coefficients():
    """dr/dp_k = -r^k / p'(r), of 'np.roots', which knows no derivatives."""
    p = np.array([2.0, -3.0, -4.0, 1.0])
    root = np.max(np.real(np.roots(p)))

    def newton(p):
        r = 2.5
        for _ in range(60):
            r = r - np.polyval(p, r) / np.polyval(p[:-1] * [3.0, 2.0, 1.0], r)
        return r

    close(jacobian(newton, p), -(root ** np.arange(3, -1, -1)) / np.polyval(np.polyder(p), root), 200)


@pytest.mark.parametrize("order", range(2, 7))
def test_hilbert_matrices_are_inverted_with_their_derivatives(order):
    """Ill conditioned ones: as near to the truth as the condition allows, 1.5e7 for six rows."""
    x = 1.0 / (1.0 + np.arange(order)[:, None] + np.arange(order))
    found = jacobian(np.linalg.inv, x)
    truth = complex_step(np.linalg.inv, x)
    bound = 10.0 * order * np.finfo(float).eps * np.linalg.cond(x) * np.max(np.abs(truth))
    assert np.max(np.abs(found - truth)) <= bound
