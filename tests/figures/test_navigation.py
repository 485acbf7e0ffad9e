"""Rows T14 to T25: verdicts follow the data, and what they count is counted another way."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import integrate

from navfmu.figures import collection
from navfmu.figures.comparison import AGREES, DIFFERS, EXPLAINED
from navfmu_figures.thesis import claims, error_models, t14, t15, t16, t17, t18, t20, t21, t22, t23, t24, t25
from navfmu_figures.thesis.flown import Flown

ROWS = {row.name: row for row in collection.collection("thesis").rows}
SECONDS = np.arange(1.0, 2001.0)


def verdicts(comparisons):
    return [one.verdict for one in comparisons]


def made(scale=1.0, runs=50, stop=2100, sigma=300.0, seed=1):
    """Flights whose errors are ``scale`` times what they claim, independent from second to second."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, stop + 1.0)
    shape = (runs, len(time))
    north, east = (scale * sigma * rng.standard_normal(shape) for _ in range(2))
    ones = sigma**2 * np.ones(shape)
    return Flown(time, north, east, ones, 0.0 * ones, ones)


def test_all_rows_from_dead_reckoning_to_the_flight_are_there():
    assert {f"T{n}" for n in range(14, 26) if n != 19} <= set(ROWS)


# ---- closed forms ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time", [30.0, 400.0, 1800.0])
def test_t14_the_closed_form_is_the_double_integral_of_the_covariance(time):
    """The covariance of a Gauss-Markov process that is 0 at first, at two times, integrated numerically."""
    sigma, tau = 5.0, 400.0

    def covariance(a, b):
        return sigma**2 * (np.exp(-abs(a - b) / tau) - np.exp(-(a + b) / tau))

    expected, _ = integrate.dblquad(covariance, 0.0, time, 0.0, time, epsrel=1e-6)
    assert t14.walked(sigma, tau, np.array(time)) == pytest.approx(expected, rel=1e-5)
    assert t20.wind_alone(time) == pytest.approx(np.sqrt(2.0 * expected), rel=1e-5)


def test_t14_a_heading_that_counts_for_the_north_is_seen():
    north, east = t14.closed(SECONDS[:1800])
    right = pd.DataFrame({"nn": north, "ne": 0.0 * north, "ee": east}, index=SECONDS[:1800])
    assert set(verdicts(t14.compared(right))) == {AGREES}
    turned = right.rename(columns={"nn": "ee", "ee": "nn"})
    assert DIFFERS in verdicts(t14.compared(turned))


def test_t25_share_outside_is_that_of_draws():
    """Of an ellipse that lies askew: 200 000 draws."""
    matrix = np.array([[500.0**2, 0.6 * 500.0 * 800.0], [0.6 * 500.0 * 800.0, 800.0**2]])
    draws = np.random.default_rng(1).multivariate_normal([0.0, 0.0], matrix, 200_000)
    expected = np.mean(np.hypot(*draws.T) > t25.LIMIT)
    cell = [np.full((1, 1), x) for x in (0.0, 0.0, matrix[0, 0], matrix[0, 1], matrix[1, 1])]
    found = float(t25.outside(Flown(np.zeros(1), *cell))[0, 0])
    assert found == pytest.approx(expected, abs=4.0 * np.sqrt(0.25 / 200_000))


def test_flown_squares_are_those_of_the_inverse():
    rng = np.random.default_rng(2)
    root = rng.standard_normal((2, 2))
    matrix, error = root @ root.T, rng.standard_normal(2)
    cell = [np.full((1, 1), x) for x in (*error, matrix[0, 0], matrix[0, 1], matrix[1, 1])]
    assert Flown(np.zeros(1), *cell).squares[0, 0] == pytest.approx(error @ np.linalg.inv(matrix) @ error)


def test_first_above_is_the_first_of_all():
    sigma = pd.Series([1.0, 3.0, 2.0, 5.0], index=[10.0, 20.0, 30.0, 40.0])
    assert claims.first_above(sigma, 2.5) == 20.0
    assert claims.first_above(sigma, 9.0) == np.inf


# ---- verdicts --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("scale", "verdict"), [(1.0, AGREES), (1.3, DIFFERS), (0.7, DIFFERS)])
def test_t15_a_claim_is_neither_too_small_nor_too_large(scale, verdict):
    flown = {name: made(scale, t15.RUNS, seed=i) for i, name in enumerate(t15.METHODS)}
    assert verdicts(t15.compared(flown))[::2] == [verdict] * 3


def test_t15_an_error_beyond_half_a_mile_is_not_bounded():
    flown = {name: made(1.0, t15.RUNS, sigma=900.0, seed=i) for i, name in enumerate(t15.METHODS)}
    assert verdicts(t15.compared(flown))[1::2] == [DIFFERS] * 3


def test_t16_r_as_printed_must_boast_and_the_reduced_order_be_as_good():
    full, reduced = made(runs=t16.RUNS), made(runs=t16.RUNS, seed=2)
    printed = made(15.0, t16.RUNS, sigma=20.0, seed=3)
    flown = dict(zip(t16.SIDES, (full, reduced, printed), strict=True))
    rest = verdicts(t16.compared(flown))[1:]
    assert rest == [AGREES, AGREES, AGREES]
    flown["reduced_as_printed"] = made(runs=t16.RUNS, seed=4)
    assert verdicts(t16.compared(flown))[2] == DIFFERS
    flown["reduced"] = made(2.0, runs=t16.RUNS, seed=5)
    assert verdicts(t16.compared(flown))[:2] == [DIFFERS, DIFFERS]


def test_t17_a_useful_inertial_navigator_would_contradict():
    alone, aided, reckoned = (made(runs=t17.RUNS, sigma=s, seed=i) for i, s in enumerate((5e3, 450.0, 400.0)))
    flown = dict(zip(t17.SIDES, (alone, aided, reckoned), strict=True))
    assert verdicts(t17.compared(flown)) == [AGREES, AGREES, EXPLAINED]
    flown["inertial_alone"] = made(runs=t17.RUNS, sigma=100.0)
    assert verdicts(t17.compared(flown))[0] == DIFFERS


def test_t18_a_step_of_its_own_is_seen():
    flown = made(0.0, t18.RUNS, 1000, sigma=2.0)
    assert verdicts(t18.compared(flown)) == [AGREES, AGREES, AGREES]
    flown.north[7, 301:] += 10.0
    assert verdicts(t18.compared(flown))[0] == DIFFERS
    flown.north[:, 901:] = 50.0
    assert verdicts(t18.compared(flown))[1:] == [DIFFERS, DIFFERS]


def grown(rate):
    """Errors that pass 700 m after 555 s times a power."""
    return pd.Series(700.0 * (SECONDS / 555.0) ** rate, index=SECONDS)


def test_t20_times_decide():
    reckoned = pd.Series(7000.0 * SECONDS / 1800.0, index=SECONDS)
    inertial = {(grade, name): 30.0 * grown(2.2) for grade in t20.GRADES for name in t20.CONVENTIONS}
    inertial["tactical", "1 Hz"] = grown(2.2)
    inertial["tactical", "100 Hz"] = grown(2.2) * 0.5
    errors = t20.Errors(reckoned, inertial)
    assert verdicts(t20.tactical(errors))[:2] == [AGREES, EXPLAINED]
    assert verdicts(t20.reckoning(errors)) == [AGREES]
    assert verdicts(t20.reckoning(t20.Errors(reckoned / 3.0, inertial))) == [DIFFERS]
    inertial["tactical", "1 Hz"] = grown(2.2) * 0.7
    assert verdicts(t20.tactical(errors))[0] == DIFFERS


def test_t21_another_source_that_is_larger_is_seen():
    parts = {"wind": 3.0, "airspeed": 1.5, "heading": 1.0, "noise of heading": 0.1}
    total = float(np.sqrt(sum(x * x for x in parts.values())))
    errors = {name: pd.Series([0.0, x]) for name, x in {**parts, t21.TOTAL: total}.items()}
    assert verdicts(t21.compared(errors)) == [AGREES, AGREES]
    errors["airspeed"] = pd.Series([0.0, 5.0])
    assert verdicts(t21.compared(errors)) == [DIFFERS, DIFFERS]


def approach(north, east):
    return pd.DataFrame({"nn": north**2, "ne": 0.0 * north, "ee": east**2}, index=SECONDS)


def test_t22_the_other_way_round_differs():
    rises, falls = np.linspace(200.0, 600.0, len(SECONDS)), np.linspace(400.0, 200.0, len(SECONDS))
    assert verdicts(t22.compared(approach(rises, falls))) == [AGREES, AGREES, AGREES]
    assert verdicts(t22.compared(approach(falls, rises))) == [AGREES, DIFFERS, DIFFERS]
    assert verdicts(t22.compared(approach(10.0 * rises, falls)))[0] == DIFFERS


def test_t23_averages_decide():
    best = pd.Series(300.0, index=SECONDS)
    errors = {t23.BEST: best, t23.TWO: best + 25.0, t23.ONE: best + 50.0, t23.SLOWER: best + 50.0}
    assert set(verdicts(t23.compared(errors))) == {AGREES}
    errors[t23.TWO] = best + 60.0
    assert DIFFERS in verdicts(t23.compared(errors))


def test_t24_an_error_that_grows_on_differs():
    held = {one: pd.Series(100.0 + 9.0 * one, index=SECONDS) for one in t24.INTERVALS}
    assert set(verdicts(t24.compared(held))) == {AGREES}
    held[60.0] = pd.Series(0.5 * SECONDS, index=SECONDS)
    assert DIFFERS in verdicts(t24.compared(held))


def test_t25_shares_beyond_the_claim_differ():
    honest = made(sigma=400.0)
    wrong = made(2.0, sigma=400.0)
    assert t25.as_claimed("scanning", honest).verdict == AGREES
    assert t25.as_claimed("scanning", wrong).verdict == DIFFERS
    assert t25.leaving(made(sigma=2000.0)).verdict == AGREES
    assert t25.leaving(made(sigma=100.0)).verdict == DIFFERS


# ---- what rows fly ---------------------------------------------------------------------------------------------------


def test_the_approach_is_50_miles_and_ends_between_the_stations():
    plan = error_models.approach()
    durations, climbs = plan["segment_duration"], plan["segment_vertical_speed"]
    assert durations[0] * error_models.SPEED == pytest.approx(48.0 * 1852.0)
    assert plan["initial_altitude"] + durations[0] * climbs[0] == pytest.approx(800.0 * 0.3048)
    west, east = error_models.ABEAM["station_longitude"][:2]
    assert west < error_models.AIRPORT[1] < east
