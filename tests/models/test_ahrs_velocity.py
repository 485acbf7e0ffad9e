"""The quaternion filter: its matrices against the motion itself, and the component on closed forms."""

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from fmus.attitude.ahrs import Ahrs
from fmus.attitude.ahrs_velocity import HAND, AhrsVelocity
from models.attitude import ahrs, ahrs_velocity, attitude, quaternion
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY
from tests.models.native import Native

RNG = np.random.default_rng(5)
G = STANDARD_GRAVITY
GRAVITY = np.array([0.0, 0.0, G])
DIP, DECLINATION, STRENGTH = np.radians(61.0), np.radians(13.0), 4.8e-5
FIELD_N = STRENGTH * ahrs.field_n(DIP, DECLINATION)
STEP = 0.02
NAMES = ["turn", "gyro_bias", "hard_iron", "dip", "sigmas", "velocity", "strength", "covariance"]
NAMES += ["place", "local_declination"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(AhrsVelocity, tmp_path_factory.mktemp("ahrs_velocity"))


def fly(
    native, turns, velocities, parameters=None, bias=(0, 0, 0), iron=(0, 0, 0), airspeed=None, more=None, wrong=0.0
):
    """Outputs, and the rotation in n that is left, deg, of ideal sensors on a motion; ``wrong`` is what gyros err by.

    ``turns`` are SciPy's rotations of b to n and ``velocities`` those in n, at 0, STEP, ...; rates and specific forces
    are what takes one to the next, so they are those of the middle of a step.
    """
    rates = (turns[:-1].inv() * turns[1:]).as_rotvec() / STEP
    forces = np.diff(velocities, axis=0) / STEP - GRAVITY
    middle = turns[:-1] * Rotation.from_rotvec(0.5 * STEP * rates)
    forces = middle.inv().apply(forces)
    fields = turns.inv().apply(FIELD_N) + STRENGTH * np.asarray(iron)
    # the component takes the mean of two samples: as they are, the means of the two steps at a sample
    rates, forces = (np.concatenate([x[:1], 0.5 * (x[:-1] + x[1:]), x[-1:]]) for x in (rates, forces))
    rates = rates + wrong
    held = {}

    def inputs(t):
        k = round(t / STEP) + 1
        now = k * STEP
        values = {"imu.rate": rates[k] + bias, "imu.specific_force": forces[k], "field.field_b": fields[k]}
        seen = ["imu", "field"]
        if airspeed is not None:
            values["air.true_airspeed"] = airspeed
            seen.append("air")
        for bundle in seen:
            held[f"{bundle}.valid"], held[f"{bundle}.sequence"], held[f"{bundle}.time_of_validity"] = True, k, now
        return values | (more(k) if more else {}) | held

    got = native.run(
        (len(turns) - 1) * STEP, STEP, NAMES,
        {"sample_period": STEP, "declination": DECLINATION, **(parameters or {})}, inputs,
    )  # fmt: skip
    estimated = Rotation.from_quat(np.roll(got["turn"], -1, axis=1))
    return got, np.degrees((turns * estimated.inv()).as_rotvec())


# --- equations -------------------------------------------------------------------------------------------------------


def state():
    q = quaternion.of_euler(0.4, -0.9, 2.2)
    return q, np.array([20.0, -30.0, 4.0]), np.array([0.5, -1.0, 0.7])


def test_transition_is_what_errors_become_in_the_motion_itself():
    """Integrated in a hundred steps by SciPy's rotations, with errors put in; a missing term of bias or place shows."""
    rng, time, steps = np.random.default_rng(2), 0.5, 200
    start = Rotation.from_euler("ZYX", [2.2, -0.9, 0.4])
    rate, force = np.array([0.02, -0.03, 0.05]), np.array([1.0, 0.5, -9.0])

    def fly(error):
        turn = Rotation.from_rotvec(error[:3]) * start
        velocity, place, step = error[3:6].copy(), error[6:9].copy(), time / steps
        matrix, gained = np.zeros((3, 3)), np.zeros(3)
        for _ in range(steps):
            half = turn * Rotation.from_rotvec(0.5 * step * (rate - error[9:]))
            force_n = half.apply(force)
            place += velocity * step + 0.5 * (force_n + GRAVITY) * step**2
            velocity += (force_n + GRAVITY) * step
            matrix, gained = matrix + half.as_matrix() / steps, gained + force_n * step
            turn = turn * Rotation.from_rotvec(step * (rate - error[9:]))
        return turn, velocity, place, matrix, gained

    turn, velocity, place, matrix, gained = fly(np.zeros(12))
    phi = ahrs_velocity.transition(matrix, gained, time, 1.0)
    by = [1e-5] * 3 + [1e-3] * 6 + [1e-5] * 3
    for _ in range(5):
        error = rng.standard_normal(12) * by
        moved = fly(error)
        change = [(moved[0] * turn.inv()).as_rotvec(), moved[1] - velocity, moved[2] - place]
        np.testing.assert_allclose(phi @ error, np.concatenate(change), rtol=0.02, atol=2e-7)
    velocity, place = ahrs_velocity.carried(np.zeros(3), np.zeros(3), gained, time)
    np.testing.assert_allclose(velocity, fly(np.zeros(12))[1], atol=1e-12)
    np.testing.assert_allclose(place, fly(np.zeros(12))[2], atol=5e-3)


def test_what_is_measured_has_the_derivatives_of_closed_form():
    """C_bn (v - turn x v), C_bn (n - turn x n) and the turn itself: a turn on the wrong side has C_bn on the other."""
    q, velocity, flow = state()
    c_bn = quaternion.dcm(q).T
    expected, matrix = ahrs_velocity.rows(ahrs_velocity.flow_seen, q, velocity, flow)
    np.testing.assert_allclose(expected, c_bn @ velocity + flow, atol=1e-13)
    wanted = np.zeros((3, 20))
    wanted[:, :3], wanted[:, 3:6], wanted[:, 17:] = c_bn @ attitude.skew(velocity), c_bn, np.eye(3)
    np.testing.assert_allclose(matrix, wanted, atol=1e-12)

    iron, strength = np.array([0.1, -0.2, 0.05]), 0.03
    seen = ahrs_velocity.rows(ahrs_velocity.field_seen, q, iron, DIP, strength, DECLINATION)
    direction = ahrs.field_n(DIP, DECLINATION)
    np.testing.assert_allclose(seen[0], 1.03 * c_bn @ direction + iron, atol=1e-14)
    wanted = np.zeros((3, 20))
    wanted[:, :3], wanted[:, 12:15] = 1.03 * c_bn @ attitude.skew(direction), np.eye(3)
    wanted[:, 15] = 1.03 * c_bn @ ahrs.field_n(DIP + 0.5 * np.pi, DECLINATION)
    wanted[:, 16] = c_bn @ direction
    np.testing.assert_allclose(seen[1], wanted, atol=1e-13)

    expected, matrix = ahrs_velocity.rows(ahrs_velocity.turn_seen, q, q)
    np.testing.assert_allclose(expected, 0.0, atol=1e-15)
    np.testing.assert_allclose(matrix, np.eye(3, 20), atol=1e-14)


def test_the_first_covariance_leaves_the_airspeed_to_say_nothing_of_heading():
    """Velocity and heading of the first attitude err together: without that the airspeed would halve the heading's
    variance, because a velocity that is known in n would tell where the nose points."""
    q = quaternion.of_euler(0.1, 0.05, 1.0)
    velocity = quaternion.dcm(q) @ np.array([50.0, 0.0, 0.0])
    upper = ahrs_velocity.initial_covariance(
        q, velocity, np.float64(0.05), np.float64(0.01), 0.1, 0.02, np.array([2.0, 1.0, 1.0]), 0.0
    )
    before = kalman.diagonal(upper)
    np.testing.assert_allclose(before[:3], [0.0025, 0.0025, 1.0])
    assert np.linalg.eigvalsh(kalman.unpack(upper)).min() > -1e-12
    expected, matrix = ahrs_velocity.rows(ahrs_velocity.flow_seen, q, velocity, np.zeros(3))
    _, after = ahrs_velocity.updates(np.zeros(20), upper, expected, matrix, expected, 0.01, True)
    np.testing.assert_allclose(kalman.diagonal(after)[:3], before[:3], rtol=1e-9)


def test_sigmas_of_euler_angles_are_those_of_turned_attitudes():
    """20 000 random small turns in n, SciPy's Euler angles: the sigma of a sigma is 0.5 %, four of them."""
    roll, pitch, heading = 0.5, -0.8, 2.0
    half = np.random.default_rng(3).standard_normal((3, 3)) * 1e-3
    turns = Rotation.from_rotvec(RNG.standard_normal((20000, 3)) @ half.T)
    angles = (turns * Rotation.from_euler("ZYX", [heading, pitch, roll])).as_euler("ZYX")[:, ::-1]
    upper = np.zeros((20, 20))
    upper[:3, :3] = half @ half.T
    got = ahrs_velocity.euler_sigmas(kalman.pack(upper), heading, pitch)
    np.testing.assert_allclose(got, np.std(angles, axis=0), rtol=0.02)


def test_errors_that_last_count_as_white_noise_of_the_same_weight():
    """The mean of 400 samples of a Gauss-Markov process has, in 4000 runs, the variance of the white noise over 400.

    Its sigma is 2.2 %, four of them; what the ends lack of the sums is 2 %. Samples that each count as one have a
    fifteenth of it.
    """
    rng, time, apart, count, runs = np.random.default_rng(4), 1.5, 0.2, 400, 4000
    rho = np.exp(-apart / time)
    values = rng.standard_normal((count, runs))
    for k in range(1, count):
        values[k] = rho * values[k - 1] + np.sqrt(1.0 - rho * rho) * values[k]
    white = ahrs_velocity.lasting(1.0, time, apart)
    assert np.var(values.mean(axis=0)) * count == pytest.approx(white, rel=0.11)
    assert ahrs_velocity.lasting(4.0, 0.0, apart) == 4.0
    assert ahrs_velocity.lasting(1.0, time, 1e-3) * 1e-3 == pytest.approx(2.0 * time, rel=1e-6)


def test_what_jumps_is_the_hard_iron_and_what_gyros_explain_is_not():
    """A change of 8 % forward raises the variance of that axis by its square; after a turn whose gyros may err by 6
    degrees it says nothing, and neither does one that comes within the errors that last."""
    matrix = ahrs_velocity.rows(ahrs_velocity.field_seen, *state()[:1], np.zeros(3), DIP, 0.0, DECLINATION)[1]
    upper = kalman.of_variances(np.full(20, 1e-5))
    told = {"variance": 4e-4, "noise": 1e-4, "kept": 0.85, "limit": 3.5}
    change = np.array([0.08, 0.01, -0.02])
    gained = [
        kalman.diagonal(ahrs_velocity.jumped(upper, matrix, c, turned=turned, **told) - upper)
        for c, turned in ((change, np.zeros(3)), (change, np.full(3, 0.01)), (0.5 * change, np.zeros(3)))
    ]
    wanted = np.zeros(20)
    wanted[12] = 0.08**2
    np.testing.assert_allclose(gained[0], wanted, atol=1e-15)
    np.testing.assert_allclose(gained[1:], 0.0, atol=1e-15)


# --- the component ---------------------------------------------------------------------------------------------------


def loop(seconds, rate):
    """A vertical circle at 50 m/s: pitch goes through 90, 180 and 270 degrees; level flight before and after."""
    time = np.arange(0.0, seconds + 60.0 + 0.5 * STEP, STEP)
    pitch = np.clip(time - 30.0, 0.0, seconds) * rate
    zero = np.zeros_like(time)
    turns = Rotation.from_euler("ZYX", np.column_stack([zero + 0.7, pitch, zero]))
    return time, turns, turns.apply([50.0, 0.0, 0.0])


def test_it_flies_a_loop(native):
    """At 90 and 270 degrees of pitch Euler angles have a pole, at which a filter of them is thrown off."""
    seconds = 20.0
    _, turns, velocities = loop(seconds, 2.0 * np.pi / seconds)
    got, left = fly(native, turns, velocities, airspeed=50.0)
    assert np.abs(left[500:]).max() < 0.1
    assert np.isfinite(got["covariance"]).all()
    assert np.isfinite(got["sigmas"]).all()


def test_a_coordinated_turn_shows_as_a_turn(native):
    """In one at 5 deg/s the specific force stands on the wings: a filter that takes it for the vertical levels 24
    degrees of roll away within minutes."""
    time = np.arange(0.0, 240.0 + 0.5 * STEP, STEP)
    rate, speed = np.radians(5.0), 50.0
    heading = np.clip(time - 20.0, 0.0, None) * rate
    roll = np.arctan(speed * rate / G) * np.clip((time - 19.0) / 2.0, 0.0, 1.0)
    turns = Rotation.from_euler("ZYX", np.column_stack([heading, 0.0 * time, roll]))
    _, left = fly(native, turns, turns.apply([speed, 0.0, 0.0]), airspeed=speed)
    assert np.abs(left[1000:]).max() < 0.5


def test_gyro_biases_and_hard_iron_are_learned_in_circles(native):
    time = np.arange(0.0, 600.0 + 0.5 * STEP, STEP)
    heading = np.radians(3.0) * np.clip(time - 30.0, 0.0, None)
    roll = np.arctan(50.0 * np.radians(3.0) / G) * np.clip((time - 29.0) / 2.0, 0.0, 1.0)
    turns = Rotation.from_euler("ZYX", np.column_stack([heading, 0.0 * time, roll]))
    bias, iron = np.radians([0.15, -0.1, 0.1]), np.array([0.02, -0.015, 0.01])
    got, left = fly(native, turns, turns.apply([50.0, 0.0, 0.0]), airspeed=50.0, bias=bias, iron=iron)
    np.testing.assert_allclose(got["gyro_bias"][-1], bias, atol=np.radians(0.02))
    np.testing.assert_allclose(got["hard_iron"][-1][:2], iron[:2], atol=0.003)
    assert np.abs(left[-1]).max() < 1.0


def test_a_hand_that_moves_to_and_fro_does_not_tilt(native):
    """Half a metre at 0.5 Hz, 4.9 m/s2: specific force taken for the vertical tilts by up to 27 degrees."""
    time = np.arange(0.0, 60.0 + 0.5 * STEP, STEP)
    moving = np.where(time > 5.0, 1.0, 0.0)
    frequency = 2.0 * np.pi * 0.5
    velocity = 0.5 * frequency * np.sin(frequency * (time - 5.0)) * moving
    angles = np.column_stack([time, 0.2 * np.sin(time), 0.4 * np.sin(0.7 * time)])
    turns = Rotation.from_euler("ZYX", angles)
    velocities = np.column_stack([velocity, 0.3 * velocity, 0.0 * velocity])
    _, left = fly(native, turns, velocities, {**HAND.values, "declination": DECLINATION})
    assert np.abs(left[100:, :2]).max() < 1.5


def test_how_often_it_is_aided_does_not_change_what_the_field_tells(native):
    """Errors of the field that last for 2 s, taken ten times as often: samples that each count as one would say that
    the heading is three times as good."""
    time = np.arange(0.0, 60.0 + 0.5 * STEP, STEP)
    turns = Rotation.from_euler("ZYX", np.column_stack([0.7 + 0.0 * time, 0.0 * time, 0.0 * time]))
    still = {"level_sigma": 0.0, "mounting_sigma": 0.0, "declination_sigma": 0.0, "field_time": 2.0}
    sigmas = [
        fly(native, turns, turns.apply([50.0, 0, 0]), {**still, "aiding_period": period}, airspeed=50.0)[0]["sigmas"]
        for period in (0.04, 0.4)
    ]
    np.testing.assert_allclose(sigmas[0][-1], sigmas[1][-1], rtol=0.03)


def test_a_magnet_turns_the_heading_little(native):
    """A field that turns by 60 degrees and doubles for ten seconds: taken at its face value, heading follows."""
    time = np.arange(0.0, 60.0 + 0.5 * STEP, STEP)
    turns = Rotation.from_euler("ZYX", np.column_stack([0.3 * np.sin(0.5 * time), 0.0 * time, 0.0 * time]))
    fields = turns.inv().apply(FIELD_N + STRENGTH * np.array([-0.2, 1.4, 0.0]))

    def magnet(k):
        return {"field.field_b": fields[k]} if 30.0 < k * STEP < 40.0 else {}

    _, left = fly(native, turns, np.zeros((len(time), 3)), HAND.values, more=magnet)
    assert np.abs(left[500:, 2]).max() < 5.0


def disturbed(native, disturb, **parameters):
    """Heading error, its sigma (deg) and hard iron by time, s, of legs of half a minute with turns to either side; at
    220 s, on a leg, ``disturb`` (time, fields in b, turns) changes the field. Fields have noise of 1 %."""
    rng = np.random.default_rng(8)
    time = np.arange(0.0, 420.0 + 0.5 * STEP, STEP)
    legs = (time % 50.0 > 25.0) & (time > 50.0)
    rate = np.convolve(np.radians(3.0) * legs * np.where(time % 100.0 > 50.0, 1.0, -1.0), np.ones(100) / 100.0, "same")
    turns = Rotation.from_euler(
        "ZYX", np.column_stack([0.6 + np.cumsum(rate) * STEP, 0.0 * time, np.arctan(50.0 * rate / G)])
    )
    fields = disturb(time, turns.inv().apply(FIELD_N), turns)
    fields = fields + 0.01 * STRENGTH * rng.standard_normal(fields.shape)
    still = {"level_sigma": 0.0, "mounting_sigma": 0.0, "declination_sigma": 0.0}
    got, left = fly(
        native, turns, turns.apply([50.0, 0, 0]), {**still, **parameters}, airspeed=50.0,
        more=lambda k: {"field.field_b": fields[k]},
    )  # fmt: skip
    return time[-len(left) :], left[:, 2], np.degrees(got["sigmas"][:, 2]), got["hard_iron"]


def test_a_current_on_board_is_taken_for_hard_iron(native):
    """40 mG forward, from 220 s on (F16), are told as ``hard_iron``: a filter that knows no jumps gives them to the
    heading, 5 degrees for minutes."""

    def current(time, fields, turns):
        return fields + np.where(time > 220.0, 40e-7, 0.0)[:, None] * [1.0, 0.0, 0.0]

    time, error, _, iron = disturbed(native, current)
    after = time > 221.0
    assert np.sqrt(np.mean(error[after] ** 2)) < 2.0
    assert iron[-1][0] == pytest.approx(40e-7 / STRENGTH, abs=0.02)
    _, without, _, _ = disturbed(native, current, jump_limit=1e6)
    assert np.sqrt(np.mean(without[after] ** 2)) > 4.0


def test_iron_that_bends_the_field_stays_within_sigmas(native):
    """10 % more along the forward axis from 220 s on (F17): twice to and fro in a circle, 3 degrees at most."""
    time, error, sigma, _ = disturbed(
        native, lambda time, fields, turns: np.where((time > 220.0)[:, None], fields * [1.1, 1.0, 1.0], fields)
    )
    assert np.all(np.abs(error[time > 221.0]) < 3.0 * sigma[time > 221.0])


def test_a_place_that_is_disturbed_passes(native):
    """20 mG to the east for two minutes (F18) turn the needle by asin(0.042 / cos 61 degrees), 4.9 degrees, which is
    what the heading may be wrong by, root mean square; a minute later it is right."""

    def anomaly(time, fields, turns):
        there = ((time > 220.0) & (time < 340.0))[:, None]
        return fields + there * turns.inv().apply([0.0, 20e-7, 0.0])

    time, error, _, _ = disturbed(native, anomaly)
    assert np.sqrt(np.mean(error[(time > 220.0) & (time < 340.0)] ** 2)) < 4.9
    assert np.abs(error[time > 400.0]).max() < 1.5


def test_a_field_is_taken_at_its_time_with_samples_that_are_rare(native):
    """Turning by 1 rad/s with samples every 0.1 s, and aided in between: a filter that turns the field back from the
    time of aiding, and not from that of its attitude, has a heading that is wrong by half of that, 3 degrees."""
    time = np.arange(0.0, 120.0, 0.1)
    turns = Rotation.from_euler("z", time[:, None])
    forces, fields = turns.inv().apply(-GRAVITY), turns.inv().apply(FIELD_N)

    def inputs(t):
        k = round(t / STEP) // 5
        values = {"imu.rate": (0.0, 0.0, 1.0), "imu.specific_force": forces[k], "field.field_b": fields[k]}
        for bundle in ("imu", "field"):
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k + 1, f"{bundle}.time_of_validity": time[k]}
        return values

    told = {"sample_period": STEP, "declination": DECLINATION, "aiding_period": 0.16, "airspeed": 0.0}
    got = native.run(118.0, STEP, ["turn", "attitude.time_of_validity"], told, inputs)
    estimated = Rotation.from_quat(np.roll(got["turn"], -1, axis=1))
    left = (
        Rotation.from_euler("z", np.reshape(got["attitude.time_of_validity"], (-1, 1))) * estimated.inv()
    ).as_rotvec()
    assert np.degrees(np.abs(left[3000:, 2])).max() < 0.5


def test_the_first_declination_turns_all_that_is_in_n(native):
    """The filter knows no north but that of the field. So one whose declination is wrong by 1.5 rad until it gets a
    position goes on as one that knew it from the start; what is left behind in the old n (place, sums, covariance)
    shows as a difference. Between two aidings, and in motion, so that nothing in n is zero."""
    time = np.arange(0.0, 12.0 + 0.5 * STEP, STEP)
    turns = Rotation.from_euler("ZYX", np.column_stack([time, 0.2 * np.sin(time), 0.4 * np.sin(0.7 * time)]))
    velocities = np.column_stack([np.sin(time), 0.3 * np.cos(2.0 * time), 0.2 * np.sin(3.0 * time)])
    here = {"position.latitude": 0.66, "position.longitude": -2.1, "position.altitude": 1500.0}
    told = {**HAND.values, "chart_period": 5.03, "gyro_scale_sigma": 0.0}

    def found(declination):
        return fly(
            native, turns, velocities, {**told, "declination": declination},
            more=lambda k: here | {"position.valid": True, "position.sequence": 1},
        )[0]  # fmt: skip

    known = found(found(0.0)["local_declination"][-1])
    other = found(known["local_declination"][-1] + 1.5)
    assert np.abs(other["turn"][200] - known["turn"][200]).max() > 0.1
    for name in ("turn", "velocity", "place", "gyro_bias", "hard_iron", "covariance"):
        np.testing.assert_allclose(other[name][260:], known[name][260:], atol=1e-9, err_msg=name)


def test_gps_attitude_takes_an_attitude_that_is_wrong(native):
    """The hard iron turns the field by 15 degrees: with three antennas the heading is theirs, upside down too."""
    time = np.arange(0.0, 40.0 + 0.5 * STEP, STEP)
    angles = np.column_stack([0.0 * time - 2.0, 0.0 * time + 0.1, 0.0 * time])
    turns = Rotation.from_euler("ZYX", angles)

    def told(k):
        heading, pitch, roll = angles[k]
        values = {"gps.roll": roll, "gps.pitch": pitch, "gps.heading": heading}
        return values | {"gps.valid": True, "gps.sequence": k, "gps.time_of_validity": k * STEP}

    iron = (0.0, 0.12, 0.0)
    _, alone = fly(native, turns, turns.apply([50.0, 0, 0]), airspeed=50.0, iron=iron)
    _, aided = fly(native, turns, turns.apply([50.0, 0, 0]), airspeed=50.0, iron=iron, more=told)
    assert np.abs(alone[-1, 2]) > 5.0
    assert np.abs(aided[-1]).max() < 0.2


@pytest.mark.parametrize("name", ["air.true_airspeed", "field.field_b", "imu.rate", "imu.specific_force"])
@pytest.mark.parametrize("value", [np.nan, 1e6, 1e18])
def test_one_sample_that_no_sensor_has_is_no_end(native, name, value):
    """Valid, and no number or an absurd one: a filter that lets it into its states shows no attitude for the rest of
    the flight, or one that is wrong: of an airspeed of 1e6 m/s by half a turn, for minutes."""
    time = np.arange(0.0, 60.0 + 0.5 * STEP, STEP)
    turns = Rotation.from_euler("ZYX", np.column_stack([0.0 * time + 0.7, 0.0 * time, 0.0 * time]))
    _, left = fly(
        native, turns, turns.apply([50.0, 0, 0]), airspeed=50.0, more=lambda k: {name: value} if k == 1000 else {}
    )
    assert np.abs(left[-500:]).max() < 0.1


def test_it_takes_the_place_of_ahrs():
    """The same bundles with the same members, units and numbers."""
    for name, bundle in Ahrs.layout.bundles.items():
        other = AhrsVelocity.layout.bundles[name]
        assert other.causality == bundle.causality
        assert {n: (m.unit, m.shape) for n, m in other.members.items()} == {
            n: (m.unit, m.shape) for n, m in bundle.members.items()
        }


# --- consistency -----------------------------------------------------------------------------------------------------

SEEDS, LONG, PERIOD = 24, 120.0, 0.5
MODELLED = {
    "gyro_noise": 0.002, "alpha": 1.0, "gyro_scale_sigma": 0.0, "gyro_null_shift_sigma": 0.003, "gyro_drift_sigma": 0.0,
    "hard_iron_sigma": 0.02, "field_sigma": 0.02, "field_time": 0.0, "field_noise": 0.0, "field_limit": 10.0,
    "jump_limit": 10.0, "dip_sigma": 0.1, "dip_walk": 0.0, "velocity_walk": 0.35, "velocity_density": 0.7,
    "flow_sigma": 1.5, "flow_time": 5.0, "airspeed_time": 1e6, "aiding_period": PERIOD, "initial_sigma": 0.03,
}  # fmt: skip
"""What the filter is told, and what :func:`drawn` does."""


def drawn(native, seed, seconds=LONG, **changed):
    """What is left of the turn (rad) and of the gyro biases (rad/s), and their covariances, at the end of a flight of
    random turns that errs as modelled."""
    rng, count = np.random.default_rng(seed), round(seconds / STEP) + 1
    told = MODELLED | changed
    time = np.arange(count) * STEP
    turning = np.repeat(rng.uniform(-0.05, 0.05, count // 1000 + 1), 1000)[:count]
    smooth = np.convolve(turning, np.ones(100) / 100.0, "same")
    heading = rng.uniform(-np.pi, np.pi) + np.cumsum(smooth) * STEP
    turns = Rotation.from_euler(
        "ZYX", np.column_stack([heading, 0.05 * np.sin(0.2 * time), np.arctan(50.0 * smooth / G)])
    )
    # across the nose: Gauss-Markov; the airspeed's own error stands still
    decay, white = np.exp(-STEP / told["flow_time"]), rng.standard_normal((count, 2))
    across = told["flow_sigma"] * rng.standard_normal(2)
    flow = np.zeros((count, 3))
    for k in range(count):
        across = decay * across + told["flow_sigma"] * np.sqrt(1.0 - decay**2) * white[k]
        flow[k, 1:] = across
    wind = np.cumsum(told["velocity_walk"] * np.sqrt(STEP) * rng.standard_normal((count, 3)), axis=0)
    air = turns.apply([50.0, 0.0, 0.0] - flow)
    error = 2.0 * rng.standard_normal()
    noise = told["velocity_density"] / np.sqrt(PERIOD) * rng.standard_normal(count)
    null_shift = told["gyro_null_shift_sigma"] * rng.standard_normal(3)
    rates = null_shift + told["gyro_noise"] * rng.standard_normal((count, 3))
    iron = told["hard_iron_sigma"] * rng.standard_normal(3)
    fields = turns.inv().apply(FIELD_N) + STRENGTH * (iron + told["field_sigma"] * rng.standard_normal((count, 3)))

    def more(k):
        return {
            "field.field_b": fields[k],
            "air.true_airspeed": 50.0 + error + noise[k],
            "air.true_airspeed_sigma": 2.0,
        }

    still = {"level_sigma": 0.0, "mounting_sigma": 0.0, "declination_sigma": 0.0}
    got, left = fly(
        native, turns, air + wind, {**told, **still}, airspeed=50.0, more=more, wrong=rates
    )  # fmt: skip
    covariance = kalman.unpack(got["covariance"][-1])
    return (np.radians(left[-1]), covariance[:3, :3]), (null_shift - got["gyro_bias"][-1], covariance[9:12, 9:12])


def test_errors_are_as_large_as_they_are_said_to_be(native):
    """Of 24 flights the squares of the turn that is left over its covariance: chi-square of 72, 99.9 % of it.

    Sigmas of twice the size have a quarter of that, a filter that takes the wind for a third of what it is 4.5 times.
    """
    flights = (drawn(native, seed)[0] for seed in range(SEEDS))
    squares = [left @ np.linalg.solve(covariance, left) for left, covariance in flights]
    low, high = stats.chi2.ppf([0.0005, 0.9995], 3 * SEEDS)
    assert low < np.sum(squares) < high


def test_gyro_biases_are_as_uncertain_as_they_are_said_to_be_from_the_start(native):
    """Of 48 flights of 30 s, chi-square of 144, 99.9 % of it. A filter that takes the velocity of its alignment for as
    good as the airspeed without its noise lets the biases explain that noise.

    The first level is that of the mean force in the first half second, in which a flow of 0.2 m/s that lasts for 5 s
    changes by 0.09 m/s, 0.018 rad, and the wind by 0.035 m/s, 0.007 rad: as ``initial_sigma`` has it."""
    calm = {"flow_sigma": 0.2, "velocity_walk": 0.05, "velocity_density": 0.3, "initial_sigma": 0.02}
    flights = (drawn(native, seed, 30.0, **calm)[1] for seed in range(2 * SEEDS))
    squares = [left @ np.linalg.solve(covariance, left) for left, covariance in flights]
    low, high = stats.chi2.ppf([0.0005, 0.9995], 6 * SEEDS)
    assert low < np.sum(squares) < high, np.sum(squares)


def test_the_first_velocity_errs_as_the_airspeed_it_was_read_from():
    """So the second airspeed differs from it by the noise of both: with sigma 2 the innovation has 4, and 4 of its own.
    What flow, tilt and heading add cancels."""
    q = quaternion.of_euler(0.1, 0.05, 1.0)
    velocity = quaternion.dcm(q) @ np.array([50.0, 0.0, 0.0])
    upper = ahrs_velocity.initial_covariance(
        q, velocity, np.float64(0.05), np.float64(0.01), 0.1, 0.02, np.array([2.0, 1.0, 1.0]), 2.0
    )
    matrix = ahrs_velocity.rows(ahrs_velocity.flow_seen, q, velocity, np.zeros(3))[1]
    np.testing.assert_allclose(matrix @ kalman.unpack(upper) @ matrix.T, 4.0 * np.eye(3), atol=1e-9)
