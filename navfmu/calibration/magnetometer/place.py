"""Earth's field at a place, as the shipped FMU that measures it has it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.system import shipped
from navfmu.system.system import System

FIELD = "field.field_b"
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
    triad = _triad()
    values = {**PERFECT, "latitude": latitude, "longitude": longitude, "date": date}
    run = System.load(triad).run(
        stop=2.0,
        step=1.0,
        parameters={f"{triad.stem}.{name}": value for name, value in values.items()},
        record=[f"{triad.stem}.{FIELD}"],
    )
    north_east_down: Sequence[float] = run.to_numpy()[-1]
    return Field(float(np.linalg.norm(north_east_down)), float(np.linalg.norm(north_east_down[:2])))


def _triad() -> Path:
    """The shipped FMU of a triad: it puts out a field, and has place, date and the errors that are switched off."""
    wanted = {f"{FIELD}[1]", "latitude", "longitude", "date"}
    for file in map(shipped.path, shipped.names(".fmu")):
        known = describe(file).by_name
        if wanted <= known.keys() and all(name in known or f"{name}[1]" in known for name in PERFECT):
            return file
    raise NavfmuError(
        "--place: no FMU of a magnetometer is shipped, which has the model of the field; expected one with the others "
        "(python build_fmus.py), or the strength by --field"
    )
