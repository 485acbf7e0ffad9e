"""Wander and gusts: stationary from the first moment, with the levels and correlations of their closed forms."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import solve_ivp

from fmus.motion.aircraft import Aircraft
from models.air import turbulence
from models.attitude import attitude
from models.motion import aircraft, wander
from models.motion.flight_plan import FlightPlan, straight
from models.processes import lags
from tests.models.native import Native

CALM = {"wander_sigma": np.zeros(3), "gust_sigma": np.zeros(3)}
SPEED = 46.3
LEGS = FlightPlan(0.65, -2.1, 1500.0, 0.7, SPEED, (straight(10.0, SPEED), straight(1e5, SPEED))).parameters()
"""Straight and level for ever."""


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Aircraft, tmp_path_factory.mktemp("aircraft"))


def linear(function, count, axis=0):
    """Matrix of a linear function of ``count`` levels on one axis."""
    columns = [function(np.repeat(np.eye(count)[:, [k]], 3, axis=1))[..., axis] for k in range(count)]
    return np.stack([np.ravel(c) for c in columns], axis=1)


def covariances(drawn, count, time_constant, period, axis):
    """Covariance of the levels as drawn, their transition over a period, and what the held noise adds in it."""
    root = linear(drawn, count, axis)
    ratio = period / time_constant
    decay = np.exp(-ratio)
    transition = linear(lambda x: lags.advance(x, np.zeros(3), ratio, decay), count, axis)
    drive = lags.advance(np.zeros((count, 3)), np.ones(3), ratio, decay)[:, axis]
    drive = drive * lags.held_drive(time_constant, period)
    return root @ root.T, transition, np.outer(drive, drive)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_levels_are_drawn_from_the_distribution_that_the_noise_keeps(axis):
    """P = Phi P Phi' + Q, to the error of holding the noise, (period / tau)^2 / 12: no sampling, so no luck.

    Draws with a wrong covariance between position and acceleration, and noise of another density, fail.
    """
    for drawn, count, tau in ((wander.stationary, 4, 10.0), (turbulence.stationary, 2, 11.5)):
        used = 1 if count == 2 and axis == 0 else count  # the gust along has one lag only
        p, phi, q = (m[:used, :used] for m in covariances(drawn, count, tau, 0.1, axis))
        np.testing.assert_allclose(phi @ p @ phi.T + q, p, atol=1e-5)
        np.testing.assert_allclose(np.diagonal(p)[0], 1.0, rtol=1e-12)


def test_wander_has_the_closed_forms_of_its_spectrum():
    """Standard deviations (1) and the autocorrelation (2) of the acceleration, from the transition itself."""
    sigma, tau = 0.24, 10.0
    p, _, _ = covariances(wander.stationary, 4, tau, 0.1, 0)
    output = linear(lambda x: np.stack(wander.deviation(x, np.full(3, sigma), tau)), 4)
    spread = output @ p @ output.T
    expected = (np.sqrt(5.0) * sigma * tau**2, sigma * tau, sigma, np.sqrt(5.0) * sigma / tau)
    np.testing.assert_allclose(np.sqrt(np.diagonal(spread)), expected, rtol=1e-12)
    for lag in (1.0, 5.0, 10.0, 20.0, 60.0):
        _, phi, _ = covariances(wander.stationary, 4, tau, lag, 0)
        x = lag / tau
        found = (output @ phi @ p @ output.T)[2, 2] / sigma**2
        assert found == pytest.approx(np.exp(-x) * (1.0 + x - 2.0 * x**2 + x**3 / 3.0), abs=1e-12)


def test_derivatives_of_the_wander_are_derivatives():
    """Against differences over a thousandth of the time constant."""
    rng = np.random.default_rng(1)
    tau, sigma, step = 8.0, np.array([0.2, 0.3, 0.1]), 0.008
    levels, held = wander.stationary(rng.standard_normal((4, 3))), rng.standard_normal(3)
    rows = []
    for _ in range(5):
        rows.append(wander.deviation(levels, sigma, tau))
        levels = lags.advance(levels, held, step / tau, np.exp(-step / tau))
    rows = np.array(rows)
    slope = (8.0 * (rows[3] - rows[1]) - (rows[4] - rows[0])) / (12.0 * step)
    np.testing.assert_allclose(slope[:3], rows[2][1:], rtol=1e-8)


def test_gusts_have_the_autocorrelation_of_dryden():
    """sigma^2 exp(-x) along and sigma^2 exp(-x) (1 - x / 2) across and down, x = |t| V / L (MIL-F-8785C)."""
    tau, sigma = 11.5, np.array([1.0, 2.0, 3.0])
    for axis in range(3):
        p, _, _ = covariances(turbulence.stationary, 2, tau, 0.1, axis)
        output = linear(lambda x: turbulence.gust(x, sigma), 2, axis)
        for lag in (0.0, 1.0, 5.0, 11.5, 23.0, 40.0):
            _, phi, _ = covariances(turbulence.stationary, 2, tau, max(lag, 1e-12), axis)
            x = lag / tau
            shape = np.exp(-x) * (1.0 if axis == 0 else 1.0 - x / 2.0)
            assert (output @ phi @ p @ output.T)[0, 0] == pytest.approx(sigma[axis] ** 2 * shape, abs=1e-9)


@pytest.mark.parametrize(("rate", "hold"), [(1.8, 30.0), (0.1, 30.0), (0.0, 30.0), (4.0, 1.0), (20.0, 30.0)])
def test_the_response_to_a_gust_solves_its_equation(rate, hold):
    """e'' + Z e' + Z/T e = Z g by an integrator, over and under critical damping, for a gust that is linear."""
    period, old, new = 0.05, 1.5, -0.7
    e, c = 0.0 * rate + (3.0 if rate else 0.0), (0.4 if rate else 0.0)

    def slope(t, state):
        gust = old + (new - old) * t / period
        return [state[1], rate * (gust - state[1]) - rate / hold * state[0]]

    expected = solve_ivp(slope, (0.0, period), [e, c], rtol=1e-12, atol=1e-14).y[:, -1]
    found = turbulence.carried(e, c, old, new, turbulence.response(np.array(rate), hold, period), hold, period)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12)


def test_lift_and_side_force_have_the_rates_of_the_book():
    """Z_down = g / (V dalpha), dalpha the angle of attack that 1 g more needs: rho V S C_L_alpha / (2 m)."""
    density, speed, area, mass = 1.05, 50.0, 16.2, 1111.0
    found = turbulence.aerodynamic_rate(density, speed, 5.14, mass * 9.80665 / area)
    assert found == pytest.approx(density * speed * area * 5.14 / (2.0 * mass), rel=1e-12)
    assert turbulence.aerodynamic_rate(density, speed, 5.14, 0.0) == 0.0


SEEDS = 400


def test_the_aircraft_wanders_with_its_sigma_from_the_first_moment(native):
    """Velocity less the plan's at t = 0 and a tau later over 400 seeds: sigma tau, and its correlation; bounds at 1e-6.

    The velocity's autocorrelation is exp(-x) (1 + x - x^3 / 3). A wander that starts at rest, axes that share their
    noise or seeds that do not matter fail.
    """
    sigma, tau = np.array([0.3, 0.2, 0.1]), 10.0
    plan = np.array([SPEED * np.cos(0.7), SPEED * np.sin(0.7), 0.0])
    parameters = {**LEGS, "gust_sigma": np.zeros(3), "wander_sigma": sigma, "wander_time": np.full(3, tau)}
    found = np.array([
        native.run(tau, tau, ["velocity_n"], {**parameters, "seed": seed})["velocity_n"] for seed in range(SEEDS)
    ])  # fmt: skip
    deviation = (found - plan) / (sigma * tau)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], SEEDS) / SEEDS
    for moment in (0, 1):
        variance = np.mean(deviation[:, moment] ** 2, axis=0)
        assert low < np.min(variance) and np.max(variance) < high
    bound = 4.9 / np.sqrt(SEEDS - 3)
    for axis in range(3):
        r = np.corrcoef(deviation[:, 0, axis], deviation[:, 1, axis])[0, 1]
        assert abs(np.arctanh(r) - np.arctanh(np.exp(-1.0) * (1.0 + 1.0 - 1.0 / 3.0))) < bound
    between = np.corrcoef(deviation[:, 0].T) - np.eye(3)
    assert np.max(np.abs(np.arctanh(between))) < bound


def test_gusts_have_their_sigma_and_hold_on_to_the_air(native):
    """Gust along, across and down at t = 0 and a length later over 400 seeds, in axes of the track; bounds at 1e-6."""
    sigma, length = np.array([1.0, 2.0, 3.0]), 463.0
    parameters = {**LEGS, "wander_sigma": np.zeros(3), "gust_sigma": sigma, "gust_length": length}
    track = attitude.dcm(0.0, 0.0, 0.7)
    found = np.array([
        native.run(10.0, 10.0, ["air_velocity_n"], {**parameters, "seed": seed})["air_velocity_n"] @ track
        for seed in range(SEEDS)
    ])  # fmt: skip
    gust = found / sigma
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], SEEDS) / SEEDS
    for moment in (0, 1):
        variance = np.mean(gust[:, moment] ** 2, axis=0)
        assert low < np.min(variance) and np.max(variance) < high
    bound = 4.9 / np.sqrt(SEEDS - 3)
    for axis, expected in enumerate((np.exp(-1.0), 0.5 * np.exp(-1.0), 0.5 * np.exp(-1.0))):
        r = np.corrcoef(gust[:, 0, axis], gust[:, 1, axis])[0, 1]
        assert abs(np.arctanh(r) - np.arctanh(expected)) < bound
    assert np.max(np.abs(np.arctanh(np.corrcoef(gust[:, 0].T) - np.eye(3)))) < bound


def test_seeds_and_streams_are_flights_of_their_own_and_repeat(native):
    record = ["velocity_n", "air_velocity_n"]
    runs = [
        native.run(60.0, 0.5, record, {**LEGS, "seed": seed, "stream": stream})
        for seed, stream in ((1, 7), (2, 7), (1, 8), (1, 7))
    ]
    for name in record:
        np.testing.assert_array_equal(runs[0][name], runs[3][name])
        for other in runs[1:3]:
            assert np.min(np.max(np.abs(runs[0][name] - other[name]), axis=0)) > 0.1


def test_the_motion_does_not_depend_on_the_communication_step(native):
    """All of it is of the aircraft's own clock, noise too."""
    record = ["latitude", "longitude", "altitude", "velocity_n", "specific_force", "rate", "heading", "sideslip"]
    fine, coarse = (native.run(60.0, step, record, {**LEGS, "wind_n": [4.0, -3.0, 0.5]}) for step in (0.01, 0.3))
    for name in record:
        np.testing.assert_array_equal(fine[name][::30], coarse[name])


def test_with_everything_off_the_nose_is_on_the_path(native):
    """Roll, pitch and heading of a climbing turn in still air are those of the plan alone, to rounding."""
    plan = FlightPlan(0.65, -2.1, 1500.0, 0.7, SPEED, (straight(10.0, SPEED), straight(100.0, 60.0, 3.0))).parameters()
    plan["segment_turn_rate"][1] = 0.03
    off = {**plan, **CALM, "wing_loading": 0.0, "zero_lift_angle": 0.0}
    run = native.run(100.0, 0.1, ["velocity_n", "roll", "pitch", "heading", "angle_of_attack", "sideslip"], off)
    v = run["velocity_n"]
    ground = np.hypot(v[:, 0], v[:, 1])
    np.testing.assert_allclose(run["pitch"], np.arctan(-v[:, 2] / ground), atol=1e-13)
    np.testing.assert_allclose(attitude.wrap(run["heading"] - np.arctan2(v[:, 1], v[:, 0])), 0.0, atol=1e-12)
    steady = run["time"] > 80.0
    np.testing.assert_allclose(run["roll"][steady], np.arctan(60.0 * 0.03 / 9.80665), atol=1e-12)
    np.testing.assert_allclose(run["angle_of_attack"], 0.0, atol=1e-12)
    np.testing.assert_allclose(run["sideslip"], 0.0, atol=1e-12)


def test_angle_of_attack_carries_the_lift(native):
    """Straight, a circle and a descent in smooth air: alpha = alpha_0 + 2 (G/S) n / (rho V^2 C_L_alpha), beta = 0.

    n is the measured load factor, so an angle that follows speed or bank alone, or the wrong way, fails.
    """
    record = ["specific_force", "true_airspeed", "angle_of_attack", "sideslip", "roll", "lift_length"]
    run = native.run(900.0, 0.1, record, {**CALM, "wind_n": [6.0, -4.0, 0.0]})
    load = -run["specific_force"][:, 2]
    expected = -0.0603 + run["lift_length"] * load / run["true_airspeed"] ** 2
    assert np.ptp(run["true_airspeed"]) > 10.0 and np.ptp(run["angle_of_attack"]) > np.radians(2.0)
    # lift is across the air's flow and the force across the body: they differ by 1 - cos(alpha + climb angle)
    np.testing.assert_allclose(run["angle_of_attack"], expected, atol=np.radians(0.1))
    np.testing.assert_allclose(run["sideslip"], 0.0, atol=1e-3)


def test_no_wing_gives_more_than_it_can(native):
    """A slow plan does not stand on its tail: alpha stays below the stall, and force and rate stay derivatives."""
    legs = (straight(10.0, SPEED), straight(1e3, 12.0, 1.0))
    slow = FlightPlan(0.65, -2.1, 500.0, 0.7, SPEED, legs).parameters()
    record = ["angle_of_attack", "pitch", "rate", "roll"]
    run = native.run(100.0, 0.01, record, {**slow, **CALM})
    assert np.max(run["angle_of_attack"]) < aircraft.STALL - 0.0603
    assert run["angle_of_attack"][-1] > 0.2
    k = np.arange(5, 9990, 10)
    turning = (run["pitch"][k + 1] - run["pitch"][k - 1]) / 0.02
    # in straight flight pitch rate is all there is, but for the turning of the earth and of the level
    assert np.max(np.abs(run["rate"][k, 1] - turning)) < 1e-4
    assert np.max(np.abs(turning)) > 5e-3


def test_gusts_show_in_lift_and_side_force(native):
    """f_y = -Z V beta, and alpha carries the lift, on straight legs in gusts across and down.

    To the second order of the angles. Gusts along change the lift by 2 u / V until the pilot has answered; that is left
    out of the force.
    """
    record = ["specific_force", "true_airspeed", "angle_of_attack", "sideslip", "lift_length", "aerodynamic_rate"]
    run = native.run(1800.0, 0.1, record, {**LEGS, "gust_sigma": (0.0, 0.3, 0.3), "wander_sigma": np.zeros(3)})
    speed, beta, alpha = run["true_airspeed"], run["sideslip"], run["angle_of_attack"]
    assert np.std(beta) > np.radians(0.2) and np.std(alpha) > np.radians(0.08)
    side = -run["aerodynamic_rate"][:, 0] * speed * beta
    assert np.std(run["specific_force"][:, 1] - side) < 0.1 * np.std(side)
    expected = -0.0603 - run["lift_length"] * run["specific_force"][:, 2] / speed**2
    assert np.std(alpha - expected) < 0.1 * np.std(alpha)


def test_airspeed_is_relative_to_wind_and_gust(native):
    record = [
        "velocity_n",
        "air_velocity_n",
        "true_airspeed",
        "roll",
        "pitch",
        "heading",
        "angle_of_attack",
        "sideslip",
    ]
    run = native.run(100.0, 0.5, record, {"wind_n": [6.0, -4.0, 0.5]})
    relative = run["velocity_n"] - run["air_velocity_n"]
    np.testing.assert_allclose(run["true_airspeed"], np.linalg.norm(relative, axis=1), rtol=1e-12)
    for k in (0, 77, 200):
        angles = (run[name][k] for name in ("roll", "pitch", "heading"))
        u, v, w = attitude.dcm(*angles).T @ relative[k]
        assert run["angle_of_attack"][k] == pytest.approx(np.arctan2(w, u), abs=1e-12)
        assert run["sideslip"][k] == pytest.approx(np.arcsin(v / np.linalg.norm(relative[k])), abs=1e-12)
