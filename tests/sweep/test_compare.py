"""What is an error, and what cannot be compared."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from navfmu.errors import NavfmuError
from navfmu.sweep.compare import comparable, compare, difference, not_real

KEYS = [(algorithm, step) for algorithm in ("gauss_seidel", "jacobi") for step in (0.1, 0.2)]


def frame(unit="m", **columns) -> pd.DataFrame:
    made = pd.DataFrame({name.replace("__", "."): values for name, values in columns.items()})
    made.attrs["units"] = {name: unit for name in made}
    return made


@pytest.mark.parametrize(("unit", "largest"), [("rad", 0.02), ("m", 2.0 * np.pi - 0.02)])
def test_angles_differ_by_the_short_way_round(unit, largest):
    a, b = (frame(unit, a=[0.0, sign * (np.pi - 0.01)]) for sign in (1.0, -1.0))
    assert difference(a, b, "a")[1] == pytest.approx(largest)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", ["run", "reference", "both"])
def test_a_value_that_is_not_finite_is_a_problem_wherever_it_is(value, where):
    """rms over NaN once was NaN, which no comparison ever found too great."""
    good, bad = frame(a__y=[1.0, 2.0, 3.0]), frame(a__y=[1.0, value, 3.0])
    run, reference = {"run": (bad, good), "reference": (good, bad), "both": (bad, bad)}[where]
    rms, largest, problem = difference(run, reference, "a.y")
    assert np.isnan(rms) and np.isnan(largest) and problem == "is not finite at 1 of 3 points"


def test_what_is_not_valid_need_not_be_finite():
    run = frame(b__y=[np.nan, 2.0], b__valid=[False, True])
    assert difference(run, frame(b__y=[0.0, 1.5], b__valid=[False, True]), "b.y") == (0.5, 0.5, "")


def test_a_run_that_is_never_valid_has_not_the_error_zero():
    never = frame(b__y=[9.0, 9.0], b__valid=[False, False])
    always = frame(b__y=[1.0, 2.0], b__valid=[True, True])
    frames = dict(zip(KEYS, (always, never, always, always), strict=True))
    rows, _ = compare(frames, ["b.y"], 0.1)
    problems = {(row.algorithm, row.step): row.problem for row in rows}
    assert problems["gauss_seidel", 0.2] == "is valid at no common point" and not problems["jacobi", 0.2]


def test_signals_that_are_valid_in_no_run_are_set_aside_by_name():
    silent = frame(b__y=[9.0, 9.0], b__valid=[False, False], c__y=[1.0, 2.0])
    assert comparable(dict.fromkeys(KEYS, silent)) == (["c.y"], ("b.y",))
    with pytest.raises(NavfmuError, match="valid in any run"):
        comparable(dict.fromkeys(KEYS, silent[["b.y", "b.valid"]]))


def test_modes_and_flags_are_named_because_they_have_no_error():
    mixed = frame(a__y=[1.0, 2.0], a__mode=[0, 1], b__y=[1.0, 2.0], b__valid=[True, True], b__lost=[0, 3])
    assert not_real(dict.fromkeys(KEYS, mixed)) == ("a.mode",)


def test_a_range_with_nan_in_it_makes_no_error_small():
    bad, other = frame(a__y=[1.0, np.nan]), frame(a__y=[1.0, 2.0])
    moved = frame(a__y=[1.0, 2.5])
    rows, apart = compare(dict(zip(KEYS, (bad, bad, other, moved), strict=True)), ["a.y"], 0.1)
    assert np.isnan(apart["a.y"])
    assert [row.relative for row in rows] == [np.inf, np.inf, 0.0, np.inf]
