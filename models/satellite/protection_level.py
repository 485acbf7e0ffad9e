"""Protection levels: how far off a position may be while integrity monitoring is silent.

``sigma`` is the standard deviation of the position in that direction, ``slope`` the largest one of :mod:`raim`.
"""

from __future__ import annotations

import numpy as np

NONE = 1.0e6
"""What is told where nothing protects, and at most, m."""


def of_slope(slope, non_centrality):
    """Brown (1992): the bias that is missed with the wanted probability, along the worst slope, m."""
    return np.minimum(np.max(slope) * np.sqrt(non_centrality), NONE)


def of_slope_and_noise(slope, threshold, sigma, multiple):
    """Walter and Enge (1995): the bias that reaches the threshold by itself, and what noise adds, m.

    ``threshold`` is that of the root of the sum of squares; ``multiple`` of sigma stands for missed detection.
    """
    return np.minimum(np.max(slope) * threshold + multiple * sigma, NONE)
