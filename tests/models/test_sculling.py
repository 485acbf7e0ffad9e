"""Sculling: velocities put together in turning axes, against closed forms and quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad_vec

from fmus.inertial.imu import Imu
from models.inertial import coning, sculling
from tests.models.native import Native
from tests.models.rotation import matrix
from tests.models.test_coning import PASSED, error_by_formula
from tests.models.test_imu import QUIET

SWING, SHAKE = 2e-5, 3.0
"""rad about the first axis and m/s2 along the second, in phase: to first order the third gets SWING SHAKE / 2."""


def velocity(shape: str, past: int, around: int, each: int = 6) -> float:
    """Mean acceleration along the third axis over its truth, minus 1: w = d/dt SWING sin t, f = SHAKE sin t."""
    a = 2 * np.pi / around
    times = a * np.arange(-past, each * around + 1)
    angles = np.diff(np.outer(SWING * np.sin(times), [1.0, 0.0, 0.0]), axis=0) * PASSED[shape](a)
    velocities = np.diff(np.outer(-SHAKE * np.cos(times), [0.0, 1.0, 0.0]), axis=0) * PASSED[shape](a)
    c = np.array([float(x) for x in coning.before(past, shape)])
    gained = np.zeros(3)
    for first in range(past, len(angles), each):
        angle, total, scull = np.zeros(3), np.zeros(3), np.zeros(3)
        for i in range(first, first + each):
            old = slice(i - past, i)
            scull = scull + sculling.step(
                angle, angles[old][::-1], angles[i], total, velocities[old][::-1], velocities[i], c
            )
            angle, total = angle + angles[i], total + velocities[i]
        apparent = PASSED[shape](a) * SWING * np.sin(times[first])  # the attitude that these angles have led to
        turned = matrix(np.array([apparent, 0.0, 0.0]))
        gained = gained + turned @ sculling.at_the_beginning(angle, total + scull)
    return gained[2] / (0.5 * SWING * SHAKE * times[-1]) - 1.0


@pytest.mark.parametrize("shape", coning.SHAPES)
@pytest.mark.parametrize("past", [0, 1, 2, 3])
def test_sculling_is_as_exact_as_coning(shape, past):
    """An error of a sign, or the second product left out, would be as large as sculling itself.

    As for coning, what is right is the truth and not what a narrower swing and shake would have: so F^2 = 1 is met.
    """
    around = np.array([12, 24])
    a = 2 * np.pi / around
    found = np.array([velocity(shape, past, n) for n in around])
    numbers = coning.before(past, shape)
    np.testing.assert_allclose(-found, [error_by_formula(numbers, 1, shape, x) for x in a], rtol=1e-3, atol=3e-9)
    assert np.log2(found[0] / found[1]) == pytest.approx(2 * past + 2, abs=1.5 * a[0] ** 2)


@pytest.mark.parametrize("size", [0.0, 1e-4, 0.9e-3, 1.1e-3, 0.3, 3.0])
def test_constant_rate_and_force_are_turned_exactly(size):
    """integral C(t) f dt by quadrature; the second product left out is seen from 0.3 rad on, the first everywhere."""
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    force = np.array([1.0, 5.0, -9.8])
    exact, _ = quad_vec(lambda t: matrix(size * t * axis) @ force, 0.0, 1.0, epsabs=1e-13)
    np.testing.assert_allclose(sculling.at_the_beginning(size * axis, force), exact, atol=1e-12)


def test_constant_rate_and_force_have_no_sculling():
    angle, force = np.array([0.01, -0.02, 0.03]), np.array([1.0, 5.0, -9.8])
    past = np.ones((3, 1))
    c = np.array([float(x) for x in coning.before(3)])
    found = sculling.step(2 * angle, past * angle, angle, 2 * force, past * force, force, c)
    np.testing.assert_allclose(found, 0.0, atol=1e-15)


def test_the_fmu_sculls(tmp_path_factory):
    """Swing and shake in phase at 5 Hz, read at 100 Hz, increments of 4: the third axis gains what is true.

    Numbers of the other sign, or none, would be off by 8 % of the sculling; the flat ones by 1.6 %.
    """
    step, around, each, swing = 0.01, 20, 4, 1e-4
    native = Native(Imu, tmp_path_factory.mktemp("imu"))
    w, a = 2 * np.pi / (around * step), 2 * np.pi / around
    run = native.run(
        10 * around * step,
        step,
        ["increment.angle", "increment.velocity"],
        {**QUIET, "increment_samples": each},
        lambda t: {
            "rate": (swing * w * np.cos(w * t), 0.0, 0.0),
            "specific_force": (0.0, SHAKE * np.sin(w * t), 0.0),
        },
    )
    first = around // each
    angles, velocities = (run[n][each::each][first:] for n in ("increment.angle", "increment.velocity"))
    passed = PASSED["trapezoid"](a)
    # the inputs are held, so the increments are those of a step before; the swing has gone as far as its last rate
    attitude, gained = np.array([-passed * swing * np.sin(a), 0.0, 0.0]), np.zeros(3)
    for angle, change in zip(angles, velocities, strict=True):
        gained = gained + matrix(attitude) @ sculling.at_the_beginning(angle, change)
        attitude = attitude + angle
    turns = len(angles) * each * step
    assert gained[2] / (0.5 * swing * SHAKE * turns) - 1.0 == pytest.approx(
        -error_by_formula(coning.before(3, "trapezoid"), 1, "trapezoid", a), abs=1e-6
    )
