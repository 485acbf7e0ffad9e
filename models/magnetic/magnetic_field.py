"""Earth's magnetic field by spherical harmonics: the World Magnetic Model of the date at a geodetic position.

    V = a sum_n (a/r)^(n+1) sum_m (g_nm cos(m lambda) + h_nm sin(m lambda)) P_nm(cos theta),   B = -grad V

with Schmidt semi-normalised P_nm, geocentric colatitude theta and radius r, a = 6371.2 km, and g, h linear in the date
(NOAA, *The US/UK World Magnetic Model for 2025-2030*, technical report, section 1.2). The recursions run over P_nm/sin
theta for m > 0, so the poles are not singular. A new model comes every five years and holds for them: those of 2010,
2015 (version 2), 2020 and 2025 are here, and a date has the newest that has begun. The thesis (section 3.6, p. 56) used
IGRF of 1999; these are its successor's kind: good to about 140 nT (1 sigma, crustal fields) anywhere
(:func:`left_out`).
"""

from __future__ import annotations

import numpy as np

from models.earth import earth
from models.magnetic import wmm2010, wmm2015, wmm2020, wmm2025

REFERENCE_RADIUS = 6371200.0
"""Geomagnetic reference radius a, m."""
MODELS = (wmm2010, wmm2015, wmm2020, wmm2025)
BEGIN, END = MODELS[0].EPOCH, MODELS[-1].EPOCH + 5.0
"""Dates between which one of the models is valid, decimal years."""
DEGREE = 12

_COEFFICIENTS = np.array([model.COEFFICIENTS for model in MODELS])[:, :, 2:] * 1e-9


def known(date):
    """Whether one of the models is valid at the date."""
    return np.logical_and(date >= BEGIN, date <= END)


def _at(date, *values):
    """That of the values, one for each model, whose model is valid at the date."""
    value = values[0]
    for model, later in zip(MODELS[1:], values[1:], strict=True):
        value = np.where(date >= model.EPOCH, later, value)
    return value


def field(latitude, longitude, altitude, date):
    """Field in n, T, at a geodetic position (rad, rad, m above the ellipsoid) and a date in decimal years.

    A date that is not :func:`known` has the field of the nearest model, led on: whoever takes it, refuses it.
    """
    _, east_west = earth.radii(latitude)
    across = (east_west + altitude) * np.cos(latitude)
    up = (east_west * (1.0 - earth.ECCENTRICITY_SQUARED) + altitude) * np.sin(latitude)
    radius = np.sqrt(across * across + up * up)
    c, s = up / radius, across / radius  # cosine and sine of the geocentric colatitude

    cos_longitude, sin_longitude = np.cos(longitude), np.sin(longitude)
    cosines, sines = [1.0 + 0.0 * longitude], [0.0 * longitude]  # of m times the longitude
    for _ in range(DEGREE):
        cosines, sines = (
            [*cosines, cosines[-1] * cos_longitude - sines[-1] * sin_longitude],
            [*sines, sines[-1] * cos_longitude + cosines[-1] * sin_longitude],
        )

    years = date - _at(date, *(model.EPOCH for model in MODELS))
    chosen = _at(date, *_COEFFICIENTS)
    g_all, h_all = (chosen[:, i] + years * chosen[:, i + 2] for i in (0, 1))
    ratio = REFERENCE_RADIUS / radius
    scale = ratio * ratio
    one, zero = 1.0 + 0.0 * c, 0.0 * c
    # legendre[m] is P_nm for m = 0 and P_nm / s for m > 0; slope[m] is dP_nm / dtheta
    last, last_slope = [], []
    legendre, slope = [one], [zero]
    outward = southward = eastward = 0.0
    for n in range(1, DEGREE + 1):
        before, before_slope, last, last_slope = last, last_slope, legendre, slope
        legendre, slope = [], []
        for m in range(n + 1):
            if m == n:
                factor = 1.0 if n == 1 else float(np.sqrt((2 * n - 1) / (2 * n)))
                # P_nn = factor s P_(n-1)(n-1), where the stored one is divided by s already unless n = 1
                p = factor * last[m - 1] * (1.0 if n == 1 else s)
                q = factor * (s * last_slope[m - 1] + c * last[m - 1] * (1.0 if n == 1 else s))
            else:
                norm = float(np.sqrt(n * n - m * m))
                a, b = (2 * n - 1) / norm, float(np.sqrt((n - 1) ** 2 - m * m)) / norm
                whole = last[m] if m == 0 else last[m] * s
                p = a * c * last[m]
                q = a * (c * last_slope[m] - s * whole)
                if m < n - 1:
                    p = p - b * before[m]
                    q = q - b * before_slope[m]
            legendre.append(p)
            slope.append(q)
        scale = scale * ratio  # (a/r)^(n+2)
        radial = polar = azimuthal = 0.0
        for m in range(n + 1):
            row = n * (n + 1) // 2 - 1 + m
            g, h = g_all[row], h_all[row]
            along = g * cosines[m] + h * sines[m]
            radial = radial + along * (legendre[m] if m == 0 else legendre[m] * s)
            polar = polar + along * slope[m]
            if m > 0:
                azimuthal = azimuthal + m * legendre[m] * (g * sines[m] - h * cosines[m])
        outward = outward + (n + 1) * scale * radial
        southward = southward - scale * polar
        eastward = eastward + scale * azimuthal

    # from the geocentric to the geodetic level: turn by the difference of the latitudes
    north, down = -southward, -outward
    sine = np.sin(latitude) * s - np.cos(latitude) * c  # sin(geodetic - geocentric latitude)
    cosine = np.cos(latitude) * s + np.sin(latitude) * c
    return np.array([north * cosine + down * sine, eastward, down * cosine - north * sine])


def declination(field_n):
    """Angle from true to magnetic north, positive east, rad."""
    return np.arctan2(field_n[1], field_n[0])


def left_out(field_n, date):
    """Standard deviations of what the model leaves out, north, east, down, T: crust, short waves of the core,
    disturbances.

    The error model of the technical report of 2025 (section 3) has 141 nT down, and sqrt(0.26^2 + (5417 nT / H)^2)
    degrees of declination, H the horizontal field; that is what the horizontal components have that turn the needle so
    far. Both are taken alike, because the crust does not know where north is. The report's errors of horizontal field
    (133 nT) and strength (138 nT) follow within a sixth where the dip is 60 to 70 degrees; its errors north and east
    are 137 and 89 nT. The models before it have figures of their own, up to 165 nT down.
    """
    turned, displaced, down = (_at(date, *figures) for figures in zip(*(m.ERRORS for m in MODELS), strict=True))
    horizontal = _horizontal(field_n)
    across = np.radians(np.sqrt((turned * horizontal) ** 2 + displaced**2))
    return np.stack([across, across, down + 0.0 * across])


def declination_sigma(field_n, date):
    """Error of the model's declination (1 sigma), rad: sqrt(0.26^2 + (5417 nT / H)^2) degrees in 2025, see
    :func:`left_out`."""
    return left_out(field_n, date)[0] / _horizontal(field_n)


def _horizontal(field_n):
    return np.sqrt(field_n[0] * field_n[0] + field_n[1] * field_n[1])
