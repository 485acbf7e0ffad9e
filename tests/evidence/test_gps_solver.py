"""A recorded day of satellites: without data nothing is claimed, and what differs from the independent one is said."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pymap3d

from evidence.sensors import gps_solver, observed


def test_without_data_it_is_left_out_with_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in gps_solver.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    section = gps_solver.run(tmp_path)
    assert section.left_out.endswith("has no esbc1770.rnx.gz") and not section.claims


def test_errors_are_east_north_up_from_the_antenna():
    """By pymap3d; north and east exchanged, or down for up, would be seen."""
    latitude, longitude, altitude = pymap3d.ecef2geodetic(*observed.TRUTH, deg=False)
    place = pymap3d.enu2geodetic(1.0, 2.0, -3.0, latitude, longitude, altitude, deg=False)
    found = {
        f"fix.{name}": np.array([value])
        for name, value in zip(("latitude", "longitude", "altitude"), place, strict=True)
    }
    np.testing.assert_allclose(observed.errors(found), [[1.0, 2.0, -3.0]], atol=1e-6)
    moving = {"fix.velocity_n": np.array([[2.0, 1.0, 3.0]])}
    np.testing.assert_array_equal(observed.velocities(moving), [[1.0, 2.0, -3.0]])


def day(**made) -> SimpleNamespace:
    return SimpleNamespace(**made)


def test_errors_of_another_size_are_said():
    """12 % more in one axis miss the bound of 10 %, however good the others are."""
    theirs = np.tile([0.6, 0.9, 1.4], (10, 1))
    for scale, holds in ((1.0, True), (1.09, True), (1.12, False), (0.88, False)):
        ours = theirs * [1.0, scale, 1.0]
        made = day(
            errors=ours,
            whole={"fix.velocity_n": theirs[:, [1, 0, 2]] * [1, 1, -1]},
            theirs=lambda name: theirs,
        )
        position, velocity = gps_solver.Day.accurate.fget(made)
        assert position.holds == holds and velocity.holds
        assert ("otherwise" in position.sentence) != holds


def test_a_model_that_is_missed_otherwise_is_said():
    columns = [f"ours_{axis}" for axis in "enu"] + ["rms_e", "rms_n", "rms_u"]
    for found, holds in ((1.19, True), (1.21, False)):
        spoilt = pd.DataFrame([[1.0, found, 1.0, 1.0, 1.0, 1.0]], columns=columns, index=["no TGD"])
        assert gps_solver.Day.left_out.fget(day(spoilt=spoilt)).holds == holds


def test_a_wrong_satellite_or_an_alarm_is_no_finding():
    cases = pd.DataFrame(
        {
            "bias_m": [0.0, 30.0, 100.0],
            "excluded_prn": [np.nan, 5.0, 5.0],
            "ours_excluded": [0.0, 5.0, 5.0],
            "alarm": [0, 0, 0],
        }
    )
    assert gps_solver.Day.found.fget(day(cases=cases)).holds
    assert not gps_solver.Day.found.fget(day(cases=cases.assign(ours_excluded=[0.0, 5.0, 7.0]))).holds
    assert not gps_solver.Day.found.fget(day(cases=cases.assign(ours_excluded=[2.0, 5.0, 5.0]))).holds
    assert not gps_solver.Day.found.fget(day(cases=cases.assign(alarm=[0, 1, 0]))).holds


def test_an_error_beyond_its_protection_level_is_said():
    one = np.ones(3)
    levels = pd.DataFrame(
        {
            **dict.fromkeys(("ours", "hpl_we_wgt", "ours_vertical", "vpl_we_wgt", "ours_brown", "hpl_brown_33m"), one),
            "off": 0.5 * one,
            "off_vertical": [0.1, 0.2, 0.9],
        }
    )
    same, below = gps_solver.Day.bounded.fget(day(levels=levels))
    assert same.holds and below.holds and below.measured == 0.9
    same, below = gps_solver.Day.bounded.fget(day(levels=levels.assign(off_vertical=1.1, ours_brown=1.01)))
    assert not same.holds and not below.holds


def test_the_best_three_surround_the_receiver():
    """Of six low satellites at equal angles and three close together, three that are 120 degrees apart."""
    azimuth = np.radians([0.0, 10.0, 20.0, 60.0, 120.0, 180.0, 240.0, 300.0])
    unit_n = np.stack([0.9 * np.cos(azimuth), 0.9 * np.sin(azimuth), np.full(8, -np.sqrt(0.19))], axis=1)
    chosen = np.degrees(azimuth[list(gps_solver.best_three(unit_n))])
    np.testing.assert_allclose(np.diff(chosen), 120.0, atol=1e-9)
