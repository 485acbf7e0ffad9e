"""The statistics of an error in two axes, which stand beside the verdicts of a campaign."""

from __future__ import annotations

import math

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.report.scene import Bound, Recorded
from navfmu.report.statistics.radial import Statistic, beyond

TIME = np.arange(100.0)
LIMIT = Bound("R", "e.r", None, 10.0, "m", 0.0)


def statistic() -> Statistic:
    axes = [{"name": axis, "error": f"e.{axis}", "sigma": f"s.{axis}"} for axis in ("n", "e")]
    return Statistic(kind="radial", error="e.r", axes=axes)


def run(north: np.ndarray, sigma: np.ndarray | float = 5.0) -> Recorded:
    signals = {"e.r": np.abs(north), "e.n": north, "e.e": 0 * TIME, "s.n": sigma + 0 * TIME, "s.e": 5.0 + 0 * TIME}
    return Recorded("seed", TIME, signals)


def test_the_probability_of_a_large_error_has_its_closed_forms():
    sigma = np.array([300.0])
    assert beyond(926.0, sigma, sigma) == pytest.approx(math.exp(-(926**2) / 2 / 300**2), rel=1e-12)  # Rayleigh
    line = math.erfc(926.0 / 800.0 / math.sqrt(2))
    assert beyond(926.0, np.array([800.0]), np.array([1e-3])) == pytest.approx(line, rel=1e-3)  # normal, one axis
    assert beyond(926.0, np.array([0.0]), np.array([0.0])) == 0.0


def test_the_probability_agrees_with_drawn_errors():
    random = np.random.default_rng(1)
    drawn = np.hypot(random.normal(0, 300, 400_000), random.normal(0, 150, 400_000)) > 500
    assert beyond(500.0, np.array([300.0]), np.array([150.0])) == pytest.approx(drawn.mean(), abs=0.002)


def test_what_is_no_number_is_beyond_the_limit_outside_and_said():
    north = np.full(100, 1.0)
    north[:7] = np.nan
    runs = [run(north), run(np.full(100, 2.0))]
    row = statistic().row(runs, [LIMIT])
    assert (row["above"], row["inside"], row["ever"]) == (pytest.approx(3.5), pytest.approx(96.5), 1)
    assert row["high"] == math.inf and row["high_time"] == 0.0
    assert "not finite at 14 of 1000 points" in statistic().remark(runs, [LIMIT])
    headings, ((_, median, *_),) = statistic().table([row], "m")
    assert headings[1] == "median, m" and median == "not finite"
    assert statistic().remark([run(np.full(100, 2.0))], [LIMIT]) == ""


def test_a_sigma_that_is_no_number_promises_nothing():
    sigma = np.full(100, 1e-3)
    assert statistic().row([run(0 * TIME, sigma)], [LIMIT])["predicted"] == pytest.approx(100 * beyond(10.0, 1e-3, 5.0))
    sigma[:50] = np.nan
    row = statistic().row([run(0 * TIME, sigma)], [LIMIT])
    assert row["predicted"] > 50.0 and row["inside"] == 50.0


def test_the_longest_upper_bound_is_asked_and_its_window_counts():
    short, low = Bound("S", "e.r", None, 1.0, "m", 0.0, 10.0), Bound("L", "e.r", 0.0, None, "m")
    late = Bound("T", "e.r", None, 10.0, "m", 50.0)
    assert statistic().row([run(TIME)], [short, low, late])["limit"] == 10.0
    assert statistic().row([run(TIME)], [short, late])["median"] == 99.0
    assert statistic().row([run(TIME)], [short])["median_time"] == 10.0
    assert statistic().row([run(TIME)], [low]) is None


def test_its_units_must_be_one():
    units = dict.fromkeys(statistic().needs(), "m")
    statistic().check(units)
    with pytest.raises(NavfmuError, match=r"'e.r' is in m, 's.e' in rad"):
        statistic().check(units | {"s.e": "rad"})


def test_runs_that_ended_early_are_beyond_the_limit_from_then_on_and_said():
    """They were stacked as if all had one length."""
    whole = run(np.full(100, 2.0))
    short = Recorded("seed", TIME[:60], {name: whole[name][:60] for name in whole.signals}, TIME)
    row = statistic().row([whole, short], [LIMIT])
    assert (row["above"], row["inside"], row["high_time"]) == (pytest.approx(20.0), pytest.approx(80.0), 60.0)
    assert statistic().remark([whole, short], [LIMIT]).startswith("1 of 2 runs ended early: ")
    over = Bound("R", "e.r", None, 10.0, "m", 0.0, 50.0)
    assert statistic().row([whole, short], [over])["above"] == 0.0 and not statistic().remark([whole, short], [over])
    late = Bound("R", "e.r", None, 10.0, "m", 70.0)
    assert statistic().row([short, short], [late])["above"] == 100.0
