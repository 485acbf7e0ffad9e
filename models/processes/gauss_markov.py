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


def white_equivalent(variance, since, time_constant):
    """Variance of independent values that carry the information of a process of ``variance`` measured every ``since``
    s.

    The mean of many samples of the process has the variance of independent samples of

        sigma^2 (1 + rho) / (1 - rho),  rho = exp(-since / tau).

    It goes to sigma^2 where the process has changed altogether between samples, and to 2 tau / since times that where
    they are close together.
    """
    rho = np.exp(-since / time_constant)
    return variance * (1.0 + rho) / (1.0 - rho)
