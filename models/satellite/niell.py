"""Niell's mapping functions (J. Geophys. Res. 101 B2, 1996): delay at an elevation over that at the zenith."""

from __future__ import annotations

import numpy as np

DEGREES = (15.0, 30.0, 45.0, 60.0, 75.0)
"""Latitudes of the tables; what lies outside has the first or last one."""
AVERAGE = (
    (1.2769934e-3, 1.2683230e-3, 1.2465397e-3, 1.2196049e-3, 1.2045996e-3),
    (2.9153695e-3, 2.9152299e-3, 2.9288445e-3, 2.9022565e-3, 2.9024912e-3),
    (62.610505e-3, 62.837393e-3, 63.721774e-3, 63.824265e-3, 64.258455e-3),
)
"""Table 3, hydrostatic: a, b, c."""
AMPLITUDE = (
    (0.0, 1.2709626e-5, 2.6523662e-5, 3.4000452e-5, 4.1202191e-5),
    (0.0, 2.1414979e-5, 3.0160779e-5, 7.2562722e-5, 11.723375e-5),
    (0.0, 9.0128400e-5, 4.3497037e-5, 84.795348e-5, 170.37206e-5),
)
"""Table 3, over the year."""
WET = (
    (5.8021897e-4, 5.6794847e-4, 5.8118019e-4, 5.9727542e-4, 6.1641693e-4),
    (1.4275268e-3, 1.5138625e-3, 1.4572752e-3, 1.5007428e-3, 1.7599082e-3),
    (4.3472961e-2, 4.6729510e-2, 4.3908931e-2, 4.4626982e-2, 5.4736038e-2),
)
"""Table 4."""
HEIGHT = (2.53e-5, 5.49e-3, 1.14e-3)
"""Correction of the hydrostatic one for height, per km."""


def fraction(sine, a, b, c):
    """Marini's continued fraction, 1 at the zenith: equation (4)."""
    return (1.0 + a / (1.0 + b / (1.0 + c))) / (sine + a / (sine + b / (sine + c)))


def mapping(day, latitude, altitude, sine):
    """Hydrostatic and wet mapping function.

    ``day`` of the year; ``latitude`` rad; ``altitude`` m above the sea, for which the height above the ellipsoid does;
    ``sine`` of the elevation.
    """
    degrees = np.abs(np.degrees(latitude))
    year = np.cos(2.0 * np.pi * ((day - 28.0) / 365.25 + np.where(latitude < 0.0, 0.5, 0.0)))
    hydrostatic = [
        np.interp(degrees, DEGREES, mean) - year * np.interp(degrees, DEGREES, size)
        for mean, size in zip(AVERAGE, AMPLITUDE, strict=True)
    ]
    wet = [np.interp(degrees, DEGREES, column) for column in WET]
    higher = (1.0 / sine - fraction(sine, *HEIGHT)) * altitude * 1e-3
    return fraction(sine, *hydrostatic) + higher, fraction(sine, *wet)
