"""What a calibration leaves of a heading: thesis section 3.12.

A field error in the level turns the needle by (3.48), each heading by another angle. The thesis makes of it a process,
a first-order Gauss-Markov one with white noise, (3.82)-(3.86), for the covariance of a dead reckoning navigator.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SLOW = np.radians(2.5)
"""(3.84), rad."""
TIME = 120.0
"""(3.85), s."""
WHITE = np.radians(0.8)
"""(3.86), rad, of samples once a second: 3.5 degrees at 20 Hz over sqrt(20), as the text has it."""
PERIOD = 1.0
"""s."""
HEADINGS = np.radians(np.arange(0.0, 360.0, 1.0))


def of_residual(left: np.ndarray, horizontal: float, heading: np.ndarray = HEADINGS) -> np.ndarray:
    """Errors of the heading, rad, for what is left of x and y, T, (..., 2), in a horizontal field, T: (3.48)."""
    x, y = left[..., 0, None], left[..., 1, None]
    return -(x * np.sin(heading) + y * np.cos(heading)) / horizontal


def largest(left: float, horizontal: float) -> float:
    """Largest error of the heading, rad, where x and y are both left with as much, T."""
    return float(np.hypot(left, left)) / horizontal


@dataclass(frozen=True)
class Process:
    """``slow`` and ``error`` (runs, samples), rad: the Gauss-Markov part and that with white noise, each PERIOD."""

    slow: np.ndarray
    error: np.ndarray

    def correlation(self, lag: int) -> float:
        """Mean product of samples that many apart over the mean square, of the slow part."""
        return float(np.mean(self.slow[:, lag:] * self.slow[:, : self.slow.shape[1] - lag]) / np.mean(self.slow**2))


def process(runs: int, samples: int, seed: int = 0) -> Process:
    """Heading errors of (3.82)-(3.86), exact at their samples and stationary from the first one on."""
    rng = np.random.default_rng(seed)
    phi = np.exp(-PERIOD / TIME)
    slow = SLOW * rng.standard_normal((runs, samples))
    for i in range(1, samples):
        slow[:, i] = phi * slow[:, i - 1] + np.sqrt(1.0 - phi**2) * slow[:, i]
    return Process(slow, slow + WHITE * rng.standard_normal((runs, samples)))
