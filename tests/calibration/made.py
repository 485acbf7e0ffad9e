"""Samples of the error terms, made by recursions of their own: three axes, a second apart."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

COUNT = 20000


def white(rng, sigma=1.0, count=COUNT):
    return sigma * rng.standard_normal((count, 3))


def walk(rng, step, count=COUNT):
    return np.cumsum(step * rng.standard_normal((count, 3)), axis=0)


def markov(rng, sigma, time, count=COUNT):
    """Stationary from the first sample on."""
    phi = np.exp(-1.0 / time)
    drive = sigma * np.sqrt(1.0 - phi**2) * rng.standard_normal((count, 3))
    drive[0] = sigma * rng.standard_normal(3)
    return lfilter([1.0], [1.0, -phi], drive, axis=0)


def pulses(rng, quantum, count=COUNT):
    """Rates of whole pulses, less the true ones: what has made no pulse is kept."""
    return np.diff(quantum * rng.uniform(-0.5, 0.5, (count + 1, 3)), axis=0)


def flicker(rng, instability, count=COUNT):
    """One-sided density B^2 / (pi f), by its spectrum over a period four times as long."""
    n = 4 * count
    f = np.fft.rfftfreq(n, 1.0)[1:]
    size = np.sqrt(instability**2 / (np.pi * f) * n / 4.0)  # E|X|^2 = n S / 2, in two parts
    parts = size[:, None] * (rng.standard_normal((len(f), 3)) + 1j * rng.standard_normal((len(f), 3)))
    return np.fft.irfft(np.vstack([np.zeros((1, 3)), parts]), n, axis=0)[:count]
