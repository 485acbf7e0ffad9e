"""The statistics that stand beside the verdicts of a navigation campaign."""

from __future__ import annotations

import math

import numpy as np
import pytest

from navfmu.report.statistics.radial import beyond


def test_the_probability_of_a_large_error_has_its_closed_forms():
    sigma = np.array([300.0])
    assert beyond(926.0, sigma, sigma) == pytest.approx(math.exp(-(926**2) / 2 / 300**2), rel=1e-12)  # Rayleigh
    line = math.erfc(926.0 / 800.0 / math.sqrt(2))
    assert beyond(926.0, np.array([800.0]), np.array([1e-3])) == pytest.approx(line, rel=1e-3)  # normal, one axis
    assert beyond(926.0, np.array([0.0]), np.array([0.0])) == 0.0


def test_the_probability_agrees_with_drawn_errors():
    random = np.random.default_rng(1)
    drawn = np.hypot(random.normal(0, 300, 400_000), random.normal(0, 150, 400_000)) > 500
    assert beyond(500.0, np.array([300.0]), np.array([150.0])) == pytest.approx(drawn.mean(), abs=0.002)
