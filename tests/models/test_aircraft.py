"""The aircraft's truth: consistent with itself, on its plan whatever the wind, with a coordinated turn."""

from dataclasses import replace

import numpy as np
import pymap3d
import pytest

from evidence.strapdown import navigate
from fmus.motion.aircraft import Aircraft
from fmus.motion.flight_plans import FLIGHT_PLANS, LIVERMORE_25L, LIVERMORE_25L_COURSE
from models.attitude import attitude
from models.earth import earth
from models.motion import aircraft
from models.motion.flight_plan import FlightPlan, Segment, straight, turn
from models.processes import lags
from navfmu.constants import STANDARD_GRAVITY
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret

SIGNALS = ("latitude", "longitude", "altitude", "velocity_n", "roll", "pitch", "heading", "specific_force", "rate")
SPEED = 46.3
SMOOTH = {"wander_sigma": np.zeros(3), "gust_sigma": np.zeros(3)}
"""Nothing but the plan is flown."""


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Aircraft, tmp_path_factory.mktemp("aircraft"))


def steps_of_wind(seed: int):
    """A wind that changes in steps every 0.1 s, as the wind FMU's does, 5 m/s and 400 s."""
    rng, phi = np.random.default_rng(seed), np.exp(-0.1 / 400.0)
    values = [5.0 * rng.standard_normal(2)]
    for _ in range(22000):
        values.append(phi * values[-1] + 5.0 * np.sqrt(1 - phi**2) * rng.standard_normal(2))

    def wind(t):
        tenths = round(t / 0.1, 6)
        return {"wind_n": [*values[int(tenths)], 0.0]} if tenths.is_integer() else {}

    return wind


@pytest.fixture(scope="module")
def flight(native):
    """The shipped flight of 35 minutes in a random wind, with wander and gusts, every 10 ms."""
    return native.run(2100.0, 0.01, SIGNALS, inputs=steps_of_wind(3))


def distance(a, b):
    """Horizontal distance between two results, m."""
    north_south, east_west = earth.radii(a["latitude"])
    north = (a["latitude"] - b["latitude"]) * north_south
    east = (a["longitude"] - b["longitude"]) * east_west * np.cos(a["latitude"])
    return np.hypot(north, east)


def test_specific_force_and_rate_integrate_to_the_trajectory(native):
    """Fifteen minutes of the flight by a navigator in inertial space; measured: 0.2 mm, 0.02 mm in height, 4e-11 rad.

    Turns and a descent are in them. At this period every instant at which a derivative bends is a sample of Simpson's
    rule (the changes of speed, turn and climb end at multiples of 5 ms, noise is drawn every 0.1 s); at 10 ms the rule
    itself, which then runs across such bends, is wrong by 0.3 m after half an hour.
    """
    period, n = 0.0025, 360001
    flight = native.run(900.0, period, SIGNALS, {"update_period": period}, steps_of_wind(3))
    latitude, longitude, altitude, c_nb = navigate(
        period,
        flight["specific_force"][:n],
        flight["rate"][:n],
        flight["latitude"][0],
        flight["longitude"][0],
        flight["altitude"][0],
        flight["velocity_n"][0],
        (flight["roll"][0], flight["pitch"][0], flight["heading"][0]),
    )
    drift = distance({"latitude": latitude, "longitude": longitude}, {k: flight[k][:n] for k in SIGNALS})
    assert np.max(drift) < 0.005
    assert np.max(np.abs(altitude - flight["altitude"][:n])) < 0.001
    truth = attitude.dcm(flight["roll"][n - 1], flight["pitch"][n - 1], flight["heading"][n - 1])
    assert np.max(np.abs(c_nb @ truth.T - np.eye(3))) < 1e-9


def test_velocity_is_the_derivative_of_position(flight):
    """Over 40 ms without a draw of noise inside, where the velocity is smooth."""
    k = np.arange(0, 210000, 10)
    e = np.stack(pymap3d.geodetic2ecef(flight["latitude"], flight["longitude"], flight["altitude"], deg=False), -1)
    speed = np.linalg.norm(e[k + 4] - e[k], axis=1) / 0.04
    v = flight["velocity_n"]
    mean = (v[k] + 4.0 * v[k + 2] + v[k + 4]) / 6.0
    np.testing.assert_allclose(speed, np.linalg.norm(mean, axis=1), atol=2e-5)


def test_attitude_rates_are_the_derivative_of_attitude(flight):
    """Euler rates from the angular rate, less those of the local level, against differences over 20 ms."""
    k = np.arange(1005, 210000, 190)  # in the middle between two draws of noise
    for name, i in (("roll", 0), ("pitch", 1), ("heading", 2)):
        measured = (flight[name][k + 1] - flight[name][k - 1]) / 0.02
        expected = []
        for j in k:
            roll, pitch, heading = flight["roll"][j], flight["pitch"][j], flight["heading"][j]
            level = earth.earth_rate(flight["latitude"][j]) + earth.transport_rate(
                flight["latitude"][j], flight["altitude"][j], flight["velocity_n"][j]
            )
            rate_nb = flight["rate"][j] - attitude.dcm(roll, pitch, heading).T @ level
            expected.append(attitude.euler_rates(rate_nb, roll, pitch)[i])
        np.testing.assert_allclose(measured, expected, atol=2e-5)


def test_turns_are_coordinated_and_roll_rate_is_limited(native):
    """In still air nothing but Earth's rotation pushes sideways (below 1 mg); the lift carries the turn."""
    calm = native.run(2100.0, 0.05, SIGNALS, SMOOTH)
    assert np.max(np.abs(calm["specific_force"][:, 1])) < 0.001 * STANDARD_GRAVITY * 1.6
    turning = np.abs(calm["roll"]) > 0.1
    assert 0.2 < np.mean(turning) < 0.9
    load = np.linalg.norm(calm["specific_force"], axis=1)[turning] * np.cos(calm["roll"][turning])
    assert np.max(np.abs(load / 9.80 - 1.0)) < 0.06
    rate = np.diff(calm["roll"]) / 0.05
    assert 0.04 < np.max(np.abs(rate)) < np.radians(5.0) * 1.02
    # no jump in the roll rate either: it needs at least a second from rest to its greatest value
    assert np.max(np.abs(np.diff(rate))) < 0.05 * np.radians(5.0) * 3.0


def test_the_wind_turns_the_nose_and_not_the_track(native, flight):
    calm = native.run(2100.0, 0.1, SIGNALS)
    for name in ("latitude", "longitude", "altitude", "velocity_n"):
        np.testing.assert_array_equal(calm[name], flight[name][::10])
    assert np.max(np.abs(calm["heading"] - flight["heading"][::10])) > 0.02


def test_crab_angle_settles_on_the_wind_triangle():
    """Flying north, 10 m/s of wind from the west set in: the nose goes left by asin(10 / airspeed)."""
    run = interpret(Aircraft, initial_track=0.0, segment_turn_rate=0.0, update_period=0.05, plan_period=1.0, **SMOOTH)
    assert run.get("heading") == 0.0
    run.set("wind_n", (0.0, 10.0, 0.0))
    run.do_step(0.0, 20.0)
    assert run.get("heading") == pytest.approx(-np.arctan2(10.0, run.get("velocity_n")[0]), abs=2e-6)


def test_crab_angle_starts_at_its_steady_value(native):
    """In a steady wind the heading does not move while the track does not."""
    wind = {"wind_n": [-6.0, 8.0, 0.0]}
    steady = native.run(30.0, 0.1, SIGNALS, {**SMOOTH, **wind})
    assert np.ptp(steady["heading"]) < 1e-9
    north, east = steady["velocity_n"][0, :2] - wind["wind_n"][:2]
    assert steady["heading"][0] == pytest.approx(np.arctan2(east, north), abs=1e-9)
    assert abs(np.arctan2(east, north) - np.arctan2(*steady["velocity_n"][0, 1::-1])) > 0.1


def test_the_wind_is_felt_through_two_equal_lags():
    """The step response of tau^2 c'' + 2 tau c' + c = u, and its exactness for any period with u linear."""
    tau, period = 1.25, 0.4
    decay = np.exp(-period / tau)
    c, rate = 0.0, 0.0
    for k in range(1, 20):
        c, rate = lags.follow(c, rate, 1.0, 1.0, period, tau, decay)
        x = k * period / tau
        assert c == pytest.approx(1.0 - np.exp(-x) * (1.0 + x), abs=1e-13)
        assert rate == pytest.approx(x * np.exp(-x) / tau, abs=1e-13)
    c = rate = 0.0
    for k in range(200):
        c, rate = lags.follow(c, rate, 0.1 * k, 0.1 * (k + 1), period, tau, decay)
    assert c == pytest.approx(0.1 * 200 - 2 * tau * 0.1 / period, abs=1e-9)


def test_smooth_step_has_exact_derivatives_and_integral():
    t = np.linspace(-0.5, 8.0, 3001)
    value, first, second, integral = aircraft.change(t, 2.0, -3.0, 5.0)
    h = t[1] - t[0]
    np.testing.assert_allclose(np.gradient(value, h)[2:-2], first[2:-2], atol=3e-5)
    np.testing.assert_allclose(np.gradient(first, h)[2:-2], second[2:-2], atol=1e-3)
    np.testing.assert_allclose(np.gradient(integral, h)[2:-2], value[2:-2], atol=1e-5)
    assert value[0] == 2.0 and value[-1] == pytest.approx(-1.0)
    assert np.max(np.abs(first)) == pytest.approx(aircraft.PEAK * 3.0 / 5.0, rel=1e-5)


def test_trajectory_does_not_depend_on_the_update_period(native):
    fine, coarse = (
        native.run(700.0, 0.1, SIGNALS, parameters={**SMOOTH, "update_period": period, "plan_period": 0.1})
        for period in (0.01, 0.1)
    )
    assert np.max(distance(fine, coarse)) < 1e-3
    np.testing.assert_allclose(fine["rate"], coarse["rate"], atol=1e-9)


def test_the_fmu_flies_what_the_plan_says(native):
    plan = FLIGHT_PLANS["livermore"].sample()
    whole = native.run(2100.0, 1.0, SIGNALS, SMOOTH)
    assert np.max(distance(plan, whole)) < 0.01
    np.testing.assert_allclose(plan["velocity_n"], whole["velocity_n"], atol=1e-9)


def test_livermore_flight_is_the_one_of_the_thesis():
    plan = FLIGHT_PLANS["livermore"]
    path = plan.sample()
    assert plan.duration == pytest.approx(2100.0)
    assert path["latitude"][-1] == pytest.approx(LIVERMORE_25L[0], abs=1e-9)
    assert path["longitude"][-1] == pytest.approx(LIVERMORE_25L[1], abs=1e-9)
    assert path["track"][-1] == pytest.approx(LIVERMORE_25L_COURSE, abs=1e-9)
    turned = np.abs(np.diff(path["track"]))
    assert np.sum(turned[:1300]) > 4 * 2 * np.pi  # four full circles at least, before 22 minutes
    east, north, _ = pymap3d.geodetic2enu(
        path["latitude"],
        path["longitude"],
        path["altitude"],
        np.radians(37.6934),
        np.radians(-121.8204),
        122.0,
        deg=False,
    )
    assert np.mean(east[:1300]) / 1852.0 == pytest.approx(16.0, abs=1.5)
    assert np.mean(north[:1300]) / 1852.0 == pytest.approx(6.0, abs=1.0)
    straight_in = path["time"] > 1610.0
    assert np.max(turned[straight_in[1:]]) < 1e-9
    np.testing.assert_allclose(np.hypot(*path["velocity_n"][:, :2].T), 90 * 1852 / 3600, rtol=1e-9)


def test_straight_in_approach_is_the_one_of_the_thesis():
    path = FLIGHT_PLANS["straight_in"].sample()
    start = (path["latitude"][0], path["longitude"][0], 0.0)
    length = np.linalg.norm(pymap3d.geodetic2enu(*start, *LIVERMORE_25L, 0.0, deg=False))
    assert length / 1852.0 == pytest.approx(50.0, abs=0.1)
    level = path["time"] > path["time"][-1] - 1.9 * 1852.0 / 46.3
    np.testing.assert_allclose(path["altitude"][level], 800 * 0.3048, atol=6.0)


def test_a_turn_turns_by_its_angle():
    plan = FlightPlan(0.6, 0.1, 500.0, 1.0, SPEED, (straight(20, SPEED), turn(2.0, 0.03, SPEED), straight(30, SPEED)))
    assert plan.sample()["track"][-1] == pytest.approx(3.0, abs=1e-12)


def test_a_plan_moves_to_where_it_should_end():
    plan = replace(FLIGHT_PLANS["livermore"], latitude=0.3, longitude=1.0).ending_at(-0.7, 2.5)
    end = plan.sample()
    assert (end["latitude"][-1], end["longitude"][-1]) == pytest.approx((-0.7, 2.5), abs=1e-11)


def test_a_plan_that_changes_everything_is_still_consistent(native):
    """Accelerating, climbing and turning at once, near the limits: differences of velocity give the specific force."""
    segments = (
        Segment(30.0, SPEED),
        Segment(120.0, 70.0, np.radians(3.0), 5.0),
        Segment(90.0, 50.0, np.radians(-3.0), -4.0),
        Segment(60.0, 50.0),
    )
    plan = FlightPlan(-0.8, 3.0, 800.0, 2.0, SPEED, segments)
    r = native.run(300.0, 0.01, SIGNALS, parameters=plan.parameters(), inputs=steps_of_wind(8))
    k = np.arange(5, 29990, 50)  # in the middle between two draws of noise
    v = r["velocity_n"]
    slope = (8.0 * (v[k + 1] - v[k - 1]) - (v[k + 2] - v[k - 2])) / 0.12
    for i, j in enumerate(k):
        c_nb = attitude.dcm(r["roll"][j], r["pitch"][j], r["heading"][j])
        turning = 2 * earth.earth_rate(r["latitude"][j]) + earth.transport_rate(
            r["latitude"][j], r["altitude"][j], v[j]
        )
        gravity = np.array([0.0, 0.0, earth.gravity(r["latitude"][j], r["altitude"][j])])
        expected = c_nb.T @ (slope[i] + np.cross(turning, v[j]) - gravity)
        # the gust is taken as linear over half a period: Z h^2 / 48 times its second derivative, some 1e-6 m/s2
        np.testing.assert_allclose(r["specific_force"][j], expected, atol=5e-6)
    n = 29999
    start = (r["latitude"][0], r["longitude"][0], r["altitude"][0], v[0])
    latitude, longitude, altitude, _ = navigate(
        0.01, r["specific_force"][:n], r["rate"][:n], *start, (r["roll"][0], r["pitch"][0], r["heading"][0])
    )
    assert np.max(distance({"latitude": latitude, "longitude": longitude}, {q: r[q][:n] for q in SIGNALS})) < 0.05
    assert np.max(np.abs(altitude - r["altitude"][:n])) < 0.01


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"segment_duration[1]": 0.0}, "gap"),
        ({"segment_duration[3]": 0.0}, "gap"),
        ({"segment_duration[1]": 2.0, "segment_turn_rate[1]": 0.05}, "shorter than the transition"),
        ({"segment_speed[2]": 1.0}, "below 5 m/s"),
        ({"update_period": 0.03}, "whole multiple of update_period 0.03"),
        ({"initial_latitude": 1.6}, "initial_latitude"),
    ],
)
def test_impossible_plans_are_refused_with_a_sentence(values, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        interpret(Aircraft, **values)


def test_impossible_plans_are_refused_when_written():
    with pytest.raises(ValueError, match="segment 2 of the flight plan lasts 2 s"):
        FlightPlan(0.6, 0.1, 500.0, 1.0, SPEED, (straight(20, SPEED), Segment(2.0, 60.0), straight(30, SPEED)))
    with pytest.raises(ValueError, match="1 to 24 segments, this one has 0"):
        FlightPlan(0.6, 0.1, 500.0, 1.0, SPEED, ())
