"""A recorded day flown as FMUs: without data nothing is claimed, and what differs from the independent one is said."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd

from evidence.sensors import observations


def test_without_data_it_is_left_out_with_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in observations.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    section = observations.run(tmp_path)
    assert section.left_out.endswith("has no esbc1770.rnx.gz") and not section.claims


def test_arrays_are_gathered_by_place():
    frame = pd.DataFrame({"a": [1.0, 2.0], "b[1]": [3.0, 4.0], "b[2]": [5.0, 6.0]})
    found = observations._gathered(frame)
    np.testing.assert_array_equal(found["a"], [1.0, 2.0])
    np.testing.assert_array_equal(found["b"], [[3.0, 5.0], [4.0, 6.0]])


def test_errors_of_another_size_and_places_elsewhere_are_said():
    """12 % more in one axis miss the bound of 10 %; 3 mm in two of 100 places miss that of 2 mm."""
    theirs = np.tile([0.6, 0.9, 1.4], (10, 1))
    for scale, holds in ((1.0, True), (1.09, True), (1.12, False), (0.88, False)):
        made = SimpleNamespace(
            errors=theirs * [1.0, scale, 1.0],
            whole={"fix.velocity_n": theirs[:, [1, 0, 2]] * [1, 1, -1]},
            theirs=lambda name: theirs,
        )
        position, velocity = observations.Day.accurate.fget(made)
        assert position.holds == holds and velocity.holds
    for off, holds in ((1e-3, True), (3e-3, False)):
        apart = np.zeros(1000)
        apart[:20] = off
        assert observations.Day.same.fget(SimpleNamespace(apart=apart)).holds == holds


def test_a_fault_that_is_not_found_or_of_another_satellite_is_said():
    cases = pd.DataFrame(
        {"bias_m": [0.0, 30.0], "excluded_prn": [np.nan, 15.0], "ours_excluded": [0.0, 15.0], "alarm": [False, False]}
    )
    assert observations.Day.found.fget(SimpleNamespace(cases=cases)).holds
    for wrong in ({"ours_excluded": [0.0, 14.0]}, {"ours_excluded": [3.0, 15.0]}, {"alarm": [True, False]}):
        assert not observations.Day.found.fget(SimpleNamespace(cases=cases.assign(**wrong))).holds


def test_protection_levels_and_models_left_out_that_differ_are_said():
    levels = pd.DataFrame({"ours": [10.0], "hpl_we_wgt": [10.0], "ours_vertical": [20.0], "vpl_we_wgt": [20.0]})
    assert observations.Day.bounded.fget(SimpleNamespace(levels=levels)).holds
    assert not observations.Day.bounded.fget(SimpleNamespace(levels=levels.assign(ours=10.1))).holds
    spoilt = pd.DataFrame([[1.0, 2.0, 3.0, 1.0, 2.0, 3.0]])
    assert observations.Day.missed.fget(SimpleNamespace(spoilt=spoilt)).holds
    assert not observations.Day.missed.fget(SimpleNamespace(spoilt=spoilt * [1, 1, 1.3, 1, 1, 1])).holds
