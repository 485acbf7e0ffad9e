"""How much of the sphere a triad has been turned through."""

from __future__ import annotations

import numpy as np

AXES = 300
"""Axes that are tried at a time."""
NEAR = (1.0, 0.15, 0.03)
"""How far, rad, they lie from the best one so far: first all around."""
FEW = 2000
"""Samples that are looked at, about."""
LEFT_OUT = 0.5
"""Percent of the samples at either end of a strip that do not count: a wild sample widens none."""


def sphere(count: int) -> np.ndarray:
    """Directions (count, 3) that are spread evenly over the sphere, on a spiral of the golden angle."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    return np.stack([np.sqrt(1.0 - z**2) * np.cos(turn), np.sqrt(1.0 - z**2) * np.sin(turn), z], axis=1)


def strip(directions: np.ndarray) -> float:
    """Width, rad, of the narrowest strip around any axis in which all ``directions`` (samples, 3) lie.

    It is the central angle Phi of thesis Fig 3.19: fields of a triad that was turned about one axis alone have none.
    """
    some = directions[:: 1 + len(directions) // FEW]
    found, narrowest = np.zeros(3), np.inf
    for around in NEAR:
        tried = found + around * sphere(AXES)
        latitude = np.arcsin(np.clip(some @ (tried.T / np.linalg.norm(tried, axis=1)), -1.0, 1.0))
        low, high = np.percentile(latitude, [LEFT_OUT, 100.0 - LEFT_OUT], axis=0)
        best = int(np.argmin(high - low))
        if high[best] - low[best] < narrowest:
            found, narrowest = tried[best] / np.linalg.norm(tried[best]), float(high[best] - low[best])
    return narrowest
