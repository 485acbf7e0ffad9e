"""The earth: WGS-84 ellipsoid, normal gravity, earth rate and transport rate.

Frames: n is north-east-down at the aircraft, e is earth-centred earth-fixed. Latitude and longitude are geodetic, in
rad; altitude is the height above the ellipsoid, positive up, in m (the thesis writes h positive *down*, hence its
``R - h``).

References: NIMA TR8350.2 (WGS-84); thesis appendix A, (A.1)-(A.5), (A.24)-(A.29). The thesis's radii (A.4), (A.5) are
expansions to first order in the flattening; here the closed forms are used, they differ by less than 3e-5.
"""

from __future__ import annotations

import numpy as np

EQUATORIAL_RADIUS = 6378137.0
"""Semi-major axis R_0, m."""
FLATTENING = 1.0 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
EARTH_RATE = 7.292115e-5
"""Rate of e with respect to inertial space, rad/s."""
GRAVITY_EQUATOR = 9.7803253359
"""Normal gravity on the ellipsoid at the equator, m/s2."""
SOMIGLIANA = 0.00193185265241
GRAVITY_RATIO = 0.00344978650684
"""Centrifugal to gravitational acceleration at the equator, omega^2 a^2 b / GM."""


def radii(latitude):
    """Radii of curvature (R_NS, R_EW) of the ellipsoid in m: meridian and prime vertical."""
    s = np.sin(latitude)
    w = 1.0 / np.sqrt(1.0 - ECCENTRICITY_SQUARED * s * s)
    return EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED) * w * w * w, EQUATORIAL_RADIUS * w


def gravity(latitude, altitude):
    """Magnitude of normal gravity, m/s2: Somigliana's formula on the ellipsoid and its free-air change to second order.

    g = g_e (1 + k s^2) / sqrt(1 - e^2 s^2) * (1 - 2 (1 + f + m - 2 f s^2) h / a + 3 h^2 / a^2), s = sin(latitude).
    Its direction is taken as down, the deflection of the normal with height (below 2e-6 rad under 2 km) is left out.
    """
    s2 = np.sin(latitude) * np.sin(latitude)
    surface = GRAVITY_EQUATOR * (1.0 + SOMIGLIANA * s2) / np.sqrt(1.0 - ECCENTRICITY_SQUARED * s2)
    x = altitude / EQUATORIAL_RADIUS
    return surface * (1.0 - 2.0 * (1.0 + FLATTENING + GRAVITY_RATIO - 2.0 * FLATTENING * s2) * x + 3.0 * x * x)


def earth_rate(latitude):
    """Rate of e with respect to inertial space in n, rad/s, thesis (A.24)."""
    return np.array([EARTH_RATE * np.cos(latitude), 0.0 * latitude, -EARTH_RATE * np.sin(latitude)])


def transport_rate(latitude, altitude, velocity_n):
    """Rate of n with respect to e in n, rad/s: the turning of the local level as the aircraft moves (rho in (A.1))."""
    north_south, east_west = radii(latitude)
    east = velocity_n[1] / (east_west + altitude)
    return np.array([east, -velocity_n[0] / (north_south + altitude), -east * np.tan(latitude)])


def to_ecef(latitude, longitude, altitude):
    """Position in e, m."""
    _, east_west = radii(latitude)
    across = (east_west + altitude) * np.cos(latitude)
    return np.array(
        [
            across * np.cos(longitude),
            across * np.sin(longitude),
            (east_west * (1.0 - ECCENTRICITY_SQUARED) + altitude) * np.sin(latitude),
        ]
    )


def from_ecef(position_e):
    """Latitude and longitude (rad) and altitude (m) of a position in e, shape (3,), m; Bowring (1976), applied twice.

    Exact to the last places of a double from the ground to 50 000 km; at the centre of the earth it has no meaning.
    """
    x, y, z = position_e[0], position_e[1], position_e[2]
    across = np.sqrt(x * x + y * y)
    polar_radius = EQUATORIAL_RADIUS * (1.0 - FLATTENING)
    sine, cosine = z, (1.0 - FLATTENING) * across  # of the reduced latitude, but for a common factor
    for _ in range(2):
        size = np.sqrt(sine * sine + cosine * cosine)
        sine, cosine = sine / size, cosine / size
        up = z + ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED) * polar_radius * sine * sine * sine
        out = across - ECCENTRICITY_SQUARED * EQUATORIAL_RADIUS * cosine * cosine * cosine
        sine, cosine = (1.0 - FLATTENING) * up, out
    size = np.sqrt(up * up + out * out)
    sine, cosine = up / size, out / size
    root = np.sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)
    return np.arctan2(up, out), np.arctan2(y, x), across * cosine + z * sine - EQUATORIAL_RADIUS * root


def north_east_down(latitude, longitude):
    """C_ne, shape (3, 3): takes components from e to n."""
    sp, cp, sl, cl = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    return np.array([[-sp * cl, -sp * sl, cp], [-sl, cl, 0.0 * cl], [-cp * cl, -cp * sl, -sp]])
