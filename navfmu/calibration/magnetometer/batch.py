"""The linearised batch estimator (LBLS) of the thesis, (3.66)-(3.68)."""

from __future__ import annotations

import numpy as np

from navfmu.calibration.magnetometer.locus import AXES, Locus, of_unknowns

STEPS = 100
SMALL = 1e-9
"""Change of the parameters, in field strengths, at which it has converged."""
FAR = 1e6
"""Field strengths, or scale factors, beyond which it has diverged."""


def length(x: np.ndarray, scaled: np.ndarray) -> np.ndarray:
    """R of (3.65) for centre and scale factors x = (b, 1 + s), of samples (n, 3) over the field strength."""
    return np.sqrt(np.sum(((scaled - x[:3]) / x[3:]) ** 2, axis=1))


def slopes(x: np.ndarray, scaled: np.ndarray) -> np.ndarray:
    """Derivatives (n, 6) of R, (3.66) over 2 R."""
    from_centre = scaled - x[:3]
    by_centre, by_scale = -from_centre / x[3:] ** 2, -(from_centre**2) / x[3:] ** 3
    return np.hstack([by_centre, by_scale]) / length(x, scaled)[:, None]


def iterate(scaled: np.ndarray, start: np.ndarray) -> np.ndarray | None:
    """The end of the iteration from ``start``, both (b, 1 + s), or None where it diverged."""
    x = start
    for _ in range(STEPS):
        with np.errstate(all="ignore"):
            rows, left = slopes(x, scaled), 1.0 - length(x, scaled)
        if not (np.all(np.isfinite(rows)) and np.all(np.abs(x) < FAR)):
            return None
        step = np.linalg.lstsq(rows, left, rcond=None)[0]
        x = x + step
        if np.max(np.abs(step)) < SMALL:
            return x
    return None


def batch(measured: np.ndarray, field: float) -> Locus | None:
    """Centre and the gains of three axes of fields (n, 3), T, or None where the iteration diverges.

    It starts at what hard iron alone makes, the mean of the samples, and scale factors of 1.
    """
    scaled = measured / field
    found = iterate(scaled, np.concatenate([np.mean(scaled, axis=0), np.ones(3)]))
    if found is None or np.any(found[3:] == 0.0):
        return None
    left, rows = 1.0 - length(found, scaled), slopes(found, scaled)
    spread = float(left @ left) / max(1, len(left) - 6) * np.linalg.pinv(rows.T @ rows, hermitian=True)
    scale = np.concatenate([np.ones(3), -1.0 / found[3:] ** 2])
    x = np.concatenate([found[:3], 1.0 / np.abs(found[3:])])
    return of_unknowns(AXES, x, spread * np.outer(scale, scale), measured, field)
