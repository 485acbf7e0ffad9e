"""Flicker noise of a sensor, its bias instability B.

IEEE Std 952, annex C: the two-sided density is B^2 / (2 pi f) and the Allan deviation sqrt(2 ln 2 / pi) B = 0.664 B at
all averaging times (slope 0, thesis Table C.1). No process of finite order has it. A sum of Gauss-Markov processes, one
for each decade of correlation times tau_i = tau_0 10^i, all of variance s^2, has the density

    sum 2 s^2 tau_i / (1 + (2 pi f tau_i)^2)  ~  s^2 / (2 f ln 10)  =  B^2 / (2 pi f),   s^2 = B^2 ln 10 / pi

as the mean over a decade of f. With the DECADES of this module the Allan deviation is within 1.5 % of 0.664 B for
averaging times from 18 tau_0 to 1800 tau_0, within 7 % from 3 tau_0 to 10^4 tau_0, and falls beyond.
"""

from __future__ import annotations

import numpy as np

from models.processes import gauss_markov

DECADES = 5
"""Processes in the sum."""
FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))
"""Allan deviation over B."""
SHARE = float(np.sqrt(np.log(10.0) / np.pi))
"""s over B: standard deviation of one process."""


def correlation_times(shortest):
    """tau_i, s, shape (DECADES, 1)."""
    return shortest * np.array([[10.0**i] for i in range(DECADES)])


def stationary(instability, normals):
    """First values, shape (DECADES, axes), from the long-run distribution; ``instability`` is B of each axis."""
    return gauss_markov.stationary(SHARE * instability, normals)


def advance(values, instability, decay, normals):
    """Values one period later, ``decay`` = exp(-period / tau_i)."""
    return gauss_markov.advance(values, decay, gauss_markov.drive(SHARE * instability, decay), normals)
