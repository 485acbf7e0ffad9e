"""Time is counted in whole steps."""

import numpy as np
import pytest

from navfmu.engine.clock import FOREVER, Clock
from navfmu.errors import NavfmuError


def test_ten_steps_of_a_tenth_end_at_one():
    clock = Clock.of(0.1, 1.0)
    assert clock.steps == 10
    assert clock.time(10) == 1.0


def test_times_are_the_nearest_doubles_to_the_decimal_times():
    clock = Clock.of(0.1, 10.0)
    assert [clock.time(k) for k in range(101)] == [float(f"{k // 10}.{k % 10}") for k in range(101)]


@pytest.mark.parametrize("step", [0.002, 0.005, 0.01, 0.015, 1 / 3, 0.1, 1.0, 0.7071067811865476, 1e-5])
def test_a_run_ends_at_its_stop_time(step):
    for steps in (1, 7, 1000, 123_457):
        clock = Clock.of(step, steps * step)
        assert clock.steps == steps
        assert clock.time(steps) == pytest.approx(steps * step, rel=1e-15)


def test_a_stop_time_between_steps_is_refused_with_the_nearest_ones():
    with pytest.raises(NavfmuError, match=r"stop time 1 s is not a multiple of the step 0.3 s.*0.9 s or 1.2 s"):
        Clock.of(0.3, 1.0)
    with pytest.raises(NavfmuError, match=r"nearest is 0\.3 s"):
        Clock.of(0.3, 0.1)


@pytest.mark.parametrize(
    ("step", "stop"), [(0, 1), (-0.1, 1), (0.1, 0), (0.1, -1), (float("nan"), 1), (0.1, float("inf"))]
)
def test_step_and_stop_must_be_positive_numbers(step, stop):
    with pytest.raises(NavfmuError, match="must be a positive number of seconds"):
        Clock.of(step, stop)


def test_numbers_of_numpy_are_numbers():
    clock = Clock.of(np.float32(0.5), np.int64(2))
    assert (clock.step, clock.steps, clock.multiple(np.int32(1), "period")) == (0.5, 4, 2)


def test_steps_that_cannot_be_counted_are_refused():
    with pytest.raises(NavfmuError, match="more steps than can be counted exactly"):
        Clock.of(1e-300, 1.0)
    with pytest.raises(NavfmuError, match="more steps than can be counted exactly"):
        Clock.of(0.01, 1e300)


def test_the_first_point_at_or_after_a_time():
    clock = Clock.of(0.1, 10.0)
    assert [clock.index(t) for t in (0.0, 0.05, 0.1, 0.3, 0.1 + 0.2, 0.31, 5.0)] == [0, 1, 1, 3, 3, 4, 50]
    assert clock.index(float("inf")) == FOREVER


def test_a_period_must_be_a_multiple_of_the_step():
    clock = Clock.of(0.01, 10.0)
    assert clock.multiple(0.5, "recording period") == 50
    with pytest.raises(NavfmuError, match=r"recording period 0.015 s is not a multiple of the step 0.01 s"):
        clock.multiple(0.015, "recording period")
    with pytest.raises(NavfmuError, match="positive"):
        clock.multiple(0.0, "recording period")
