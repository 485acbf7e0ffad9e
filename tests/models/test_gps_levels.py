"""GPS as positions and as signals: what is done to one is done to the other, and both are lost at the same distance."""

from __future__ import annotations

import numpy as np

from fmus.satellite.gps import Gps
from fmus.satellite.gps_signals import GpsSignals
from fmus.satellite.gps_solver import GpsSolver
from tests.models.native import interpret
from tests.models.receiving import PLACE, Receiving

EARTH = 6.371e6


def declared(component, name):
    """What a host sees of a variable."""
    field = component.layout.fields[name]
    return field.type, field.shape, field.unit


def test_one_file_of_faults_serves_positions_and_signals():
    """And so do the parameters that say where jammers and regions are."""
    ours = Gps.layout.fields
    faults = {name for name, field in ours.items() if field.fault}
    assert faults == {"jammed", "jammer_power", "region_radius", "spoofing_n", "spoofing_rate_n", "accuracy_lie"}
    places = {name for name in ours if name.startswith(("jammer_", "region_", "acquisition_", "carrier_"))}
    for name in faults | places:
        assert declared(Gps, name) == declared(GpsSignals, name), name
    for name in ours:
        if name.startswith("fix."):
            assert declared(Gps, name) == declared(GpsSolver, name), name


def test_both_are_lost_at_the_same_distance_from_a_jammer(tmp_path):
    """A jammer 15 km away grows by half a decibel a second; twelve hours of a day have different satellites, whose
    distances of loss scatter by 15 %: their mean is known to 4 %. With 45 dB-Hz, a strong satellite in the place of the
    fourth, the distance would be a quarter less."""
    place = {"jammer_latitude": PLACE["latitude"] + 15e3 / EARTH, "jammer_longitude": PLACE["longitude"]}

    def inputs(t):
        return {"jammer_power": [0.05 * 10.0 ** (0.05 * t), 0.0, 0.0, 0.0]}

    seconds, rises = 56, 10.0 ** (0.05 / 2.0)
    receiving = Receiving(tmp_path)
    lost = []
    for hour in range(0, 24, 2):
        valid = receiving.run(seconds, inputs, **place, start_seconds=3600.0 * hour)["fix.valid"] > 0.0
        assert valid[2] and not valid[-1]
        lost.append(int(np.flatnonzero(valid)[-1]))
    run = interpret(Gps, **PLACE, **place)
    valid = []
    for k in range(seconds):
        run.set("jammer_power", inputs(float(k))["jammer_power"])
        run.do_step(float(k), 1.0)
        valid.append(run.get("fix.valid"))
    ours = np.flatnonzero(valid)[-1]
    distances = rises ** (ours - np.array(lost, float))  # of signals over that of positions, at equal power
    assert 0.05 < np.std(distances) < 0.25
    assert abs(np.mean(distances) - 1.0) < 4.0 * 0.04
