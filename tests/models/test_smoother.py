"""The smoother against the least squares of all measurements at once, which is what it is short for."""

import numpy as np
import pytest

from models.filters import kalman
from models.filters.smoother import Step, smoothed


def recorded(seed, count=40):
    """A position with a Gauss-Markov velocity that is measured now and then, filtered with a trajectory of its own."""
    rng = np.random.default_rng(seed)
    phi, noise = np.array([[1.0, 1.0], [0.0, 0.95]]), np.diag([1.0e-3, 0.2])
    start, variance, row = np.diag([25.0, 4.0]), 2.0, np.array([1.0, 0.0])
    state = np.linalg.cholesky(start) @ rng.standard_normal(2)
    covariance, estimate = start, np.zeros(2)
    truth, estimates, steps, measured = [state], [estimate], [], []
    for k in range(1, count + 1):
        state = phi @ state + np.sqrt(np.diag(noise)) * rng.standard_normal(2)
        begun, predicted = covariance, phi @ covariance @ phi.T + noise
        there = k % 7 == 0
        z = row @ state + np.sqrt(variance) * rng.standard_normal()
        estimate = phi @ estimate
        correction, upper, _ = kalman.update(
            np.zeros(2), kalman.pack(predicted), row, variance, z - row @ estimate, there
        )
        estimate, covariance = estimate + correction, kalman.unpack(upper)
        steps.append(Step(begun, phi, predicted, correction))
        truth.append(state)
        estimates.append(estimate)
        measured.append((k, z) if there else None)
    return np.array(truth), np.array(estimates), steps, covariance, (phi, noise, start, row, variance), measured


def at_once(model, measured, count):
    """Mean and covariance of all states by the normal equations of start, motion and measurements."""
    phi, noise, start, row, variance = model
    n = 2 * (count + 1)
    information, right = np.zeros((n, n)), np.zeros(n)
    information[:2, :2] += np.linalg.inv(start)
    weight = np.linalg.inv(noise)
    for k in range(count):
        both = np.hstack([-phi, np.eye(2)])
        information[2 * k : 2 * k + 4, 2 * k : 2 * k + 4] += both.T @ weight @ both
    for k, z in filter(None, measured):
        information[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] += np.outer(row, row) / variance
        right[2 * k : 2 * k + 2] += row * z / variance
    covariance = np.linalg.inv(information)
    return (covariance @ right).reshape(-1, 2), covariance


@pytest.mark.parametrize("seed", range(3))
def test_smoothed_states_are_those_of_least_squares(seed):
    """Catches a gain that takes the covariance after the measurements, and one that forgets the correction at the end
    of a step."""
    _, estimates, steps, last, model, measured = recorded(seed)
    corrections, covariances = smoothed(steps, last)
    expected, covariance = at_once(model, measured, len(steps))
    np.testing.assert_allclose(estimates + corrections, expected, atol=1e-9)
    for k, one in enumerate(covariances):
        np.testing.assert_allclose(one, covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2], atol=1e-9)


def test_units_of_states_make_no_difference():
    """Positions in rad, ten orders smaller."""
    _, _, steps, last, _, _ = recorded(5)
    unit = np.array([1.0e-10, 1.0])
    turned = [
        Step(
            step.begun * np.outer(unit, unit),
            step.transition * np.outer(unit, 1.0 / unit),
            step.predicted * np.outer(unit, unit),
            step.correction * unit,
        )
        for step in steps
    ]
    plain, other = smoothed(steps, last)[0], smoothed(turned, last * np.outer(unit, unit))[0]
    np.testing.assert_allclose(other / unit, plain, rtol=1e-7, atol=1e-9)
