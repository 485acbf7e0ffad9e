"""Navigators of the thesis: matrices, covariances against independent ones, what the whole family does alike."""

import numpy as np
import pymap3d
import pytest
from scipy import linalg

from fmus.navigation.navigator import Navigator
from fmus.navigation.navigator_full import SETS as FULL
from fmus.navigation.navigator_full import NavigatorFull
from fmus.navigation.navigator_reckoning import NavigatorReckoning
from fmus.navigation.navigator_reduced import SETS as REDUCED
from fmus.navigation.navigator_reduced import NavigatorReduced
from models.earth import earth
from models.filters import kalman
from models.navigation import full_order, navigator, reckoning, reduced_order
from models.radio import dme
from navfmu.derivatives import jacobian
from navfmu.export.interpreter import Interpreter
from tests.models.native import Native
from tests.models.test_navigator import (
    ALTITUDE,
    HEADING_SIGMA,
    LONGITUDE,
    SPEED,
    STATION,
    Flight,
    bundle,
    north_of_start,
    ranges_at,
)

THESIS = (NavigatorReckoning, NavigatorFull, NavigatorReduced)
AIDED = (NavigatorFull, NavigatorReduced)
FAMILY = (Navigator, *THESIS)
TABLE_7_1 = {"calibration": False, "gust_sigma": 0.0, "innovation_gate": 0.0}
NOISE, BIAS, BIAS_LENGTH = 7.4, 315.0, 926.0
LAST_FIX, STOP = 20, 250
DEGREE = np.radians(1.0)


@pytest.fixture(params=THESIS, ids=lambda component: component.layout.name)
def thesis(request):
    return request.param


@pytest.fixture(scope="module", params=FAMILY, ids=lambda component: component.layout.name)
def native(request, tmp_path_factory):
    return Native(request.param, tmp_path_factory.mktemp(request.param.layout.name))


@pytest.fixture(params=AIDED, ids=lambda component: component.layout.name)
def aided(request):
    return request.param


@pytest.fixture(params=FAMILY, ids=lambda component: component.layout.name)
def any_of_them(request):
    return request.param


# --- matrices --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_velocity_has_the_rows_of_the_dynamic_matrix(seed):
    """The first two rows of (5.13) and (6.26), at the corrected heading and airspeed; heading in degrees, a wind that
    is taken off or a dh that moves the aircraft show."""
    rng = np.random.default_rng(seed)
    v, psi = rng.uniform(30.0, 90.0), rng.uniform(-3.0, 3.0)
    errors = rng.normal(size=10) * [5.0, 5.0, 5.0, 0.1, 3.0, *[315.0] * 5]
    found = reckoning.velocity_rows(errors, v - errors[4], psi - errors[3], np.array([3.0, -2.0]))
    printed = [[0.0, 1.0, 0.0, -v * np.sin(psi), np.cos(psi)], [0.0, 0.0, 1.0, v * np.cos(psi), np.sin(psi)]]
    np.testing.assert_allclose(found, printed, atol=1e-12)
    of_wind = jacobian(reduced_order.velocity, np.zeros(2), v, psi, np.zeros(2))
    np.testing.assert_array_equal(reduced_order.velocity_rows(), of_wind)


@pytest.mark.parametrize("seed", range(5))
def test_ranges_have_their_derivatives_as_rows(seed):
    """By the project's own differentiation of the slant range; and (6.36), of ranges projected on the plane, where a
    station is as high as the aircraft."""
    rng = np.random.default_rng(seed)
    here = rng.uniform(-1.2, 1.2), rng.uniform(-3.0, 3.0), rng.uniform(0.0, 1e4)
    where = here[0] + rng.normal(size=2) * 0.005, here[1] + rng.normal(size=2) * 0.005, rng.uniform(0, 2e3, 2)
    sight = dme.line_of_sight(*here, *where)
    north, east, _ = navigator.direction_cosines(*here[:2], sight)
    up = navigator.vertical_cosine(*here[:2], sight)

    def ranges(z):
        meridian, vertical = earth.radii(here[0])
        latitude = here[0] + z[0] / (meridian + here[2])
        longitude = here[1] + z[1] / ((vertical + here[2]) * np.cos(here[0]))
        return dme.slant_range(latitude, longitude, here[2] + z[2], *where) + z[7:]

    derived = jacobian(ranges, np.zeros(9))
    np.testing.assert_allclose(full_order.range_rows(north, east, up, True), derived, atol=1e-8)
    np.testing.assert_allclose(reduced_order.range_rows(north, east), derived[:, [0, 1, 3, 4]], atol=1e-8)
    printed = full_order.range_rows(north, east, up, False)
    assert not np.any(printed[:, 3:])  # H12 of (6.35): no range tells of a bias

    level = here[0], here[1], 0.0
    e, n, _ = pymap3d.geodetic2enu(*level, here[0] + 0.001, here[1] + 0.0015, 0.0, deg=False)
    one = dme.line_of_sight(*level, *(np.array([x]) for x in (here[0] + 0.001, here[1] + 0.0015, 0.0)))
    north, east, _ = navigator.direction_cosines(*level[:2], one)
    np.testing.assert_allclose([north[0], east[0]], np.array([n, e]) / np.hypot(n, e), atol=3e-3)  # (6.36)


# --- covariances -----------------------------------------------------------------------------------------------------


def independent(states, updates, biases=True, stations=(0, 1), wide=0.8):
    """North and east sigma STOP s after a fix of an independent filter of some of the ``states`` (6.24), northbound
    with the errors of Table 7.1: matrix form, Van Loan's discrete noise, Joseph's update, geometry by pymap3d. Of the
    second order of a range it knows what the filter does: as noise that is news with the time of the wind."""
    sigmas = np.array([23.0, 5.0, 5.0, HEADING_SIGMA, 2.6, BIAS, BIAS])
    times = np.array([400.0, 400.0, 400.0, 120.0, 400.0, BIAS_LENGTH / SPEED, BIAS_LENGTH / SPEED])
    f = np.zeros((9, 9))
    f[0, [3, 6]] = f[1, 4] = 1.0
    f[1, 5] = SPEED
    f[2:, 2:] = -np.diag(1.0 / times)
    q = np.diag([0.0, (SPEED * np.radians(wide)) ** 2, *(2.0 * sigmas**2 / times)])
    p = np.diag([4.0, 4.0, 25.0, *sigmas[1:] ** 2])
    f, q, p = (matrix[np.ix_(states, states)] for matrix in (f, q, p))
    order = len(states)
    van_loan = linalg.expm(np.block([[-f, q], [np.zeros((order, order)), f.T]]))
    phi = van_loan[order:, order:].T
    noise = phi @ van_loan[:order, order:]
    before = -1e9
    for t in range(1, STOP + 1):
        p = phi @ p @ phi.T + noise
        if t not in updates:
            continue
        horizontal = p[:2, :2]
        for station in stations:
            here = north_of_start(LAST_FIX + t), LONGITUDE, ALTITUDE
            sight = -np.array(pymap3d.geodetic2ned(*(STATION[k][station] for k in STATION), *here, deg=False))
            distance = np.linalg.norm(sight)
            h = np.zeros(9)
            h[:3] = sight * [1.0, 1.0, -1.0] / distance
            h[7 + station] = biases
            across = np.array([-h[1], h[0]])
            second_order = 0.5 * (across @ horizontal @ across / distance) ** 2
            r = NOISE**2 + second_order / (1.0 - np.exp((before - t) / 400.0))
            h = h[None, states]
            gain = p @ h.T / (h @ p @ h.T + r)
            p = (np.eye(order) - gain @ h) @ p @ (np.eye(order) - gain @ h).T + r * gain @ gain.T
        before = t
    return np.sqrt(p[0, 0]), np.sqrt(p[1, 1])


ALL, SEVEN, FOUR = list(range(9)), list(range(7)), [0, 1, 3, 4]
CASES = {
    "reckoning": (NavigatorReckoning, {}, {"states": SEVEN, "stations": ()}),
    "wide band": (NavigatorReckoning, {"heading_noise": 0.2}, {"states": SEVEN, "stations": (), "wide": 0.2 / DEGREE}),
    "full": (NavigatorFull, {"bias_sigma": BIAS}, {"states": ALL}),
    "full as printed": (
        NavigatorFull,
        {**FULL["as_printed"].values, "calibration": False},
        {"states": ALL, "biases": False},
    ),
    "reduced as printed": (NavigatorReduced, REDUCED["as_printed"].values, {"states": FOUR, "wide": 0.0}),
}


@pytest.mark.parametrize(("case", "interval"), [(case, 15) for case in CASES] + [(case, 1) for case in list(CASES)[2:]])
def test_sigmas_equal_those_of_an_independent_filter(case, interval):
    """A wrong column of F or H, noise of the wrong density, a wide-band noise that is a heading, an altitude that is
    known, sigmas that are told before the ranges of their moment: 0.1 %."""
    component, parameters, independently = CASES[case]
    given = {**FULL["table_7_1"].values, "noise_sigma": NOISE, **parameters}
    flight = Flight(component=component, **given).fly(LAST_FIX, fix=True)
    flight.fly(1.0, fix=False).fly(STOP - 1.0, ranging=interval)
    updates = {t for t in range(2, STOP + 1) if (LAST_FIX + t) % interval == 0}
    expected = independent(updates=updates, **independently)
    assert (flight["north_sigma"], flight["east_sigma"]) == pytest.approx(expected, rel=1e-3)
    assert np.hypot(*flight.error()) < 2.0  # true ranges leave the estimate alone


def test_open_loop_grows_as_integrated_processes_do():
    """Half an hour: sigma sqrt(2 tau (T - tau (1 - exp(-T / tau)))) for the wind, V sigma sqrt(T) for wide-band noise
    of heading. One that lets the wind's error decay without new noise has a limit."""
    known = {"heading_sigma": 0.0, "airspeed_sigma": 0.0, "step": 1.0, "component": NavigatorReckoning}
    tau, stop = 400.0, 1800.0
    alone = {"wind": {"heading_noise": 0.0}, "noise": {"wind_sigma": 0.0}}
    grown = {
        "wind": 5.0 * np.sqrt(2.0 * tau * (stop - tau * (1.0 - np.exp(-stop / tau)))),
        "noise": SPEED * np.radians(0.8) * np.sqrt(stop),
    }
    for name, parameters in alone.items():
        flight = Flight(fix_sigma=1e-3, **TABLE_7_1, **known, **parameters)
        flight.fly(2.0, fix=True).fly(1.0, fix=False).fly(stop - 1.0)
        assert flight["east_sigma"] == pytest.approx(grown[name], rel=2e-3)


@pytest.mark.parametrize("ruffled", [0.0, 0.04])
def test_what_a_gust_does_to_the_speed_does_not_make_the_airspeed_forget(ruffled):
    """Five minutes of an airspeed that is 4 % more and less in turns, and its sigma with it: the closed form of a
    steady one. Where a larger sigma adds noise whatever the reason, 43 % of it are left."""
    known = {"wind_sigma": 0.0, "heading_sigma": 0.0, "heading_noise": 0.0, "gust_sigma": 0.0, "velocity_sigma": 1e3}
    flight = Flight(component=NavigatorReckoning, step=1.0, fix_sigma=1e-3, **known)
    flight.fly(1.0, fix=True).fly(1.0, fix=False).fly(300.0, ruffled=ruffled)
    expected = 2.6 * np.sqrt(800.0 * (301.0 - 400.0 * (1.0 - np.exp(-301.0 / 400.0))))
    assert flight["north_sigma"] == pytest.approx(expected, rel=0.01)


def test_six_hours_leave_a_covariance_that_is_one(native):
    """GPS for a minute, then two ranges every second, whose noise is 1 cm, and heading that comes and goes: the
    smallest eigenvalue of the correlation matrix stays above 0 and no variance is below it. Looked at every minute."""

    def inputs(t):
        k = round(t) + 1
        there = north_of_start(200.0 * np.sin(k / 200.0))  # up and down the meridian, 9 km each way
        heading = 0.0 if np.cos(k / 200.0) > 0.0 else np.pi
        values = bundle("attitude", k, k, k % 977 > 5, heading=heading, yaw_rate=0.0, heading_sigma=HEADING_SIGMA)
        speed = SPEED * abs(np.cos(k / 200.0))
        values |= bundle("air", k, k, true_airspeed=speed, true_airspeed_sigma=2.6, pressure_altitude=ALTITUDE)
        if k <= 60:
            place = {"latitude": there, "longitude": LONGITUDE, "altitude": ALTITUDE}
            values |= bundle("fix", k, k, **place, velocity_n=(SPEED * np.cos(k / 200.0), 0.0, 0.0))
        if k == 61:
            values |= bundle("fix", k, k, False)
        if k > 61:
            slant = ranges_at(there, LONGITUDE, ALTITUDE, **STATION)
            values |= bundle("ranging", k, k, slant_range=slant, measured=[True, True, False, False, False])
        return values

    name = "upper" if "upper" in native.fields else "covariances"
    parameters = {"update_period": 1.0, "noise_sigma": 0.01}
    got = native.run(6.0 * 3600.0, 1.0, [name, "used"], parameters, inputs)
    elements = native.fields[name].shape[-1]
    matrices = kalman.unpack(got[name][60::60].reshape(-1, elements))
    variances = np.diagonal(matrices, axis1=1, axis2=2)
    assert np.all(variances > 0.0)
    scale = 1.0 / np.sqrt(variances)
    correlations = matrices * scale[:, :, None] * scale[:, None, :]
    assert np.min(np.linalg.eigvalsh(correlations)) > 1e-9
    assert got["used"][-1] > 30_000 or "reckoning" in native.description.modelName


# --- what they do alike ----------------------------------------------------------------------------------------------


def test_modes_follow_the_receiver(any_of_them):
    flight = Flight(component=any_of_them)
    assert (flight["mode"], flight["solution.valid"]) == (0, False)
    flight.fly(0.9)
    assert (flight["mode"], flight["solution.valid"]) == (0, False)
    flight.fly(9.1, fix=True)
    assert (flight["mode"], flight["solution.valid"]) == (1, True)
    flight.fly(1.0, fix=False)
    assert flight["mode"] == 2
    flight.fly(1.0, fix=True)
    assert flight["mode"] == 1
    flight.fly(3.5)
    assert flight["mode"] == 2


def test_there_is_no_step_when_gps_goes_and_a_correction_within_sigma_when_it_returns(thesis):
    flight = Flight(component=thesis).fly(60.0, fix=True)
    before = np.array(flight.error())
    flight.fly(1.0, fix=False)
    assert np.hypot(*(np.array(flight.error()) - before)) < 0.5
    flight.fly(120.0, wrong=np.radians(1.0))
    sigma, error = flight["east_sigma"], flight.error()[1]
    assert 20.0 < abs(error) < 3.0 * sigma
    flight.fly(5.0, fix=True)
    assert flight["east_sigma"] < 3.0 and np.hypot(*flight.error()) < 2.0


def test_a_fix_that_jumps_says_nothing_about_the_wind(thesis):
    """5 km there and back. Taken for what wind did in a second, it throws the wind by 100 m/s and more."""
    flight = Flight(component=thesis).fly(60.0, fix=True)
    for shift in (5000.0, 0.0):
        flight.fly(3.0, fix=True, fix_shift=shift)
        north, east = flight.error()
        assert np.hypot(north - shift, east) < 5.0
        assert np.hypot(*flight["solution.wind_n"]) < 1.0
        assert flight["north_sigma"] < 2.0 and flight["east_sigma"] < 2.0


def test_a_fix_that_comes_late_counts_for_its_own_time(thesis):
    """Half a second late, it would be wrong by 23 m, of which a filter that takes it for one of now believes a third,
    and one that begins anew all."""
    for calibration in (True, False):
        flight = Flight(component=thesis, calibration=calibration).fly(5.0, fix=True)
        then = flight.step * flight.k - 0.4
        place = {"latitude": north_of_start(then), "longitude": LONGITUDE, "altitude": ALTITUDE}
        flight.set(bundle("fix", 100, then, **place, velocity_n=(SPEED, 0.0, 0.0)))
        flight.fly(0.1)
        assert np.hypot(*flight.error()) < 0.5


def test_wind_is_learned_from_gps_and_decays_to_its_forecast(thesis):
    """There is none, where 6.3 m/s are forecast; without calibration the forecast is all there is."""
    certain = {"heading_sigma": 0.0, "airspeed_sigma": 0.0, "gust_sigma": 0.0, "component": thesis, "step": 1.0}
    flight = Flight(wind_mean=(6.3, 0.0), **certain).fly(60.0, fix=True)
    before = flight["solution.wind_n"][0]
    assert before == pytest.approx(0.0, abs=0.1)
    flight.fly(100.0)
    assert flight["solution.wind_n"][0] == pytest.approx(6.3 + (before - 6.3) * np.exp(-100.0 / 400.0), rel=1e-6)
    untold = Flight(wind_mean=(6.3, 0.0), calibration=False, **certain).fly(60.0, fix=True)
    assert untold["solution.wind_n"] == pytest.approx([6.3, 0.0])
    assert untold["north_sigma"] == pytest.approx(2.0)


def test_altitude_is_that_of_gps_and_then_of_the_altimeter(thesis):
    flight = Flight(component=thesis, step=1.0).fly(120.0, fix=True)
    assert flight["solution.altitude"] == pytest.approx(ALTITUDE, abs=0.1)  # pressure altitude is 30 m less
    flight.fly(10.0)
    assert flight["solution.altitude"] == pytest.approx(ALTITUDE, abs=0.1)


def test_a_range_that_comes_late_counts_for_its_own_time(aided):
    """Half a second late it would be wrong by up to 20 m; (6.40) as printed believes it."""
    flight = Flight(component=aided, bias_sigma=0.0).fly(10.0, fix=True).fly(1.0, fix=False)
    flight.fly(60.0, ranging=5.0, age=0.5)
    assert flight["used"] == 24
    assert np.hypot(*flight.error()) < 0.5


def test_reckoning_and_filters_without_aiding_leave_ranges_alone(thesis):
    """And say so: there, but left out."""
    given = {} if thesis is NavigatorReckoning else {"dme_aiding": False}
    with_ranges = Flight(component=thesis, **given).fly(10.0, fix=True).fly(1.0, fix=False)
    with_ranges.fly(60.0, ranging=5.0, shift=800.0)
    without = Flight(component=thesis).fly(10.0, fix=True).fly(1.0, fix=False).fly(60.0)
    assert (with_ranges["used"], with_ranges.error()) == (0, without.error())
    assert with_ranges["north_sigma"] == without["north_sigma"]
    assert list(with_ranges["gate"]) == [3, 3, 0, 0, 0]


def test_one_wild_range_is_refused_and_does_nothing(aided):
    flight = Flight(component=aided).fly(10.0, fix=True).fly(1.0, fix=False).fly(60.0, ranging=5.0)
    used, sigma = flight["used"], flight["north_sigma"]
    flight.fly(5.0, ranging=5.0, shift=np.array([5000.0, 0.0, 0.0, 0.0, 0.0]))
    assert (flight["rejected"], flight["used"], list(flight["gate"][:2])) == (1, used + 1, [2, 1])
    assert flight["innovation"][0] == pytest.approx(5000.0, abs=1.0)
    assert flight["innovation"][0] > 4.0 * flight["innovation_sigma"][0]
    assert np.hypot(*flight.error()) < 1.0
    assert flight["north_sigma"] < 1.1 * sigma


def test_a_gate_recovers(aided):
    """The last fixes were wrong by 8 km, unnoticed: a gate alone would refuse every range for ever."""
    flight = (
        Flight(component=aided, step=1.0).fly(20.0, fix=True).fly(10.0, fix=True, fix_shift=8e3).fly(1.0, fix=False)
    )
    assert abs(flight.error()[0]) > 7.9e3
    flight.fly(120.0, ranging=15.0)
    assert np.hypot(*flight.error()) < 1000.0
    assert abs(flight.error()[0]) < 3.0 * flight["north_sigma"]
    flight.fly(300.0, ranging=15.0)
    assert np.hypot(*flight.error()) < 500.0


def test_without_heading_the_ranges_carry_the_solution(aided):
    """Heading drops out and the aircraft turns back: sigma grows and ranges are believed, instead of being refused."""
    flight = Flight(component=aided, bias_sigma=30.0).fly(10.0, fix=True).fly(1.0, fix=False).fly(20.0, ranging=1.0)
    run, start = flight.run, 0.1 * flight.k
    run.set("attitude.valid", False)
    for k in range(1, 1201):
        t = start + 0.1 * k
        latitude = north_of_start(start - 0.1 * k)  # it flies south now
        given = bundle("air", 1000 + k, t, true_airspeed=SPEED, pressure_altitude=ALTITUDE - 30.0)
        if k % 10 == 0:
            slant = ranges_at(latitude, LONGITUDE, ALTITUDE, **STATION)
            given |= bundle("ranging", 1000 + k, t, slant_range=slant, measured=[True, True, False, False, False])
        flight.set(given)
        run.do_step(t - 0.1, 0.1)
    there = run.get("solution.latitude"), run.get("solution.longitude")
    assert np.hypot(*navigator.offset(latitude, LONGITUDE, ALTITUDE, *there)) < 100.0
    assert run.get("rejected") == 0
    run.set("attitude.valid", True)  # and what the aircraft did meanwhile is no wind
    flight.set(bundle("attitude", 5000, t, heading=np.pi, yaw_rate=0.0, heading_sigma=HEADING_SIGMA))
    run.do_step(t, 0.2)
    assert np.hypot(*run.get("solution.wind_n")) < 1.0
    forgotten = slice(3, 5) if aided is NavigatorFull else slice(0, 2)  # heading and airspeed, or the wind
    assert not np.any(run.get("errors")[forgotten])


def test_a_state_that_is_saved_goes_on_as_if_nothing_had_been(any_of_them):
    """Also from a start that is not 0: to the last bit what a flight without a break has."""
    names = ["solution.latitude", "solution.wind_n", "position_covariance", "innovation", "gate", "state_sigma"]
    flight = Flight(component=any_of_them).fly(10.0, fix=True).fly(1.0, fix=False).fly(20.0, ranging=5.0, shift=100.0)
    saved, k, rangings = flight.run.get_state(), flight.k, flight.rangings
    flight.fly(20.0, ranging=5.0, shift=-100.0)
    expected = [np.array(flight[name]) for name in names]
    flight.run.set_state(saved)
    flight.k, flight.rangings = k, rangings
    flight.fly(20.0, ranging=5.0, shift=-100.0)
    for name, value in zip(names, expected, strict=True):
        assert np.array_equal(flight[name], value), name


def test_a_flight_may_begin_at_any_time(any_of_them):
    """20 minutes after 0, and 56 km further north: sigmas are those of a flight from 0, but for the airspeed, which is
    learned from the curvature of the meridian to 1e-6."""
    sigmas = []
    for start in (0.0, 1200.0):
        flight = Flight(component=any_of_them, step=1.0)
        flight.run = Interpreter(any_of_them)
        flight.run.set("update_period", 1.0)
        flight.run.setup(start)
        flight.k = round(start)
        flight.fly(10.0, fix=True).fly(1.0, fix=False).fly(30.0)
        assert np.hypot(*flight.error()) < 0.5
        sigmas.append([flight["north_sigma"], flight["east_sigma"]])
    assert sigmas[1] == pytest.approx(sigmas[0], rel=1e-5)
    assert sigmas[0][1] > 3.0
