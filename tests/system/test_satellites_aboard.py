"""The backup navigator with a receiver of signals and a solver in the place of a receiver of positions."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu import System
from navfmu.faults import Fault
from navfmu.system import shipped
from system_ssp.backup_navigator.system import source


@pytest.fixture(scope="module")
def aboard(tmp_path_factory):
    file = tmp_path_factory.mktemp("aboard") / "aboard.ssp"
    source(shipped.path("imu.fmu").parent, signals="gps_signals.fmu", name="aboard").pack(file)
    return System.load(file)


def test_it_flies_by_satellites_and_coasts_while_a_jammer_is_near(aboard):
    """A jammer of 1 kW is on the air for 30 s. Before, positions are those of GPS; then the navigator coasts (mode 2)
    until the signals have been found again, 20 s after it stops, and comes back to them."""
    jammer = Fault("jammer", "gps.jammer_power[1]", "input", start=60.0, duration=30.0, value=1000.0)
    signals = ["navigator.mode", "evaluation.horizontal_error", "gps.satellites", "gps_solver.fix.valid"]
    run = aboard.run(stop=150.0, step=0.01, seed=3, faults=[jammer], record=signals, record_period=1.0)
    mode, error, seen, valid = (run[name].to_numpy() for name in signals)
    assert np.all(seen[5:60] >= 5) and np.all(valid[5:60])
    assert np.all(seen[62:109] == 0) and not np.any(valid[63:109])
    assert np.all(seen[114:] >= 5) and np.all(valid[115:])
    assert np.all(mode[10:60] == 1) and np.all(mode[70:105] == 2) and np.all(mode[120:] == 1)
    assert np.all(error[10:60] < 30.0) and np.all(error[120:] < 30.0)
