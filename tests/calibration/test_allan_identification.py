"""Terms that were put in are found, and no others; intervals hold what was put in.

All are made with seeds and of three axes. Where a rate is claimed, its bound is that of the binomial distribution at
1e-6, for the number of seeds that is said.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from navfmu.calibration.allan.chart import chart
from navfmu.calibration.allan.identification import CHANCE, CONFIDENCE, identify
from navfmu.calibration.allan.terms import FLICKER, GAUSS_MARKOV, QUANTISATION, RAMP, RANDOM_WALK, TERMS, WHITE
from tests.calibration import made

SEEDS = 40
RARE = 1e-6


def found(samples):
    return identify(chart([samples], 1.0))


def held(one, term, truth):
    """How many axes have the truth in the interval of a term."""
    i = one.terms.index(term)
    return int(np.sum((one.low[i] <= truth) & (truth <= one.high[i])))


def fewest(trials, probability):
    """Successes that so many trials have at least, but for a chance of RARE."""
    return stats.binom.ppf(RARE, trials, probability)


def test_white_noise_is_white_noise_and_nothing_else():
    """Of 40 seeds, with five other terms at CHANCE each. Wrong: a term wherever the fit becomes a little better."""
    ones = [found(made.white(np.random.default_rng(seed), 0.05, 4096)) for seed in range(SEEDS)]
    others = sum(one.terms != (WHITE,) for one in ones)
    assert others <= stats.binom.isf(RARE, SEEDS, (len(TERMS) - 1) * CHANCE)
    alone = [one for one in ones if one.terms == (WHITE,)]
    inside = sum(held(one, WHITE, 0.05) for one in alone)
    assert inside >= fewest(3 * len(alone), CONFIDENCE)
    assert inside < 3 * len(alone)  # an interval that holds everything says nothing


MIXTURES = {
    "random walk": ([(made.white, 1.0), (made.walk, 0.01)], {WHITE: 1.0, RANDOM_WALK: 0.01}),
    "markov": ([(made.white, 1.0), (made.markov, 0.5, 100.0)], {WHITE: 1.0, GAUSS_MARKOV: 0.5}),
    "short process": ([(made.white, 1.0), (made.markov, 3.0, 10.0)], {WHITE: 1.0, GAUSS_MARKOV: 3.0}),
    "pulses": ([(made.pulses, 1.0), (made.white, 0.02)], {QUANTISATION: 1.0 / np.sqrt(12.0), WHITE: 0.02}),
    "flicker": ([(made.white, 1.0), (made.flicker, 0.1)], {WHITE: 1.0, FLICKER: 0.1}),
}


@pytest.mark.parametrize("name", MIXTURES)
def test_two_terms_are_found_and_held_by_their_intervals(name):
    """Ten seeds. Each term is 10 times the other at one end of the chart. Wrong: units of a sample for a second's,
    K for K / sqrt(3), Q for the pulse, B for its floor, intervals of variances for those of coefficients."""
    parts, truth = MIXTURES[name]
    inside, right = 0, 0
    for seed in range(10):
        rng = np.random.default_rng(seed)
        one = found(sum(make(rng, *numbers) for make, *numbers in parts))
        if set(one.terms) == set(truth):
            right += 1
            inside += sum(held(one, term, value) for term, value in truth.items())
    assert right >= fewest(10, 1.0 - (len(TERMS) - 2) * CHANCE)
    assert inside >= fewest(6 * right, CONFIDENCE)


def test_a_ramp_is_found():
    """R within 0.11: at 2048 s noise is sigma / (R T^1.5) = 0.054 of the ramp. Without its root of 2 it is 0.41 off."""
    samples = made.white(np.random.default_rng(1)) + 2e-4 * np.arange(made.COUNT)[:, None]
    one = found(samples)
    assert one.terms == (WHITE, RAMP)
    np.testing.assert_allclose(one.of(RAMP), 2e-4, rtol=2.0 / (2e-4 * 2048.0**1.5))


def test_the_correlation_time_is_held_by_its_interval():
    """20 seeds of a process of 100 s in noise, one time for three axes. Wrong: the time at which the chart is highest,
    1.89 times as long."""
    inside = 0
    for seed in range(20):
        rng = np.random.default_rng(100 + seed)
        _, low, high = found(made.white(rng) + made.markov(rng, 0.5, 100.0)).correlation_time
        inside += low <= 100.0 <= high
    assert inside >= fewest(20, CONFIDENCE)


def test_a_random_walk_is_no_process_of_some_time_constant():
    """Of 40 seeds. Wrong: a correlation time for nothing; at one price for every term 4 of 60 were such a process."""
    others = 0
    for seed in range(SEEDS):
        rng = np.random.default_rng(2000 + seed)
        others += found(made.white(rng) + made.walk(rng, 0.01)).terms != (WHITE, RANDOM_WALK)
    assert others <= stats.binom.isf(RARE, SEEDS, (len(TERMS) - 2) * CHANCE)


def test_a_process_much_slower_than_the_recording_is_a_random_walk():
    """Section 3.3.1: the two cannot be told apart there. K = sigma sqrt(2 / tau)."""
    rng = np.random.default_rng(3)
    one = found(made.white(rng) + made.markov(rng, 10.0, 2e6))
    assert one.terms == (WHITE, RANDOM_WALK)
    assert held(one, RANDOM_WALK, 0.01) == 3


def test_a_chart_that_the_terms_do_not_make_is_said():
    """A sine, whose chart rises by 1 and falls by 1 around a tenth of its period. Of noise alone nothing is said."""
    samples = made.white(np.random.default_rng(4)) + np.sin(2.0 * np.pi * np.arange(made.COUNT) / 40.0)[:, None]
    assert found(samples).chance < CHANCE
    assert found(made.white(np.random.default_rng(4))).chance > 0.01


def test_an_axis_may_lack_a_term():
    samples = made.white(np.random.default_rng(5))
    samples[:, 1:] += made.walk(np.random.default_rng(6), 0.02)[:, 1:]
    one = found(samples)
    assert one.terms == (WHITE, RANDOM_WALK)
    assert one.of(RANDOM_WALK)[0] < 0.1 * one.of(RANDOM_WALK)[1:].min()
    np.testing.assert_array_equal(one.of(FLICKER), 0.0)
