"""A short past: what was, exactly for what is linear, by closed forms and by NumPy's own interpolation."""

from __future__ import annotations

import numpy as np
import pytest

from models.processes import past

LONG_AGO = -1.0e9


def empty(moments=8, quantities=1):
    return np.full(moments, LONG_AGO), np.zeros((moments, quantities))


def filled(times, function, spacing=0.0, moments=8):
    held, values = empty(moments)
    for time in times:
        held, values = past.remember(held, values, time, np.array([function(time)]), spacing)
    return held, values


def test_between_moments_it_is_that_of_an_independent_interpolation():
    """A ring that takes the wrong neighbour, or the newest first for the oldest, is another polygon."""
    times = np.array([0.0, 0.1, 0.35, 0.4, 0.7, 0.75, 1.0])
    held, values = filled(times, lambda t: np.sin(5.0 * t))
    for moment in np.linspace(0.0, 1.2, 61):
        expected = np.interp(moment, times, np.sin(5.0 * times))
        assert past.at(held, values, moment)[0] == pytest.approx(expected, abs=1e-12)


def test_what_is_newest_is_told_with_its_bits():
    """Interpolated between two others it would differ in the last place, and so would all that a fix without delay
    does."""
    held, values = filled(np.arange(0.0, 1.0, 0.1), lambda t: 0.1 + t / 3.0)
    assert past.at(held, values, held[0])[0] == values[0, 0]
    assert past.at(held, values, held[0] + 5.0)[0] == values[0, 0]
    assert past.since(held, values, held[0])[0] == 0.0


@pytest.mark.parametrize("period", [0.01, 0.03, 0.1, 0.2])
def test_a_few_moments_reach_back_whatever_the_period(period):
    """One that keeps every sample forgets after 0.08 s at 100 Hz, and then tells the oldest for what was at 0.5 s."""
    held, values = filled(np.arange(0.0, 3.0, period), lambda t: 2.0 * t, spacing=0.1)
    assert held[0] - held[-1] >= 0.6
    assert np.all(np.diff(held) < 0.0)
    assert past.at(held, values, held[0] - 0.5)[0] == pytest.approx(2.0 * (held[0] - 0.5), abs=1e-12)


def test_what_a_turn_carries_is_its_arc():
    """Velocity in a turn of radius v / w: the way back over 0.4 s is v / w (sin ...), not the velocity of now times
    0.4 s, which is 0.5 m off where v = 25 m/s and w = 0.3 rad/s."""
    speed, turn, age = 25.0, 0.3, 0.4
    held, values = empty(quantities=2)
    for time in np.arange(0.0, 2.0, 0.1):
        velocity = speed * np.array([np.cos(turn * time), np.sin(turn * time)])
        held, values = past.remember(held, values, time, velocity, 0.1)
    now, then = held[0], held[0] - age
    arc = speed / turn * np.array([np.sin(turn * now) - np.sin(turn * then), np.cos(turn * then) - np.cos(turn * now)])
    straight = values[0] * age
    assert np.linalg.norm(straight - arc) > 0.5
    np.testing.assert_allclose(straight + past.since(held, values, then), arc, atol=2e-3)


def test_before_the_oldest_it_holds():
    """One that goes on along the last line tells a speed that never was; one that knows nothing tells 0."""
    held, values = filled(np.arange(0.0, 0.8, 0.1), lambda t: 3.0 + t)
    assert past.at(held, values, -10.0)[0] == pytest.approx(3.0)
    expected = -0.5 * 0.7 * 0.7 - 10.0 * 0.7
    assert past.since(held, values, -10.0)[0] == pytest.approx(expected)


def test_of_one_sample_nothing_is_known_but_this():
    """Between it and the start value of a ring lies no line."""
    held, values = filled([4.0], lambda t: 7.0)
    assert past.at(held, values, 3.5)[0] == pytest.approx(7.0, abs=1e-6)
    assert past.since(held, values, 3.5)[0] == pytest.approx(0.0, abs=1e-6)
