"""Earth's field at a place, as the FMU ``magnetometer`` has it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.system import shipped
from navfmu.system.system import System

PERFECT = {
    "crustal_level": 0.0,
    "hard_iron_sigma": [0.0] * 3,
    "soft_iron_sigma": 0.0,
    "scale_factor_sigma": [0.0] * 3,
    "misalignment_sigma": [0.0] * 3,
    "noise_sigma": [0.0] * 3,
    "sample_period": 1.0,
    "field_period": 0.5,
}


@dataclass(frozen=True)
class Field:
    """Strength and its horizontal part, T; None where it is not known."""

    strength: float | None = None
    horizontal: float | None = None


def field_at(latitude: float, longitude: float, date: float) -> Field:
    """The field of the World Magnetic Model at sea level, rad and decimal year."""
    values = {**PERFECT, "latitude": latitude, "longitude": longitude, "date": date}
    run = System.load(shipped.path("magnetometer.fmu")).run(
        stop=2.0,
        step=1.0,
        parameters={f"magnetometer.{name}": value for name, value in values.items()},
        record=["magnetometer.field.field_b"],
    )
    north_east_down: Sequence[float] = run.to_numpy()[-1]
    return Field(float(np.linalg.norm(north_east_down)), float(np.linalg.norm(north_east_down[:2])))
