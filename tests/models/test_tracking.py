"""What a receiver follows, and how noisily: figures of papers, closed forms, and other ways to the same numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate, signal
from scipy.linalg import expm

from models.satellite import ageing, receiver_clock, signal_power, tracking


def test_noise_and_thresholds_are_those_of_the_paper():
    """RTO MP-43, Landry: 2 m at 40 dB-Hz; lock down to 17 dB-Hz with 50 Hz and 20 dB-Hz with 250 Hz, 3 sigma, 1 Hz.

    Without the squaring loss (the second term) the thresholds are both 12.6 dB-Hz."""
    assert tracking.code_sigma(1e4, 1.0, 50.0) == pytest.approx(2.0, abs=0.1)
    found = [10.0 * np.log10(tracking.threshold(3.0, 1.0, detection)) for detection in (50.0, 250.0)]
    np.testing.assert_allclose(found, [17.2, 20.2], atol=0.05)


@pytest.mark.parametrize("spacing", [1.0, 0.5, 0.1])
def test_at_the_threshold_the_sigmas_fill_half_the_spacing(spacing):
    """Solved for C/N0 by hand, with the spacing in the wrong place it would not."""
    least = tracking.threshold(3.0, 0.5, 50.0, spacing)
    sigma = tracking.code_sigma(least, 0.5, 50.0, spacing) / tracking.CHIP
    assert 3.0 * sigma == pytest.approx(0.5 * spacing, rel=1e-12)


def test_free_space_takes_184_4_decibels():
    """From a satellite at an elevation of 5 degrees, as link budgets have it; 6 dB more at twice the distance."""
    assert signal_power.free_space_loss(signal_power.FARTHEST) == pytest.approx(184.4, abs=0.05)
    more = signal_power.free_space_loss(2e7) - signal_power.free_space_loss(1e7)
    assert more == pytest.approx(20.0 * np.log10(2.0))


def test_a_jammer_takes_a_signal_down_to_a_threshold_where_the_closed_form_says():
    """J/S = Q R_c (1 / threshold - 1 / C/N0): 32.0 dB for 45 down to 28 dB-Hz in a narrow band, 3 dB more spread."""
    signal, density = -156.5, -201.5
    for spread, told in ((1.0, 32.0), (2.0, 35.0)):
        over = 10.0 * np.log10(spread * 1.023e6 * (10**-2.8 - 10**-4.5))
        assert over == pytest.approx(told, abs=0.05)
        power = 10.0 ** (signal / 10.0)
        found = signal_power.carrier_to_noise(power, power * 10.0 ** (over / 10.0), density, spread)
        assert 10.0 * np.log10(found) == pytest.approx(28.0, abs=1e-9)


def test_a_jammer_of_a_watt_reaches_as_far_as_free_space_says():
    """1 W at 10 km: -116.4 dBW, 40 dB over a signal of -156.5 dBW."""
    assert signal_power.of_jammer(1.0, 1e4) == pytest.approx(-116.4, abs=0.05)
    assert signal_power.of_jammer(0.0, 1e4) < -390.0


LOOPS = {tracking.SECOND: (2, [np.sqrt(2.0), 1.0]), tracking.THIRD: (3, [2.4, 1.1, 1.0])}
"""Order, and the other coefficients of s^n + ... in units of the loop's frequency: Kaplan and Hegarty, table 5.6."""


@pytest.mark.parametrize("order", LOOPS)
def test_a_loop_stays_behind_as_far_as_its_differential_equation_says(order):
    """The error of a loop of 10 Hz that follows a steady acceleration or jerk, and its noise bandwidth as an integral.
    Catches the other power of w, w for B, and metres for waves."""
    power, below = LOOPS[order]
    frequency = 10.0 / {2: 0.53, 3: 0.7845}[power]
    loop = np.array([1.0, *(c * frequency ** (k + 1) for k, c in enumerate(below))])
    follows = np.concatenate([[0.0], loop[1:]])

    def passed(hertz):
        s = 2j * np.pi * hertz
        return np.abs(np.polyval(follows, s) / np.polyval(loop, s)) ** 2

    bandwidth, _ = integrate.quad(passed, 0.0, np.inf, limit=500)
    assert bandwidth == pytest.approx(10.0, rel=5e-3)
    error = signal.TransferFunction([1.0] + [0.0] * power, loop)
    time = np.linspace(0.0, 4.0, 40001)
    motion = time**power / {2: 2.0, 3: 6.0}[power]  # m, of 1 m/s2 or 1 m/s3
    _, behind, _ = signal.lsim(error, motion, time)
    expected = tracking.lag(order, 1.0, 1.0, 10.0) * 299792458.0 / 1575.42e6 / (2.0 * np.pi)
    assert behind[-1] == pytest.approx(expected, rel=1e-3)


def test_ten_g_a_second_are_15_4_degrees():
    """Kaplan and Hegarty's example: 98 m/s3, which are 185 398 degrees of L1 a s3, and 18 Hz of the third order."""
    assert np.degrees(tracking.lag(tracking.THIRD, 0.0, 98.0, 18.0)) == pytest.approx(
        0.4828 * 185398.0 / 18.0**3, rel=2e-3
    )
    assert tracking.holds(np.radians(9.8), np.radians(15.4)) and not tracking.holds(np.radians(9.9), -np.radians(15.4))


@pytest.mark.parametrize("sigma", [0.2, 0.25, 0.3, 0.35])
def test_slips_come_at_the_rate_of_a_first_passage(sigma):
    """Mean time in which a phase, doubled by the data, passes from 0 to 2 pi or -2 pi: Fokker and Planck's equation by
    quadrature; the closed form leaves out 1 / (4 r), 12 % at most. Catches a phase that is not doubled, by powers of
    ten."""
    r, bandwidth = 1.0 / (2.0 * sigma) ** 2, 10.0
    angle = np.linspace(0.0, 2.0 * np.pi, 20001)
    inner = integrate.cumulative_trapezoid(np.exp(r * (np.cos(angle) - 1.0)), angle, initial=0.0)
    time = r / (4.0 * bandwidth) * np.trapezoid(np.exp(-r * (np.cos(angle) - 1.0)) * inner, angle)
    assert tracking.slip_rate(sigma, bandwidth) * time == pytest.approx(1.0 + 0.25 / r, abs=0.06 + 0.1 / r)


def test_a_signal_is_found_again_only_after_it_was_strong_long_enough():
    """Lost at the fourth tick, strong from the sixth on: found 3 s later. A count that goes on finds it at once."""
    was, strong_for, seen = np.array(True), np.array(0.0), []
    for strong in [1, 1, 1, 0, 0, 1, 1, 0, 1, 1, 1, 1]:
        was, strong_for = tracking.locked(was, strong_for, bool(strong), bool(strong), 1.0, 3.0)
        seen.append(int(was))
    assert seen == [1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1]


def test_noise_of_the_clock_is_that_of_its_differential_equation():
    """Van Loan (1978): the matrix exponential. With S_g T^3 / 2 in place of / 3 it is off by half."""
    for period in (0.1, 1.0, 30.0):
        frequency, rate = receiver_clock.densities(2e-19, 2e-20)
        f, q = np.array([[0.0, 1.0], [0.0, 0.0]]), np.diag([frequency, rate])
        both = expm(np.block([[-f, q], [np.zeros((2, 2)), f.T]]) * period)
        expected = both[2:, 2:].T @ both[:2, 2:]
        found = receiver_clock.covariance((frequency, rate), period)
        np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_steps_of_the_clock_have_this_covariance():
    """40 000 steps: a covariance is within 4 sqrt(2 / n) = 2.8 % of the variances."""
    covariance = receiver_clock.covariance(receiver_clock.densities(2e-19, 2e-20), 1.0)
    normal = np.random.default_rng(4).standard_normal((2, 40_000))
    steps = np.array(receiver_clock.advance(0.0, 0.0, 0.0, covariance, 1.0, normal))
    scale = np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    np.testing.assert_allclose(np.cov(steps) / scale, covariance / scale, atol=4.0 * np.sqrt(2.0 / 40_000))


def test_a_clock_without_noise_runs_by_its_drift_and_by_what_it_feels():
    bias, drift = receiver_clock.advance(1e-3, 1e-7, 2e-9, np.zeros((2, 2)), 10.0, np.ones(2))
    assert (bias, drift) == (pytest.approx(1e-3 + 1.02e-6, rel=1e-12), 1e-7)


def test_seven_days_without_an_upload_are_sixty_metres():
    """AGARD CP-298, Coriat."""
    assert ageing.sigma(1.0, 7.0 * 86400.0) == pytest.approx(60.0, abs=0.02)
    assert ageing.sigma(1.0, 0.0) == 1.0
