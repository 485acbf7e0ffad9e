"""The runs shown in the documentation: what their inputs do."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fmus.examples import ahrs_inputs
from models.magnetic import magnetometer

IRON = (8.0e-6, -5.0e-6, 3.0e-6)
SCALE = (0.05, -0.04, 0.02)


def correction_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """The field of a full circle at 3 deg/s, as a triad with hard iron and scale factors has it."""
    distortion = magnetometer.distortion(np.zeros((3, 3)), np.array(SCALE), np.zeros(3))
    field = ahrs_inputs(time)["field.field_b"]
    return {"field.field_b": magnetometer.sense(field.T, np.array(IRON)[:, None], distortion, 0.0).T}


def correction_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Strength of the field as measured and without the errors."""
    fields = {
        "measured": correction_inputs(outputs["time"])["field.field_b"],
        "corrected": np.where(outputs["corrected.valid"][:, None] > 0.0, outputs["corrected.field_b"], np.nan),
    }
    strength = {name: np.linalg.norm(field, axis=1) / magnetometer.MILLIGAUSS for name, field in fields.items()}
    return {"strength of the field (mG)": strength}
