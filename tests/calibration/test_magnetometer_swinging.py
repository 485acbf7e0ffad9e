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


def test_corrected_headings_are_as_good_as_the_coefficients_with_much_hard_iron():
    """Of 30 % of the horizontal field, all around: the third order is left, 0.3^3 / 3 rad. Wrong: two rounds of the
    needle's errors, which leave 1.4 degrees."""
    heading = np.radians(np.arange(0.0, 360.0, 5.0))
    measured = fields(heading, soft=0.0 * SOFT, iron=0.3 * HORIZONTAL * np.array([0.6, -0.8]))
    left = wrap(swing(measured, heading, "made").corrected(needle(measured)) - heading)
    assert np.max(np.abs(left)) < 1.3 * 0.3**3 / 3.0


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


def test_hard_iron_makes_no_soft_iron():
    """Hard iron of a fifth of the horizontal field, and nothing else. Wrong: its square, 2 %, as soft iron."""
    heading = np.radians(np.arange(0.0, 360.0, 10.0))
    found = swing(fields(heading, 0.0 * SOFT, HORIZONTAL * np.array([0.16, -0.12])), heading, "made")
    np.testing.assert_allclose(found.soft_iron, np.zeros((2, 2)), atol=1e-3)  # orders beyond the third are left


def test_hard_iron_that_the_series_does_not_hold_is_refused():
    """Two fifths of the horizontal field in half of the rose are 10 degrees off in the other half, and more than all of
    it is no series. Wrong: a sigma of 0.2 degrees, that of noise."""
    iron, noise = np.array([8e-6, -6e-6]), 1e-7 * np.random.default_rng(1).standard_normal((36, 2))
    half, rose = np.radians(np.arange(0.0, 180.0, 5.0)), np.radians(np.arange(0.0, 360.0, 10.0))
    for heading, size in ((half, 1.0), (rose, 3.5)):
        with pytest.raises(NavfmuError, match="compass rose"):
            swing(fields(heading, 0.0 * SOFT, size * iron, noise), heading, "made")
    assert swing(fields(rose, 0.0 * SOFT, iron, noise), rose, "made").coefficients[1] < -0.3


def test_errors_that_follow_the_heading_make_wider_covariances():
    """A sine of three times the heading is left. Wrong: as many independent errors as there are samples."""
    heading = np.radians(np.tile(np.arange(0.0, 360.0, 3.0), 4))
    np.random.default_rng(2).shuffle(heading)
    more = HORIZONTAL * 0.02 * np.sin(3.0 * heading)[:, None]
    white = HORIZONTAL * 0.02 / np.sqrt(2.0) * np.random.default_rng(3).standard_normal((480, 1))
    wide, narrow = (
        np.sqrt(np.max(np.diag(swing(fields(heading, noise=one), heading, "made").covariance))) for one in (more, white)
    )
    assert wide > 3.0 * narrow
