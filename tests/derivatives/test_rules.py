"""Every rule against differences of the function's values: they know no rule, so a wrong one shows."""

import numpy as np
import pytest

from navfmu.derivatives import jacobian, value_and_jacobian
from navfmu.derivatives.dual import RULES
from navfmu.export.tracing import functions, rules

from .differences import complex_step, extrapolated
from .functions import ANALYTIC, CHOOSING

POINTS = [*np.random.default_rng(7).normal(size=(4, 3)), np.array([0.71, -0.43, 0.23])]


@pytest.mark.parametrize("name", ANALYTIC)
def test_analytic_functions_to_the_last_places(name):
    function = ANALYTIC[name]
    for x in POINTS:
        truth, found = complex_step(function, x), jacobian(function, x)
        assert found.shape == (*np.shape(function(x)), 3)
        np.testing.assert_allclose(found, truth, rtol=1e-12, atol=1e-13 * (1.0 + np.max(np.abs(truth))))


@pytest.mark.parametrize("name", {**ANALYTIC, **CHOOSING})
def test_all_functions_by_differences(name):
    function = {**ANALYTIC, **CHOOSING}[name]
    for x in POINTS:
        truth, bound = extrapolated(function, x, 1e-4)
        found = jacobian(function, x)
        assert found.shape == truth.shape
        assert np.all(np.abs(found - truth) <= bound), (x, found, truth)


@pytest.mark.parametrize("name", {**ANALYTIC, **CHOOSING})
def test_the_value_has_the_bits_of_the_function(name):
    """Whoever takes value and derivatives in one go must not get another value."""
    function = {**ANALYTIC, **CHOOSING}[name]
    for x in POINTS:
        value, derivatives = value_and_jacobian(function, x)
        np.testing.assert_array_equal(value, function(x))
        np.testing.assert_array_equal(derivatives, jacobian(function, x))


KINKS = {  # function, where, one-sided derivatives of which it must be one
    "abs is flat at 0, between both": (np.abs, 0.0, (0.0,)),
    "the larger": (lambda x: np.maximum(x, 0.0), 0.0, (0.0, 1.0)),
    "the smaller": (lambda x: np.minimum(3.0 * x, x), 0.0, (3.0, 1.0)),
    "clipped at the lower end": (lambda x: np.clip(x, 0.0, 1.0), 0.0, (0.0, 1.0)),
    "clipped at the upper end": (lambda x: np.clip(x, 0.0, 1.0), 1.0, (0.0, 1.0)),
    "interpolated at a row": (lambda x: np.interp(x, [0.0, 1.0, 2.0], [0.0, 3.0, 4.0]), 1.0, (3.0, 1.0)),
    "interpolated at the first row": (lambda x: np.interp(x, [0.0, 1.0], [0.0, 3.0]), 0.0, (0.0, 3.0)),
    "interpolated at the last row": (lambda x: np.interp(x, [0.0, 1.0], [0.0, 3.0]), 1.0, (0.0, 3.0)),
    "chosen": (lambda x: np.where(x < 1.0, x, 2.0 - x), 1.0, (1.0, -1.0)),
    "one of two equal ones": (lambda x: np.sort(np.array([x, 1.0]))[0], 1.0, (0.0, 1.0)),
    "both of two equal ones": (lambda x: np.sum(np.sort(np.array([x, 1.0]))), 1.0, (1.0,)),
    "wrapped": (lambda x: np.mod(x, 1.0), 3.0, (1.0,)),
    "a step": (np.floor, 2.0, (0.0,)),
    "zero to the power 0": (lambda x: x**0.0, 0.0, (0.0,)),
    "zero to the power 1": (lambda x: x**1.0, 0.0, (1.0,)),
    "zero to the power 2": (lambda x: x**2, 0.0, (0.0,)),
    "zero to a power that changes": (lambda x: 0.0**x, 2.0, (0.0,)),
}


@pytest.mark.parametrize("name", KINKS)
def test_at_a_kink_it_is_the_derivative_of_one_side(name):
    """Neither NaN nor a mixture of both sides."""
    function, x, sides = KINKS[name]
    assert float(jacobian(function, x)) in sides


def test_the_branch_that_is_not_taken_leaves_no_trace():
    """A rule that multiplies by 0 instead of choosing makes NaN of the root's infinite derivative."""
    x = np.array([0.0, 4.0])
    with np.errstate(all="ignore"):
        found = jacobian(lambda x: np.where(x > 1.0, np.sqrt(x), 0.0) + np.maximum(np.sqrt(x), 1.0), x)
    np.testing.assert_array_equal(found, np.diag([0.0, 0.5]))


def test_a_norm_at_the_origin_is_no_number_and_can_be_guarded():
    with np.errstate(invalid="ignore", divide="ignore"):
        assert np.all(np.isnan(jacobian(np.linalg.norm, np.zeros(2))))
        np.testing.assert_array_equal(jacobian(lambda x: np.maximum(np.linalg.norm(x), 1.0), np.zeros(2)), [0.0, 0.0])


@pytest.mark.parametrize("shape", [(), (1,), (2, 3), (2, 1, 2)])
def test_x_has_any_shape(shape):
    x = np.random.default_rng(8).normal(size=shape)

    def function(x):
        return np.stack([np.sum(np.sin(x) * x), np.max(x)])

    truth, bound = extrapolated(function, x)
    found = jacobian(function, x)
    assert found.shape == (2, *shape)
    assert np.all(np.abs(found - truth) <= bound)


def test_results_may_be_lists_numbers_or_independent_of_x():
    x = np.array([2.0, 3.0])
    np.testing.assert_array_equal(jacobian(lambda x: [x[0] * x[1], 5.0], x), [[3.0, 2.0], [0.0, 0.0]])
    np.testing.assert_array_equal(jacobian(lambda x: x[0] * x[1], x), [3.0, 2.0])
    np.testing.assert_array_equal(jacobian(lambda x: 7.0, x), [0.0, 0.0])
    np.testing.assert_array_equal(jacobian(lambda x: np.eye(2), x), np.zeros((2, 2, 2)))
    np.testing.assert_array_equal(jacobian(lambda x: np.argmax(x), x), [0.0, 0.0])


def test_other_arguments_are_constants():
    x, m = np.array([2.0, 3.0]), np.array([[1.0, 2.0], [3.0, 4.0]])
    np.testing.assert_array_equal(jacobian(lambda x, m, k: k * m @ x, x, m, 2.0), 2.0 * m)
    many = np.arange(8.0).reshape(4, 2)  # a leading axis of constants is one of the result
    np.testing.assert_array_equal(jacobian(lambda x, p: np.sum((x - p) ** 2, -1), x, many), 2.0 * (x - many))


def test_the_arguments_stay_as_they_are():
    x = np.array([2.0, 3.0])

    def changing(x):
        x[0] = 5.0
        x *= x
        return x

    np.testing.assert_array_equal(jacobian(changing, x), [[0.0, 0.0], [0.0, 6.0]])
    np.testing.assert_array_equal(x, [2.0, 3.0])


NESTED = {
    "gradient": lambda x: np.sin(x[0]) * x[1] ** 2 + np.exp(x[2] * x[0]),
    "norm": lambda x: np.linalg.norm(x * x - 1.0),
    "quotient": lambda x: x[0] / (1.0 + x[1] * x[1]) + np.arctan2(x[1], x[2]),
    "matrix": lambda x: np.sum(np.linalg.inv(np.outer(x, x) + 4.0 * np.eye(3)) @ x),
    "assigned": lambda x: np.sum(assigned_twice(x)),
}


def assigned_twice(x):
    f = np.zeros((3, 3))
    f[0] = x * x
    f[1, 1:] = x[:2] * x[2]
    return f @ f @ x


@pytest.mark.parametrize("name", NESTED)
def test_a_derivative_of_a_derivative_is_the_hessian(name):
    """By differences of the gradient; who takes the outer derivative for a constant, or for the inner one, fails."""
    function = NESTED[name]
    for x in POINTS:
        found = jacobian(lambda x: jacobian(function, x), x)
        truth, bound = extrapolated(lambda x: jacobian(function, x), x, 1e-4)
        assert np.all(np.abs(found - truth) <= bound)
        np.testing.assert_allclose(found, found.T, rtol=1e-12, atol=1e-12)


def test_nested_derivatives_are_told_apart():
    """d/dx (x d/dy (x + y)) at 1 is 1; taking one perturbation for the other gives 2."""
    assert jacobian(lambda x: x * jacobian(lambda y: x + y, 2.0), 1.0) == 1.0
    assert jacobian(lambda x: x * jacobian(lambda y: x * y, 2.0), 3.0) == 6.0


ASIDE = {  # what tracing knows and derivatives do not
    *(np.bitwise_and, np.bitwise_or, np.bitwise_xor, np.invert),  # of truth values only
}


def test_all_that_can_be_traced_can_be_differentiated():
    known = {*rules.RULES, *functions.FUNCTIONS, *functions.STRUCTURAL}
    missing = {f for f in known if f not in RULES and f not in ASIDE}
    assert not missing, sorted(f.__name__ for f in missing)
