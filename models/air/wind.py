"""What a wind along a flight is made of: wander over travelling time, a profile with height, shear and gusts.

*Travelling time.* Thesis (3.35), p. 67 (Berman and Powell, PLANS 1998): the wind at two points of a flight differs as a
process does over the travelling time t_r,

    t_r^2 = t_N^2 + t_E^2 + t_D^2 + dt^2,   t_N = dp_N / V_N and so on.                                           (1)

On an axis on which the aircraft moves dp / V is dt, whatever the speed; on one on which it does not, 0 / 0 is taken for
0. In between a speed below 1 m/s counts in its proportion, t_N = dp_N / max(|V_N|, 1 m/s).

*Profile.* Near the ground the mean wind falls with the height h above it as

    W(h) = W (h / h_g)^p   below the gradient height h_g,                                                         (2)

the power law of ASCE 7-05, table 6-2: over open country (exposure C) h_g = 274 m and p = 1 / 6.5.

*Gust.* A frozen gust is met with the airspeed: along the distance s since its front it is, with the gradient H and the
part c in which it stays at its peak U,

    u(s) = U (k(s / H) - k((s - H - c) / H)),   k(x) = (1 - cos(pi x)) / 2, 0 below x = 0, 1 above x = 1.          (3)

With c = 0 this is the gust of CS-25.341 (a)(2), U/2 (1 - cos(pi s / H)) up to s = 2 H, H from 9 to 107 m; with a c
that does not end it is that of MIL-F-8785C, section 3.7; with a short H and c the width of a wake, a step in and out.
"""

from __future__ import annotations

import numpy as np

LEAST_SPEED = 1.0
"""Of (1), m/s."""
LEAST_HEIGHT = 1.0
"""Below which a profile does not change, m."""


def travelling(velocity_n):
    """Travelling time per time, dt_r / dt of (1): 1 at rest, sqrt(2) along one axis, 2 along all three."""
    moving = np.abs(velocity_n) / np.maximum(np.abs(velocity_n), LEAST_SPEED)
    return np.sqrt(1.0 + np.sum(moving * moving))


def track(velocity_n):
    """Cosine and sine of the direction of motion over ground; north at rest."""
    north, east = velocity_n[0], velocity_n[1]
    speed = np.hypot(north, east)
    moving = speed > 0.0
    return np.where(moving, north, 1.0) / np.where(moving, speed, 1.0), east / np.where(moving, speed, 1.0)


def near_ground(height, gradient_height, exponent):
    """W(h) / W of (2); 1 above the gradient height."""
    return np.clip(height / gradient_height, LEAST_HEIGHT / gradient_height, 1.0) ** exponent


def layered(altitude, altitudes, winds, count):
    """Wind between the first ``count`` rows of a table, linear; below and above it the first and the last row.

    ``altitudes`` have the shape (n,) and do not fall, ``winds`` (n, 3). Two rows of one altitude are a step, from which
    on the wind is that of the second one. No rows are no wind.
    """
    first = np.where(count > 0, winds[0], 0.0)
    thickness = altitudes[1:] - altitudes[:-1]
    part = np.where(
        thickness > 0.0,
        np.clip((altitude - altitudes[:-1]) / np.where(thickness > 0.0, thickness, 1.0), 0.0, 1.0),
        altitude >= altitudes[1:],
    )
    used = np.arange(1, len(altitudes)) < count
    return first + np.where(used, part, 0.0) @ (winds[1:] - winds[:-1])


def ramped(level, target, period, duration):
    """Level one period later on its way to a target at the rate 1 / duration; at once for a duration of 0."""
    step = period / np.maximum(duration, period)
    return level + np.clip(target - level, -step, step)


def rise(x):
    """k of (3)."""
    return 0.5 * (1.0 - np.cos(np.pi * np.clip(x, 0.0, 1.0)))


def gust(distance, gradient, plateau):
    """u / U of (3) at a distance behind the front; 0 before it and behind the gust."""
    return rise(distance / gradient) - rise((distance - gradient - plateau) / gradient)
