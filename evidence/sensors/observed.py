"""A recorded day of observations of satellites as inputs of ``gps_solver``, whole or with something left out.

The environment variable NAVFMU_DATA names a folder with ``gnss/``: observations and broadcast ephemerides of the
station ESBC00DNK in RINEX 3, and the results of an independent solution. They are not part of the project.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fmus.satellite.gps_solver import GpsSolver
from fmus.satellite.signals import PLACES
from models.earth import earth
from models.satellite import orbit, satellite_clock, selection, sight
from navfmu.constants import WAVELENGTH
from navfmu.export.interpreter import Interpreter
from navfmu.satellite.file import read_orbits
from navfmu.satellite.observations import read_observations

FILES = ("esbc1770.rnx.gz", "esbc1770_nav.rnx.gz")
TRUTH = np.array([3582104.917, 532590.184, 5232755.308])
"""Antenna in ITRF2014 at 2020.48, m: static precise point positioning over the day, good to 0.1 m."""
LEAP = 18.0
"""Seconds by which UTC was behind."""
KLOBUCHAR_OFF, TROPOSPHERE_OFF = 2, 3
OUTPUTS = (
    "fix.latitude", "fix.longitude", "fix.altitude", "fix.velocity_n", "fix.valid", "satellites", "hdop", "vdop",
    "squares", "threshold", "detected", "alarm", "used", "excluded", "horizontal_protection", "vertical_protection",
    "horizontal_protection_slope", "vertical_protection_slope", "residual", "elevation",
)  # fmt: skip

Signals = dict[str, Any]
Change = Callable[[int, Signals], None]


@dataclass(frozen=True)
class Station:
    """What was observed, with what the satellites said of themselves."""

    folder: Path

    @cached_property
    def orbits(self):
        return read_orbits(self.folder / FILES[1])

    @cached_property
    def observations(self):
        return read_observations(self.folder / FILES[0])

    def rows(self, seconds: Sequence[float]) -> np.ndarray:
        """Which epochs have these seconds of the week."""
        return np.searchsorted(self.observations.second, np.asarray(seconds, float) - 1e-3)

    def signals(self, row: int, left_out: str = "") -> Signals:
        """The inputs of the solver at an epoch, without "TGD", "relativity", or with another mistake of ABLATIONS."""
        o = self.observations
        code = o.named("C1C")[row]
        prn = np.flatnonzero(np.isfinite(code)) + 1
        week, second = o.week[row], o.second[row] + (LEAP if left_out == "leap seconds" else 0.0)
        orbits = selection.around(selection.finder(self.orbits.rows), prn, week, second)
        chosen = selection.nearest(orbits, prn, week, second)
        usable = selection.usable(chosen, prn, week, second)
        sent = satellite_clock.sending_time(chosen, week, second, code[prn - 1])
        if left_out == "travel":
            sent = np.full_like(sent, second)
        anomaly = orbit.anomaly(chosen, week, sent)
        position, velocity = orbit.state_at(chosen, anomaly, week, sent)
        clock, rate = satellite_clock.error_at(chosen, anomaly, week, sent)
        if left_out == "relativity":
            clock = clock - satellite_clock.relativity(chosen, anomaly)[0]
        if left_out != "TGD":
            clock = satellite_clock.on_l1(chosen, clock)
        if left_out == "Sagnac":  # what the solver will turn forward is turned back
            position = sight.turned(position, -sight.travel_time(TRUTH, position))
        values = {
            "number": prn,
            "pseudorange": code[prn - 1],
            "range_rate": -WAVELENGTH * o.named("D1C")[row, prn - 1],
            "signal_to_noise": o.named("S1C")[row, prn - 1],
            "satellite_e": position,
            "satellite_velocity_e": velocity,
            "satellite_clock": clock,
            "satellite_clock_rate": rate,
            "accuracy": chosen.accuracy,
            "tracked": usable & np.isfinite(o.named("D1C")[row, prn - 1]),
        }
        found = {"signals.week": week, "signals.seconds": o.second[row], "signals.valid": True}
        for name, value in values.items():
            found[f"signals.{name}"] = np.zeros((PLACES, *np.shape(value)[1:]))
            found[f"signals.{name}"][: len(prn)] = value
        return found

    def solve(
        self, rows: Sequence[int], left_out: str = "", change: Change | None = None, **parameters: Any
    ) -> dict[str, np.ndarray]:
        """Outputs of the solver at epochs, one after the other; ``change`` may spoil what it is given at each."""
        alpha, beta = self.orbits.ionosphere
        run = Interpreter(GpsSolver)
        given = {"tick_period": 1.0, "ionosphere_alpha": alpha, "ionosphere_beta": beta} | parameters
        for name, value in given.items():
            run.set(name, value)
        run.setup()
        found: dict[str, list] = {name: [] for name in OUTPUTS}
        for k, row in enumerate(rows):
            signals = self.signals(int(row), left_out)
            if change is not None:
                change(k, signals)
            for name, value in signals.items():
                run.set(name, value)
            run.set("signals.sequence", k + 1)
            run.do_step(float(k), 1.0)
            for name, values in found.items():
                values.append(np.array(run.get(name)))
        return {name: np.array(values) for name, values in found.items()}


def errors(found: Mapping[str, np.ndarray]) -> np.ndarray:
    """Position errors east, north, up, m, (epochs, 3)."""
    latitude, longitude, _ = earth.from_ecef(TRUTH)
    places = zip(found["fix.latitude"], found["fix.longitude"], found["fix.altitude"], strict=True)
    off = np.array([earth.to_ecef(*place) for place in places]) - TRUTH
    north, east, down = earth.north_east_down(latitude, longitude) @ off.T
    return np.stack([east, north, -down], axis=1)


def velocities(found: Mapping[str, np.ndarray]) -> np.ndarray:
    """Velocities of the station, which stands still: east, north, up, m/s, (epochs, 3)."""
    return found["fix.velocity_n"][:, [1, 0, 2]] * np.array([1.0, 1.0, -1.0])


def rms(values: np.ndarray) -> np.ndarray:
    """Root of the mean of squares of each column."""
    return np.sqrt(np.mean(values**2, axis=0))
