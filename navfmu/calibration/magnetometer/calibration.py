"""A calibration: what was found, how sure, what there is to say, and its picture, whatever the method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from navfmu.calibration.magnetometer import parameters
from navfmu.calibration.magnetometer.choice import METHODS, Chosen, choose
from navfmu.calibration.magnetometer.parameters import Errors
from navfmu.calibration.magnetometer.picture import draw, draw_swing
from navfmu.calibration.magnetometer.place import Field
from navfmu.calibration.magnetometer.recording import Recording, check_strength
from navfmu.calibration.magnetometer.swinging import LETTERS, swing
from navfmu.calibration.magnetometer.wild import FAR
from navfmu.errors import NavfmuError

SWINGING = "swinging"


@dataclass(frozen=True)
class Row:
    """A ``value`` and its standard deviation ``sigma``, both in ``unit``."""

    name: str
    value: float
    sigma: float
    unit: str


@dataclass(frozen=True)
class Calibration:
    """``errors`` of the triad by a ``method``, as ``rows`` of a table, and ``picture()``, PNG."""

    source: str
    method: str
    errors: Errors
    rows: Sequence[Row]
    sentences: Sequence[str]
    picture: Callable[[], bytes]


def calibrate(taken: Recording, earth: Field, method: str) -> Calibration:
    """What a recording tells in Earth's field; what it does not allow is a sentence."""
    check_strength(taken, earth.strength)
    return _swung(taken, earth) if method == SWINGING else _turned(taken, earth, method)


def _turned(taken: Recording, earth: Field, method: str) -> Calibration:
    chosen = choose(taken.measured, earth.strength, earth.horizontal, method, taken.source)
    found = parameters.errors(chosen.locus)
    sentences = (*taken.sentences, *(f"not {text}" for text in chosen.refused), *_said(chosen))
    picture = partial(draw, chosen, taken.measured, taken.source)
    return Calibration(taken.source, chosen.method, found, _of_errors(found), sentences, picture)


def _swung(taken: Recording, earth: Field) -> Calibration:
    if taken.heading is None:
        raise NavfmuError(f"{taken.source}: has no column 'heading'; expected the known headings for {SWINGING}")
    found = swing(taken.measured, taken.heading, taken.source)
    horizontal = earth.horizontal or float(np.mean(np.linalg.norm(taken.measured[:, :2], axis=1)))
    values, sigmas = np.degrees(found.coefficients), np.degrees(np.sqrt(np.diag(found.covariance)))
    rows = [Row(*row, "deg") for row in zip(LETTERS, values.tolist(), sigmas.tolist(), strict=True)]
    left = np.degrees(float(np.std(found.left)))
    sentences = (*taken.sentences, f"headings are left with {left:.2g} deg rms; A has the mounting and a declination")
    picture = partial(draw_swing, found, taken.measured, taken.heading, taken.source)
    return Calibration(taken.source, SWINGING, parameters.of_swing(found, horizontal), rows, sentences, picture)


def _said(chosen: Chosen) -> list[str]:
    locus = chosen.locus
    span = "in a level turn" if chosen.angle is None else f"in a strip of {np.degrees(chosen.angle):.0f} degrees"
    found = [
        METHODS[chosen.method].text,
        f"{1e6 * locus.sigma:.3g} uT of {1e6 * locus.field:.4g} are left, rms; a corrected field has errors of "
        f"{100.0 * chosen.error:.2g} % at most, one standard deviation, {span}, where the triad was turned",
    ]
    if chosen.wild:
        found.append(f"{chosen.wild} samples are left out: they are {FAR:g} sigma off the surface of the others")
    if chosen.untold > 1e-6:
        found.append(
            f"gains and soft iron that the method leaves out add {100.0 * chosen.untold:.2g} % for each percent of them"
        )
    if locus.correlation > 2.0:
        found.append(f"what is left goes together: {locus.correlation:.0f} samples are as good as one")
    return found


def _of_errors(found: Errors) -> list[Row]:
    """Hard iron in uT, the rest in percent; what was not looked for is left out."""
    names = [f"hard iron {axis}" for axis in "xyz"] + [f"scale factor {axis}" for axis in "xyz"]
    names += [f"soft iron {i}{j}" for i in "xyz" for j in "xyz"]
    factors = [1e6] * 3 + [100.0] * 12
    values = np.concatenate([found.hard_iron, found.scale_factor, found.soft_iron.ravel()])
    sigmas = np.concatenate([found.hard_iron_sigma, found.scale_factor_sigma, found.soft_iron_sigma.ravel()])
    rows = zip(names, (values * factors).tolist(), (sigmas * factors).tolist(), factors, strict=True)
    return [Row(name, value, sigma, "uT" if by > 1e3 else "%") for name, value, sigma, by in rows if sigma > 0.0]
