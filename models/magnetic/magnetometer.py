"""Magnetometer triad, thesis (3.28), p. 58: what a strapdown magnetometer makes of Earth's field.

    B_measured = C_m C_sf C_si (B^b + dB^b) + noise

dB^b is the hard iron (permanent magnets aboard), C_si the soft iron (field induced in iron, proportional to the field),
C_sf the scale factors of the three axes, C_m the misalignment of the triad. The thesis writes the result turned to n;
it is kept in b here, where the instrument lives.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude

MILLIGAUSS = 1.0e-7
"""1 mG in T."""


def triad(scale_factor, misalignment):
    """C_m C_sf, what the triad makes of the field where it is; see :func:`distortion`."""
    return attitude.mounting(misalignment) * (1.0 + scale_factor)


def distortion(soft_iron, scale_factor, misalignment):
    """C_m C_sf C_si.

    Parameters
    ----------
    soft_iron
        3 x 3 matrix alpha, C_si = I + alpha.
    scale_factor
        Errors of the three axes, C_sf = I + diag(scale_factor).
    misalignment
        Small rotation of the triad against b about the three axes, rad; C_m = I - [misalignment x], thesis (3.29).
    """
    gained = (np.eye(3) + soft_iron) * (1.0 + np.reshape(scale_factor, (3, 1)))
    return attitude.mounting(misalignment) @ gained


def sense(field_b, hard_iron, distortion, noise):
    """Measured field, T, thesis (3.28)."""
    return distortion @ (field_b + hard_iron) + noise


def corrected(measured, hard_iron, inverse):
    """Field, T, of a measured one: (3.28) solved for it, with the inverse of C_m C_sf C_si, noise being 0."""
    return inverse @ measured - hard_iron


def digitise(field, limit, resolution):
    """What comes out of a converter: no axis beyond its limit, whole multiples of its resolution (0: as it is)."""
    field = np.clip(field, -limit, limit)
    step = np.where(resolution > 0.0, resolution, 1.0)
    return np.where(resolution > 0.0, step * np.rint(field / step), field)
