"""How strong signals and jammers are at a receiver: powers in dBW, C/N0 in dB-Hz.

Free-space loss 20 lg(4 pi d / lambda). Interference by E. D. Kaplan and C. J. Hegarty, Understanding GPS: it acts as
noise with the density J / (Q R_c), C/N0 of both being 1 / (1 / (C/N0) + (J/S) / (Q R_c)); Q is 1 for a narrow band and
2 for one that is spread as the code is.
"""

from __future__ import annotations

import numpy as np

from models.satellite.tracking import CHIP_RATE
from navfmu.constants import WAVELENGTH

LEAST_POWER = -158.5
"""dBW of the C/A code by an antenna of 3 dBi, linear: least guaranteed by IS-GPS-200, table 3-Va (IIR-M on)."""
LEAST_GAIN = 3.0
FARTHEST = 25.24e6
"""m, where it is guaranteed: from 26 560 km at an elevation of 5 degrees."""
NOISE_DENSITY = -201.5
"""dBW/Hz of a receiver with its antenna, 513 K: usual."""


def decibel(ratio):
    """10 lg of a ratio."""
    return 10.0 * np.log10(ratio)


def ratio(decibels):
    """Of decibels; powers of two are quicker than powers of ten."""
    return np.exp2(decibels * (np.log2(10.0) / 10.0))


def free_space_loss(distance):
    """dB at L1."""
    return 2.0 * decibel(4.0 * np.pi / WAVELENGTH * distance)


def of_satellite(distance, gain):
    """Power of the weakest guaranteed satellite behind an antenna with a ``gain`` in dB, W."""
    share = FARTHEST / distance
    return ratio(LEAST_POWER - LEAST_GAIN + gain) * share * share


def of_jammer(power, distance):
    """Power of a jammer that radiates ``power`` W at an isotropic antenna, dBW; a power of 0 is -300 dBW."""
    return decibel(np.maximum(power, 1e-30)) - free_space_loss(np.maximum(distance, 1.0))


def carrier_to_noise(signal, interference, noise_density, spread):
    """C/N0, a ratio, of a signal (W) beside an ``interference`` (W), with ``spread`` Q."""
    noise = ratio(noise_density) + interference / (spread * CHIP_RATE)
    return signal / noise
