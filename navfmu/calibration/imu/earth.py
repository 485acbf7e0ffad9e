"""What acts on a unit that stands on the ground: gravity and the rotation of the Earth."""

from __future__ import annotations

import numpy as np

ROTATION = 7.292115e-5
"""WGS-84, rad/s."""


def gravity(latitude: float, altitude: float) -> float:
    """Normal gravity of WGS-84, m/s2, by Somigliana's formula and its change with height (NIMA TR8350.2, (4-1), (4-3)).

    ``latitude`` rad, ``altitude`` m above the ellipsoid.
    """
    square = np.sin(latitude) ** 2
    ground = 9.7803253359 * (1.0 + 0.00193185265241 * square) / np.sqrt(1.0 - 0.00669437999013 * square)
    flattening, ratio, radius = 1.0 / 298.257223563, 0.00344978650684, 6378137.0
    slope = 2.0 / radius * (1.0 + flattening + ratio - 2.0 * flattening * square)
    return float(ground * (1.0 - slope * altitude + 3.0 * altitude**2 / radius**2))


def rotation_n(latitude: float) -> np.ndarray:
    """Rate of the Earth in n (3,), rad/s."""
    return ROTATION * np.array([np.cos(latitude), 0.0, -np.sin(latitude)])


def to_body(roll: np.ndarray, pitch: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """C_bn (rows, 3, 3): vectors in n to those in b, for heading, then pitch, then roll (rows,), rad."""
    (sr, cr), (sp, cp), (sh, ch) = ((np.sin(angle), np.cos(angle)) for angle in (roll, pitch, heading))
    rows = [
        [cp * ch, cp * sh, -sp],
        [sr * sp * ch - cr * sh, sr * sp * sh + cr * ch, sr * cp],
        [cr * sp * ch + sr * sh, cr * sp * sh - sr * ch, cr * cp],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
