"""Motion along a recorded track: polynomials between rows of position, velocity, acceleration; their derivatives.

Latitude, longitude and altitude are polynomials of degree five in time between two rows, set by value, first and
second derivative at both. They are the flight, without approximation; velocity, acceleration and jerk, which the
attitude rates need, follow from them in closed form, so specific force and angular rate are exact derivatives of
velocity and attitude.
"""

from __future__ import annotations

import numpy as np

from models.earth import earth


def between(start, end, elapsed, duration):
    """Position and three derivatives, ``elapsed`` seconds after the row ``start``.

    Parameters
    ----------
    start, end
        (position, velocity, acceleration) at the two rows, each an array of axes.
    duration
        Time from one row to the other, s; beyond it, and where it is 0, the motion goes on with constant velocity.
    """
    p0, v0, a0 = start
    p1, v1, a1 = end
    beyond = elapsed >= duration
    t = np.where(duration > 0.0, duration, 1.0)
    s = np.where(beyond, t, elapsed)
    d = p1 - p0 - t * (v0 + 0.5 * t * a0)
    e = t * (v1 - v0 - t * a0)
    f = 0.5 * t * t * (a1 - a0)
    c3 = (10.0 * d - 4.0 * e + f) / (t * t * t)
    c4 = (-15.0 * d + 7.0 * e - 2.0 * f) / (t * t * t * t)
    c5 = (6.0 * d - 3.0 * e + f) / (t * t * t * t * t)
    position = p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))
    velocity = v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + 5.0 * s * c5)))
    acceleration = a0 + s * (6.0 * c3 + s * (12.0 * c4 + 20.0 * s * c5))
    jerk = 6.0 * c3 + s * (24.0 * c4 + 60.0 * s * c5)
    return (
        np.where(beyond, p1 + (elapsed - duration) * v1, position),
        np.where(beyond, v1, velocity),
        np.where(beyond, 0.0 * a1, acceleration),
        np.where(beyond, 0.0 * a1, jerk),
    )


def horizontal_motion(latitude, longitude, altitude):
    """North and east velocity with their first and second derivatives, m/s, m/s2, m/s3.

    Each argument is (value, first, second, third derivative) in rad or m. With radii of curvature M (meridian), N:
    v_N = (M + h) phi', v_E = (N + h) cos(phi) lambda', and d(N cos phi)/d phi = -M sin phi.
    """
    phi, phi1, phi2, phi3 = latitude
    _, lam1, lam2, lam3 = longitude
    h, h1, h2, _ = altitude
    meridian, transverse = earth.radii(phi)
    sine, cosine = np.sin(phi), np.cos(phi)
    e2 = earth.ECCENTRICITY_SQUARED
    w2 = 1.0 / (1.0 - e2 * sine * sine)
    u = 3.0 * e2 * sine * cosine * w2  # M' = M u
    u1 = 3.0 * e2 * w2 * (cosine * cosine - sine * sine + 2.0 * e2 * sine * sine * cosine * cosine * w2)
    m = meridian + h
    m1 = meridian * u * phi1 + h1
    m2 = meridian * ((u * u + u1) * phi1 * phi1 + u * phi2) + h2
    p = (transverse + h) * cosine
    p1 = h1 * cosine - m * sine * phi1
    p2 = h2 * cosine - h1 * sine * phi1 - m1 * sine * phi1 - m * (cosine * phi1 * phi1 + sine * phi2)
    north = (m * phi1, m * phi2 + m1 * phi1, m * phi3 + 2.0 * m1 * phi2 + m2 * phi1)
    east = (p * lam1, p * lam2 + p1 * lam1, p * lam3 + 2.0 * p1 * lam2 + p2 * lam1)
    return north, east
