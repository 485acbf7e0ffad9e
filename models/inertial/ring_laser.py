"""Ring-laser gyro: two beams run round a ring, and the phase between them counts its turning, but for lock-in.

The phase psi turns by 2 pi for each pulse of K rad about the axis, and light that is scattered from one beam into the
other pulls it towards a value of its own (Adler's equation; dead zone +-w_L of RTO MP-43 (1999), Loukianov, Fig 4):

    psi' = 2 pi / K (w - w_L sin psi)                                                                              (1)

Below w_L it comes to rest and there are no pulses. Above, pulses come in the mean at the rate sqrt(w^2 - w_L^2).

(1) is Riccati's for tan(psi/2) = p/q, so over a time T with w held it is a matrix, (p, q) <- exp(M T) (p, q), where
M M = (w_L^2 - w^2) (pi / K)^2 times the unit matrix: :func:`advance` is exact for any T. Of (p, q) only the direction
counts.

Dither turns the ring to and fro at a peak rate w_D much above w_L, at a frequency f (250 to 500 Hz in AGARD CP-298,
Siouris; 400 Hz in Loukianov). Within lock-in it then is only where it turns back, with the acceleration 2 pi f w_D,
twice in a period. There the integral of -w_L sin(psi_0 + 2 pi f w_D (2 pi / K) t^2 / 2) is gained or lost, a Fresnel
integral of mean square w_L^2 K / (4 pi f w_D) where psi_0 is as good as random, which is what random dither is for. So
the angle walks, independently of f, by

    w_L sqrt(K / (2 pi w_D))  rad per root second                                                                  (2)

A ring that turns at w stands still where the dither goes at -w, with the acceleration 2 pi f sqrt(w_D^2 - w^2): that
root takes the place of w_D in (2). Faster than w_D it never stands still, and nothing walks.
"""

from __future__ import annotations

import numpy as np


def beat(rate, lock_in):
    """Mean rate that pulses show without dither, rad/s: sqrt(w^2 - w_L^2), and nothing in the dead zone."""
    return np.sign(rate) * np.sqrt(np.maximum(rate * rate - lock_in * lock_in, 0.0))


def advance(p, q, rate, lock_in, pulse, period):
    """The phase after ``period`` by (1).

    Parameters
    ----------
    p, q
        Sine and cosine of half the phase psi.
    rate, lock_in, pulse, period
        w and w_L in rad/s, K in rad, T in s.

    Returns
    -------
    How far the phase has got, rad; sine and cosine of half of it (or both with the other sign).
    """
    drive, pull = np.pi * rate / pulse, np.pi * lock_in / pulse
    square = drive * drive - pull * pull
    free, still = square > 0.0, np.abs(square) <= 1e-24 * pull * pull
    root = np.sqrt(np.where(still, 1.0, np.abs(square)))
    through = np.where(np.logical_or(still, np.logical_not(free)), 0.0, root * period)
    turns = np.floor(through / np.pi)
    rest = through - np.pi * turns
    ratio = np.where(free, np.sin(rest), np.tanh(np.where(free, 0.0, root * period))) / root
    ratio = np.where(still, period, ratio)
    share = np.cos(rest)
    p_after = share * p + ratio * (drive * q - pull * p)
    q_after = share * q + ratio * (pull * q - drive * p)
    size = np.sqrt(p_after * p_after + q_after * q_after)
    half = np.arctan2(p_after * q - q_after * p, p_after * p + q_after * q)
    # a last bit at the end of a turn must not make it one backwards
    half = np.where(np.logical_and(free, half * drive < -np.abs(drive)), half + 2.0 * np.pi * np.sign(drive), half)
    return 2.0 * (half + np.pi * np.sign(rate) * turns), p_after / size, q_after / size


def random_walk(lock_in, pulse, dither_rate, rate):
    """Angle random walk of a ring with random dither that turns at ``rate``, rad per root second: (2).

    Near w_D the root is not taken to be below that at 0.9 w_D, for the size of the dither is random, too.
    """
    share = 1.0 - (rate / dither_rate) ** 2
    slowest = dither_rate * np.sqrt(np.maximum(share, 1.0 - 0.9**2))
    return np.where(share > 0.0, lock_in * np.sqrt(pulse / (2.0 * np.pi * slowest)), 0.0)
