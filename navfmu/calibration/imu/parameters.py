"""The errors that are told, as the parameters of an FMU that models an inertial unit; and their covariance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from navfmu.calibration.imu.determination import Determination, Element
from navfmu.calibration.imu.terms import SENSITIVITY, TERMS
from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import values_document


def parameters(found: Determination) -> dict[str, float]:
    """Parameters by name, SI: of each element that is told the given part is its value, and what is drawn at turn-on
    has its sigma. The nine of the sensitivity to specific force have one sigma in common, their root mean square.
    """
    values: dict[str, float] = {}
    sensitive: list[float] = []
    for element in found.elements:
        if element.told and element.term.modelled:
            at = _place(element)
            values[f"{element.term.name}{at}"] = element.value
            if element.term is SENSITIVITY:
                sensitive.append(element.sigma)
            else:
                values[f"{element.term.name}_sigma{at}"] = element.sigma
    if sensitive:
        values[f"{SENSITIVITY.name}_sigma"] = float(np.sqrt(np.mean(np.square(sensitive))))
    return values


def _place(element: Element) -> str:
    number = element.term.elements.index(element.axis)
    if len(element.term.elements) == 3:
        return f"[{number + 1}]"
    return f"[{number // 3 + 1},{number % 3 + 1}]"


def document(found: Determination, fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU."""
    description = describe(fmu)
    wanted = [f"{term.name}[{1 if term is not SENSITIVITY else '1,1'}]" for term in TERMS if term.modelled]
    if any(name not in description.by_name for name in wanted):
        raise NavfmuError(
            f"{fmu}: is no model of an inertial unit; expected an FMU with the parameters {', '.join(wanted)}"
        )
    return values_document(description, expand(description, parameters(found), str(fmu)), text)


def covariance(found: Determination) -> pd.DataFrame:
    """Value, and covariance with each other, of all elements, SI: a row each."""
    names = [element.name.replace(" ", "_") for element in found.elements]
    table = pd.DataFrame(found.fit.covariance, index=pd.Index(names, name="error"), columns=names)
    table.insert(0, "value", found.fit.values)
    table.insert(1, "told", [element.told for element in found.elements])
    return table
