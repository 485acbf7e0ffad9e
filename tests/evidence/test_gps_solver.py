"""A recorded day of satellites: without data nothing is claimed, and an error that is not bounded is said."""

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


def test_an_error_beyond_its_protection_level_is_said():
    one = np.ones(3)
    levels = pd.DataFrame({"ours": one, "ours_vertical": one, "off": 0.5 * one, "off_vertical": [0.1, 0.2, 0.9]})
    below = gps_solver.Day.beyond.fget(SimpleNamespace(levels=levels))
    assert below.holds and below.measured == 0.9
    assert not gps_solver.Day.beyond.fget(SimpleNamespace(levels=levels.assign(off_vertical=1.1))).holds
    assert not gps_solver.Day.beyond.fget(SimpleNamespace(levels=levels.assign(off=1.1))).holds


def test_the_best_three_surround_the_receiver():
    """Of six low satellites at equal angles and three close together, three that are 120 degrees apart."""
    azimuth = np.radians([0.0, 10.0, 20.0, 60.0, 120.0, 180.0, 240.0, 300.0])
    unit_n = np.stack([0.9 * np.cos(azimuth), 0.9 * np.sin(azimuth), np.full(8, -np.sqrt(0.19))], axis=1)
    chosen = np.degrees(azimuth[list(gps_solver.best_three(unit_n))])
    np.testing.assert_allclose(np.diff(chosen), 120.0, atol=1e-9)
