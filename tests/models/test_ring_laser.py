"""Ring-laser gyros: Adler's equation against its mean and against small steps, dither against its integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import solve_ivp

from fmus.inertial.ring_laser import ARCSEC, RingLaser
from models.inertial import ring_laser
from tests.models.native import Native

PULSE, LOCK_IN = 2.0 * ARCSEC, 1.5e-3


def advance(phase, rate, lock_in, pulse, period):
    """How far a phase gets, rad."""
    return ring_laser.advance(np.sin(0.5 * phase), np.cos(0.5 * phase), rate, lock_in, pulse, period)[0]


RECORD = ["increment.angle", "increment.pulses"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(RingLaser, tmp_path_factory.mktemp("ring"))


@pytest.mark.parametrize("share", [-3.0, -1.001, -0.999, -0.3, 0.0, 0.5, 1.0, 1.0001, 1.5, 40.0])
@pytest.mark.parametrize("phase", [-3.1, -1.0, 0.0, 0.7, 1.5707, 3.0])
def test_a_step_is_the_solution_of_adlers_equation(share, phase):
    """scipy's DOP853 at 1e-11 a step, over parts of a beat and over many; a lost turn would be off by 2 pi."""
    gain = 2 * np.pi / PULSE

    def slope(_, psi):
        return gain * LOCK_IN * (share - np.sin(psi))

    for period in (5e-4, 1e-2, 7e-2):
        exact = solve_ivp(slope, (0.0, period), [phase], method="DOP853", rtol=1e-11, atol=1e-11).y[0, -1] - phase
        found = advance(phase, share * LOCK_IN, LOCK_IN, PULSE, period)
        assert found == pytest.approx(exact, rel=2e-8, abs=1e-6)


@pytest.mark.parametrize("share", [0.99, 1.01, 1.5, -2.0, 10.0])
def test_the_mean_rate_is_the_root(share):
    """After a second the pulses are within two of sqrt(w^2 - w_L^2); w - w_L would be off by hundreds at 1.5."""
    phase, total = 0.4, 0.0
    for _ in range(100):
        step = advance(phase, share * LOCK_IN, LOCK_IN, PULSE, 0.01)
        phase, total = phase + step, total + step
    pulses = ring_laser.beat(share * LOCK_IN, LOCK_IN) / PULSE
    assert total / (2 * np.pi) == pytest.approx(pulses, abs=2.0)


def test_without_lock_in_the_phase_counts_the_angle():
    found = advance(np.array([0.1, 2.0, -3.0]), np.array([1e-3, -2e-2, 0.0]), 0.0, PULSE, 0.5)
    np.testing.assert_allclose(found, np.pi / PULSE * np.array([1e-3, -2e-2, 0.0]), rtol=1e-10, atol=1e-12)


def test_a_locked_ring_stays_however_long():
    assert advance(0.3, 0.5 * LOCK_IN, LOCK_IN, PULSE, 100.0) == pytest.approx(np.arcsin(0.5) - 0.3, rel=1e-12)


def lost_by_lock_in(rate: float, rings=600, swing=100.0, pull=5.0) -> np.ndarray:
    """Adler's equation integrated through 12 turns of dither, each half turn with an amplitude of its own (+-20 %).

    The phase swings by 100 rad; ``rate`` is that of the ring over that of the dither.
    """
    halves, steps = 12, 2500
    rng = np.random.default_rng(2)
    h = np.pi / steps  # time in units of 1 / (2 pi f); pull is (2 pi / K) w_L
    psi = 2 * np.pi * rng.random(rings)
    free = psi.copy()
    for half in range(halves):
        size = swing * (1.0 + 0.4 * (rng.random(rings) - 0.5))
        begin = half * np.pi
        for t in begin + h * np.arange(steps):  # psi' = size sin t + rate swing - pull sin psi, by the midpoint
            move = size * (np.cos(t + h) - np.cos(t)) + rate * swing * h
            half_way = size * (np.cos(t + 0.5 * h) - np.cos(t)) + 0.5 * rate * swing * h
            move_pulled = move - h * pull * np.sin(psi + half_way - 0.5 * h * pull * np.sin(psi))
            psi, free = psi + move_pulled, free + move
    return psi - free


def test_dither_leaves_the_random_walk_of_the_formula():
    """Bounds are of chi square at 1e-6 with 600 rings, and 3 % for the Fresnel integral of a swing that ends.

    A walk that depended on the frequency of the dither, or a factor of 2 in its variance, is outside.
    """
    lost = lost_by_lock_in(0.0)
    # with K = 2 pi angles are phases; size is the peak rate of the dither in them
    sizes = 100.0 * (1.0 + 0.4 * (np.linspace(0, 1, 1001) - 0.5))
    expected = np.mean(ring_laser.random_walk(5.0, 2 * np.pi, sizes, 0.0) ** 2) * 12 * np.pi
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 600) / 600
    assert 0.97 * low < np.mean(lost**2) / expected < 1.03 * high


@pytest.mark.parametrize(("rate", "times"), [(-0.8, 1.667), (0.9, 2.294), (1.4, 0.0)])
def test_a_ring_that_turns_as_fast_as_its_dither_walks_more_and_beyond_it_not_at_all(rate, times):
    """The variance over that of a ring at rest; a walk of the same size at all rates is outside at 0.9 and 1.4.

    10 % are for the amplitudes, which are all the same in the formula.
    """
    at_rest = ring_laser.random_walk(5.0, 2 * np.pi, 100.0, 0.0) ** 2
    formula = ring_laser.random_walk(5.0, 2 * np.pi, 100.0, 100.0 * rate) ** 2
    assert formula / at_rest == pytest.approx(times, abs=1e-3)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 600) / 600
    found = np.var(lost_by_lock_in(rate)) / (at_rest * 12 * np.pi)
    assert 0.9 * low * times <= found < 1.1 * high * times + 0.05


def test_the_fmu_walks_as_the_formula_says(native):
    """500 increments of 0.1 s on three axes at a probability of 1e-6; whole pulses add less than 0.1 %."""
    pulse, lock_in, dither_rate = 0.02 * ARCSEC, 0.05, np.radians(100.0)
    run = native.run(50.0, 0.1, RECORD, {"sample_period": 0.1, "pulse": pulse, "lock_in": lock_in, "seed": 4})
    variance = lock_in**2 * pulse / (2 * np.pi * dither_rate) * 0.1
    angles = run["increment.angle"][1:]
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], angles.size)
    assert low < np.sum(angles**2) / variance < high


def test_pulses_are_whole_and_sum_to_the_angle(native):
    """With no lock-in there is no walk: the sum is never further from the angle than half a pulse."""
    run = native.run(10.0, 0.01, RECORD, {"lock_in": 0.0}, lambda t: {"rate": (0.01, -0.3, 1e-7)})
    np.testing.assert_allclose(run["increment.angle"], run["increment.pulses"] * PULSE, rtol=1e-12)
    total = np.cumsum(run["increment.angle"][1:], axis=0)
    truth = np.outer(run["time"][1:], (0.01, -0.3, 1e-7))
    assert np.max(np.abs(total - truth)) < 0.5000001 * PULSE


def test_a_fast_turn_has_no_walk(native):
    """At 120 deg/s, beyond the dither, as without lock-in; at rest it walks by tens of pulses in 10 s."""
    lock_in = 0.05
    fast, still = (native.run(10.0, 0.01, RECORD, {"lock_in": lock_in, "rate": rate}) for rate in (-2.1, 0.0))
    total = np.cumsum(fast["increment.angle"][1:], axis=0)
    assert np.max(np.abs(total + 2.1 * fast["time"][1:, None])) < 0.5000001 * PULSE
    assert np.max(np.abs(np.sum(still["increment.angle"][1:], axis=0))) > 5.0 * PULSE


def test_without_dither_slow_turning_is_not_seen_and_comes_back(native):
    """Dither off from 2 to 6 s: half the lock-in rate shows nothing, twice of it sqrt(3), then all is as before."""
    lock_in = 300.0 * ARCSEC
    inputs = {"rate": (0.5 * lock_in, 2.0 * lock_in, 0.0)}
    healthy = native.run(10.0, 0.01, RECORD, {"seed": 9}, lambda t: inputs)
    failed = native.run(10.0, 0.01, RECORD, {"seed": 9}, lambda t: {**inputs, "dither_off": 1.995 < t < 5.995})
    angle = failed["increment.angle"]
    np.testing.assert_array_equal(angle[:200], healthy["increment.angle"][:200])
    assert np.all(angle[230:601, 0] == 0.0)
    # pulses of 4 s, and one more or less at each end
    pulses = np.sum(angle[201:601, 1]) / PULSE
    assert pulses == pytest.approx(np.sqrt(3.0) * lock_in * 4.0 / PULSE, abs=2.5)
    # what has not made a pulse differs by less than one, so do increments
    assert np.max(np.abs(angle[601:] - healthy["increment.angle"][601:])) < 1.0001 * PULSE
    difference = np.cumsum(angle[601:] - healthy["increment.angle"][601:], axis=0)
    assert np.max(np.abs(difference)) < 1.0001 * PULSE
