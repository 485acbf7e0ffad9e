"""Delay of the ionosphere by Klobuchar's model, IS-GPS-200, 20.3.3.5.2.5 and figure 20-4.

Angles are semicircles there, and are so inside: 1 is pi.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import SPEED_OF_LIGHT

DAY = 86400.0


def polynomial(coefficients, x):
    """c_0 + c_1 x + c_2 x^2 + c_3 x^3, for the four that a satellite sends."""
    return coefficients[0] + x * (coefficients[1] + x * (coefficients[2] + x * coefficients[3]))


def delay(latitude, longitude, elevation, azimuth, seconds, alpha, beta):
    """Delay at L1, m.

    Parameters
    ----------
    latitude, longitude
        Of the receiver, rad.
    elevation
        Of the satellites, rad, any shape.
    azimuth
        Its sine and cosine, from north over east.
    seconds
        GPS time, s, of the week or of the day.
    alpha, beta
        Four coefficients each: amplitude in s and period in s, by powers of the geomagnetic latitude in semicircles.
    """
    e = np.maximum(elevation, 0.0) / np.pi
    (sine, cosine), psi = azimuth, 0.0137 / (e + 0.11) - 0.022
    phi_i = np.clip(latitude / np.pi + psi * cosine, -0.416, 0.416)
    lambda_i = longitude / np.pi + psi * sine / np.cos(phi_i * np.pi)
    phi_m = phi_i + 0.064 * np.cos((lambda_i - 1.617) * np.pi)
    t = np.mod(43200.0 * lambda_i + seconds, DAY)
    low = 0.53 - e
    obliquity = 1.0 + 16.0 * low * low * low
    amplitude = np.maximum(polynomial(alpha, phi_m), 0.0)
    period = np.maximum(polynomial(beta, phi_m), 72000.0)
    x = 2.0 * np.pi * (t - 50400.0) / period
    day = np.where(np.abs(x) < 1.57, amplitude * (1.0 + x * x * (-0.5 + x * x / 24.0)), 0.0)
    return SPEED_OF_LIGHT * obliquity * (5.0e-9 + day)
