"""Kepler's equation, with as many steps whatever the numbers are."""

from __future__ import annotations

from models.satellite import sines

STEPS = 2
"""Newton's steps. The start is off by e^2 / 2 at most, and a step leaves e / 2 times the square of what was off: 1e-15
rad after two for e up to 0.05 (GPS has up to 0.03), 5e-14 for 0.1, which is as far as E - M is small."""


def eccentric_anomaly(mean_anomaly, eccentricity):
    """Sine and cosine of E of M = E - e sin E, rad: IS-GPS-200 table 20-IV, by Newton's method for E - M."""
    mean = sines.of(mean_anomaly)
    ahead = eccentricity * mean[0]
    for _ in range(STEPS):
        sine, cosine = sines.both(mean, sines.small(ahead))
        ahead = ahead - (ahead - eccentricity * sine) / (1.0 - eccentricity * cosine)
    return sines.both(mean, sines.small(ahead))
