"""The attitude filters of the thesis: their matrices against the printed ones, the components on simulated flights."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import expm, solve_discrete_are
from scipy.spatial.transform import Rotation

from fmus.attitude.ahrs import Ahrs
from fmus.attitude.ahrs_euler import AhrsEuler
from fmus.attitude.ahrs_quaternion import AhrsQuaternion
from fmus.attitude.thesis import GPS as BY_GPS
from fmus.attitude.thesis import LEVEL as BY_LEVEL
from fmus.attitude.thesis import NOTHING, SETS
from models.attitude import ahrs, ahrs_euler, ahrs_quaternion, attitude, gyro_axis, quaternion
from models.filters import kalman
from models.magnetic import magnetic_field
from navfmu.constants import STANDARD_GRAVITY as G
from tests.models.native import Native

STEP, PERIOD = 0.05, 0.5
GYRO, GPS = np.radians(0.05), np.radians(0.25)
BIAS = np.radians([0.3, -0.2, 0.25])
DIP, DECLINATION, STRENGTH = np.radians(61.0), np.radians(13.0), 4.8e-5
FIELD_N = STRENGTH * ahrs.field_n(DIP, DECLINATION)
TABLE = SETS["table_4_2"].values
HORIZON = {**TABLE, "alpha": 1.0, "beta": 1.0, "gains": 1, "declination": DECLINATION}
"""Noise and drift of the Horizon gyros as they are, gains computed."""
EULER, QUATERNION = "euler", "quaternion"
BOTH = pytest.mark.parametrize("kind", [EULER, QUATERNION])
NAMES = [f"attitude.{name}{more}" for name in ("roll", "pitch", "heading") for more in ("", "_sigma")]
NAMES += ["gyro_bias", "hard_iron", "dip", "covariance", "aiding", "computed_yaw_rate", "attitude.yaw_rate"]


@pytest.fixture(scope="module")
def natives(tmp_path_factory):
    components = {EULER: AhrsEuler, QUATERNION: AhrsQuaternion}
    return {kind: Native(c, tmp_path_factory.mktemp(f"ahrs_{kind}")) for kind, c in components.items()}


def straight(seconds, heading=0.7, pitch=0.05, roll=0.0):
    time = np.arange(round(seconds / STEP) + 2) * STEP
    return Rotation.from_euler("ZYX", np.column_stack([0.0 * time + angle for angle in (heading, pitch, roll)]))


def fly(
    native,
    turns,
    parameters,
    gps=np.inf,
    field=False,
    speed=0.0,
    bias=BIAS,
    seed=1,
    gyro=GYRO,
    iron=0.0,
    more=None,
    names=NAMES,
):
    """Outputs, and what is left of the rotation in b (deg), of a flight of attitudes at 0, STEP, ...

    GPS attitude comes at 2 Hz until ``gps``. ``speed``: that of an aircraft whose velocity is along its nose.
    """
    rng, count = np.random.default_rng(seed), len(turns) - 1
    rates = (turns[:-1].inv() * turns[1:]).as_rotvec() / STEP
    # the components take the mean of two samples: as they are, the means of the two steps at a sample
    rates = np.concatenate([rates[:1], 0.5 * (rates[1:] + rates[:-1]), rates[-1:]])
    forces = turns.inv().apply([0.0, 0.0, -G]) + np.cross(rates, [speed, 0.0, 0.0])
    fields = turns.inv().apply(FIELD_N) + STRENGTH * np.asarray(iron)
    angles = turns.as_euler("ZYX")[:, ::-1]
    noise = gyro * rng.standard_normal((count + 1, 3))
    wrong = np.broadcast_to(bias, (count + 1, 3))
    told = angles + GPS * rng.standard_normal((count + 1, 3))

    def inputs(t):
        k = round(t / STEP) + 1
        values = {"imu.rate": rates[k] + wrong[k] + noise[k], "imu.specific_force": forces[k]}
        seen = ["imu"]
        if k % 10 == 0 and k * STEP <= gps:
            values |= {f"gps.{name}": told[k, i] for i, name in enumerate(("roll", "pitch", "heading"))}
            seen.append("gps")
        if field:
            values |= {"field.field_b": fields[k], "air.true_airspeed": speed}
            seen += ["field", "air"]
        for bundle in seen:
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k, f"{bundle}.time_of_validity": k * STEP}
        return values | (more(k) if more else {})

    got = native.run((count - 1) * STEP, STEP, names, parameters, inputs)
    estimated = Rotation.from_euler(
        "ZYX", np.column_stack([got[f"attitude.{n}"] for n in ("heading", "pitch", "roll")])
    )
    return got, np.degrees((turns[:-1].inv() * estimated).as_rotvec())


PLACE = 0.66, -2.1, 1500.0
FAR_NORTH = 1.09, -2.0, 1500.0
"""Yellowknife: a dip of 82 degrees."""


def at_place(k, place=PLACE):
    """The bundle ``position``."""
    values = {f"position.{name}": x for name, x in zip(("latitude", "longitude", "altitude"), place, strict=True)}
    return values | {"position.valid": True, "position.sequence": k, "position.time_of_validity": k * STEP}


def valid(native):
    """Whether the last attitude was valid."""
    return native.fmu.getBoolean([native.fields["attitude.valid"].index])[0]


# --- equations -------------------------------------------------------------------------------------------------------


def test_euler_transition_is_the_printed_one_where_nothing_turns():
    """(4.34), (4.35) with -sin(roll) in row 2, column 3, and the bias as what the rates are wrong by."""
    heading, pitch, roll, time = 0.3, 0.4, -0.8, 0.5
    sr, cr, cp, tp = np.sin(roll), np.cos(roll), np.cos(pitch), np.tan(pitch)
    printed = np.array([[0.0, sr / cp, cr / cp], [0.0, cr, -sr], [1.0, sr * tp, cr * tp]])
    state = np.array([heading, pitch, roll])
    np.testing.assert_allclose(ahrs_euler.by_gyros(state), printed, atol=1e-15)
    phi = ahrs_euler.transition(state, np.zeros(3), time)
    np.testing.assert_allclose(phi, np.concatenate([np.eye(3), -time * printed], axis=1), atol=1e-14)


@BOTH
def test_transition_is_what_errors_become_in_the_motion_itself(kind):
    """SciPy's rotations, 0.5 s at 7 deg/s: F of (4.34) without the derivatives by pitch and roll fails."""
    rng, time = np.random.default_rng(4), 0.5
    rotation = time * np.radians([3.0, -4.0, 5.0])
    roll, pitch, heading = -0.6, 0.3, 2.0
    true = Rotation.from_euler("ZYX", [heading, pitch, roll])

    def errors(start, turned):
        if kind == EULER:
            return turned.as_euler("ZYX") - start.as_euler("ZYX")
        return 0.5 * (start.inv() * turned).as_rotvec()

    model = {EULER: ahrs_euler, QUATERNION: ahrs_quaternion}[kind]
    phi = model.transition(model.of_angles(roll, pitch, heading), rotation, time)
    for _ in range(5):
        at_first, bias = 1e-5 * rng.standard_normal(3), 1e-5 * rng.standard_normal(3)
        wrong = true * Rotation.from_rotvec(at_first)
        end, ended = true, wrong
        for _ in range(500):
            end = end * Rotation.from_rotvec(rotation / 500)
            ended = ended * Rotation.from_rotvec((rotation - time * bias) / 500)
        expected = errors(end, ended)
        got = phi @ np.concatenate([errors(true, wrong), bias])
        np.testing.assert_allclose(got, expected, atol=0.004 * np.abs(expected).max())


def test_quaternion_transition_is_the_printed_one():
    """The exponential of (4.54), with -1/2 for the bias."""
    rate, time = np.array([0.05, -0.08, 0.1]), 0.5
    f = np.zeros((6, 6))
    f[:3, :3], f[:3, 3:] = -attitude.skew(rate), -0.5 * np.eye(3)
    phi = ahrs_quaternion.transition(np.array([1.0, 0.0, 0.0, 0.0]), rate * time, time)
    np.testing.assert_allclose(phi, expm(f * time)[:3], atol=1e-5)


def test_vectors_have_the_derivatives_of_closed_form():
    """H = 2 [u_b x], from (4.25) turned into b; as (4.60) is printed, with vectors in n, the signs of b are lost."""
    q = quaternion.of_euler(0.4, -0.3, 2.2)
    c_bn = quaternion.dcm(q).T
    known = np.stack([ahrs.field_n(DIP, DECLINATION), [0.0, 0.0, -1.0]])
    error = np.array([2e-6, -3e-6, 1e-6])
    true = quaternion.dcm(ahrs_quaternion.corrected(q, error)).T
    sigmas = np.array([0.02, 0.01, 0.01])
    residuals, rows, variances = ahrs_quaternion.by_vectors(
        q, 3.0 * true @ known[0], G * true @ known[1], DIP, DECLINATION, sigmas
    )
    closed = np.concatenate([2.0 * attitude.skew(c_bn @ vector) for vector in known])
    np.testing.assert_allclose(rows, closed, atol=1e-12)
    np.testing.assert_allclose(residuals, closed @ error, atol=1e-10)
    np.testing.assert_allclose(variances, np.repeat([(0.02 * np.cos(DIP)) ** 2, 1e-4], 3))


@pytest.mark.parametrize("kind", [EULER, QUATERNION])
@pytest.mark.parametrize("degrees", [-60.0, 0.0, 30.0, 90.0])
def test_scheduled_gains_are_those_at_rest(kind, degrees):
    """SciPy's solution of all six states at that roll (Figs 4.16, 4.17), with Table 4.4's noises of level and needle.

    A table of gains in level flight would teach the pitch gyro in a bank of 90 degrees what the yaw gyro is wrong by.
    """
    roll, angle, bias = np.radians(degrees), 3e-8, 1e-9
    sigmas = np.radians([0.8, 0.06, 0.06])
    model = {EULER: ahrs_euler, QUATERNION: ahrs_quaternion}[kind]
    state = model.of_angles(roll, 0.0, 0.7)
    driven = model.driven(state)
    phi = np.eye(6)
    phi[:3, 3:] = -PERIOD * driven
    noise = gyro_axis.noises(driven, angle * PERIOD * np.ones(3), bias, PERIOD)
    h = np.eye(3, 6)
    r = np.diag(sigmas**2)
    if kind == QUATERNION:  # half a rotation in b; heading is a rotation about the vertical
        c_nb = quaternion.dcm(state)
        r = 0.25 * c_nb.T @ np.diag(sigmas[[2, 1, 0]] ** 2) @ c_nb
    before = solve_discrete_are(phi.T, h.T, noise, r)
    expected = before @ h.T @ np.linalg.inv(h @ before @ h.T + r)
    gains = np.stack([gyro_axis.scheduled(angle, bias, sigma, PERIOD)[0] for sigma in sigmas])
    np.testing.assert_allclose(model.scheduled(state, gains), expected, atol=1e-7 * np.abs(expected).max())


def test_quaternion_gains_by_gps_do_not_depend_on_attitude():
    """Fig 4.17."""
    gains = np.stack([gyro_axis.scheduled(3e-8, 1e-9, GPS, PERIOD)[0]] * 3)
    level = ahrs_quaternion.scheduled(quaternion.of_euler(0.0, 0.0, 0.0), gains)
    turned = ahrs_quaternion.scheduled(quaternion.of_euler(1.2, -0.7, 2.0), gains)
    np.testing.assert_allclose(turned, level, atol=1e-15)
    np.testing.assert_allclose(
        level, np.concatenate([gains[0, 0] * np.eye(3), 2.0 * gains[0, 1] * np.eye(3)]), atol=1e-15
    )


@pytest.mark.parametrize("pitch", [0.3, 1.3])
def test_sigmas_of_a_quaternion_are_those_of_turned_attitudes(pitch):
    """20 000 random small errors, SciPy's Euler angles: the sigma of a sigma is 0.5 %, four of them."""
    q, half = quaternion.of_euler(0.5, pitch, 2.0), np.random.default_rng(3).standard_normal((3, 3)) * 1e-4
    errors = np.random.default_rng(4).standard_normal((20000, 3)) @ half.T
    angles = (Rotation.from_euler("ZYX", [2.0, pitch, 0.5]) * Rotation.from_rotvec(2.0 * errors)).as_euler("ZYX")
    got = np.sqrt(ahrs_quaternion.variances(q, half @ half.T))
    np.testing.assert_allclose(got, np.std(angles, axis=0)[::-1], rtol=0.02)


# --- GPS attitude ----------------------------------------------------------------------------------------------------


@BOTH
def test_computed_gains_come_to_rest_where_scheduled_ones_are(natives, kind):
    got, _ = fly(natives[kind], straight(300.0, pitch=0.0), {**HORIZON, "sample_period": STEP})
    scheduled, _ = fly(natives[kind], straight(60.0, pitch=0.0), {**HORIZON, "gains": 2})
    for name in ("roll", "pitch", "heading"):
        sigmas = [run[f"attitude.{name}_sigma"][-1] for run in (got, scheduled)]
        assert sigmas[0] == pytest.approx(sigmas[1], rel=1e-3)


@BOTH
@pytest.mark.parametrize("gains", [1, 2])
def test_biases_settle_in_four_minutes(natives, kind, gains):
    """Fig 4.10, with Table 4.2. A tenth of what they were is what a first-order lag of 1.6 minutes would have left, and
    with (4.44) as it is printed, gains at rest have left 98 % of them."""
    got, _ = fly(natives[kind], straight(300.0), {**TABLE, "gains": gains})
    late = got["time"] > 240.0
    assert np.max(np.abs(got["gyro_bias"][late] - BIAS)) < 0.1 * np.max(BIAS)


def test_with_the_printed_drift_gains_at_rest_do_not_settle(natives):
    """Table 4.2's beta with (4.44): the pole is at 6 hours."""
    got, _ = fly(natives[EULER], straight(300.0), {**TABLE, "beta": 2e-4})
    assert np.max(np.abs(got["gyro_bias"][-1] - BIAS)) > 0.9 * np.max(BIAS)


@BOTH
def test_what_is_left_after_gps_is_lost_grows_as_its_integral(natives, kind):
    """P_a - 2 t P_ab + t2 P_b + q t3 / 3 + noise, from the covariance at rest: computed, and so also scheduled."""
    still = {"level_sigma": 0.0, "mounting_sigma": 0.0, "declination_sigma": 0.0}
    _, ((pa, pab), (_, pb)) = gyro_axis.scheduled(GYRO**2 * STEP, 2.0 * GYRO**2 / 1000.0, GPS, PERIOD)
    t, q = 100.0, 2.0 * GYRO**2 / 1000.0
    expected = pa - 2.0 * t * pab + t * t * pb + q * t**3 / 3.0 + GYRO**2 * STEP * t
    for gains in (1, 2):
        got, _ = fly(natives[kind], straight(300.0, pitch=0.0), {**HORIZON, **still, "gains": gains}, gps=200.0)
        for name in ("roll", "pitch", "heading"):
            assert got[f"attitude.{name}_sigma"][-1] == pytest.approx(np.sqrt(expected), rel=0.01)


def test_both_agree_in_their_common_range(natives):
    """The same readings: weaving with 30 degrees of roll and 15 of pitch. They differ by a tenth of their sigma."""
    time = np.arange(round(200.0 / STEP) + 2) * STEP
    weaving = np.column_stack([0.8 * np.sin(0.05 * time), 0.26 * np.sin(0.07 * time), 0.52 * np.sin(0.1 * time)])
    turns = Rotation.from_euler("ZYX", weaving)
    for gains in (1, 2):
        runs = [fly(natives[kind], turns, {**HORIZON, "gains": gains}) for kind in (EULER, QUATERNION)]
        sigma = np.degrees(runs[0][0]["attitude.pitch_sigma"][-1])
        settled = runs[0][0]["time"] > 20.0
        assert np.abs(runs[0][1] - runs[1][1])[settled].max() < 0.5 * sigma
        assert np.sqrt(np.mean((runs[0][1] - runs[1][1])[settled] ** 2)) < 0.1 * sigma


def climb():
    """Two minutes level, 20 s straight up with a nose that wavers by 2 degrees about the vertical, level again."""
    time = np.arange(round(200.0 / STEP) + 2) * STEP
    pitch = 10.0 * (np.clip(time - 120.0, 0.0, 9.0) - np.clip(time - 149.0, 0.0, 9.0))
    up = np.clip(time - 129.0, 0.0, 20.0)
    wavering = 2.0 * np.column_stack([np.sin(0.4 * np.pi * up), np.sin(0.2 * np.pi * up)])
    steady = Rotation.from_euler("ZYX", np.column_stack([0.0 * time + 40.0, pitch - 0.01, 0.0 * time]), degrees=True)
    return steady * Rotation.from_euler("ZY", wavering, degrees=True)


@pytest.mark.parametrize("gains", [1, 2])
def test_the_quaternion_passes_the_vertical(natives, gains):
    """Without GPS from before the climb on."""
    _, left = fly(natives[QUATERNION], climb(), {**HORIZON, "gains": gains}, gps=115.0)
    assert np.abs(left[1500:]).max() < 1.0
    assert valid(natives[QUATERNION])


def test_euler_angles_do_not_pass_the_vertical(natives):
    """There Phi (4.34) has no bounds: the sigma of heading passes half a turn, and with it the attitude is lost."""
    fly(natives[EULER], climb(), HORIZON, gps=115.0)
    assert not valid(natives[EULER])
    _, left = fly(natives[EULER], climb(), HORIZON)
    assert np.abs(left[2500:3100]).max() > 2.0
    assert valid(natives[EULER])


@BOTH
def test_published_angles_are_those_of_an_attitude(natives, kind):
    """Rolling by 20 deg/s and then looping by 15: between two aidings roll was beyond 180 and pitch beyond 90 degrees,
    where the yaw rate of it was divided by 1e-6."""
    time = np.arange(round(72.0 / STEP) + 2) * STEP
    rolled = 20.0 * np.clip(time, 0.0, 36.0), [1.0, 0.0, 0.0]
    looped = 15.0 * np.clip(time - 36.0, 0.0, None) + 0.1, [0.0, 1.0, 0.0]
    turns = Rotation.from_rotvec(np.radians(np.outer(*rolled))) * Rotation.from_rotvec(np.radians(np.outer(*looped)))
    got, _ = fly(natives[kind], turns, HORIZON)
    assert np.abs(got["attitude.roll"]).max() <= np.pi
    assert np.abs(got["attitude.pitch"]).max() <= 0.5 * np.pi
    assert np.abs(got["attitude.yaw_rate"]).max() < 1e4


@pytest.mark.parametrize("gains", [1, 2])
def test_at_the_vertical_sigmas_say_that_roll_and_heading_are_one(natives, gains):
    """A tenth of a degree from it: those of scheduled gains stayed as they are in level flight."""
    got, _ = fly(natives[QUATERNION], straight(30.0, pitch=np.radians(89.9)), {**HORIZON, "gains": gains})
    roll, pitch, heading = (got[f"attitude.{name}_sigma"][-1] for name in ("roll", "pitch", "heading"))
    assert min(roll, heading) > 100.0 * pitch


@BOTH
def test_hard_iron_is_learned_while_gps_attitude_tells(natives, kind):
    """The field of the World Magnetic Model at a place, and iron of 2 %; without a position nothing is learned."""
    iron = np.array([0.02, -0.015, 0.01])
    turns, known = straight(120.0, roll=0.2), magnetic_field.field(*PLACE, 2026.0)
    field_b = turns[0].inv().apply(known) + np.linalg.norm(known) * iron

    def seen(k):
        return at_place(k) | {"field.field_b": field_b}

    got, _ = fly(natives[kind], turns, {**HORIZON, "chart_period": 1.0}, field=True, more=seen)
    np.testing.assert_allclose(got["hard_iron"][-1], iron, atol=0.002)
    got, _ = fly(natives[kind], turns, HORIZON, field=True, more=lambda k: {"field.field_b": field_b})
    np.testing.assert_array_equal(got["hard_iron"][-1], 0.0)


SEEDS = 24


@BOTH
def test_errors_are_as_large_as_they_are_said_to_be(natives, kind):
    """Of 24 flights with turns, which err as modelled, the squares of the six errors over their covariance.

    Chi-square of 144, 99.9 % of it. Biases that were held to be constant, or noise of twice the size, are outside.
    """
    seconds, squares = 120.0, 0.0
    for seed in range(SEEDS):
        rng = np.random.default_rng(100 + seed)
        count = round(seconds / STEP) + 2
        time = np.arange(count) * STEP
        size, phase = rng.uniform(0.2, 0.5, 3), rng.uniform(0.0, 6.0, 3)
        angles = size * np.sin(np.outer(time, [0.05, 0.08, 0.1]) + phase)
        turns = Rotation.from_euler("ZYX", angles)
        walk = np.sqrt(2.0 * GYRO**2 / 1000.0 * STEP) * rng.standard_normal((count, 3))
        bias = 0.005 * rng.standard_normal(3) + np.cumsum(walk, axis=0)
        parameters = {**HORIZON, "gyro_null_shift_sigma": 0.005, "gyro_drift_sigma": GYRO}
        got, left = fly(natives[kind], turns, parameters, bias=bias, seed=seed)
        if kind == EULER:
            found = np.stack([got[f"attitude.{n}"][-1] for n in ("heading", "pitch", "roll")])
            error = turns[-2].as_euler("ZYX") - found
        else:
            error = -0.5 * np.radians(left[-1])
        error = np.concatenate([attitude.wrap(error) if kind == EULER else error, bias[-2] - got["gyro_bias"][-1]])
        squares += error @ np.linalg.solve(kalman.unpack(got["covariance"][-1]), error)
    low, high = stats.chi2.ppf([0.0005, 0.9995], 6 * SEEDS)
    assert low < squares < high


# --- level and field -------------------------------------------------------------------------------------------------

LEVEL = {**HORIZON, "tilt_sigma": np.radians(0.5), "needle_sigma": np.radians(0.8)}


def circling(rate, seconds=240.0, speed=50.0, begin=60.0):
    """A coordinated turn at ``rate``, rolled into within 2 s."""
    time = np.arange(round(seconds / STEP) + 2) * STEP
    heading = np.clip(time - begin, 0.0, None) * rate
    roll = np.arctan(speed * rate / G) * np.clip((time - begin + 1.0) / 2.0, 0.0, 1.0)
    return Rotation.from_euler("ZYX", np.column_stack([heading, 0.0 * time, roll]))


@BOTH
@pytest.mark.parametrize("gains", [1, 2])
def test_straight_flight_is_held_by_level_and_field(natives, kind, gains):
    got, left = fly(natives[kind], straight(240.0), {**LEVEL, "gains": gains}, gps=-1.0, field=True, speed=50.0)
    assert np.all(got["aiding"][100::10] == BY_LEVEL)
    assert np.abs(left[2400:]).max() < 0.5
    np.testing.assert_allclose(got["gyro_bias"][-1], BIAS, atol=np.radians(0.02))


@BOTH
def test_in_a_turn_nothing_aids_and_so_it_is_kept(natives, kind):
    """At 3 deg/s the specific force stands on the wings: with a turn limit beyond that, roll is lost in a minute."""
    turns = circling(np.radians(3.0))
    got, left = fly(natives[kind], turns, LEVEL, gps=-1.0, field=True, speed=50.0, bias=np.zeros(3))
    turning = (got["time"] > 65.0) & (got["time"] < 230.0)
    assert np.all(got["aiding"][turning] == NOTHING)
    np.testing.assert_allclose(got["computed_yaw_rate"][turning], np.radians(3.0), atol=np.radians(0.3))
    assert np.abs(left[1300:]).max() < 3.0
    open_ = {**LEVEL, "turn_limit": 1.0, "force_limit": 2.0}
    _, left = fly(natives[kind], turns, open_, gps=-1.0, field=True, speed=50.0, bias=np.zeros(3))
    assert np.abs(left[3000:, 0]).mean() > 5.0


@BOTH
def test_a_turn_that_yaws_slowly_is_told_by_its_weight(natives, kind):
    """40 degrees of bank at 200 m/s yaw by 2.4 deg/s: with the turn limit out of the way, 1.3 g close the gate."""
    turns = circling(G * np.tan(np.radians(40.0)) / 200.0, speed=200.0)
    got, _ = fly(natives[kind], turns, {**LEVEL, "turn_limit": 1.0}, gps=-1.0, field=True, speed=200.0)
    assert np.all(got["aiding"][1400::10] == NOTHING)


@BOTH
def test_with_compensation_a_turn_is_aided(natives, kind):
    """The biases are learned in the turn, too, which gates leave for the integral: 0.3 deg/s for 3 minutes."""
    turns = circling(np.radians(3.0))
    got, left = fly(natives[kind], turns, {**LEVEL, "compensated": True}, gps=-1.0, field=True, speed=50.0)
    assert np.all(got["aiding"][1400::10] == BY_LEVEL)
    assert np.abs(left[2400:]).max() < 1.0


def by_level_and_field(native, kind, seed, place=PLACE):
    """Errors of the six states and their covariance after 90 s of straight flight; both vectors err white."""
    rng, tilt, needle = np.random.default_rng(seed), np.radians(2.0), np.radians(0.8)
    turns = straight(90.0, heading=rng.uniform(-3.0, 3.0))
    known = magnetic_field.field(*place, 2026.0)
    across = 0.5 * np.linalg.norm(known)  # what errs by the needle's sigma where the dip is 60 degrees
    white = rng.standard_normal((3, len(turns), 3))
    forces = turns.inv().apply([0.0, 0.0, -G]) + G * tilt * np.sqrt(PERIOD / STEP) * white[0]  # which is averaged
    fields = turns.inv().apply(known) + across * needle * white[1]
    bias = 0.002 * rng.standard_normal(3) + np.cumsum(np.sqrt(2.0 * GYRO**2 / 1000.0 * STEP) * white[2], axis=0)

    def seen(k):
        return at_place(k, place) | {"field.field_b": fields[k], "imu.specific_force": forces[k]}

    told = {"tilt_sigma": tilt, "needle_sigma": needle, "initial_sigma": tilt, "gyro_null_shift_sigma": 0.002}
    open_ = {"turn_limit": 1.0, "force_limit": 2.0, "chart_period": 1.0}
    got, left = fly(native, turns, {**HORIZON, **told, **open_}, gps=-1.0, field=True, bias=bias, seed=seed, more=seen)
    error = -0.5 * np.radians(left[-1])
    if kind == EULER:
        found = np.stack([got[f"attitude.{n}"][-1] for n in ("heading", "pitch", "roll")])
        error = attitude.wrap(turns[-2].as_euler("ZYX") - found)
    return np.concatenate([error, bias[-2] - got["gyro_bias"][-1]]), kalman.unpack(got["covariance"][-1])


@pytest.mark.parametrize("place", [PLACE, FAR_NORTH])
def test_by_vectors_errors_are_as_large_as_they_are_said_to_be(natives, place):
    """24 flights, chi-square of 144, 99.9 % of it: vectors have the errors that (4.60) gives them, at any dip.

    Not so where the field's direction is known to the needle times cos(dip), or the first heading as well as the needle
    of a known level.
    """
    flights = [by_level_and_field(natives[QUATERNION], QUATERNION, seed, place) for seed in range(SEEDS)]
    low, high = stats.chi2.ppf([0.0005, 0.9995], 6 * SEEDS)
    assert low < sum(error @ np.linalg.solve(covariance, error) for error, covariance in flights) < high


def test_a_needle_errs_with_the_level(natives):
    """It is levelled by the force, whose error counts tan(dip) times in it, and R_v (4.51) has none of that.

    So Euler angles say of heading less than half of what they are wrong by.
    """
    flights = [by_level_and_field(natives[EULER], EULER, seed) for seed in range(SEEDS)]
    assert np.mean([error[0] ** 2 / covariance[0, 0] for error, covariance in flights]) > 4.0


def test_a_dip_without_a_chart_is_that_of_many_samples(natives):
    """GPS attitude aligns, and a field comes later; then they stand on a level that errs by 2 degrees a sample.

    A dip that is read at the alignment is that of no field, and level and field disagree for ever; one that is read of
    the first field is wrong by what the level was then.
    """
    turns, rng = straight(150.0), np.random.default_rng(4)
    white = G * np.radians(2.0) * np.sqrt(PERIOD / STEP) * rng.standard_normal((len(turns), 3))
    forces = turns.inv().apply([0.0, 0.0, -G]) + white

    def late(k):
        return {"field.valid": k * STEP > 20.0, "imu.specific_force": forces[k]}

    open_ = {"tilt_sigma": np.radians(2.0), "turn_limit": 1.0, "force_limit": 2.0}
    got, left = fly(natives[QUATERNION], turns, {**HORIZON, **open_}, gps=40.0, field=True, more=late)
    assert abs(got["dip"][-1] - DIP) < np.radians(0.5)  # 2 degrees over sqrt(260), four of them
    assert np.abs(left[-1]).max() < 1.5


@BOTH
def test_gps_attitude_comes_before_level_and_field(natives, kind):
    """An iron that turns the needle by 10 degrees counts when GPS is silent for longer than its timeout, not before."""
    got, left = fly(natives[kind], straight(120.0), LEVEL, gps=60.0, field=True, speed=50.0, iron=(0.0, 0.08, 0.0))
    assert np.all(got["aiding"][100:1200:10] == BY_GPS)
    assert np.all(got["aiding"][1300::10] == BY_LEVEL)
    assert np.abs(left[400:1200]).max() < 0.7
    assert np.abs(left[-1, 2]) > 5.0


@BOTH
@pytest.mark.parametrize("by", ["field", "gps"])
def test_what_aids_is_taken_at_its_time_with_samples_that_are_rare(natives, kind, by):
    """Turning by 1 rad/s with samples every 0.1 s, aided between them: a filter that turns field or GPS attitude on to
    the time of aiding, and not to that of its attitude, has a heading that is wrong by half of 0.1 s, 3 degrees."""
    apart, step = 0.1, 0.02

    def inputs(t):
        k = round(t / step) // 5
        heading = attitude.wrap(apart * k)
        values = {"imu.rate": (0.0, 0.0, 1.0), "gps.heading": heading}
        values["field.field_b"] = Rotation.from_euler("z", heading).inv().apply(FIELD_N)
        for bundle in ("imu", by):
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k + 1, f"{bundle}.time_of_validity": apart * k}
        return values

    told = {**LEVEL, "sample_period": step, "aiding_period": 0.16, "airspeed": 0.0, "turn_limit": 3.0}
    got = natives[kind].run(120.0, step, ["attitude.heading", "attitude.time_of_validity"], told, inputs)
    left = np.degrees(attitude.wrap(got["attitude.time_of_validity"] - got["attitude.heading"]))
    assert np.abs(left[3000:]).max() < 0.5


@BOTH
@pytest.mark.parametrize("gains", [1, 2])
@pytest.mark.parametrize(
    "name", ["field.field_b", "imu.rate", "imu.specific_force", "gps.heading", "air.true_airspeed"]
)
@pytest.mark.parametrize("value", [np.nan, 1e18])
def test_one_sample_that_no_sensor_has_is_no_end(natives, kind, gains, name, value):
    """Valid, and no number or an absurd one: a filter that lets it into its states shows no attitude for the rest of
    the flight, or one that is wrong."""
    parameters = {**LEVEL, "gains": gains, "compensated": True}
    gps = np.inf if name.startswith("gps") else -1.0
    _, left = fly(
        natives[kind], straight(120.0), parameters, gps=gps, field=True, speed=50.0, bias=np.zeros(3),
        more=lambda k: {name: value} if k == 1000 else {},
    )  # fmt: skip
    assert np.abs(left[-500:]).max() < 1.0


@pytest.mark.parametrize("component", [AhrsEuler, AhrsQuaternion])
def test_it_takes_the_place_of_ahrs(component):
    """The same bundles with the same members, units and numbers."""
    for name, bundle in Ahrs.layout.bundles.items():
        other = component.layout.bundles[name]
        assert other.causality == bundle.causality
        assert {n: (m.unit, m.shape) for n, m in other.members.items()} == {
            n: (m.unit, m.shape) for n, m in bundle.members.items()
        }
