"""Samples that were not measured: a few that lie far from the surface of all others."""

from __future__ import annotations

import numpy as np

from navfmu.calibration.magnetometer.locus import FAMILIES, distances, fit

FAR = 10.0
"""Sigma off the surface: six are the most in recorded flights."""
NORMAL = 1.4826
"""Sigma of normal numbers over the median of their sizes."""
LEAST = 1e-3
"""Of the field: what is nearer is not wild, however little the others scatter."""
MOST = 0.05
"""Share of the samples: of more there is another reason, and they stay."""
ROUNDS = 5


def tame(measured: np.ndarray, field: float) -> np.ndarray:
    """Which of these fields (samples, 3) are not wild, (samples,), where Earth's is ``field``, T."""
    every = taken = np.ones(len(measured), dtype=bool)
    for _ in range(ROUNDS):
        found = next((one for one in (fit(family, measured[taken], field) for family in FAMILIES) if one), None)
        if found is None:
            return every
        x = np.concatenate([found.centre / field, found.family.unknowns(found.matrix)])
        off = np.abs(distances(x, found.family, measured / field, 0.0))
        near = off <= max(FAR * NORMAL * float(np.median(off)), LEAST)
        if np.array_equal(near, taken):
            return taken
        if np.mean(near) < 1.0 - MOST:
            return every
        taken = near
    return taken
