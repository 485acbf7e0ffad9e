"""AHRS: its equations against numbers, and the component on the aircraft's own motion."""

import numpy as np
import pygeomag
import pytest

from fmus.attitude.ahrs import Ahrs
from fmus.grades import GRADES, MAGNETOMETER, ahrs_parameters
from models.attitude import ahrs, attitude
from models.earth import earth
from models.filters import kalman
from models.magnetic import magnetometer
from models.motion.flight_plan import FlightPlan, straight, turn
from navfmu.constants import STANDARD_GRAVITY
from tests.models.native import Native, interpret

PERIOD = 0.1
G = STANDARD_GRAVITY
DIP, DECLINATION, STRENGTH = np.radians(61.0), np.radians(13.0), 4.8e-5
SPEED = 46.3
LEVEL_SIGMA = interpret(Ahrs).get("level_sigma")
ANGLES = ("roll", "pitch", "heading")
NAMES = [f"attitude.{name}{suffix}" for name in ANGLES for suffix in ("", "_sigma")]
NAMES += ["gyro_bias", "hard_iron", "dip", "tilt_noise", "local_declination", "covariance"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Ahrs, tmp_path_factory.mktemp("ahrs"))


def wrap(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def motion(time, speed, heading, roll, pitch=0.0, climb=0.0):
    """What ideal sensors show of a motion given as arrays over time: level or with a pitch; closed formulas."""
    step = time[1] - time[0]
    roll, pitch, speed, climb = (x + 0.0 * time for x in (roll, pitch, speed, climb))
    turn_rate = np.gradient(heading, step)
    rates = attitude.body_rate(
        np.gradient(roll, step), np.gradient(pitch, step), turn_rate,
        np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch),
    )  # fmt: skip
    velocity_n = np.stack([speed * np.cos(heading), speed * np.sin(heading), -climb])
    force_n = np.gradient(velocity_n, step, axis=1) - np.array([0.0, 0.0, G])[:, None]
    c_nb = attitude.dcm(roll, pitch, heading)
    return {
        "time": time,
        "roll": roll,
        "pitch": pitch,
        "heading": heading,
        "speed": speed,
        "rate": rates,
        "force": np.einsum("jit,jt->it", c_nb, force_n),
        "field": STRENGTH * np.einsum("jit,j->it", c_nb, ahrs.field_n(DIP, DECLINATION)),
    }


def coordinated(time, speed, turn_rate):
    """A level turn at a constant rate from the first moment on."""
    return motion(time, speed, turn_rate * time, np.arctan(speed * turn_rate / G))


@pytest.fixture(scope="module")
def flight():
    """Ten minutes with two 360-degree turns, analytic: angles, body rates and specific force at each sample."""
    segments = (
        straight(90.0, SPEED),
        turn(2.0 * np.pi, np.radians(3.0), SPEED),
        straight(50.0, SPEED),
        turn(-2.0 * np.pi, np.radians(1.5), SPEED),
        straight(90.0, SPEED),
    )
    track = FlightPlan(0.65, -2.1, 1500.0, 0.4, SPEED, segments).sample(PERIOD)
    heading = np.unwrap(track["track"])
    roll = np.arctan(SPEED * np.gradient(heading, PERIOD) / G)
    return motion(track["time"], SPEED, heading, roll)


def fly(
    native, flight, parameters=None, bias=(0.0, 0.0, 0.0), noise=0.0, field_until=1e9, air_until=1e9, iron=0.0,
    position_from=1e9,
):  # fmt: skip
    """Outputs, and errors of roll, pitch and heading (deg), from samples at PERIOD, 2 PERIOD ... of the flight."""
    rng = np.random.default_rng(3)
    white = noise * rng.standard_normal(flight["rate"].shape)
    held = {}

    def inputs(t):
        k = round(t / PERIOD) + 1  # the sample that is taken at the end of this step
        now = k * PERIOD
        values = {"imu.rate": flight["rate"][:, k] + bias + white[:, k], "imu.specific_force": flight["force"][:, k]}
        seen = ["imu"]
        if now <= field_until:
            values["field.field_b"] = flight["field"][:, k] + iron
            seen.append("field")
        if now <= air_until:
            values["air.true_airspeed"] = flight["speed"][k]
            seen.append("air")
        if now >= position_from:
            values |= {f"position.{name}": flight["position"][name][k] for name in flight["position"]}
            seen.append("position")
        for bundle in seen:
            held[f"{bundle}.valid"], held[f"{bundle}.sequence"], held[f"{bundle}.time_of_validity"] = True, k, now
        return values | held

    stop = (len(flight["time"]) - 1) * PERIOD
    got = native.run(
        stop, PERIOD, NAMES, {"sample_period": PERIOD, "declination": DECLINATION, **(parameters or {})}, inputs
    )
    return got, {name: np.degrees(wrap(got[f"attitude.{name}"] - flight[name])) for name in ANGLES}


# --- equations -------------------------------------------------------------------------------------------------------


def derivatives(function, x, step=1e-6):
    return np.stack([(function(x + step * d) - function(x - step * d)) / (2 * step) for d in np.eye(len(x))], axis=1)


def test_levelling_and_compass_return_the_attitude_they_were_made_from():
    """In a turn, too, once the turning acceleration is taken away."""
    for roll, pitch, heading in [(0.0, 0.0, 0.0), (0.3, -0.2, 2.5), (-0.9, 0.4, -1.2)]:
        c_nb = attitude.dcm(roll, pitch, heading)
        turning = ahrs.turning_acceleration(80.0, np.array([0.01, 0.03, 0.05]))
        got = ahrs.level(c_nb.T @ np.array([0.0, 0.0, -9.8]) + turning, turning)
        assert got == pytest.approx((roll, pitch), abs=1e-12)
        magnetic, down = ahrs.levelled_heading(c_nb.T @ ahrs.field_n(DIP, 0.0), roll, pitch)
        assert magnetic == pytest.approx(heading, abs=1e-12)
        assert down == pytest.approx(np.sin(DIP), abs=1e-12)


def test_the_turning_acceleration_is_the_cross_product_of_rate_and_velocity():
    rate = np.array([0.3, -0.2, 0.5])
    np.testing.assert_allclose(
        ahrs.turning_acceleration(70.0, rate), np.cross(rate, [70.0, 0.0, 0.0]), rtol=0, atol=1e-15
    )


def test_dynamics_are_the_derivatives_of_the_euler_rates():
    """Including row 2, column 3 = -sin(roll), which (4.35) prints as -cos(roll)."""
    x = np.array([0.4, -0.25, 1.0, 0.0, 0.0, 0.0])
    rate, time = np.array([0.02, 0.05, -0.07]), 0.5
    numeric = derivatives(lambda y: attitude.euler_rates(rate - y[3:], y[0], y[1]), x)
    phi = ahrs.dynamics(x[0], x[1], rate, time)
    np.testing.assert_allclose(phi, np.eye(6)[:3] + time * numeric, atol=1e-9)
    assert phi[1, 5] == pytest.approx(time * np.sin(0.4))


def test_field_rows_are_the_derivatives_of_the_direction_of_the_measured_field():
    """By attitude, dip and hard iron; across the field only, for a direction has no length."""
    x = np.array([0.4, -0.25, 1.0, 0.0, 0.0, 0.0, 1.1, 0.02, -0.01, 0.03, 0.0])

    def seen(y):
        v = attitude.dcm(*y[:3]).T @ ahrs.field_n(y[6], DECLINATION) + y[7:10]
        return v / np.linalg.norm(v)

    unit, rows = ahrs.field_rows(x[0], x[1], x[2], x[6], DECLINATION, x[7:10])
    np.testing.assert_allclose(unit, seen(x), atol=1e-14)
    np.testing.assert_allclose(rows, derivatives(seen, x), atol=1e-9)


def test_tilt_rows_are_the_derivatives_of_the_specific_force():
    """By the bias of the yaw gyro and by the airspeed as well: V r has their errors."""
    x = np.array([0.4, -0.25, 1.0, 0.001, 0.002, -0.003, 0.0, 0.0, 0.0, 0.0, 2.0])
    measured, seen = np.array([0.02, 0.05, -0.07]), 80.0

    def expected(y):
        """(2) over g without V', of an aircraft at V = seen - v that turns at measured - b."""
        c_bn = attitude.dcm(*y[:3]).T
        turning = np.cross(measured - y[3:6], [seen - y[10], 0.0, 0.0])
        return ((turning - c_bn @ [0.0, 0.0, G]) / G)[[1, 0]]

    rows = ahrs.tilt_rows(seen - x[10], (measured - x[3:6])[2], x[0], x[1])
    np.testing.assert_allclose(rows, derivatives(expected, x), atol=1e-9)
    force = np.array([0.3, -0.4, -9.9])
    residuals = ahrs.tilt_residuals(force, seen - x[10], measured - x[3:6], x[0], x[1])
    np.testing.assert_allclose(residuals, force[[1, 0]] / G - expected(x), atol=1e-14)


@pytest.mark.parametrize("colour", [0.0, 0.6, 0.9])
def test_the_learned_level_is_the_density_at_low_frequency(colour):
    """Noise x = (1 - c) sum of c^k white has the density of the white noise at zero frequency, but (1-c)/(1+c) of its
    variance: a level from squares of single innovations, not of their sum, would be 0.25 and 0.05 of the truth.

    400 windows of 60: the mean square of 400 sums has a sigma of sqrt(2 / 400) = 7 %; a window of 60 correlated over
    10 lacks c / (1 - c^2) / 60 * 2 of it, at most 16 %.
    """
    rng = np.random.default_rng(7)
    white, x, state = rng.standard_normal(24000), [], 0.0
    for w in white:
        state = colour * state + (1.0 - colour) * w
        x.append(state)
    sums = np.sum(np.reshape(x, (400, 60)), axis=1)
    level = 1.0
    for k, total in enumerate(sums):
        level = ahrs.learned((level, total, 60.0), 1.0 / (k + 1.0), 0.0)
    lost = 2.0 * colour / (1.0 - colour**2) / 60.0
    assert 1.0 - lost - 3 * 0.07 < level < 1.0 + 3 * 0.07


def test_an_innovation_that_does_not_fit_raises_the_level_to_where_it_is_three_sigma():
    assert ahrs.raised(1.0, 2.9, 1.0, 1.0, 3.0) == 1.0
    assert ahrs.raised(1.0, 6.0, 1.0, 1.0, 3.0) == pytest.approx(4.0)
    assert ahrs.raised(1.0, 6.0, 4.0, 1.0, 3.0) == 1.0  # the sum of four has twice the sigma
    assert ahrs.raised(1.0, 6.0, 1.0, 4.0, 3.0) == 1.0  # one of four that are enough
    assert ahrs.learned((1.0, 0.0, 9.0), 1.0, 0.25) == 0.25
    assert ahrs.learned((1.0, 0.0, 0.0), 1.0, 0.25) == 1.0  # nothing was seen


def test_a_gust_along_is_no_noise_that_lasts():
    """The difference of a Gauss-Markov gust of 1.5 m/s and 11.5 s (5 ft/s at 90 kn) in steps of 0.5 s, which
    the airspeed shows and the force does not, beside white noise of level 1 (4 degrees): single innovations have
    1 + 2 * 1.5^2 (1 - exp(-0.5 / 11.5)) / 0.342^2 = 2.6 of its variance, sums over the window 1.6. The mean level of
    200 runs has a standard error of 0.02; one that a single innovation raises is 2.0.
    """
    rng = np.random.default_rng(3)
    decay = np.exp(-0.5 / 11.5)
    runs, unit = 200, 0.5 * G * np.radians(4.0)
    gust = 1.5 * rng.standard_normal(runs)
    level, means = np.ones(runs), []
    for _ in range(60):
        total = np.zeros(runs)
        for count in range(1, 61):
            later = decay * gust + 1.5 * np.sqrt(1.0 - decay**2) * rng.standard_normal(runs)
            total = total + rng.standard_normal(runs) + (later - gust) / unit
            gust = later
            level = ahrs.raised(level, total, count, 20.0, 3.0)
        level = ahrs.learned((level, total, 60.0), 0.05, 0.25)
        means.append(np.mean(level))
    assert 1.5 < np.mean(means[20:]) < 1.9


@pytest.mark.parametrize(("pitch", "dip"), [(10.0, 100.0), (95.0, 60.0), (-100.0, -91.0), (30.0, -60.0)])
def test_angles_beyond_the_vertical_are_the_same_attitude_and_field(pitch, dip):
    angles = 0.2, np.radians(pitch), 0.3
    roll, now, heading, new_dip, over, under = ahrs.upright(*angles, np.radians(dip))
    assert (bool(over), bool(under)) == (abs(pitch) > 90.0, abs(dip) > 90.0)
    assert max(abs(now), abs(new_dip)) <= 0.5 * np.pi
    np.testing.assert_allclose(
        attitude.dcm(roll, now, heading).T @ ahrs.field_n(new_dip, DECLINATION),
        attitude.dcm(*angles).T @ ahrs.field_n(np.radians(dip), DECLINATION),
        atol=1e-14,
    )
    down = np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(attitude.dcm(roll, now, heading).T @ down, attitude.dcm(*angles).T @ down, atol=1e-14)


def test_the_covariance_follows_the_side_that_is_changed():
    root = np.random.default_rng(1).standard_normal((11, 14))
    upper = kalman.pack(root @ root.T)
    flip = np.eye(11)
    flip[6, 6] = -1.0
    np.testing.assert_allclose(kalman.unpack(ahrs.mirrored(upper, True, ahrs.DIP)), flip @ root @ root.T @ flip)
    np.testing.assert_array_equal(ahrs.mirrored(upper, False, ahrs.DIP), upper)


def test_an_airspeed_that_is_back_has_an_error_of_its_own():
    rng = np.random.default_rng(2)
    root = rng.standard_normal((11, 14))
    got = kalman.unpack(ahrs.renewed(kalman.pack(root @ root.T), 4.0, True))
    wanted = root @ root.T
    wanted[10, :] = wanted[:, 10] = 0.0
    wanted[10, 10] = 4.0
    np.testing.assert_array_equal(got, wanted)


def test_a_grade_tells_the_ahrs_what_its_imu_has():
    """All of it parameters of the component; what is drawn at turn-on is in the sigmas; and no gyro, however good, is
    believed to better than the part of Earth's rate that it sees."""
    told = {grade: ahrs_parameters(grade) for grade in GRADES}
    for grade, imu in GRADES.items():
        assert set(told[grade]) <= set(Ahrs.layout.fields)
        assert told[grade]["level_sigma"] >= imu["accelerometer_null_shift_sigma"] / G
        assert told[grade]["gyro_null_shift_sigma"] == imu["gyro_null_shift_sigma"]
        assert told[grade]["gyro_drift_sigma"] >= max(imu["gyro_drift_sigma"], np.radians(9.0) / 3600.0)
    assert told["consumer"]["level_sigma"] == pytest.approx(2.0 * told["automotive"]["level_sigma"])
    start = interpret(Ahrs)
    assert all(start.get(name) == value for name, value in told["automotive"].items())


def test_the_needle_is_believed_to_what_its_triad_is_worth():
    """Heading errors of 20000 drawn triads on 24 headings at a horizontal field, where hard iron and level do nothing
    to it: rms to 1 %. Without the errors that turn twice in a circle the sigma is 0.32 instead of 0.41 degrees."""
    rng = np.random.default_rng(4)
    soft, scale, turned = (MAGNETOMETER[f"{name}_sigma"] for name in ("soft_iron", "scale_factor", "misalignment"))
    headings = np.arange(24) * np.pi / 12
    truth = np.array([np.cos(headings), -np.sin(headings), 0.0 * headings])
    square = 0.0
    for _ in range(20000):
        draws = rng.standard_normal((3, 3)), rng.standard_normal(3), rng.standard_normal(3)
        seen = magnetometer.distortion(soft * draws[0], scale * draws[1], turned * draws[2]) @ truth
        square += np.mean(wrap(np.arctan2(-seen[1], seen[0]) - headings) ** 2) / 20000
    assert ahrs_parameters("automotive")["mounting_sigma"] == pytest.approx(np.sqrt(square), rel=0.02)


# --- closed forms ----------------------------------------------------------------------------------------------------


def test_at_rest_the_angles_are_those_of_force_and_field(native):
    """Roll 3, pitch -2, heading 40 degrees; no airspeed."""
    time = np.arange(0.0, 60.0, PERIOD)
    still = motion(time, 0.0, np.radians(40.0) + 0.0 * time, np.radians(3.0), np.radians(-2.0))
    got, error = fly(native, still)
    for name in ANGLES:
        assert np.max(np.abs(error[name][6:])) < 1e-6, name
        assert got[f"attitude.{name}_sigma"][-1] < np.radians(3.0)


def test_a_turn_that_has_begun_long_ago_is_seen_as_a_turn(native):
    """Ninety m/s, 3 deg/s: 25.7 degrees of bank, and the accelerometers show none. Levelling takes it for level flight,
    and a gate closed in turns leaves it at that."""
    _, error = fly(native, coordinated(np.arange(0.0, 180.0, PERIOD), 90.0, np.radians(3.0)))
    for name in ANGLES:
        assert np.max(np.abs(error[name][10:-2])) < 0.2, name


@pytest.mark.parametrize("acceleration", [0.5, -0.25])
def test_an_aircraft_that_gains_speed_does_not_pitch_up(native, acceleration):
    """0.5 m/s2 turn the specific force by 2.9 degrees and change its length by 0.13 %: no gate sees it.

    The first alignment, before there are two airspeeds, takes it for pitch; after 30 s a tenth of that is left at most.
    """
    time = np.arange(0.0, 90.0, PERIOD)
    dash = motion(time, 50.0 + acceleration * time, 0.7 + 0.0 * time, 0.0)
    _, error = fly(native, dash)
    assert np.max(np.abs(error["pitch"][300:-2])) < np.degrees(abs(acceleration) / G) / 10
    got, blind = fly(native, dash, air_until=-1.0)
    assert abs(blind["pitch"][-10]) > np.degrees(abs(acceleration) / G) / 2
    assert abs(blind["pitch"][-10]) < 3 * np.degrees(got["attitude.pitch_sigma"][-10])


# --- the component ---------------------------------------------------------------------------------------------------


def test_with_perfect_sensors_the_attitude_is_exact_through_turns(native, flight):
    """Bound: samples of 0.1 s, between which the roll rate begins and ends."""
    _, error = fly(native, flight)
    for name in ANGLES:
        assert np.max(np.abs(error[name][20:])) < 0.3, name


def test_gyro_biases_are_found_and_removed(native, flight):
    """0.1, -0.07 and 0.05 deg/s: found to 0.01 deg/s; by the end the attitude is as good as without."""
    bias = np.radians([0.1, -0.07, 0.05])
    got, error = fly(native, flight, bias=bias)
    np.testing.assert_allclose(got["gyro_bias"][-1], bias, atol=np.radians(0.01))
    for name in ANGLES:
        assert np.max(np.abs(error[name][-800:])) < 0.5, name


def test_hard_iron_is_found_in_turns(native, flight):
    """5 mG forward and -4 mG right turn the needle of a horizontal field of 233 mG by 1.2 and 1 degree; after two full
    turns less than a quarter of that is left."""
    iron = np.array([5e-7, -4e-7, 0.0])
    got, error = fly(native, flight, noise=np.radians(0.05), iron=iron[:, None].T[0])
    limit = np.degrees(np.linalg.norm(iron) / (STRENGTH * np.cos(DIP)))
    assert np.max(np.abs(error["heading"][:400])) > 0.5 * limit
    assert np.sqrt(np.mean(error["heading"][-600:] ** 2)) < 0.25 * limit
    np.testing.assert_allclose(got["hard_iron"][-1][:2], iron[:2] / STRENGTH, atol=0.3 * 5e-7 / STRENGTH)


def test_a_hard_iron_that_jumps_is_learned_and_leaves_the_heading(native, flight):
    """40 mG more forward in straight flight at 220 s, which are 9.7 degrees at a horizontal field of 233 mG. A filter
    whose hard iron is settled gives the jump to the heading and keeps its sigma."""
    jump = np.where(flight["time"] > 220.0, 40e-7, 0.0) * np.array([1.0, 0.0, 0.0])[:, None]
    got, error = fly(native, flight | {"field": flight["field"] + jump}, noise=np.radians(0.05))
    assert np.max(np.abs(error["heading"][2200:])) < 9.7 / 3
    for name in ANGLES:
        assert np.mean(np.abs(error[name][2200:]) < 3 * np.degrees(got[f"attitude.{name}_sigma"][2200:])) > 0.95, name
    assert got["hard_iron"][-1][0] == pytest.approx(40e-7 / STRENGTH, rel=0.2)


def test_without_air_data_the_sigmas_are_wider_and_right(native, flight):
    """From 60 s on no air data: all errors of the analytic flight stay within three sigma, which are wider."""
    bias, noise = np.radians([0.05, 0.05, -0.05]), np.radians(0.05)
    whole, _ = fly(native, flight, bias=bias, noise=noise)
    blind, error = fly(native, flight, bias=bias, noise=noise, air_until=60.0)
    for name in ANGLES:
        sigma = blind[f"attitude.{name}_sigma"]
        assert np.all(sigma[700:] > whole[f"attitude.{name}_sigma"][700:])
        assert np.mean(np.abs(error[name][100:]) < 3 * np.degrees(sigma[100:])) > 0.99, name


def test_never_any_air_data_is_flown_through(native, flight):
    got, error = fly(native, flight, air_until=-1.0)
    for name in ANGLES:
        sigma = np.degrees(got[f"attitude.{name}_sigma"])
        assert np.mean(np.abs(error[name][100:]) < 3 * sigma[100:]) > 0.99, name


def test_a_changing_wind_raises_the_noise_of_the_tilt(native, flight):
    """White accelerations of 1 m/s2 in 0.5 s are 5.8 degrees of tilt, a level of 2.13; still air leaves less and less.

    After n windows the level has gone 1 - 0.9^n of the way from 1, with the scatter of n draws of chi2: eight flights
    leave their mean uncertain by that over sqrt(8). For what raises it at once 0.1 is left.
    """
    rng = np.random.default_rng(4)
    count = flight["time"].size
    calm, _ = fly(native, flight)
    levels, sigmas = [], []
    for _ in range(8):
        pushes = np.repeat(rng.standard_normal((2, count // 5 + 1)), 5, axis=1)[:, :count]
        rough, _ = fly(native, flight | {"force": flight["force"] + np.stack([pushes[0], pushes[1], 0.0 * pushes[0]])})
        levels.append((rough["tilt_noise"][-1] / np.radians(4.0)) ** 2)
        sigmas.append([rough[f"attitude.{name}_sigma"][-1] for name in ("roll", "pitch")])
    windows = int((flight["time"][-1] - 1.0) // 60.0)
    target = (1.0 / G / np.radians(4.0)) ** 2
    gains = 0.1 * 0.9 ** np.arange(windows)
    expected = target * np.sum(gains) + 0.9**windows
    error = target * np.sqrt(2.0 * np.sum(gains**2) / 8)
    mean = np.mean(levels, axis=0)
    assert np.all(mean > expected - 3.0 * error)
    assert np.all(mean < expected + 3.0 * error + 0.1)
    np.testing.assert_allclose(calm["tilt_noise"][-1], np.radians(4.0) * 0.9 ** (0.5 * windows), rtol=1e-3)
    for name, sigma in zip(("roll", "pitch"), np.mean(sigmas, axis=0), strict=True):
        assert sigma**2 - LEVEL_SIGMA**2 > 1.15**2 * (calm[f"attitude.{name}_sigma"][-1] ** 2 - LEVEL_SIGMA**2)


def test_an_attitude_that_is_lost_is_found_again(native):
    """The aircraft is thrown round within one sample, which the gyros do not show. The attitude is wrong by 50 degrees
    in roll and does not know it. A filter that takes all misfit for noise stays there: its gain has gone."""
    time = np.arange(0.0, 300.0, PERIOD)
    thrown = motion(time, 60.0, 0.3 + 0.0 * time, np.where(time < 100.0, np.radians(-50.0), 0.0))
    level = motion(time, 60.0, 0.3 + 0.0 * time, 0.0)
    joined = {name: np.where(time < 100.0, thrown[name], level[name]) for name in level}
    joined["rate"] = 0.0 * level["rate"]
    got, error = fly(native, joined)
    assert np.max(np.abs(error["roll"][1002:1005])) > 40.0
    for name in ANGLES:
        assert np.max(np.abs(error[name][2000:])) < 1.0, name
        assert np.all(np.abs(error[name][2000:]) < 3 * np.degrees(got[f"attitude.{name}_sigma"][2000:]))


@pytest.mark.parametrize("by", ["field", "gps"])
def test_what_aids_is_taken_at_its_time_with_samples_that_are_rare(native, by):
    """Turning by 1 rad/s with samples every 0.1 s, aided between them: a filter that turns field or GPS attitude back
    from the time of aiding, and not from that of its angles, has a heading that is wrong by half of 0.1 s, 3 degrees.
    """
    apart, step = 0.1, 0.02

    def inputs(t):
        k = round(t / step) // 5
        heading = wrap(apart * k)
        values = {"imu.rate": (0.0, 0.0, 1.0), "gps.heading": heading}
        values["field.field_b"] = STRENGTH * attitude.dcm(0.0, 0.0, heading).T @ ahrs.field_n(DIP, DECLINATION)
        for bundle in {"imu", "field", by}:
            if bundle != "field" or by == "field" or k < 10:
                values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k + 1}
                values[f"{bundle}.time_of_validity"] = apart * k
        return values

    told = {"sample_period": step, "declination": DECLINATION, "aiding_period": 0.16, "airspeed": 0.0}
    got = native.run(120.0, step, ["attitude.heading", "attitude.time_of_validity"], told, inputs)
    left = np.degrees(wrap(got["attitude.time_of_validity"] - got["attitude.heading"]))
    assert np.abs(left[3000:]).max() < 0.5


def test_a_field_is_taken_at_its_time_while_the_aircraft_rolls(native):
    """By 30 degrees to either side, with a field that is 0.1 s old: roll turns by up to 3 degrees in that time, and is
    wrong by 2 where heading alone is turned back."""
    step, late, begin = 0.02, 0.1, 10.0

    def rolled(t):
        return 0.5 * np.sin(np.maximum(t - begin, 0.0))

    def inputs(t):
        roll, then = rolled(t), rolled(t - late)
        values = {"imu.rate": (0.5 * np.cos(t - begin) if t > begin else 0.0, 0.0, 0.0)}
        values["imu.specific_force"] = attitude.dcm(roll, 0.0, 0.5).T @ np.array([0.0, 0.0, -STANDARD_GRAVITY])
        values["field.field_b"] = STRENGTH * attitude.dcm(then, 0.0, 0.5).T @ ahrs.field_n(DIP, DECLINATION)
        for bundle in ("imu", "field"):
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": round(t / step) + 1}
            values[f"{bundle}.time_of_validity"] = t - (late if bundle == "field" else 0.0)
        return values

    told = {"sample_period": step, "declination": DECLINATION, "airspeed": 0.0}
    got = native.run(60.0, step, ["attitude.roll", "attitude.time_of_validity"], told, inputs)
    left = np.degrees(got["attitude.roll"] - rolled(got["attitude.time_of_validity"]))
    assert np.abs(left[1500:]).max() < 0.5


@pytest.mark.parametrize("value", [np.nan, 1e6, 1e18])
@pytest.mark.parametrize("name", ["imu.rate", "imu.specific_force", "air.true_airspeed", "gps.heading"])
def test_one_sample_that_no_sensor_has_is_no_end(native, name, value):
    """One that is valid, in level flight: a rate of 1e18 turns angles and biases to where they never come back from,
    and a heading of 1e18 is beyond what an angle can be wrapped from."""
    time = np.arange(0.0, 60.0, PERIOD)
    level = motion(time, 60.0, 0.3 + 0.0 * time, 0.0)

    def inputs(t):
        k = round(t / PERIOD) + 1
        values = {"imu.rate": level["rate"][:, k], "imu.specific_force": level["force"][:, k]}
        values |= {"field.field_b": level["field"][:, k], "air.true_airspeed": 60.0, "gps.heading": 0.3}
        for bundle in {"imu", "field", "air", name.split(".")[0]}:
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k, f"{bundle}.time_of_validity": k * PERIOD}
        return values | ({name: value} if k == 300 else {})

    got = native.run(59.0, PERIOD, NAMES, {"sample_period": PERIOD, "declination": DECLINATION}, inputs)
    left = [np.degrees(wrap(got[f"attitude.{name}"][350:] - level[name][350:591])) for name in ANGLES]
    assert np.abs(left).max() < 1.0


def test_without_the_field_roll_and_pitch_are_still_aided_and_heading_drifts(native, flight):
    """The field stops after 30 s. Roll error after the last straight leg is small, heading has gone with the bias."""
    bias = np.radians([0.0, 0.0, 0.1])
    got, error = fly(native, flight, bias=bias, field_until=30.0)
    assert np.max(np.abs(error["roll"][-100:])) < 1.0
    assert np.max(np.abs(error["heading"])) > 5.0
    assert np.all(np.abs(error["heading"][10:]) < 3 * np.degrees(got["attitude.heading_sigma"][10:]))


def test_nothing_is_valid_before_the_first_alignment(native, flight):
    """The first aiding is at 0.5 s; the first attitude after it is right to the accuracy of its sensors."""
    run = interpret(Ahrs, sample_period=PERIOD, declination=DECLINATION)
    valid = []
    for k in range(1, 21):
        for name, value in (("rate", flight["rate"]), ("specific_force", flight["force"])):
            run.set(f"imu.{name}", value[:, k])
        run.set("field.field_b", flight["field"][:, k])
        for bundle in ("imu", "field"):
            run.set(f"{bundle}.valid", True)
            run.set(f"{bundle}.sequence", k)
            run.set(f"{bundle}.time_of_validity", k * PERIOD)
        run.do_step((k - 1) * PERIOD, PERIOD)
        valid.append(run.get("attitude.valid"))
        assert run.get("attitude.sequence") == k
    assert valid == [False] * 5 + [True] * 15
    assert run.get("attitude.heading") == pytest.approx(wrap(flight["heading"][20]), abs=np.radians(0.1))


def test_lost_imu_samples_are_counted_and_bridged(native, flight):
    """Every other sample: half of them lost, and the attitude still follows, as the time between samples is used."""
    run = interpret(Ahrs, sample_period=PERIOD, declination=DECLINATION)
    for k in range(2, 402, 2):
        for name, value in (("rate", flight["rate"]), ("specific_force", flight["force"])):
            run.set(f"imu.{name}", value[:, k])
        run.set("field.field_b", flight["field"][:, k])
        for bundle in ("imu", "field"):
            run.set(f"{bundle}.valid", True)
            run.set(f"{bundle}.sequence", k)
            run.set(f"{bundle}.time_of_validity", k * PERIOD)
        run.do_step((k - 2) * PERIOD, 2 * PERIOD)
    assert run.get("imu.lost") == 200
    assert run.get("attitude.heading") == pytest.approx(wrap(flight["heading"][400]), abs=np.radians(0.1))


# --- declination -----------------------------------------------------------------------------------------------------

FAR_NORTH = {"latitude": np.radians(70.0), "longitude": np.radians(20.0), "altitude": 5000.0}


def chart(latitude, longitude, altitude, date=2026.0):
    """The World Magnetic Model by pygeomag, and its error of the declination in rad."""
    model = pygeomag.GeoMag(coefficients_file="wmm/WMM_2025.COF")
    result = model.calculate(glat=np.degrees(latitude), glon=np.degrees(longitude), alt=altitude / 1e3, time=date)
    return result, np.radians(result.calculate_uncertainty().d)


def looked_up(valid, seconds=20, **parameters):
    """An AHRS at rest with a position, after some looks at the chart."""
    run = interpret(Ahrs, sample_period=PERIOD, **parameters)
    for name, value in FAR_NORTH.items():
        run.set(f"position.{name}", value)
    run.set("position.valid", valid)
    run.do_step(0.0, float(seconds))
    return run


@pytest.fixture(scope="module")
def far():
    """400 km due east at 70 degrees north in the field of the World Magnetic Model."""
    speed = 200.0
    time = np.arange(0.0, 2000.0 + PERIOD / 2, PERIOD)
    flown = motion(time, speed, np.pi / 2 + 0.0 * time, 0.0)
    _, east_west = earth.radii(FAR_NORTH["latitude"])
    per_second = speed / ((east_west + FAR_NORTH["altitude"]) * np.cos(FAR_NORTH["latitude"]))
    position = {name: value + 0.0 * time for name, value in FAR_NORTH.items()}
    position["longitude"] = position["longitude"] + per_second * time
    marks = np.arange(0, time.size, 100)
    along = [chart(*(position[name][k] for name in FAR_NORTH))[0] for k in marks]
    field_n = np.array([np.interp(time, time[marks], [getattr(r, axis) for r in along]) for axis in "xyz"]) * 1e-9
    field_b = np.einsum("jit,jt->it", attitude.dcm(0.0 * time, 0.0 * time, flown["heading"]), field_n)
    declination = np.arctan2(field_n[1], field_n[0])
    return flown | {"field": field_b, "position": position, "declination": declination}


def beginning(flight, seconds):
    """The first seconds of a flight, with its position."""
    count = round(seconds / PERIOD) + 1
    position = {name: values[:count] for name, values in flight["position"].items()}
    return {name: v[..., :count] for name, v in flight.items() if name != "position"} | {"position": position}


def test_the_declination_is_that_of_the_chart_at_the_position():
    for date in (2026.0, 2029.5):
        expected = chart(*FAR_NORTH.values(), date)[0].d
        got = np.degrees(looked_up(True, date=date).get("local_declination"))
        assert got == pytest.approx(expected, abs=1e-9)
    assert looked_up(True, seconds=9, declination=0.2).get("local_declination") == 0.2  # not looked up yet


def test_without_a_position_the_declination_is_that_of_the_parameter():
    """A position that is not valid is none: its numbers are not looked at."""
    assert looked_up(False, declination=0.2).get("local_declination") == 0.2
    run = looked_up(True, declination=0.2)
    kept = run.get("local_declination")
    run.set("position.valid", False)
    run.set("position.longitude", 0.0)
    run.do_step(20.0, 20.0)
    assert run.get("local_declination") == kept != 0.2


def test_heading_follows_the_chart_on_a_flight_in_the_far_north(native, far):
    """The declination changes by 5.7 degrees. With a constant one the heading is wrong by the change; with the chart
    less than a twentieth of it is left: look-ups that are 10 s late, and a dip that the filter has to follow."""
    change = np.degrees(far["declination"] - far["declination"][0])
    assert change[-1] > 5.0
    told = {"declination": far["declination"][0]}
    _, without = fly(native, far, told)
    got, error = fly(native, far, told, position_from=1.0)
    np.testing.assert_allclose(without["heading"][100:], -change[100:], atol=0.3)
    assert np.max(np.abs(error["heading"][100:])) < 0.05 * change[-1]
    late = np.degrees(got["local_declination"] - far["declination"])[100:]
    assert np.max(np.abs(late)) < 1.05 * 10.0 * np.max(np.diff(change)) / PERIOD


def test_heading_turns_at_once_when_a_position_comes(native, far):
    """After 300 s with a declination that is wrong by 20 degrees. A filter that only is told the new one meets a field
    that has jumped, for which it blames the hard iron."""
    told = {"declination": far["declination"][0] - np.radians(20.0)}
    got, error = fly(native, beginning(far, 400.0), told, position_from=300.0)
    assert np.min(np.abs(error["heading"][20:2990])) > 18.0
    assert np.max(np.abs(error["heading"][3102:])) < 0.5
    np.testing.assert_allclose(got["hard_iron"][-1], 0.0, atol=0.005)


def test_the_sigma_of_heading_has_the_error_of_the_chart(native, far):
    """By the error model of the World Magnetic Model with position, and by declination_sigma without: all of it that is
    neither the filter's covariance nor the mounting."""
    mounting, told = (interpret(Ahrs).get(name) for name in ("mounting_sigma", "declination_sigma"))
    start, added = beginning(far, 60.3), []  # what the look-up and the aiding of 60 s gave is published since
    for position_from in (1.0, 1e9):
        got, _ = fly(native, start, {"declination": far["declination"][0]}, position_from=position_from)
        filtered = kalman.diagonal(got["covariance"][-1])[2]
        added.append(np.sqrt(got["attitude.heading_sigma"][-1] ** 2 - filtered - mounting**2))
    _, expected = chart(*(start["position"][name][-5] for name in FAR_NORTH))
    assert added[0] == pytest.approx(expected, rel=1e-3)
    assert added[1] == pytest.approx(told * 0.5 / np.cos(got["dip"][-1]), rel=1e-9)
