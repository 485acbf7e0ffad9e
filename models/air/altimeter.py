"""The barometric altimeter: what it shows of a static pressure, and errors that come with the distance flown.

The setting (QNH) is the pressure at sea level with which the standard atmosphere has the reading; it shifts the scale,

    h = H(p) - H(setting),    H of thesis (2.1).                                                                  (1)

Pressure surfaces slope, and their height differs from place to place: Dyment and Liang (AGARD CP-298, paper 15,
appendix 2, p. 15-10 f.) take a first-order Gauss-Markov bias with 10 m and a correlation distance of 100 km, flown
with the horizontal speed v,

    B_k = phi B_(k-1) + sigma sqrt(1 - phi^2) w,    phi = exp(-v T / lambda),                                     (2)

and white noise of the variance 2.7^2 + (0.0035 h)^2 m2 on each reading.

The vertical speed indicator is a chamber that follows the static pressure through a restriction: it shows how far it
is behind, (H - H_chamber) / tau, which in a steady climb is the rate of climb.
"""

from __future__ import annotations

import numpy as np

from models.air import atmosphere


def indicated(pressure_altitude, setting):
    """Altitude that is shown, m, with this setting in Pa, (1)."""
    return pressure_altitude - atmosphere.pressure_altitude(setting)


def distance_decay(speed, period, distance):
    """phi of (2) at a horizontal speed, m/s; 1 for one that is no number."""
    return np.exp(-np.fmax(speed, 0.0) * period / distance)


def noise_sigma(constant, slope, height):
    """Of one reading at this height, m."""
    return np.hypot(constant, slope * height)
