"""Units on a table: that the claims hold for what the command says, and not for sigmas that are wrong."""

from __future__ import annotations

from dataclasses import replace

import matplotlib.image
import pytest

from evidence.sensors import imu_calibration
from navfmu.system import shipped
from tests.built import fmu


@pytest.fixture
def table(monkeypatch, tmp_path_factory):
    monkeypatch.setattr(shipped, "path", lambda name: fmu(name.removesuffix(".fmu"), tmp_path_factory))
    monkeypatch.setattr(imu_calibration, "UNITS", 3)
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    return imu_calibration.Table()


def test_three_units_are_within_their_covariance_and_not_within_a_tenth_of_it(table):
    """Wrong: a score of one side, which takes sigmas that are far too large or too small."""
    assert table.consistent.holds and table.scattered.holds
    for share in (0.1, 10.0):
        other = imu_calibration.Table()
        other.__dict__["units"] = [
            (
                true,
                replace(one, fit=replace(one.fit, covariance=share * one.fit.covariance, sigma=share * one.fit.sigma)),
            )
            for true, one in table.units
        ]
        assert not other.consistent.holds and not other.scattered.holds


def test_without_recordings_there_are_claims_and_a_picture(table, tmp_path):
    (tmp_path / "sensors").mkdir()
    found = imu_calibration.run(tmp_path)
    assert len(found.claims) == 3 and imu_calibration.rests() == []
    assert matplotlib.image.imread(tmp_path / "sensors" / "imu_calibration.png").shape[2] == 4
