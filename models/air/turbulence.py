"""Gusts of the Dryden form, and what they do to an aircraft that keeps its attitude.

MIL-F-8785C, section 3.7 (the same in MIL-HDBK-1797): in frozen turbulence of the intensity sigma and the length L, an
aircraft of the airspeed V meets, with tau = L / V and white noise eta of the spectral density 2 tau,

    along     sigma / (1 + tau s) eta                                                                             (1)
    across    sigma / sqrt(2) (1 + sqrt(3) tau s) / (1 + tau s)^2 eta,  and likewise down                         (2)

Above 2000 ft L is 1750 ft (533 m) on all axes, and sigma is read from figure 7 there by how often it is exceeded: from
2000 to 10000 ft it is some 7 ft/s at 1e-2 (light), 10 at 1e-3 (moderate) and 23 at 1e-5 (severe); 5 ft/s lie between
1e-1 and 1e-2.

An aircraft that keeps its attitude gets from the air moving past it the specific force Z (g - c) on each axis, where
g is the gust and c its own deviation from the velocity of before; with the weight G = m g_0 and the wing area S

    Z_down = rho V C_L_alpha g_0 / (2 G/S),    Z_across = -rho V C_Y_beta g_0 / (2 G/S)                           (3)

The pilot, who steers back to the path with the time constant T, adds -(Z / T) e, e the integral of c:

    e'' + Z e' + (Z / T) e = Z g.                                                                                 (4)

Below 1000 ft, with the height h above the ground in ft and the wind W_20 at 20 ft (MIL-F-8785C, section 3.7.3),

    L_down = h,                     L_along = L_across = h / (0.177 + 0.000823 h)^1.2                             (5)
    sigma_down = 0.1 W_20,  sigma_along = sigma_across = sigma_down / (0.177 + 0.000823 h)^0.4                    (6)

W_20 is 15 kn (light), 30 (moderate), 45 (severe); from 1000 to 2000 ft both are linear in height.

White noise through the two lags of (1), (2) is sampled exactly: over a period theta tau the levels y, whose long-run
covariance is P = (1, 1/2; 1/2, 1/2), go to

    A y + w,   A = exp(-theta) (1, 0; theta, 1),   cov w = P - A P A'.                                            (7)

Over the distance x L the correlation is exp(-x) along, exp(-x) (1 - x / 2) across and down. Where a gust must be
continuous, as for (4), noise is held for a period instead (``models.processes.lags``), on the same levels.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import FOOT, STANDARD_GRAVITY

GUST_SIGMA, GUST_LENGTH = 1.5, 533.4
"""Intensity of the gusts that are flown in and allowed for, m/s (5 ft/s), and their scale, m (1750 ft)."""
LOW, HIGH = 1000.0 * FOOT, 2000.0 * FOOT
"""Heights between which the forms of near the ground and of above are mixed, m."""
TERMS = 12
"""Of the series in ``response``: with |x| < 4, the largest that parameters allow, what is left out is below 1e-16."""


def stationary(normals):
    """Levels of the two lags from their long-run distribution; ``normals`` and result have the shape (2, axes)."""
    second = normals[0] * np.array([0.0, np.sqrt(0.5), np.sqrt(0.5)])
    first = second + normals[1] * np.array([1.0, np.sqrt(0.5), np.sqrt(0.5)])
    return np.stack([first, second])


def advance(levels, ratio, normals):
    """Levels one period later, exactly, (7).

    ``ratio`` is theta on each axis, and may change from one period to the next: the levels keep their distribution.
    ``levels`` and ``normals`` have the shape (2, axes).
    """
    decay = np.exp(-ratio)
    kept = decay * decay
    spread = np.sqrt(1.0 - kept)
    common = (0.5 - kept * (ratio + 0.5)) / np.maximum(spread, 1e-12)
    own = np.sqrt(np.maximum(0.5 - kept * (ratio * (ratio + 1.0) + 0.5) - common * common, 0.0))
    return np.stack(
        [
            decay * levels[0] + spread * normals[0],
            decay * (levels[1] + ratio * levels[0]) + common * normals[0] + own * normals[1],
        ]
    )


def by_height(height, wind_at_20_feet, sigma, length):
    """Intensities and lengths along, across and down, each (3,): (5), (6) below 1000 ft, as given above 2000 ft.

    ``height`` above the ground in m; below 10 ft it is taken for 10 ft.
    """
    h = np.clip(height, 10.0 * FOOT, LOW)
    shape = 0.177 + 0.000823 * h / FOOT
    flat = h / shape**1.2
    down = 0.1 * wind_at_20_feet
    level = down / shape**0.4
    above = np.clip((height - LOW) / (HIGH - LOW), 0.0, 1.0)
    low_sigma, low_length = np.array([level, level, down]), np.array([flat, flat, h])
    return low_sigma + above * (sigma - low_sigma), low_length + above * (length - low_length)


def gust(levels, sigma):
    """Velocity of the air along, across (right) and down, m/s: (1), (2)."""
    first, second = levels
    shaped = np.sqrt(0.5) * (second + np.sqrt(3.0) * (first - second))
    return sigma * np.array([first[0], shaped[1], shaped[2]])


def aerodynamic_rate(density, airspeed, slope, wing_loading):
    """Z of (3), 1/s; 0 for a wing loading of 0 N/m2."""
    damping = density * airspeed * slope * STANDARD_GRAVITY
    return np.where(wing_loading > 0.0, damping / (2.0 * np.maximum(wing_loading, 1e-9)), 0.0)


def response(rate, hold_time, period):
    """The transition of (e, c) over a period where g = 0: rows e by e, e by c, c by e, c by c; shape (4, axes).

    exp(-Z h / 2) times (cosh + Z/2 sinh / delta, sinh / delta; -Z/T sinh / delta, cosh - Z/2 sinh / delta) of delta h
    with delta^2 = Z^2 / 4 - Z / T, as series in x = delta^2 h^2, whose sign does not matter.
    """
    half = 0.5 * rate
    stiffness = rate / hold_time
    x = (half * half - stiffness) * period * period
    even, odd, term = 0.0 * x, 0.0 * x, 1.0 + 0.0 * x
    for k in range(TERMS):
        even = even + term
        odd = odd + term / (2 * k + 1)
        term = term * x / ((2 * k + 1) * (2 * k + 2))
    odd = odd * period
    decay = np.exp(-half * period)
    return decay * np.stack([even + half * odd, odd, -stiffness * odd, even - half * odd])


def carried(displacement, velocity, old_gust, new_gust, transition, hold_time, period):
    """(e, c) one period later, the exact solution of (4) for a gust that is linear in between."""
    slope = (new_gust - old_gust) / period
    steady_velocity = hold_time * slope
    e = displacement - hold_time * (old_gust - steady_velocity)
    c = velocity - steady_velocity
    return (
        hold_time * (new_gust - steady_velocity) + transition[0] * e + transition[1] * c,
        steady_velocity + transition[2] * e + transition[3] * c,
    )
