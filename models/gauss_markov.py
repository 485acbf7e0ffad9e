"""First-order Gauss-Markov processes, thesis (3.4)-(3.5), section 3.3.1.

db/dt = -b / tau + w with the power spectral density of w equal to 2 sigma^2 / tau has, in the long run, the standard
deviation sigma and the autocorrelation sigma^2 exp(-|t| / tau). Sampled every ``period`` it is *exactly*
b[k+1] = phi b[k] + sigma sqrt(1 - phi^2) n[k], phi = exp(-period / tau), n standard normal. All functions work
element by element on arrays.
"""

from __future__ import annotations

import numpy as np


def decay(period, time_constant):
    """phi = exp(-period / tau)."""
    return np.exp(-period / time_constant)


def drive(sigma, phi):
    """Standard deviation of the sum of the driving noise over one period: sigma sqrt(1 - phi^2)."""
    return sigma * np.sqrt(1.0 - phi * phi)


def stationary(sigma, normal):
    """First value, drawn from the process's own long-run distribution."""
    return sigma * normal


def advance(value, phi, driving_sigma, normal):
    """Value one period later."""
    return phi * value + driving_sigma * normal
