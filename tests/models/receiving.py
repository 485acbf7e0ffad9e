"""A receiver's model and the solver of its position, coupled: each step the receiver measures and the solver solves."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pymap3d

from fmus.satellite.gps_signals import GpsSignals
from fmus.satellite.gps_solver import GpsSolver
from tests.models.native import Native

PLACE = {"latitude": 0.6581, "longitude": -2.1262, "altitude": 1500.0}
QUIET = {
    **dict.fromkeys(("own_sigma", "ionosphere_sigma", "troposphere_sigma", "multipath_scale"), 0.0),
    **{"clock_h0": 0.0, "clock_h2": 0.0, "loop_bandwidth": 1e-3, "spacing": 0.02},
    **{"phase_bandwidth": 0.1, "rate_interval": 10.0},
}
"""No errors but noise of some millimetres and 0.02 mm/s."""


class Receiving:
    def __init__(self, folder: Path, receiver: type = GpsSignals) -> None:
        self.receiver, self.solver = Native(receiver, folder), Native(GpsSolver, folder)

    def run(
        self,
        seconds: int,
        inputs: Callable[[float], dict[str, Any]] = lambda _: {},
        solver: dict[str, Any] | None = None,
        record: Iterable[str] = (),
        every: int = 1,
        **parameters: Any,
    ) -> dict[str, np.ndarray]:
        """Outputs of both after each second, (seconds, ...), at PLACE unless ``inputs`` say otherwise; or ``every`` so
        many seconds, in one step."""
        models = ((self.receiver, parameters), (self.solver, {"tick_period": 1.0, **(solver or {})}))
        for model, values in models:
            model.fmu.reset()
            model.fmu.setupExperiment(startTime=0.0)
            for name, value in values.items():
                model._set(model.fmu, name, value)
            model.fmu.enterInitializationMode()
            model.fmu.exitInitializationMode()
        passed = [name for name in self.receiver.fields if name.startswith("signals.") and name in self.solver.fields]
        shown = ["satellites", "jamming", "clock_bias", "clock_drift", "elevation", *record]
        solved = ["fix.latitude", "fix.longitude", "fix.altitude", "fix.velocity_n", "fix.valid", "excluded", "squares"]
        found: dict[str, list[Any]] = {}
        for k in range(0, seconds, every):
            for name, value in {**PLACE, **inputs(float(k))}.items():
                self.receiver._set(self.receiver.fmu, name, value)
            self.receiver.fmu.doStep(float(k), float(every))
            for name in passed:
                value = self.get(self.receiver, name)
                self.solver._set(self.solver.fmu, name, value)
                found.setdefault(name, []).append(value)
            self.solver.fmu.doStep(float(k), float(every))
            for name in shown:
                found.setdefault(name, []).append(self.get(self.receiver, name))
            for name in solved:
                found.setdefault(name, []).append(self.get(self.solver, name))
            found.setdefault("solved_clock", []).append(self.get(self.solver, "clock_bias"))
            found.setdefault("solved_drift", []).append(self.get(self.solver, "clock_drift"))
        return {name: np.array(values, float) for name, values in found.items()}

    @staticmethod
    def get(model: Native, name: str) -> np.ndarray:
        field = model.fields[name]
        read = {"Real": model.fmu.getReal, "Integer": model.fmu.getInteger, "Boolean": model.fmu.getBoolean}
        values = read[field.type](list(range(field.index, field.index + field.size)))
        return np.array(values, float).reshape(field.shape)


def off(found: dict[str, np.ndarray], place: dict[str, float] = PLACE) -> np.ndarray:
    """Errors of the positions, north, east, down, m, (seconds, 3)."""
    at = [found[f"fix.{name}"] for name in ("latitude", "longitude", "altitude")]
    here = place["latitude"], place["longitude"], place["altitude"]
    return np.stack(pymap3d.geodetic2ned(*at, *here, deg=False), axis=1)
