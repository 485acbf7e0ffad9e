"""DME: geometry, the schedule of Fig 2.10, coverage, and errors that do not depend on the schedule."""

import numpy as np
import pymap3d
import pytest
from scipy import stats

from fmus.radio.dme import Dme
from models.radio import dme
from navfmu.constants import RADIO_EARTH_RADIUS
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret

HERE = {"latitude": np.radians(37.75), "longitude": np.radians(-121.6), "altitude": 1500.0}
SPEED = 46.3
FLYING = {**HERE, "velocity_n": (SPEED, 0.0, 0.0)}
RANGES = "ranging.slant_range"


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Dme, tmp_path_factory.mktemp("dme"))


def five_stations(distance=30e3):
    """Parameters of five stations around HERE."""
    bearing = np.radians(np.arange(5) * 72.0)
    return {
        "station_count": 5,
        "station_latitude": HERE["latitude"] + distance * np.cos(bearing) / 6.37e6,
        "station_longitude": HERE["longitude"] + distance * np.sin(bearing) / 6.37e6 / np.cos(HERE["latitude"]),
        "station_altitude": np.full(5, 100.0),
    }


def true_ranges(run):
    return dme.slant_range(
        HERE["latitude"],
        HERE["longitude"],
        HERE["altitude"],
        *(run.get(f"station_{name}") for name in ("latitude", "longitude", "altitude")),
    )


def follow(run, stop, step=1.0):
    """Times, which were measured, and readings of each new publication."""
    found, seen = [], run.get("ranging.sequence")
    for _ in range(round(stop / step)):
        run.do_step(run.time, step)
        if run.get("ranging.sequence") != seen:
            seen = run.get("ranging.sequence")
            found.append((run.time, np.flatnonzero(run.get("ranging.measured")).tolist(), run.get(RANGES)))
    return found


# --- equations -------------------------------------------------------------------------------------------------------


def test_slant_range_is_the_straight_line_between_points_of_the_ellipsoid():
    rng = np.random.default_rng(1)
    lat, lon, alt = rng.uniform(-1.3, 1.3), rng.uniform(-3, 3), 3000.0
    lats, lons, alts = lat + rng.uniform(-0.03, 0.03, 5), lon + rng.uniform(-0.03, 0.03, 5), rng.uniform(0, 2000, 5)
    a = np.array(pymap3d.geodetic2ecef(lat, lon, alt, deg=False))
    b = np.array(pymap3d.geodetic2ecef(lats, lons, alts, deg=False))
    expected = np.linalg.norm(b - a[:, None], axis=0)
    np.testing.assert_allclose(dme.slant_range(lat, lon, alt, lats, lons, alts), expected, atol=1e-6)


def test_correlation_time_is_half_a_nautical_mile_of_flight():
    assert dme.correlation_time(np.array([30.0, 40.0, 5.0]), 5.0) == pytest.approx(926.0 / 50.0)
    assert dme.correlation_time(np.zeros(3), 5.0) == pytest.approx(926.0 / 5.0)


def test_horizon_is_the_tangent_over_four_thirds_of_the_earth():
    reach = dme.horizon(1500.0, np.array([0.0, 1000.0]), 10.0)
    tangent = np.sqrt((RADIO_EARTH_RADIUS + 1500.0) ** 2 - RADIO_EARTH_RADIUS**2)
    assert reach[0] - np.sqrt(2 * RADIO_EARTH_RADIUS * 10.0) == pytest.approx(tangent, rel=1e-3)
    assert reach[1] > reach[0]
    assert np.all(np.isfinite(dme.horizon(-50.0, np.array([-30.0]), 10.0)))


def test_dilution_of_two_lines_and_of_the_triangle():
    """Two lines crossing at gamma: sqrt(2) / sin(gamma). Three 120 degrees apart: 2 / sqrt(3), thesis Fig 7.2."""
    yes = np.array([True, True])
    for gamma in np.radians([90.0, 60.0, 20.0]):
        hdop = dme.dilution(np.array([1.0, np.cos(gamma)]), np.array([0.0, np.sin(gamma)]), yes)
        assert hdop == pytest.approx(np.sqrt(2.0) / np.sin(gamma))
    angles = np.radians([0.0, 120.0, 240.0])
    assert dme.dilution(np.cos(angles), np.sin(angles), np.ones(3, bool)) == pytest.approx(2.0 / np.sqrt(3.0))
    assert dme.dilution(np.cos(angles), np.sin(angles), np.array([True, False, False])) == 99.0
    assert dme.dilution(np.array([1.0, 1.0]), np.zeros(2), yes) == 99.0


# --- schedule --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mode", "count", "expected"),
    [
        (1, 2, [(15, [0]), (30, [1]), (45, [0]), (60, [1])]),
        (1, 3, [(15, [0]), (30, [1]), (45, [2]), (60, [0])]),
        (2, 2, [(15, [0, 1]), (30, [0, 1]), (45, [0, 1]), (60, [0, 1])]),
        (2, 5, [(15, [0, 1]), (30, [2, 3]), (45, [0, 4]), (60, [1, 2])]),
    ],
)
def test_receivers_take_the_stations_by_the_schedule(mode, count, expected):
    run = interpret(Dme, **FLYING, **(five_stations() | {"station_count": count}), mode=mode)
    assert [(t, m) for t, m, _ in follow(run, 60.0)] == expected


def test_a_scanning_receiver_measures_every_second_once_locked_in():
    run = interpret(Dme, **FLYING, **five_stations(), mode=3)
    found = follow(run, 12.0)
    assert [t for t, _, _ in found] == list(range(1, 13))
    assert [m for _, m, _ in found] == [[]] * 4 + [[0, 1, 2, 3, 4]] * 8


def test_the_schedule_does_not_depend_on_the_communication_step():
    found = {step: follow(interpret(Dme, **FLYING, **five_stations()), 60.0, step) for step in (0.25, 1.0, 5.0)}
    for step in (1.0, 5.0):
        assert [(t, m) for t, m, _ in found[step]] == [(t, m) for t, m, _ in found[0.25]]
        for (_, _, readings), (_, _, expected) in zip(found[step], found[0.25], strict=True):
            np.testing.assert_array_equal(readings, expected)


def test_a_station_that_was_off_during_lock_in_gives_no_range():
    """Fig 2.10, 4 s of lock-in and 1 s of ranging: on air 5 s before the measurement is enough, 4 s is not."""
    for on_air, expected in ((10.0, [0]), (11.0, [])):
        run = interpret(Dme, **FLYING)
        run.set("station_off", [True] + [False] * 4)
        for k in range(15):
            if k == on_air:
                run.set("station_off", [False] * 5)
            run.do_step(float(k), 1.0)
        assert np.flatnonzero(run.get("ranging.measured")).tolist() == expected
        assert run.get("ranging.valid") is bool(expected)
        assert run.get("ranging.sequence") == 1  # announced in any case
        assert run.get("ranging.time_of_validity") == 15.0


def test_an_interval_shorter_than_lock_in_and_ranging_is_refused():
    with pytest.raises(NavfmuError, match=r"interval 4 s is shorter than lock_in 4 s plus ranging_time 1 s"):
        interpret(Dme, interval=4.0)
    interpret(Dme, interval=4.0, mode=3)


@pytest.mark.parametrize("period", [0.7, 2.0, 3.0, 60.0])
def test_an_interval_that_is_long_enough_in_no_whole_steps_is_refused(period):
    """A turn of 5 s has seven steps of 0.7 s, which are 4.9 s. Catches receivers of which nothing is ever heard."""
    with pytest.raises(NavfmuError, match=f"in whole steps of ranging_period {period:g} s"):
        interpret(Dme, interval=5.0, ranging_period=period)
    if period < 5.0:
        run = interpret(Dme, **FLYING, **five_stations(), interval=5.0 + period, ranging_period=period)
        found = [m for _, m, _ in follow(run, 60.0 * period, period)]
        assert found == [[k % 5] for k in range(len(found))] and len(found) > 5


# --- coverage --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "measured"),
    [
        ({}, 5),
        ({"station_range": np.array([29e3, 29e3, 60e3, 60e3, 60e3])}, 3),
        ({"altitude": 10.0, "antenna_height": 0.0, "station_altitude": np.zeros(5)}, 0),
        ({"station_off": [False, True, False, False, False]}, 4),
        ({"station_count": 2}, 2),
    ],
)
def test_only_stations_in_reach_answer(change, measured):
    run = interpret(Dme, **{**FLYING, **five_stations(), "mode": 3, **change})
    run.do_step(0.0, 10.0)
    assert np.count_nonzero(run.get("ranging.measured")) == measured
    assert run.get("ranging.valid") is (measured > 0)


# --- errors ----------------------------------------------------------------------------------------------------------


def test_the_bias_does_not_depend_on_the_schedule(native):
    """The same seed gives the same bias in all three modes: one reading is the same bit for bit."""
    parameters = {**five_stations(), "noise_sigma": 0.0, "seed": 11}
    readings = {}
    for mode in (1, 2, 3):
        ranges = native.run(15.0, 15.0, [RANGES], {**parameters, "mode": mode}, lambda t: FLYING)[RANGES]
        readings[mode] = ranges[-1]
    assert readings[1][0] == readings[2][0] == readings[3][0]
    assert readings[2][1] == readings[3][1]
    assert readings[1][1] == 0.0  # not its turn yet


def test_the_bias_has_the_variance_and_correlation_of_3_38(native):
    """Samples 5 tau apart: chi-square on 315 m; steps of 1 s: chi-square on sigma^2 (1 - phi^2). Bounds at 1e-6."""
    parameters = {**five_stations(), "noise_sigma": 0.0, "mode": 3}
    run = interpret(Dme, **FLYING, **five_stations())
    readings = native.run(20000.0, 1.0, [RANGES], parameters, lambda t: FLYING if t == 0.0 else {})[RANGES]
    bias = (readings - true_ranges(run))[10:]
    sparse = bias[::100]
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], sparse.size) / sparse.size
    assert low < np.mean(sparse**2) / dme.BIAS_SIGMA**2 < high
    phi = np.exp(-SPEED / 926.0)
    driving = (bias[1:] - phi * bias[:-1]).ravel()
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], driving.size) / driving.size
    assert low < np.mean(driving**2) / (dme.BIAS_SIGMA**2 * (1.0 - phi**2)) < high
    # stations are independent: correlation of their driving noise
    matrix = np.corrcoef((bias[1:] - phi * bias[:-1]).T)
    assert np.max(np.abs(matrix - np.eye(5))) < 5.3 / np.sqrt(len(bias))


def test_the_bias_is_stationary_from_the_first_reading(native):
    first = np.array(
        [
            native.run(5.0, 5.0, [RANGES], {**five_stations(), "mode": 3, "seed": seed}, lambda t: FLYING)[RANGES][-1]
            for seed in range(200)
        ]
    )
    error = (first - true_ranges(interpret(Dme, **FLYING, **five_stations()))).ravel()
    variance = dme.BIAS_SIGMA**2 + dme.NOISE_SIGMA**2
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], error.size) / error.size
    assert low < np.mean(error**2) / variance < high
    assert abs(np.mean(error)) < 4.9 * np.sqrt(variance / error.size)


def test_wide_band_noise_is_white(native):
    parameters = {**five_stations(), "bias_sigma": 0.0, "mode": 3}
    readings = native.run(4000.0, 1.0, [RANGES], parameters, lambda t: FLYING if t == 0.0 else {})[RANGES][10:]
    error = readings - true_ranges(interpret(Dme, **FLYING, **five_stations()))
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], error.size) / error.size
    assert low < np.mean(error**2) / dme.NOISE_SIGMA**2 < high
    assert abs(np.mean(error[1:] * error[:-1])) / dme.NOISE_SIGMA**2 < 4.9 / np.sqrt(error.size)
