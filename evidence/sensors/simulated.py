"""The day of a station as a receiver's model measures it: with the orbits that were broadcast, its place and times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from evidence.sensors.observed import TRUTH, Signals, Station
from fmus.satellite.gps_signals import GpsSignals
from models.earth import earth
from models.satellite import antenna
from models.satellite.ephemeris import COLUMNS
from navfmu.export import Grid, Table
from navfmu.export.interpreter import Interpreter

GEODETIC = {
    "signal_margin": 3.0,
    "loop_bandwidth": 0.25,
    "phase_bandwidth": 15.0,
    "rate_interval": 0.1,
    "spacing": 0.1,
    "own_sigma": 0.8,
    "multipath_scale": 0.5,
    "multipath_time": 120.0,
    "ionosphere_sigma": 0.2,
    "clock_h0": 0.0,
    "clock_h2": 0.0,
    "clock_drift_start": 0.0,
}
"""A receiver for geodesy, half of the reflections on an aircraft, a clock that is steered. Bandwidths, signal and own
error are chosen so that the day looks like the recorded one; no seed is."""
GAIN = -9.0, 7.0
"""Of an antenna with choke rings towards the horizon and the zenith, dBi."""


@dataclass(frozen=True)
class Simulated(Station):
    """What ``gps_signals`` measures in place of what was observed."""

    seed: int = 1

    @cached_property
    def measured(self) -> list[Signals]:
        """At each epoch."""
        o = self.observations

        class Here(GpsSignals):
            name = "gps_signals"
            orbits = Table(columns=COLUMNS, rows=self.orbits.rows, key="place")
            antenna = Grid(
                axes=(("azimuth", "rad", antenna.AZIMUTHS), ("elevation", "rad", antenna.ELEVATIONS)),
                surfaces=(("gain", "1", np.tile(GAIN[0] + (GAIN[1] - GAIN[0]) * np.sin(antenna.ELEVATIONS), (2, 1))),),
            )

        alpha, beta = self.orbits.ionosphere
        step = float(o.second[1] - o.second[0])
        latitude, longitude, altitude = earth.from_ecef(TRUTH)
        run = Interpreter(Here)
        given: dict[str, Any] = {
            **GEODETIC,
            "seed": self.seed,
            "ionosphere_alpha": alpha,
            "ionosphere_beta": beta,
            "start_week": int(o.week[0]) if o.second[0] >= step else int(o.week[0]) - 1,
            "start_seconds": float(o.second[0]) - step,
            "measurement_period": step,
            "search_period": step,
        }
        for name, value in given.items():
            run.set(name, value)
        run.setup()
        for name, value in {"latitude": latitude, "longitude": longitude, "altitude": altitude}.items():
            run.set(name, float(value))
        names = [name for name in self.names if name.startswith("signals.")]
        found = []
        for k in range(len(o)):
            run.do_step(k * step, step)
            found.append({name: np.array(run.get(name)) for name in names})
        return found

    @property
    def names(self) -> list[str]:
        bundle = GpsSignals.layout.bundles["signals"]
        return [f"signals.{name}" for name in (*bundle.members, "valid")]

    def signals(self, row: int, left_out: str = "") -> Signals:
        return dict(self.measured[row])
