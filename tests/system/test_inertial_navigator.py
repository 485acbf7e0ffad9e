"""``navigator_inertial`` in the place of ``navigator``: within chi-square with GPS and without."""

import numpy as np
import pytest
from scipy import stats

from navfmu.faults import Fault

LOST = 300.0
SEEDS = range(1, 41)
WITH, WITHOUT = np.arange(60, 300, 60), np.array([360, *range(420, 1201, 180)])
"""Seconds at which errors are looked at, before GPS is lost and after."""
ANGLES = ("roll", "pitch", "heading")
SIGNALS = [
    "evaluation.north_error",
    "evaluation.east_error",
    *(f"navigator.position_covariance[{i}]" for i in (1, 2, 3)),
    *(f"navigator.angles.{angle}" for angle in ANGLES),
    *(f"navigator.angles.{angle}_sigma" for angle in ANGLES),
    *(f"aircraft.{angle}" for angle in ANGLES),
]


@pytest.fixture(scope="module")
def flown(load):
    """Runs by second, shape (seed, second, signal)."""
    system = load("navigator_inertial")
    jammed = [Fault("gps", "gps.jammed", "input", start=LOST)]
    runs = [system.run(seed=seed, stop=1200.0, faults=jammed, record=SIGNALS, record_period=1.0) for seed in SEEDS]
    return np.array([run.to_numpy(float) for run in runs])


def position_squares(runs):
    """Normalised squared errors of position, (seed, moment)."""
    errors = runs[..., :2]
    covariances = runs[..., [2, 3, 3, 4]].reshape(*runs.shape[:2], 2, 2)
    return np.einsum("smi,smij,smj->sm", errors, np.linalg.inv(covariances), errors)


def bounds(degrees, count, probability):
    return stats.chi2.ppf([0.5 * probability, 1.0 - 0.5 * probability], degrees * count) / count


@pytest.mark.parametrize("moments", [WITH, WITHOUT], ids=["gps", "dme"])
def test_position_is_as_wrong_as_it_says(flown, moments):
    """At each moment the 1e-4 interval of 40 flights. Noise that is taken for that of a sample each second, biases
    whose variance is lost at the first fix, or ranges without biases are outside."""
    seen = np.mean(position_squares(flown[:, moments]), axis=0)
    low, high = bounds(2, len(SEEDS), 1e-4)
    assert np.all((low < seen) & (seen < high)), seen


def test_attitude_is_as_wrong_as_it_says_without_gps(flown):
    """Each angle at 1200 s; with GPS its start by the attitude reference, which is no normal error, is still there."""
    last = flown[:, 1200]
    errors = (last[:, 5:8] - last[:, 11:14] + np.pi) % (2.0 * np.pi) - np.pi
    seen = np.mean((errors / last[:, 8:11]) ** 2, axis=0)
    low, high = bounds(1, len(SEEDS), 1e-4)
    assert np.all((low < seen) & (seen < high)), seen


def test_there_is_no_step_when_gps_is_lost(flown):
    """In the second of the loss position goes on as before: within 3 sigma of what it says, seed by seed."""
    before, after = flown[:, round(LOST) - 1, :2], flown[:, round(LOST) + 1, :2]
    sigmas = np.sqrt(flown[:, round(LOST) + 1, [2, 4]])
    assert np.all(np.abs(after - before) < 3.0 * np.sqrt(2.0) * sigmas)


def test_ranges_bound_it(flown):
    """Alone it would be 10 km off after 15 minutes; one range every 15 s, wrong by 315 m each, keeps it."""
    errors = np.hypot(*np.moveaxis(flown[:, 1200, :2], -1, 0))
    assert np.sqrt(np.mean(errors**2)) < 926.0
