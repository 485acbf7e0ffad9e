"""Navigators in the place of ``navigator`` in the backup navigator: wired the same, and honest about errors where they
model what the simulation does."""

import numpy as np
import pytest
from scipy import stats

from navfmu.faults import Fault

GPS_LOST = Fault("gps", "gps.jammed", "input", start=300.0)
SEEDS = range(1, 61)
MOMENTS = np.arange(420, 1501, 180)
"""Seconds at which errors are looked at, as those of test_consistency."""
SIGNALS = [
    "evaluation.north_error",
    "evaluation.east_error",
    *(f"navigator.position_covariance[{i}]" for i in (1, 2, 3)),
]
PRINTED = {"navigator.bias_sigma": 0.0, "navigator.innovation_gate": 0.0}


@pytest.fixture(scope="module")
def flown(load):
    """``flown(variant, mode, **parameters)``: NEES of position (seed, moment) and horizontal errors in m, m."""
    done = {}

    def fly(variant, mode=1, **parameters):
        key = variant, mode, *parameters.items()
        if key not in done:
            system = load(variant)
            given = {"wind.mean_n": [0.0, 0.0, 0.0], "dme.mode": mode, **parameters}
            runs = [
                system.run(
                    seed=seed, stop=1500.0, faults=[GPS_LOST], parameters=given, record=SIGNALS, record_period=1.0
                ).to_numpy(float)[MOMENTS]
                for seed in SEEDS
            ]
            errors, elements = np.split(np.array(runs), [2], axis=-1)
            covariances = elements[..., [0, 1, 1, 2]].reshape(*elements.shape[:2], 2, 2)
            nees = np.einsum("smi,smij,smj->sm", errors, np.linalg.inv(covariances), errors)
            done[key] = nees, np.hypot(*np.moveaxis(errors, -1, 0))
        return done[key]

    return fly


def bounds(count, probability):
    """Of the mean of so many NEES of two numbers each."""
    low, high = 0.5 * probability, 1.0 - 0.5 * probability
    return stats.chi2.ppf([low, high], 2 * count) / count


@pytest.mark.parametrize(
    ("variant", "mode"),
    [("navigator_reckoning", 1), ("navigator_full", 1), ("navigator_full", 2), ("navigator_full", 3)],
)
def test_at_every_moment_the_claim_is_what_is_seen(flown, variant, mode):
    """60 flights in a wind about a mean of 0, as these filters suppose: the 1e-4 interval of chi-square with 120
    degrees of freedom at each moment. Heading and airspeed that are forgotten after GPS, or wide-band noise taken for a
    heading, are outside."""
    nees, _ = flown(variant, mode)
    low, high = bounds(len(SEEDS), 1e-4)
    seen = np.mean(nees, axis=0)
    assert np.all((low < seen) & (seen < high)), seen


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_with_ranges_the_claim_of_full_order_is_what_is_seen(flown, mode):
    """Over all moments, which are nearly independent of one another there: the 1e-3 interval with 840 degrees."""
    nees, errors = flown("navigator_full", mode)
    low, high = bounds(nees.size, 1e-3)
    assert low < np.mean(nees) < high
    assert np.sqrt(np.mean(errors**2)) < 500.0


def test_r_as_printed_makes_the_reduced_order_boast(flown):
    """(6.40) without the biases: a NEES of 1900 where 2 are expected; with the biases as noise it is in the interval
    of each moment, though neither heading nor airspeed are states."""
    boasting, _ = flown("navigator_reduced", **PRINTED)
    assert np.mean(boasting) > 200.0
    nees, _ = flown("navigator_reduced")
    low, high = bounds(len(SEEDS), 1e-4)
    seen = np.mean(nees, axis=0)
    assert np.all((low < seen) & (seen < high)), seen


def test_what_is_a_state_is_learned(flown):
    """On the same measurements, squares of errors of the reduced order less those of full order: 3 sigma of their own
    mean over 60 flights above 0. Biases in the wrong column of H learn nothing."""
    full, reduced = (flown(variant)[1] for variant in ("navigator_full", "navigator_reduced"))
    more = np.mean(reduced**2 - full**2, axis=1)
    assert np.mean(more) > 3.0 * np.std(more, ddof=1) / np.sqrt(len(SEEDS))
