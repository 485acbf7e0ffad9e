"""The non-linear two-step estimator of the thesis, (3.69)-(3.80).

Step one is linear in algebraic combinations of centre and gains, step two solves these. (3.80) has the scale factor of
z, as whose it prints that of x. The thesis calls the first step's estimate free of bias; it is not, since the samples
with their noise are its regressors, too: noise of sigma makes the strip of the sphere that it sees thicker than it is.
"""

from __future__ import annotations

import numpy as np

from navfmu.calibration.magnetometer.locus import AXES, Locus, of_unknowns
from navfmu.derivatives.jacobian import jacobian


def first_step(measured: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The state of (3.70), the design H and what is left of z = H x, of samples (n, 3)."""
    x, y, z = measured.T
    design = np.stack([-2.0 * x, y**2, -2.0 * y, z**2, -2.0 * z, np.ones_like(x)], axis=1)
    size = np.linalg.norm(design, axis=0)
    state = np.linalg.lstsq(design / size, -(x**2), rcond=None)[0] / size
    return state, design, -(x**2) - design @ state


def second_step(state: np.ndarray, field: float) -> np.ndarray:
    """Centre and scale factors 1 + s, (3.75)-(3.80), of the first step's state; NaN where it is no ellipsoid."""
    k2, k3 = state[1], state[3]
    centre = np.stack([state[0], state[2] / k2, state[4] / k3])  # (3.75)-(3.77)
    k1 = centre[0] ** 2 + k2 * centre[1] ** 2 + k3 * centre[2] ** 2 - state[5]  # (3.74)
    return np.concatenate([centre, np.sqrt(np.stack([k1, k1 / k2, k1 / k3])) / field])  # (3.78)-(3.80)


def two_step(measured: np.ndarray, field: float) -> Locus | None:
    """Centre and the gains of three axes of fields (n, 3), T, or None where the first step is no ellipsoid."""
    scaled = measured / field
    state, design, left = first_step(scaled)
    with np.errstate(invalid="ignore", divide="ignore"):
        found = second_step(state, 1.0)
    if not np.all(np.isfinite(found)):
        return None
    slopes = jacobian(unknowns, state)
    spread = np.linalg.pinv(design.T @ design, hermitian=True) * float(left @ left) / max(1, len(left) - len(state))
    return of_unknowns(AXES, unknowns(state), slopes @ spread @ slopes.T, measured, field)


def unknowns(state: np.ndarray) -> np.ndarray:
    """Centre and gains 1 / (1 + s)."""
    found = second_step(state, 1.0)
    return np.concatenate([found[:3], 1.0 / found[3:]])
