"""Simulated and recorded days: without data nothing is claimed, and what differs is said."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from evidence.sensors import gps_signals


def test_without_data_it_is_left_out_with_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in gps_signals.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    section = gps_signals.run(tmp_path)
    assert section.left_out.endswith("has no esbc1770.rnx.gz") and not section.claims


def day(residual=1.0, velocity=1.0, position=1.0, strength=0.0, satellites=9.0):
    return SimpleNamespace(
        residuals=residual * np.array([0.6, 0.5]),
        found={"satellites": np.array([satellites]), "fix.velocity_n": velocity * np.ones((4, 3))},
        errors=position * np.ones((4, 3)),
        strength=45.0 + strength * np.ones(2),
    )


def test_each_difference_is_said_by_its_own_claim():
    """A statistic beyond its bound fails that claim and no other one."""
    within = {"satellites": 9.05, "residual": 1.15, "velocity": 0.85, "position": 1.35, "strength": 1.9}
    beyond = {"satellites": 9.2, "residual": 1.25, "velocity": 0.75, "position": 0.55, "strength": -2.1}
    for k, name in enumerate(within):
        for changed, holds in ((within, True), (beyond, False)):
            claims = gps_signals.Both(day(), [day(**{name: changed[name]})] * 2).claims
            assert [claim.holds for claim in claims] == [holds or i != k for i in range(5)], name


def test_statistics_are_of_what_is_used_in_a_band():
    solved = gps_signals.Solved(None)
    solved.__dict__["found"] = {
        "used": np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]]),
        "elevation": np.radians([[15.0, 25.0, 15.0], [15.0, 25.0, 70.0]]),
    }
    values = np.array([[1.0, 2.0, 100.0], [3.0, 4.0, 5.0]])
    np.testing.assert_array_equal(solved.by_band(values, np.sum), [4.0, 6.0, 0.0, 0.0, 5.0])
