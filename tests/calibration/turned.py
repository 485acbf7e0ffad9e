"""Fields that a triad with known errors measures while it is turned."""

from __future__ import annotations

import numpy as np

FIELD = 5e-5
CENTRE = np.array([2e-5, -1e-5, 3e-5])
GAINED = np.array([[1.05, 0.03, -0.02], [0.03, 0.95, 0.01], [-0.02, 0.01, 1.1]])
"""What the triad makes of a field, without its hard iron: P^-1."""


def directions(rng: np.random.Generator, strip: float, count: int) -> np.ndarray:
    """Directions (count, 3) in a strip of that central angle, rad, around the axis z; the sphere has pi."""
    z, turn = np.sin(rng.uniform(-0.5 * strip, 0.5 * strip, count)), rng.uniform(0.0, 2.0 * np.pi, count)
    return np.stack([np.sqrt(1.0 - z * z) * np.cos(turn), np.sqrt(1.0 - z * z) * np.sin(turn), z], axis=1)


def measured(rng, strip: float, count: int, noise: float, gained=GAINED, centre=CENTRE) -> np.ndarray:
    """Fields (count, 3), T, with white noise of that standard deviation, T."""
    return centre + FIELD * directions(rng, strip, count) @ gained.T + noise * rng.standard_normal((count, 3))
