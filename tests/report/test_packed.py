"""Curves of runs as a page holds them: what comes out again, and what thinning out must not lose."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from navfmu.report.packed import ALL, kept, packed, unpacked
from navfmu.report.panel import Curve, Panel, constant

TIME = np.arange(2101.0)


def panel(*curves: Curve) -> Panel:
    return Panel("title", "time, s", "error, m", curves)


def columns(curve: Curve, stretches: int = 100) -> tuple[np.ndarray, np.ndarray]:
    about, found = unpacked(packed([panel(curve)], {}, stretches))
    drawn = about["panels"][0]["curves"][0]
    return found[drawn["x"]], found[drawn["y"]]


def test_values_come_out_to_a_65534th_of_their_range():
    values = 1e6 + 300.0 * np.sin(TIME[:700] / 50.0)
    time, found = columns(Curve("a", TIME[:700], values))
    assert np.array_equal(time, TIME[:700])
    assert np.abs(found - values).max() <= 0.51 * np.ptp(values) / 65534


@pytest.mark.parametrize("values", [TIME[:700] - 350.0, np.full(700, 2.5), np.arange(700) % 2, np.full(700, -1e-300)])
def test_whole_numbers_truth_values_and_constants_come_out_as_they_are(values):
    assert np.array_equal(columns(Curve("a", TIME[:700], values))[1], np.asarray(values, float))


def test_what_is_no_number_is_a_gap_and_nothing_else_is():
    values = np.sin(TIME[:700])
    values[10], values[20], values[30] = np.nan, np.inf, -np.inf
    found = columns(Curve("a", TIME[:700], values))[1]
    assert np.array_equal(np.isnan(found), ~np.isfinite(values))
    assert np.isnan(columns(Curve("a", TIME[:5], np.full(5, np.nan)))[1]).all()


def test_the_largest_numbers_that_there_are_do_not_overflow():
    values = np.array([-1.7e308, 0.0, 1.7e308])
    found = columns(Curve("a", np.arange(3.0), values))[1]
    assert np.isfinite(found).all() and found == pytest.approx([-1e300, 0.0, 1e300], abs=1e296)


def test_thinning_out_keeps_every_peak_of_what_is_asked_for():
    """A point in a thousand that is beyond a bound would not be seen if every third point were kept."""
    values = np.random.default_rng(1).normal(size=TIME.size)
    values[777], values[1234] = 50.0, -60.0
    time, found = columns(Curve("a", TIME, values, peaks=True), stretches=50)
    assert len(time) < 300 and {777.0, 1234.0} <= set(time)
    edges = np.linspace(0, TIME.size, 51).astype(int)
    for first, end in pairwise(edges):
        inside = (time >= TIME[first]) & (time <= TIME[end - 1])
        assert found[inside].max() == pytest.approx(values[first:end].max(), abs=2e-3)
        assert found[inside].min() == pytest.approx(values[first:end].min(), abs=2e-3)
    assert time[0] == 0.0 and time[-1] == TIME[-1]


def test_thinning_out_does_not_close_a_gap():
    values = np.sin(TIME)
    values[900] = np.nan
    assert 900 in kept([values], TIME.size, 50)


def test_short_runs_are_whole_and_curves_of_another_length_are_not_thinned_out():
    assert len(kept([], ALL, 10)) == ALL
    text = packed([panel(Curve("a", TIME, TIME), constant("bound", 5.0, 3.0, 2000.0, "#000"))], {"end": 2100.0}, 20)
    about, found = unpacked(text)
    a, bound = about["panels"][0]["curves"]
    assert about["end"] == 2100.0 and len(found[a["x"]]) == 40
    assert list(found[bound["x"]]) == [3.0, 2000.0] and list(found[bound["y"]]) == [5.0, 5.0]


def test_curves_share_the_column_of_their_times():
    about, _ = unpacked(packed([panel(Curve("a", TIME, TIME**2), Curve("b", TIME, -TIME))], {}, 20))
    assert len(about["columns"]) == 3
