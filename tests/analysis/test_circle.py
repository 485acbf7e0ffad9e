"""Circles that hold a share of a normal error, beside Hoyt's distribution in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import ncx2

from navfmu.analysis.circle import principal, printed, radius


def hoyt(length: float, long: float, short: float) -> float:
    """Share within a length: Q(a, b) - Q(b, a) with Marcum's Q, the survival function of a noncentral chi-square.

    (Paris, Nakagami-q (Hoyt) distribution function with applications, Electronics Letters 45, 2009.)
    """
    q = short / long
    a = np.sqrt((1.0 - q**4) / (1.0 - q)) * np.sqrt(1.0 + q) / (2.0 * q) * length / np.hypot(long, short)
    b = a * (1.0 - q) / (1.0 + q)
    return float(ncx2.sf(b * b, 2, a * a) - ncx2.sf(a * a, 2, b * b))


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.5, 0.8, 0.99])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.95, 0.99])
def test_the_circle_holds_its_share(ratio, share):
    """One that takes the circle of sqrt(s1 s2), or of the sum of the variances, fails at all ratios but 0.99."""
    found = float(radius(np.array([9.0, 0.0, 9.0 * ratio**2]), share))
    assert hoyt(found, 3.0, 3.0 * ratio) == pytest.approx(share, abs=1e-6)


def test_a_turned_ellipse_has_the_same_circle():
    """One that leaves out the covariance of both axes fails."""
    angle = np.radians(30.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = turn @ np.diag([9.0, 1.0]) @ turn.T
    packed = np.array([turned[0, 0], turned[0, 1], turned[1, 1]])
    assert np.stack(principal(packed)) == pytest.approx([3.0, 1.0])
    assert radius(packed, 0.5) == pytest.approx(radius(np.array([9.0, 0.0, 1.0]), 0.5), rel=1e-12)


def test_limits_in_closed_form():
    """Equal sigmas: Rayleigh; one alone: the quantile of a normal number."""
    equal, line = np.array([4.0, 0.0, 4.0]), np.array([0.0, 0.0, 4.0])
    assert radius(equal, 0.5) == pytest.approx(2.0 * np.sqrt(2.0 * np.log(2.0)), rel=1e-12)
    assert radius(line, 0.95) == pytest.approx(2.0 * 1.959963984540054, rel=1e-9)
    assert radius(np.zeros(3), 0.5) == 0.0


def test_where_the_printed_sums_hold():
    """0.589 (s1 + s2) within 3 % from a ratio of 0.14 on; 1.52 (s1 + s2), for 99 %, within 3 % from 0.76 on only."""
    ratios = np.linspace(0.0, 1.0, 201)
    covariances = np.stack([np.ones_like(ratios), 0.0 * ratios, ratios**2], -1)
    half, most = (printed(covariances, share) / radius(covariances, share) - 1.0 for share in (0.5, 0.99))
    assert ratios[np.abs(half) > 0.03].max() == pytest.approx(0.13, abs=0.01)
    assert ratios[np.abs(most) > 0.03].max() == pytest.approx(0.755, abs=0.01)
    assert (half[0], most[0]) == pytest.approx((-0.127, -0.410), abs=1e-3)
