"""Least squares with what is known before: readings against a model, two kinds of them with a sigma each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from navfmu.derivatives import value_and_jacobian
from navfmu.errors import NavfmuError

ROUNDS = 50
SETTLED = 1e-9
FREE = 0.5
"""Degrees of freedom that a sigma needs, at least."""


@dataclass(frozen=True)
class Fit:
    """``values`` (n,) and their ``covariance`` (n, n); of each kind of readings the ``sigma`` of one and the degrees of
    freedom that are ``left`` to tell it; ``residuals`` (m,)."""

    values: np.ndarray
    covariance: np.ndarray
    sigma: np.ndarray
    left: np.ndarray
    residuals: np.ndarray


def information(slopes: np.ndarray, sigma: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """A^T A / sigma^2 + 1 / sizes^2 in units of the sizes: (n, n) of slopes (m, n), with a sigma for each row (m,).

    Its inverse is the covariance, AGARD CP-298, paper 10, (3.4), of parameters over their sizes.
    """
    scaled = slopes * sizes / sigma[:, None]
    return scaled.T @ scaled + np.eye(len(sizes))


def fit(
    residuals: Callable[[np.ndarray], np.ndarray],
    kinds: np.ndarray,
    sizes: np.ndarray,
    start: np.ndarray,
    sigma: np.ndarray | None = None,
) -> Fit:
    """Find the values that make ``residuals`` (m,) small, by Gauss and Newton.

    ``kinds`` (m,) says of which kind a residual is, 0, 1 ...; ``sizes`` (n,) how large values are before, one sigma;
    ``start`` is the sigma of each kind with which to begin. They are estimated from the residuals, (3.5), each with as
    many degrees of freedom as the parameters leave it, unless they are given as ``sigma``. Where they leave less than
    FREE the fit ends: there is nothing to tell a sigma from.
    """
    values, now = np.zeros(len(sizes)), np.array(start if sigma is None else sigma, dtype=float)
    members = [kinds == kind for kind in range(len(now))]
    for _ in range(ROUNDS):
        off, slopes = value_and_jacobian(residuals, values)
        each = now[kinds]
        inverse = np.linalg.inv(information(slopes, each, sizes))
        scaled = slopes * sizes / each[:, None]
        step = -sizes * (inverse @ (scaled.T @ (off / each) + values / sizes))
        used = np.einsum("ij,jk,ik->i", scaled, inverse, scaled)
        left = np.array([np.sum(1.0 - used[one]) for one in members])
        ahead = off + slopes @ step
        if sigma is None and np.any(left < FREE):
            return Fit(values, sizes * inverse * sizes[:, None], now, left, ahead)
        found = np.sqrt([np.sum(ahead[one] ** 2) for one in members] / left)
        if not np.all(np.isfinite(step)):
            break
        values = values + step
        changed = 0.0 if sigma is not None else float(np.max(np.abs(np.log((found + 1e-300) / (now + 1e-300)))))
        if np.max(np.abs(step / sizes)) < SETTLED and changed < 1e-6:
            return Fit(values, sizes * inverse * sizes[:, None], now, left, ahead)
        now = now if sigma is not None else np.maximum(found, 1e-12)
    raise NavfmuError(
        "the errors of the unit do not settle: the readings are not those of a unit at rest whose errors are a few per "
        "cent; expected axes forward, right, down and SI, or --unit"
    )
