"""Wander about the planned path: a random deviation whose acceleration is stationary and has a continuous derivative.

On each axis the deviation d is white noise through four equal lags, d = 4 tau^2 sigma y_4. With s = tau i omega the
spectrum of its acceleration is that of s^2 / (1 + s)^4, a critically damped band around 1 / tau: position, velocity,
acceleration and jerk are all stationary, with standard deviations

    sqrt(5) sigma tau^2,  sigma tau,  sigma,  sqrt(5) sigma / tau,                                                (1)

and the autocorrelation of the acceleration is, with x = |t| / tau,

    exp(-x) (1 + x - 2 x^2 + x^3 / 3).                                                                            (2)

The noise is held for a period, so between two draws the deviation is an exponential polynomial, without approximation.
"""

from __future__ import annotations

import numpy as np


def stationary(normals):
    """Levels drawn from their long-run distribution; ``normals`` and result have the shape (4, axes).

    In units of tau and of 4 tau^2 sigma: d and d'' have the covariance (5, -1; -1, 1) / 16, d' and d''' (1, -1; -1, 5)
    / 16, and the two pairs are independent.
    """
    d = np.sqrt(5.0) / 4.0 * normals[0]
    d2 = (-normals[0] + 2.0 * normals[1]) / (4.0 * np.sqrt(5.0))
    d1 = 0.25 * normals[2]
    d3 = 0.25 * (-normals[2] + 2.0 * normals[3])
    return np.stack([d + 3.0 * d1 + 3.0 * d2 + d3, d + 2.0 * d1 + d2, d + d1, d])


def deviation(levels, sigma, time_constant):
    """d and its first three derivatives: m, m/s, m/s2, m/s3."""
    y1, y2, y3, y4 = levels
    scale = 4.0 * sigma
    return (
        scale * time_constant * time_constant * y4,
        scale * time_constant * (y3 - y4),
        scale * (y2 - 2.0 * y3 + y4),
        scale / time_constant * (y1 - 3.0 * y2 + 3.0 * y3 - y4),
    )
