"""Loops that follow a signal: how noisy they are, and below which signal they lose it.

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


def rate_sigma(ratio, bandwidth, detection, interval):
    """Standard deviation of a range rate, m/s, made of two independent phases that are ``interval`` s apart."""
    return WAVELENGTH / (2.0 * np.pi) * np.sqrt(2.0) * phase_sigma(ratio, bandwidth, detection) / interval


def locked(was, strong_for, strong, holding, period, needed):
    """Whether a signal is followed, and for how long it has been strong enough to be found, s.

    It stays so while ``holding``, and is found again when it has been ``strong`` for ``needed`` s.
    """
    strong_for = np.where(strong, strong_for + period, 0.0)
    return np.where(was, holding, strong & (strong_for > needed - 0.5 * period)), strong_for
