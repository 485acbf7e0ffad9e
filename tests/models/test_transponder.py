"""DME transponders: delay, load, replies, and the rates of thesis section 2.5.5."""

import numpy as np
import pytest

from evidence.sensors.dme import play
from models.radio import interrogator, transponder


def test_a_radar_mile():
    """12.36 us to and fro over a nautical mile, the figure of every handbook; catches the one-way time."""
    assert transponder.range_of(12.36e-6) == pytest.approx(1852.0, rel=0.005 / 12.36)
    assert transponder.range_of(1e-6) / 1852.0 == pytest.approx(0.081, abs=0.0005)


def test_a_hundred_aircraft_are_the_capacity():
    """95 that track and 5 that search, thesis section 2.5.5: 3050 pulse pairs of 3000."""
    assert transponder.load(100.0) == pytest.approx(95 * 25 + 5 * 135)
    assert transponder.load(98.0) < transponder.CAPACITY < transponder.load(99.0)


@pytest.mark.parametrize("rate", [500.0, 1500.0, 2500.0, 5000.0, 8000.0])
def test_replies_are_those_of_a_transponder_that_is_played_pulse_by_pulse(rate):
    """Poisson arrivals: 5 standard errors of a share of so many (dead time makes it less). Away from the corner, where
    windows of 0.1 s with more and less than the capacity would be averaged. Catches exp(-rate dead), and a sum of both
    losses."""
    expected = transponder.efficiency(rate)
    assert abs(play(rate, 200.0) - expected) < 5.0 * np.sqrt(expected * (1.0 - expected) / (rate * 200.0)) + 2e-4


def test_both_limits():
    assert transponder.efficiency(0.0) == 1.0
    assert transponder.efficiency(6000.0) == pytest.approx(0.5)
    assert transponder.efficiency(1000.0, dead_time=0.0) == 1.0


def test_precise_errors_are_those_of_annex_10():
    """Table B, 95 %: 250 m at 20 nmi, 85 m at 5 nmi, 30 m at the threshold."""
    nmi = np.array([20.0, 5.0, 0.0])
    np.testing.assert_allclose(2.0 * transponder.precise_sigma(nmi * 1852.0), [250.0, 85.0, 30.0])


def test_a_station_may_be_asked_twice_a_minute():
    """Fig 2.10: 4 s of lock-in and a second of ranging are 565 pulse pairs, a minute of tracking is 1500."""
    rates = interrogator.rate(np.array([True, True, False]), np.array([0.0, 4.0, 9.0]), np.zeros(3), 4.0)
    assert rates.tolist() == [135.0, 25.0, 0.0]
    dwell = 4.0 * rates[0] + 1.0 * rates[1]
    assert dwell == 565.0 and 2.0 * dwell <= 60.0 * 25.0 < 3.0 * dwell
    assert interrogator.rate(True, 0.0, 30.0, 4.0) == 30.0  # Annex 10, after 30 s


def test_the_share_of_replies_has_the_variance_of_an_average_of_chances():
    """Played: 25 interrogations a second, each answered with 0.7, averaged over 2 s. Variance p (1 - p) / 100, from
    4000 averages after 10 s (which have all but exp(-10) of it): within 5 standard errors, 11 %. Catches a window of
    2 s that is even, of 50 interrogations, with twice the variance."""
    rng = np.random.default_rng(5)
    keep = np.exp(-1.0 / (25.0 * 2.0))
    average = np.full(4000, 0.7)
    for _ in range(250):
        average = keep * average + (1.0 - keep) * (rng.random(4000) < 0.7)
    found = np.var(average)
    spread = np.var(interrogator.replied(0.7, 25.0, 2.0, rng.standard_normal(4000)))
    assert found == pytest.approx(0.21 / 100.0, rel=5.0 * np.sqrt(2.0 / 4000) + 0.01)
    assert spread == pytest.approx(0.21 / 100.0, rel=5.0 * np.sqrt(2.0 / 4000))


def test_a_delay_that_drifts_is_set_right_when_it_stops():
    assert transponder.drifted(2e-7, 1e-8, 0.5) == pytest.approx(2.05e-7)
    assert transponder.drifted(2e-7, 0.0, 0.5) == 0.0
