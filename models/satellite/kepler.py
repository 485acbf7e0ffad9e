"""Kepler's equation, with as many steps whatever the numbers are."""

from __future__ import annotations

import numpy as np

STEPS = 2
"""Newton's steps. The start is off by e^2 / 2 at most, and a step leaves e / 2 times the square of what was off: 1e-15
rad after two for e up to 0.05 (GPS has up to 0.03), 5e-14 for 0.1."""


def eccentric_anomaly(mean_anomaly, eccentricity):
    """E of M = E - e sin E, rad: IS-GPS-200 table 20-IV, by Newton's method from E = M + e sin M."""
    anomaly = mean_anomaly + eccentricity * np.sin(mean_anomaly)
    for _ in range(STEPS):
        off = anomaly - eccentricity * np.sin(anomaly) - mean_anomaly
        anomaly = anomaly - off / (1.0 - eccentricity * np.cos(anomaly))
    return anomaly
