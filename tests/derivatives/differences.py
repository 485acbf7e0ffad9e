"""Truth about derivatives that knows no rules: differences of function values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

EPSILON = np.finfo(float).eps


def _central(function: Callable, x: np.ndarray, step: float) -> np.ndarray:
    columns = []
    for i in range(x.size):
        shift = np.zeros(x.size)
        shift[i] = step
        shift = shift.reshape(x.shape)
        columns.append((np.asarray(function(x + shift), float) - np.asarray(function(x - shift), float)) / (2.0 * step))
    return np.stack(columns, -1).reshape(*np.shape(columns[0]), *x.shape)


def extrapolated(function: Callable, x: np.ndarray, step: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Central differences at two steps, extrapolated to the step 0 (Richardson), and a bound of their error.

    What is left is far below the change from one step to the other; rounding of the function's values, a few units in
    the last place of the largest, comes in over the step.
    """
    x = np.asarray(x, float)
    coarse, fine = _central(function, x, step), _central(function, x, 0.5 * step)
    rounding = 20.0 * EPSILON * (1.0 + np.max(np.abs(function(x)), initial=0.0)) / step
    return (4.0 * fine - coarse) / 3.0, np.abs(coarse - fine) + rounding


def complex_step(function: Callable, x: np.ndarray) -> np.ndarray:
    """Derivatives of an analytic function to the last places: Im f(x + ih) / h, without any difference (Squire and
    Trapp, SIAM Review 40, 1998, p. 110)."""
    x = np.asarray(x, float)
    columns = []
    for i in range(x.size):
        shifted = x.astype(complex).ravel()
        shifted[i] += 1e-100j
        columns.append(np.imag(function(shifted.reshape(x.shape))) / 1e-100)
    return np.stack(columns, -1).reshape(*np.shape(columns[0]), *x.shape)
