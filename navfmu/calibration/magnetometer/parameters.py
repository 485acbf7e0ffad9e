"""A calibration as parameters: of a triad that errs so, of what takes the errors away, of what is left to filters.

    measured = C_sf C_si (B + dB) + noise                                                        (3.28)

The same set makes ``magnetometer`` err as the triad does and ``field_correction`` undo it, since both have it by the
same names. An attitude filter gets the errors that are left, over the strength of the field.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.calibration.magnetometer.locus import Locus
from navfmu.calibration.magnetometer.swinging import Swing
from navfmu.derivatives.jacobian import value_and_jacobian
from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import values_document

ACROSS = ~np.eye(3, dtype=bool)


@dataclass(frozen=True)
class Errors:
    """Of a triad, with standard deviations: ``hard_iron`` (3,) dB, T; ``scale_factor`` (3,) and ``soft_iron`` (3, 3),
    1, whose diagonal is that of the scale factors and stays 0; ``noise``, T; ``field``, T."""

    hard_iron: np.ndarray
    hard_iron_sigma: np.ndarray
    scale_factor: np.ndarray
    scale_factor_sigma: np.ndarray
    soft_iron: np.ndarray
    soft_iron_sigma: np.ndarray
    noise: float
    field: float


def errors(locus: Locus) -> Errors:
    """Those of a locus; one in the plane says nothing of z, whose errors are taken for none."""
    x = np.concatenate([locus.centre, locus.matrix.ravel()])
    axes = len(locus.centre)
    to_matrix = locus.family.gains(axes).reshape(len(locus.covariance) - axes, axes * axes).T
    by_unknowns = np.block(
        [[np.eye(axes), np.zeros((axes, to_matrix.shape[1]))], [np.zeros((axes * axes, axes)), to_matrix]]
    )
    value, slopes = value_and_jacobian(_told, x)
    slopes = slopes @ by_unknowns
    sigma = np.sqrt(np.maximum(np.sum(slopes @ locus.covariance * slopes, axis=1), 0.0))
    told = [(vector[:3], vector[3:6], vector[6:].reshape(3, 3)) for vector in (value, sigma)]
    (iron, scale, soft), (iron_sigma, scale_sigma, soft_sigma) = told
    return Errors(iron, iron_sigma, scale, scale_sigma, soft, soft_sigma, locus.sigma, locus.field)


def _told(x: np.ndarray) -> np.ndarray:
    """dB, scale factors and soft iron (15,) of centre and matrix P in two or three axes."""
    axes = 2 if np.shape(x)[0] == 6 else 3
    gained, iron = np.eye(3), np.zeros(3)
    matrix = np.reshape(x[axes:], (axes, axes))
    inverse = np.linalg.inv(matrix)
    if axes == 2:
        top = np.concatenate([inverse, np.zeros((2, 1))], axis=1)
        gained = np.concatenate([top, np.array([[0.0, 0.0, 1.0]])], axis=0)
        iron = np.concatenate([matrix @ x[:2], np.zeros(1)])
    else:
        gained, iron = inverse, matrix @ x[:3]
    gain = np.stack([gained[0, 0], gained[1, 1], gained[2, 2]])
    soft = gained / np.reshape(gain, (3, 1)) - np.eye(3)
    return np.concatenate([iron, gain - 1.0, np.reshape(soft, (9,))])


def of_swing(found: Swing, horizontal: float) -> Errors:
    """Those that coefficients of the heading tell in a ``horizontal`` field, T: of x and y, the mean gain being 1."""
    iron, soft = np.zeros(3), np.zeros((3, 3))
    iron[:2], soft[:2, :2] = found.hard_iron(horizontal), found.soft_iron
    sigma = np.sqrt(np.diag(found.covariance))
    a, b, c, d, e = sigma
    across = np.zeros((3, 3))
    across[0, 1] = across[1, 0] = np.hypot(a, e)
    scale, soft = np.diag(soft).copy(), np.where(ACROSS, soft, 0.0)
    noise = horizontal * float(np.std(found.left))
    return Errors(
        iron, horizontal * np.array([b, c, 0.0]), scale, np.array([d, d, 0.0]), soft, across, noise, horizontal
    )


def document(found: Errors, fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU: those of its parameters that a calibration tells."""
    description = describe(fmu)
    left = max(float(np.max(found.hard_iron_sigma)) / found.field, 1e-6)
    of_triad = {
        "hard_iron": found.hard_iron,
        "hard_iron_sigma": found.hard_iron_sigma,
        "scale_factor": found.scale_factor,
        "scale_factor_sigma": found.scale_factor_sigma,
        "soft_iron": found.soft_iron,
        "soft_iron_sigma": float(np.sqrt(np.mean(found.soft_iron_sigma[ACROSS] ** 2))),
        "noise_sigma": np.full(3, found.noise),
    }
    of_filter = {"field_sigma": max(found.noise / found.field, 1e-6), "hard_iron_sigma": left}
    has = {variable.name.partition("[")[0] for variable in description.with_causality("parameter")}
    values = of_triad if "hard_iron" in has else of_filter
    there = {name: value for name, value in values.items() if name in has}
    if values is of_filter and len(there) < len(of_filter):
        raise NavfmuError(
            f"{fmu}: has none of the parameters {', '.join(of_triad)}, nor {', '.join(of_filter)}; expected a triad, a "
            "correction of its field, or an attitude filter"
        )
    plain = {name: np.asarray(value).tolist() for name, value in there.items()}
    return values_document(description, expand(description, plain, str(fmu)), text)
