"""Calibration in the heading domain, thesis (3.51)-(3.55)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from navfmu.calibration.magnetometer.swinging import needle, swing, wrap
from navfmu.errors import NavfmuError

HORIZONTAL = 2.3e-5
SOFT = np.array([[0.010, 0.006], [-0.004, -0.014]])
IRON = np.array([4e-7, -7e-7])


def fields(heading, soft=SOFT, iron=IRON, noise=0.0):
    """Level fields (samples, 3), T, by (3.43), (3.44)."""
    true = HORIZONTAL * np.stack([np.cos(heading), -np.sin(heading)], axis=1)
    level = true + iron + true @ soft.T + noise
    return np.hstack([level, np.full((len(heading), 1), 4e-5)])


def test_coefficients_are_those_of_small_errors():
    """What (3.43) and (3.44) do to the needle, errors so small that their squares are nothing.

    Wrong: the thesis's indices in (3.51), or the sign that it leaves out.
    """
    heading = np.radians(np.arange(0.0, 360.0, 30.0))
    found = swing(fields(heading, 1e-4 * SOFT, 1e-4 * IRON), heading, "made")
    np.testing.assert_allclose(found.soft_iron, 1e-4 * (SOFT - np.trace(SOFT) / 2 * np.eye(2)), atol=2e-9)
    np.testing.assert_allclose(found.hard_iron(HORIZONTAL), 1e-4 * IRON, rtol=1e-3)


def test_corrected_headings_are_right():
    """Eight headings of the rose calibrate all others. Wrong: the error at the needle's heading for that at the true
    one, which leaves 0.07 degrees."""
    rose = np.radians(np.arange(0.0, 360.0, 45.0))
    found = swing(fields(rose), rose, "made")
    heading = np.radians(np.arange(7.0, 367.0, 10.0))
    assert np.degrees(np.max(np.abs(wrap(needle(fields(heading)) - heading)))) > 2.0
    assert np.degrees(np.max(np.abs(wrap(found.corrected(needle(fields(heading))) - heading)))) < 0.04


def test_errors_of_the_coefficients_are_those_of_their_covariance():
    """200 swings of 24 headings. Wrong: the variance of a sample for that of a coefficient."""
    heading, squares = np.radians(np.arange(0.0, 360.0, 15.0)), []
    exact = swing(fields(heading), heading, "made").coefficients
    for seed in range(200):
        noise = 3e-7 * np.random.default_rng(seed).standard_normal((24, 2))
        found = swing(fields(heading, noise=noise), heading, "made")
        error = found.coefficients - exact
        squares.append(error @ np.linalg.solve(found.covariance, error) / 5.0)
    assert np.max(squares) < stats.f.ppf(1.0 - 1e-4 / 200, 5, 19)
    assert np.mean(squares) == pytest.approx(19.0 / 17.0, abs=5.0 * stats.f.std(5, 19) / np.sqrt(200.0))


@pytest.mark.parametrize("degrees", [np.zeros(60), np.linspace(0.0, 40.0, 60)])
def test_headings_on_one_side_are_refused(degrees):
    """Wrong: coefficients of headings to which nobody turned."""
    heading = np.radians(degrees)
    noise = 3e-7 * np.random.default_rng(1).standard_normal((60, 2))
    with pytest.raises(NavfmuError, match="compass rose"):
        swing(fields(heading, noise=noise), heading, "made")
