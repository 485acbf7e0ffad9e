"""Loops that follow a signal: how noisy they are, below which signal they lose it, and in which motion.

RTO MP-43 (1999), Landry, "New technique to improve GPS receiver performances by threshold reduction", (2-1), (3-1) and
(3-5), for an early-late spacing of one chip; for others as in E. D. Kaplan and C. J. Hegarty, Understanding GPS, for a
non-coherent early-minus-late power discriminator. C/N0 is a ratio in Hz here, not in dB-Hz.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import SPEED_OF_LIGHT, WAVELENGTH

CHIP_RATE = 1.023e6
"""Of the C/A code, 1/s."""
CHIP = SPEED_OF_LIGHT / CHIP_RATE
"""m."""


SECOND, THIRD = 1, 2
"""Orders of the carrier loop."""
MOST = 0.25 * np.pi
"""Of a phase, rad: where the discriminator ends."""


def code_sigma(ratio, bandwidth, detection, spacing=1.0):
    """Standard deviation of a pseudorange, m: (3-1).

    ``bandwidth`` of the loop B and ``detection`` bandwidth B_FI in Hz, ``spacing`` d of early and late in chips:
    sigma = CHIP sqrt(B d / (2 C/N0) (1 + 2 B_FI / ((2 - d) C/N0))).
    """
    return CHIP * np.sqrt(0.5 * bandwidth * spacing / ratio * (1.0 + 2.0 * detection / ((2.0 - spacing) * ratio)))


def threshold(multiple, bandwidth, detection, spacing=1.0):
    """Least C/N0, a ratio, at which ``multiple`` sigmas are within half the spacing: (3-5)."""
    a = multiple * multiple * bandwidth / spacing
    return a * (1.0 + np.sqrt(1.0 + 4.0 * detection / (a * (2.0 - spacing))))


def phase_sigma(ratio, bandwidth, detection):
    """Standard deviation of the phase of the carrier, rad: (2-1)."""
    return np.sqrt(bandwidth / ratio * (1.0 + 0.5 * detection / ratio))


def rate_sigma(phase, interval):
    """Standard deviation of a range rate, m/s, made of two independent phases of this sigma, rad, ``interval`` s
    apart."""
    return WAVELENGTH / (2.0 * np.pi) * np.sqrt(2.0) * phase / interval


def lag(order, acceleration, jerk, bandwidth):
    """How far the phase of a loop stays behind a motion towards the satellite, rad: second or third ``order``.

    Acceleration (m/s2) over w^2 with B = 0.53 w, or jerk (m/s3) over w^3 with B = 0.7845 w: Kaplan and Hegarty.
    """
    second = acceleration * (0.53 / bandwidth) ** 2
    third = jerk * (0.7845 / bandwidth) ** 3
    return 2.0 * np.pi / WAVELENGTH * np.where(order == SECOND, second, third)


def holds(phase, lag):
    """Whether three sigmas of the phase (rad) and what it stays behind are within 45 degrees: Kaplan and Hegarty, for a
    loop that does not know the data."""
    return 3.0 * phase + np.abs(lag) <= MOST


def slip_rate(phase, bandwidth):
    """How often noise alone makes a loop slip that does not know the data, 1/s, of a sigma below 0.4 rad.

    A. J. Viterbi (1963) for the first order: after pi^2 r I_0(r)^2 / (2 B), of a phase of twice the size r =
    1 / (2 sigma)^2; I_0(r) is exp(r) / sqrt(2 pi r) for r above 2.
    """
    return 4.0 * bandwidth / np.pi * np.exp(-0.5 / np.maximum(phase, 1e-3) ** 2)


def locked(was, strong_for, strong, holding, period, needed):
    """Whether a signal is followed, and for how long it has been strong enough to be found, s.

    It stays so while ``holding``, and is found again when it has been ``strong`` for ``needed`` s.
    """
    strong_for = np.where(strong, strong_for + period, 0.0)
    return np.where(was, holding, strong & (strong_for > needed - 0.5 * period)), strong_for
