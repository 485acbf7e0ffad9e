"""Recorded flights, for those who have them: NAVFMU_DATA names a folder with flights/*.csv."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from navfmu.constants import FOOT, KNOT
from navfmu.recorded.importer import import_track

DATA = os.environ.get("NAVFMU_DATA")
FLIGHTS = sorted((Path(DATA) / "flights").glob("*.csv")) if DATA else []


@pytest.mark.skipif(
    not FLIGHTS, reason="recorded flights are not part of the repository; NAVFMU_DATA names their folder"
)
@pytest.mark.parametrize("path", FLIGHTS, ids=lambda path: path.stem)
def test_recorded_flight_becomes_a_plausible_one(path):
    """Jets and turboprops that calibrate navigation aids: what they cannot do would be the smoothing's doing."""
    imported = import_track(path)
    residuals, flight = imported.residuals, imported.flight
    time = np.arange(0.0, flight.duration, 0.5)
    north, east, up = flight.velocity(time)
    speed = np.hypot(north, east)
    turn = np.gradient(np.unwrap(np.arctan2(east, north)), time)
    assert flight.duration > 2.5 * 3600.0
    assert 60.0 * KNOT < np.percentile(speed, 1) and speed.max() < 450.0 * KNOT
    assert np.percentile(np.abs(np.degrees(np.arctan2(speed * turn, 9.80665))), 99.5) < 45.0
    assert np.percentile(np.abs(up), 99.5) < 6000.0 * FOOT / 60.0
    assert np.nanpercentile(np.abs(residuals.cross), 95) < 25.0
    assert np.nanpercentile(np.abs(residuals.speed), 95) < 6.0 * KNOT
    assert np.nanpercentile(np.abs(residuals.altitude), 95) < 60.0 * FOOT
    assert imported.defects.jitter < 2.5
