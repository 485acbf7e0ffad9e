"""Coning: numbers against the printed tables, rules against attitudes that are put together, the motion itself."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

import numpy as np
import pytest

from fmus.inertial.imu import Imu
from models.inertial import cone, coning, increments
from tests.models.native import Native
from tests.models.rotation import together
from tests.models.test_imu import QUIET

PRINTED = {
    ("flat", 1): ([], Fraction(1, factorial(3))),
    ("flat", 2): ([Fraction(2, 3)], Fraction(4, factorial(5))),
    ("flat", 3): ([Fraction(27, 20), Fraction(9, 20)], Fraction(36, factorial(7))),
    ("flat", 4): ([Fraction(n, 105) for n in (214, 92, 54)], Fraction(576, factorial(9))),
    ("flat", 5): ([Fraction(n, 504) for n in (1375, 650, 525, 250)], Fraction(14400, factorial(11))),
    ("resolution_enhanced", 1): ([], Fraction(30, factorial(5))),
    ("resolution_enhanced", 2): ([Fraction(3, 4)], Fraction(294, factorial(7))),
    ("resolution_enhanced", 3): ([Fraction(124, 80), Fraction(33, 80)], Fraction(4920, factorial(9))),
    # printed: 124456 / 11!
    ("resolution_enhanced", 4): (
        [Fraction(n, 7560) for n in (17909, 5858, 3985)],
        Fraction(126456, factorial(11)),
    ),
    # printed: 29762 / 60480
    ("resolution_enhanced", 5): (
        [Fraction(n, 60480) for n in (193356, 66994, 65404, 29761)],
        Fraction(4638816, factorial(13)),
    ),
}
"""RTO MP-43 (1999), Mark and Tazartes, Tables 1 and 2; two numbers of 24 are misprints."""

HALF_ANGLE = 2e-5
"""rad. What is of fourth order in it is below 1e-9 of the coning angle."""
PASSED = {
    "flat": lambda a: 1.0,
    "trapezoid": lambda a: 0.5 * a / np.tan(0.5 * a),
    "resolution_enhanced": lambda a: np.sinc(a / (2 * np.pi)),
}


def seen(shape: str, a: float, count: int) -> np.ndarray:
    """Increments of ``count`` samples on the cone, a rad from one to the next, as a gyro of this shape has them."""
    exact = cone.increments(HALF_ANGLE, 1.0, a * np.arange(count + 1))
    return exact * np.array([PASSED[shape](a), PASSED[shape](a), 1.0])


def error_by_formula(numbers, samples: int, shape: str, a: float) -> float:
    """Error of (3) over the coning rate at any a: the whole function, not its first power."""
    passed = PASSED[shape](a)
    applied = sum(
        -2 * x * a * (passed * np.sinc(a / (2 * np.pi))) ** 2 * np.sin(p * a)
        for p, x in enumerate(map(float, numbers), 1)
    )
    return applied / samples - (passed**2 * np.sinc(samples * a / np.pi) - 1.0)


def drift(shape: str, samples: int, around: int) -> float:
    """Drift of the interval rule over the coning rate: whole turns of the cone lead back to where they began."""
    angles = seen(shape, 2 * np.pi / around, around * samples)
    x = np.array([float(x) for x in coning.coefficients(samples, shape)])
    rotations = [
        angles[i : i + samples].sum(axis=0) + coning.correction(angles[i : i + samples], x)
        for i in range(0, len(angles), samples)
    ]
    return together(np.array(rotations))[2] / (samples * np.pi * HALF_ANGLE**2)


def drift_with_past(shape: str, past: int, around: int, of: str = "") -> float:
    """Drift of the rule with samples of before, seven to an interval; numbers ``of`` another shape, if named."""
    angles = seen(shape, 2 * np.pi / around, around * 7 + past)
    c = np.array([float(x) for x in coning.before(past, of or shape)])
    rotations = []
    for first in range(past, len(angles), 7):
        total, correction = np.zeros(3), np.zeros(3)
        for i in range(first, first + 7):
            correction = correction + coning.step(total, angles[i - past : i][::-1], angles[i], c)
            total = total + angles[i]
        rotations.append(total + correction)
    return together(np.array(rotations))[2] / (7 * np.pi * HALF_ANGLE**2)


@pytest.mark.parametrize(("shape", "samples"), PRINTED)
def test_numbers_are_those_of_the_printed_tables(shape, samples):
    assert (coning.coefficients(samples, shape), coning.error(samples, shape)) == PRINTED[shape, samples]


@pytest.mark.parametrize("shape", coning.SHAPES)
@pytest.mark.parametrize("samples", [1, 2, 3, 4, 5])
def test_past_samples_leave_the_same_error_as_those_of_an_interval(shape, samples):
    assert coning.error_of(coning.before(samples - 1, shape), shape) == coning.error(samples, shape)


def test_one_past_sample_counts_a_twelfth():
    assert coning.before(1) == [Fraction(1, 12)]


@pytest.mark.parametrize("shape", coning.SHAPES)
@pytest.mark.parametrize("samples", [1, 2, 3, 4])
def test_attitudes_put_together_drift_as_the_formula_says_and_fall_with_its_power(shape, samples):
    """Numbers of another shape, an exchanged order of samples or a sign would be orders of magnitude off."""
    around = np.array([12, 24])
    a = 2 * np.pi / around
    found = np.array([drift(shape, samples, n) for n in around])
    numbers = coning.coefficients(samples, shape)
    np.testing.assert_allclose(found, [error_by_formula(numbers, samples, shape, x) for x in a], rtol=1e-3, atol=3e-9)
    first = float(coning.error(samples, shape)) * a ** (2 * samples)
    np.testing.assert_allclose(found, first, rtol=1.5 * a[0] ** 2)  # what follows is of two powers more
    assert np.log2(found[0] / found[1]) == pytest.approx(2 * samples, abs=1.5 * a[0] ** 2)


@pytest.mark.parametrize("shape", coning.SHAPES)
@pytest.mark.parametrize("past", [0, 1, 2, 3])
def test_past_samples_serve_an_interval_of_any_length(shape, past):
    around = np.array([12, 24])
    a = 2 * np.pi / around
    found = np.array([drift_with_past(shape, past, n) for n in around])
    first = float(coning.error(past + 1, shape)) * a ** (2 * past + 2)
    np.testing.assert_allclose(found, first, rtol=1.5 * a[0] ** 2)
    assert np.log2(found[0] / found[1]) == pytest.approx(2 * past + 2, abs=1.5 * a[0] ** 2)


def test_numbers_for_exact_integrals_leave_second_order_when_samples_are_integrated():
    """F^2 - 1 = -a^2 / 6: the cone that trapezoids show is narrower, and its third axis is not."""
    a = 2 * np.pi / 24
    assert drift_with_past("trapezoid", 3, 24, of="flat") == pytest.approx(a**2 / 6, rel=a**2)


def test_products_equally_far_apart_are_equal():
    """So the rule may take those with the last increment alone."""
    angles = seen("flat", 0.4, 5)
    for apart in (1, 2, 3):
        products = [np.cross(angles[i], angles[i + apart])[2] for i in range(5 - apart)]
        np.testing.assert_allclose(products, products[0], rtol=1e-9)


def test_turning_about_one_axis_needs_no_correction():
    rng = np.random.default_rng(3)
    angles = rng.normal(size=(4, 1)) * np.array([0.3, -0.5, 0.8])
    x, c = (np.array([float(n) for n in numbers]) for numbers in (coning.coefficients(4), coning.before(3)))
    np.testing.assert_allclose(coning.correction(angles, x), 0.0, atol=1e-15)
    np.testing.assert_allclose(coning.step(angles[:3].sum(axis=0), angles[:3], angles[3], c), 0.0, atol=1e-15)


def test_the_cone_s_rate_is_that_of_its_attitude():
    """w = 2 q* dq/dt by central differences; the increments are integrals of the rate by Gauss's rule."""
    half_angle, frequency, h = 0.3, 5.0, 1e-5
    times = np.linspace(0.0, 2.0, 7)
    q = cone.quaternion(half_angle, frequency, times)
    dq = (cone.quaternion(half_angle, frequency, times + h) - cone.quaternion(half_angle, frequency, times - h)) / (
        2 * h
    )
    vector = q[:, :1] * dq[:, 1:] - dq[:, :1] * q[:, 1:] - np.cross(q[:, 1:], dq[:, 1:])
    np.testing.assert_allclose(2 * vector, cone.rate(half_angle, frequency, times), atol=1e-8)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    for first, last, found in zip(times[:-1], times[1:], cone.increments(half_angle, frequency, times), strict=True):
        middle, half = 0.5 * (first + last), 0.5 * (last - first)
        integral = half * weights @ cone.rate(half_angle, frequency, middle + half * nodes)
        np.testing.assert_allclose(found, integral, atol=1e-13)


def test_trapezoids_pass_an_oscillation_as_the_shape_says():
    a = 0.7
    times = a * np.arange(50)
    found = increments.trapezoid(np.cos(times[:-1]), np.cos(times[1:]), a)
    np.testing.assert_allclose(found, PASSED["trapezoid"](a) * np.diff(np.sin(times)), atol=1e-14)


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


@pytest.mark.parametrize("samples", [1, 2, 3, 4])
def test_increments_of_the_fmu_lead_back_on_a_cone(native, samples):
    """The inputs go round on a cone of 0.1 milliradians at 6.7 Hz; readings at 100 Hz, increments of 5 of them.

    What is of fourth order in the angle of the cone is some 1e-8 of the coning rate.
    """
    half_angle, step, around, each = 1e-4, 0.01, 15, 5
    frequency = 2 * np.pi / (around * step)
    parameters = {**QUIET, "increment_samples": each, "coning_samples": samples}
    run = native.run(
        10 * around * step,
        step,
        ["increment.angle", "increment.interval"],
        parameters,
        lambda t: {"rate": cone.rate(half_angle, frequency, t)},
    )
    angles = run["increment.angle"][each::each][around // each :]
    turns = len(angles) * each / around
    found = together(angles)[2] / (turns * np.pi * half_angle**2)
    expected = error_by_formula(coning.before(samples - 1, "trapezoid"), 1, "trapezoid", 2 * np.pi / around)
    assert found == pytest.approx(expected, abs=3e-8)
    assert run["increment.interval"][-1] == pytest.approx(each * step, rel=1e-12)


@pytest.mark.parametrize("each", [6, 12, 30])
def test_a_wide_cone_leaves_what_is_of_third_order_in_an_interval(native, each):
    """Five degrees: eps^2 (w tau)^6 / 1680 of the coning rate for increments of tau, and higher powers of w tau.

    The increments of two samples in the products, or trapezoids taken for integrals, leave 1e-5 and 2e-3.
    """
    half_angle, step, around = np.radians(5.0), 0.01, 60
    frequency = 2 * np.pi / (around * step)
    parameters = {**QUIET, "increment_samples": each, "coning_samples": 4}
    run = native.run(
        8 * around * step,
        step,
        ["increment.angle"],
        {**parameters, "rate": cone.rate(half_angle, frequency, 0.0)},
        lambda t: {"rate": cone.rate(half_angle, frequency, t)},
    )
    angles = run["increment.angle"][each::each][around // each :]
    found = together(angles)[2] / (7 * 4 * np.pi * np.sin(half_angle / 2) ** 2)
    turn = 2 * np.pi * each / around
    # next power: 1/1680 falls to 1/1736, 1/1930 and 1/3870 at a tenth, a fifth and half of a turn
    assert 0.4 < found / (half_angle**2 * turn**6 / 1680) < 1.0
