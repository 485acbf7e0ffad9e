"""The surface on the other side of the fields.

Turns that stay near a plane lie next to two surfaces, whose centres are mirror images: a level turn says how strong the
field across is, and not whether it points up or down. The errors of a fit, which are those around its own centre, do
not know of the other one.
"""

from __future__ import annotations

import numpy as np

from navfmu.calibration.magnetometer.locus import Locus, from_start

CERTAIN = 4.0
"""Standard deviations by which one surface must be nearer than the other."""


def twin(locus: Locus, measured: np.ndarray) -> Locus | None:
    """The surface of the same family from the mirror image of the centre, or None where there is none."""
    corrected = locus.corrected(measured)
    middle = np.mean(corrected, axis=0)
    across = np.linalg.eigh(np.cov(corrected.T))[1][:, 0]
    mirrored = locus.centre + np.linalg.solve(locus.matrix, 2.0 * (middle @ across) * across)
    return from_start(locus, mirrored, measured)


def as_good(locus: Locus, measured: np.ndarray) -> tuple[Locus, float] | None:
    """The twin, and how far corrected fields are apart by both, over their strength, if it may lie as near the fields.

    Noise of a sample is another distance to each of the two, so their squares differ at random (Vuong, 1989).
    """
    other = twin(locus, measured)
    if other is None:
        return None
    worse = other.distance**2 - locus.distance**2
    if np.sum(worse) > CERTAIN * np.sqrt(len(worse) * locus.correlation) * np.std(worse):
        return None
    apart = np.linalg.norm(locus.corrected(measured) - other.corrected(measured), axis=1)
    return other, float(np.max(apart)) / locus.field
