"""Sculling: the velocity that turning to and fro while being shaken to and fro adds to the sum of velocity increments.

The specific force f of an interval, in the axes of its beginning, adds up to integral C f = integral (f + alpha x f),
to first order in the angle alpha turned since. In parts, with v the integral of f and w the rate,

    integral C f = v + 1/2 alpha x v + 1/2 integral (alpha x f + v x w)                                           (1)

The first product is how the axes have turned at all; :func:`at_the_beginning` does that exactly. What remains is
sculling: what coning, 1/2 integral alpha x w, has in the first power of s when w, alpha become w + s f, alpha + s v.
So each rule for coning that is a sum of products of increments, x_p dtheta_i x dtheta_j, gives one for sculling of the
same order, with the same numbers:

    x_p (dtheta_i x dv_j + dv_i x dtheta_j)                                                                       (2)
"""

from __future__ import annotations

import numpy as np


def step(total_angle, past_angles, angle, total_velocity, past_velocities, velocity, c):
    """What one more sample adds to sculling, m/s: (2) of ``models.inertial.coning.step``, with its arguments twice."""
    angles = 0.5 * total_angle + np.sum(c[:, None] * past_angles, axis=0)
    velocities = 0.5 * total_velocity + np.sum(c[:, None] * past_velocities, axis=0)
    return np.cross(angles, velocity) + np.cross(velocities, angle)


def at_the_beginning(angle, velocity):
    """Increment of velocity in the axes of the beginning of the interval, m/s.

    Exact for a constant rate and specific force; Savage, "Strapdown Inertial Navigation Integration Algorithm Design
    Part 2", Journal of Guidance, Control, and Dynamics 21 (1998):
    v + (1 - cos r)/r^2 a x v + (r - sin r)/r^3 a x (a x v).

    Parameters
    ----------
    angle
        Increment of angle a with coning, rad, shape (3,).
    velocity
        Increment of velocity v with sculling, m/s, shape (3,).
    """
    square = np.sum(angle * angle)
    turned = np.cross(angle, velocity)
    small = square < 1e-6
    safe = np.where(small, 1.0, square)
    size = np.sqrt(safe)
    first = np.where(small, 0.5 - square / 24.0, (1.0 - np.cos(size)) / safe)
    second = np.where(small, 1.0 / 6.0 - square / 120.0, (size - np.sin(size)) / (safe * size))
    return velocity + first * turned + second * np.cross(angle, turned)
