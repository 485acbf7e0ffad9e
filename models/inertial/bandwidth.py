"""Bandwidth of a sensor: it shows y, which follows its input u as a lag of first or second order,

    order 1     y'  = w (u - y)                         w = 2 pi bandwidth: -3 dB at the bandwidth
    order 2     y'' = w^2 (u - y) - 2 zeta w y'         -3 dB at the bandwidth where zeta = 1 / sqrt(2)

Between two samples the input is taken as linear, u = u_0 + s t. Then y_p = u - d s, with the delay d = 1 / w or
2 zeta / w, is one motion, and what differs from it dies out as that of a free lag. With x = (y, y' / w),

    x(T) = x_p(T) + Phi (x(0) - x_p(0)),   x_p = (u - d s, s / w)                                             (1)

is exact. Phi = exp(-w T) of order 1; of order 2, Ogata, *Modern Control Engineering*, section 5-3, with
a = exp(-zeta w T), c = cos(beta w T), q = sin(beta w T) / beta, beta = sqrt(1 - zeta^2),

    Phi = a ( c + zeta q      q        )
            (    - q       c - zeta q  )                                                                      (2)

A sensor without a lag has Phi = 0 and d = 0: (1) is y = u.
"""

from __future__ import annotations

import numpy as np


def transition(bandwidth, order, damping, period):
    """Phi, shape (2, 2), of (2) over one period (s); 0 where the bandwidth (Hz) is 0, which means none."""
    angle = 2.0 * np.pi * bandwidth * period
    beta = np.sqrt(1.0 - damping * damping)
    a, c, q = np.exp(-damping * angle), np.cos(beta * angle), np.sin(beta * angle) / beta
    first, second = np.logical_and(bandwidth > 0.0, order == 1), np.logical_and(bandwidth > 0.0, order == 2)
    return np.array(
        [
            [
                np.where(second, a * (c + damping * q), np.where(first, np.exp(-angle), 0.0)),
                np.where(second, a * q, 0.0),
            ],
            [np.where(second, -a * q, 0.0), np.where(second, a * (c - damping * q), 0.0)],
        ]
    )


def times(bandwidth, order, damping):
    """The delay d of (1) and 1 / w, s; both 0 where the bandwidth is 0."""
    inverse = np.where(bandwidth > 0.0, 1.0 / (2.0 * np.pi * np.where(bandwidth > 0.0, bandwidth, 1.0)), 0.0)
    return np.where(order == 2, 2.0 * damping * inverse, inverse), inverse


def follow(lagged, old_input, new_input, period, transition, times):
    """x = (y, y' / w), shape (2, axes), one period later: (1)."""
    delay, inverse = times
    slope = (new_input - old_input) / period
    late = delay * slope
    apart = np.stack([lagged[0] - (old_input - late), lagged[1] - inverse * slope])
    return np.stack([new_input - late, inverse * slope]) + transition @ apart
