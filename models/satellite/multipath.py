"""Reflections that an aircraft adds to pseudoranges: RTCA DO-229, airborne multipath 0.13 + 0.53 exp(-e / 10 deg) m."""

from __future__ import annotations

import numpy as np


def sigma(elevation):
    """Standard deviation, m, at an elevation in rad."""
    return 0.13 + 0.53 * np.exp(-elevation / np.radians(10.0))
