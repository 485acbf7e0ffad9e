"""Verdicts beside pyins follow the errors, and a reference trajectory's transition is that of its strapdown."""

import numpy as np
import pytest

from evidence import inertial_navigation, reference_trajectory
from evidence.inertial_navigation import BEGIN, LOST, STOP, Filters, Strapdown
from evidence.reference_trajectory import Kept, Navigator, carried
from models.attitude import quaternion
from models.filters import kalman
from models.navigation import inertial

TIME = np.arange(BEGIN + 1.0, STOP + 0.5)


def filtered(ours, theirs):
    shape = (4, len(TIME))
    return Filters(TIME, ours * np.ones(shape), theirs * np.ones(shape))


def integrated(apart):
    return Strapdown(np.zeros(2), np.full(2, apart), np.ones(2), np.ones(2))


@pytest.mark.parametrize(
    ("apart", "ours", "verdicts"), [(0.1, 1.0, [True, True, True]), (2.0, 1.3, [False, False, False])]
)
def test_verdicts_follow_the_errors(apart, ours, verdicts):
    claims = inertial_navigation.claimed(integrated(apart), filtered(ours, 1.0))
    assert [claim.holds for claim in claims] == verdicts


def test_errors_count_in_their_times():
    """Before LOST and at the end: a filter that is worse only afterwards is so in the last claim alone."""
    one = filtered(1.0, 1.0)
    one.ours[:, LOST < TIME] = 3.0
    assert one.rms(BEGIN, LOST) == (1.0, 1.0) and one.rms(STOP - 1.0, STOP) == (3.0, 1.0)
    assert [claim.holds for claim in inertial_navigation.claimed(integrated(0.0), one)] == [True, True, False]


def flown(change):
    """A second of turning flight after the errors ``change`` at its begin: what the navigator then has."""
    turn = quaternion.product(quaternion.of_rotation(change[inertial.TILT]), quaternion.of_euler(0.2, 0.1, 1.0))
    state = Navigator(
        np.array([0.7, -1.5, 300.0]) + change[inertial.POSITION],
        np.array([20.0, 5.0, 1.0]) + change[inertial.VELOCITY],
        turn,
        change[9:].copy(),
        kalman.of_variances(np.ones(inertial.STATES)),
    )
    time = np.arange(0.0, 1.01, 0.02)
    force = np.array([0.5, -0.3, -9.9]) + 0.5 * np.sin(time)[:, None]
    rate = np.array([0.3, -0.1, 0.2]) * np.cos(time)[:, None]
    return state, carried(state, time, force, rate)


def test_the_transition_is_what_the_strapdown_does_with_errors():
    """By small changes of each state. A transition of the last substep alone, or in the wrong order, differs."""
    start, phi = flown(np.zeros(inertial.STATES))
    scale = np.concatenate([1.0 / np.array(inertial.metres(0.7, 300.0)), np.ones(12)])
    for i in range(9):
        change = np.zeros(inertial.STATES)
        change[i] = 1e-3 * scale[i]
        end, _ = flown(change)
        moved = np.concatenate([end.position - start.position, end.velocity - start.velocity])
        turned = quaternion.rotation(quaternion.product(end.turn, quaternion.inverse(start.turn)))
        seen = np.concatenate([moved, turned]) / scale[:9] / 1e-3
        np.testing.assert_allclose(phi[:9, i] / scale[:9] * scale[i], seen, atol=0.02)


def kept(smoothed, forwards=100.0, sigma=3.0):
    ones = np.ones((10, 2))
    return Kept("made", np.arange(10.0), forwards * ones, smoothed * ones, sigma * ones)


@pytest.mark.parametrize(("smoothed", "holds", "inside"), [(3.0, True, "100"), (12.0, True, "0"), (80.0, False, "0")])
def test_smoothed_errors_decide(smoothed, holds, inside):
    (claim,) = reference_trajectory.claimed([kept(smoothed)])
    assert claim.holds is holds
    ((name, stretches, *_, within),) = reference_trajectory.rows([kept(smoothed)])[1]
    assert (name, stretches, within) == ("made", "1", inside)
