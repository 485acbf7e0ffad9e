"""The gain that three accelerometers have in common, at rest in any attitude.

RTO MP-43 (1999), Konovalov and Yurasov: one magnet and one reference let the scale factors of a triad change together,
U_i = K_i0 K a_i, (1); then the size of gravity tells K, whatever the attitude, (2). Known errors are taken out before,
as (3) does to first order for axes that lean. A change of one scale factor cannot be told from one of all three.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from navfmu.calibration.allan.sensor import ACCELEROMETER
from navfmu.calibration.imu.stands import Stands
from navfmu.calibration.imu.terms import SCALE, TERMS, Term, specific_force
from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.reader import read_parameters
from navfmu.ssp.writer import values_document


def gains(stands: Stands, known: dict[Term, np.ndarray]) -> np.ndarray:
    """K of each stand (stands,), (2): the size of the specific force, less known errors, over gravity."""
    return np.linalg.norm(specific_force(known, stands.specific_force), axis=1) / stands.gravity


def known(path: str | Path | None) -> dict[Term, np.ndarray]:
    """The errors of the accelerometers in a parameter set (.ssv), SI; none where there is no set."""
    values = {term: np.zeros(len(term.elements)) for term in TERMS}
    names = {f"{t.name}[{i + 1}]": (t, i) for t in TERMS if ACCELEROMETER in t.sensors for i in range(len(t.elements))}
    found = [] if path is None else [setting for setting in read_parameters(path) if setting.name in names]
    if path is not None and not found:
        raise NavfmuError(f"{path}: has no error of accelerometers; expected a set as navfmu calibrate imu writes it")
    for setting in found:
        term, at = names[setting.name]
        values[term][at] = float(setting.value) * (1.0 if setting.unit is None else setting.unit.factor)
    return values


def document(gain: float, before: dict[Term, np.ndarray], fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU whose accelerometers have this gain more."""
    description = describe(fmu)
    scale = SCALE[ACCELEROMETER]
    if f"{scale.name}[1]" not in description.by_name:
        raise NavfmuError(f"{fmu}: is no model of an inertial unit; expected an FMU with the parameter {scale.name}")
    values = {scale.name: ((1.0 + before[scale]) * gain - 1.0).tolist()}
    return values_document(description, expand(description, values, str(fmu)), text)
