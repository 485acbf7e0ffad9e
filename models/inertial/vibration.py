"""Vibration of the sensors against the vehicle: one sinusoid, and what it makes of sensors that sum or square.

The sensors turn against the vehicle by phi(t) = s sin(w t) + c cos(w t), small, and are shaken by the specific force
p sin(w t) + q cos(w t); s, c (rad) and p, q (m/s2) are vectors in b. On the whole the sensors go nowhere, so

    rate            phi' - 1/2 phi x phi' = w (s cos(w t) - c sin(w t)) + w/2 s x c                                (1)
    specific force  p sin(w t) + q cos(w t) - 1/2 (s x p + c x q)                                                  (2)

to second order. The constant terms are what gyros and accelerometers see of a cone and of sculling that leads nowhere:
an exact strapdown calculation takes them away again, and what a real one leaves over is drift. Of a cone of half-angle
eps the rate is eps^2 w / 2, RTO MP-43 (1999), Mark and Tazartes, (A-6).

An accelerometer whose output has a part k f^2 shows, of vibration, the mean of the square more (rectification):

    k (p^2 + q^2) / 2 for each axis                                                                                (3)
"""

from __future__ import annotations

import numpy as np


def rate(s, c, frequency, turn):
    """Rate of the sensors against the vehicle, rad/s, (1); ``turn`` is w t in rad, ``frequency`` w in rad/s."""
    return frequency * (s * np.cos(turn) - c * np.sin(turn) + 0.5 * np.cross(s, c))


def specific_force(s, c, p, q, turn):
    """Specific force of vibration, m/s2, (2)."""
    return p * np.sin(turn) + q * np.cos(turn) - 0.5 * (np.cross(s, p) + np.cross(c, q))


def rectified(p, q, k):
    """Bias (3), m/s2; ``k`` in m/s2 per (m/s2)^2."""
    return 0.5 * k * (p * p + q * q)
