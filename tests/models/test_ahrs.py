"""AHRS: its equations against numbers, and the component on the aircraft's own motion."""

import numpy as np
import pytest

from fmus.ahrs import Ahrs
from models import ahrs, attitude, earth
from models.flight_plan import FlightPlan, straight, turn
from tests.models.native import Native, interpret

PERIOD = 0.1
DIP, DECLINATION, STRENGTH = np.radians(61.0), np.radians(13.0), 4.8e-5
NAMES = ["attitude.roll", "attitude.pitch", "attitude.heading", "gyro_bias", "heading_sigma"]


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Ahrs, tmp_path_factory.mktemp("ahrs"))


def wrap(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


@pytest.fixture(scope="module")
def flight():
    """Ten minutes with two 360-degree turns, analytic: angles, body rates and specific force at each sample."""
    speed = 46.3
    segments = (
        straight(90.0, speed),
        turn(2.0 * np.pi, np.radians(3.0), speed),
        straight(50.0, speed),
        turn(-2.0 * np.pi, np.radians(1.5), speed),
        straight(90.0, speed),
    )
    plan = FlightPlan(0.65, -2.1, 1500.0, 0.4, speed, segments)
    track = plan.sample(PERIOD)
    time, heading = track["time"], np.unwrap(track["track"])
    rate_of_turn = np.gradient(heading, PERIOD)
    roll = np.arctan(speed * rate_of_turn / earth.STANDARD_GRAVITY)
    roll_rate = np.gradient(roll, PERIOD)
    zero = np.zeros_like(roll)
    rates = attitude.body_rate(roll_rate, zero, rate_of_turn, np.sin(roll), np.cos(roll), zero, zero + 1.0)
    acceleration_n = np.stack([-np.sin(heading), np.cos(heading), zero]) * speed * rate_of_turn
    force_n = acceleration_n - np.array([0.0, 0.0, earth.STANDARD_GRAVITY])[:, None]
    c_nb = attitude.dcm(roll, zero, heading)
    force = np.einsum("jit,jt->it", c_nb, force_n)
    field = STRENGTH * np.einsum("jit,j->it", c_nb, ahrs.field_n(DIP, DECLINATION))
    turning = np.abs(rate_of_turn) > np.radians(1.0)
    sensed = {"rate": rates, "force": force, "field": field}
    return {"time": time, "roll": roll, "heading": heading, "turn": turning, **sensed}


def fly(native, flight, parameters=None, bias=(0.0, 0.0, 0.0), noise=0.0, field_until=1e9, hard_iron=(0.0, 0.0, 0.0)):
    """Errors of roll, pitch and heading (deg) from the samples at PERIOD, 2 PERIOD ... of the flight."""
    rng = np.random.default_rng(3)
    white = noise * rng.standard_normal(flight["rate"].shape)
    held = {}

    def inputs(t):
        k = round(t / PERIOD) + 1  # the sample that is taken at the end of this step
        values = {
            "imu.rate": flight["rate"][:, k] + bias + white[:, k],
            "imu.specific_force": flight["force"][:, k],
            "imu.valid": True,
            "imu.sequence": k,
            "imu.time_of_validity": k * PERIOD,
        }
        if k * PERIOD <= field_until:
            held.update(
                {
                    "field.field_b": flight["field"][:, k] + hard_iron,
                    "field.valid": True,
                    "field.sequence": k,
                    "field.time_of_validity": k * PERIOD,
                }
            )
        return values | held

    stop = (len(flight["time"]) - 1) * PERIOD
    got = native.run(
        stop,
        PERIOD,
        NAMES,
        {"sample_period": PERIOD, "declination": DECLINATION, **(parameters or {})},
        inputs,
    )
    error = {
        "roll": np.degrees(got["attitude.roll"] - flight["roll"]),
        "pitch": np.degrees(got["attitude.pitch"]),
        "heading": np.degrees(wrap(got["attitude.heading"] - flight["heading"])),
    }
    return got, error


# --- equations -------------------------------------------------------------------------------------------------------


def test_levelling_and_compass_return_the_attitude_they_were_made_from():
    for roll, pitch, heading in [(0.0, 0.0, 0.0), (0.3, -0.2, 2.5), (-0.9, 0.4, -1.2)]:
        c_nb = attitude.dcm(roll, pitch, heading)
        got = ahrs.level(c_nb.T @ np.array([0.0, 0.0, -9.8]))
        assert got == pytest.approx((roll, pitch), abs=1e-12)
        magnetic, down = ahrs.levelled_heading(c_nb.T @ ahrs.field_n(DIP, 0.0), roll, pitch)
        assert magnetic == pytest.approx(heading, abs=1e-12)
        assert down == pytest.approx(np.sin(DIP), abs=1e-12)


def test_dynamics_are_the_derivatives_of_the_euler_rates():
    """Including row 2, column 3 = -sin(roll), which (4.35) prints as -cos(roll)."""
    x = np.array([0.4, -0.25, 1.0, 0.0, 0.0, 0.0])
    rate, time, step = np.array([0.02, 0.05, -0.07]), 0.5, 1e-6

    def rates(y):
        return attitude.euler_rates(rate - y[3:], y[0], y[1])

    numeric = np.stack([(rates(x + step * d) - rates(x - step * d)) / (2 * step) for d in np.eye(6)], axis=1)
    phi = ahrs.dynamics(x[0], x[1], rate, time)
    np.testing.assert_allclose(phi[:3], np.eye(6)[:3] + time * numeric, atol=1e-9)
    np.testing.assert_array_equal(phi[3:], np.eye(6)[3:])
    assert phi[1, 5] == pytest.approx(time * np.sin(0.4))


def test_field_rows_are_the_derivatives_of_the_field_in_body_axes():
    x, step = np.array([0.4, -0.25, 1.0]), 1e-6
    direction = ahrs.field_n(DIP, DECLINATION)
    v, rows = ahrs.field_rows(*x, direction)
    np.testing.assert_allclose(v, attitude.dcm(*x).T @ direction, atol=1e-14)

    def seen(y):
        return attitude.dcm(*y).T @ direction

    numeric = np.stack([(seen(x + step * d) - seen(x - step * d)) / (2 * step) for d in np.eye(3)], axis=1)
    np.testing.assert_allclose(rows, numeric, atol=1e-9)


@pytest.mark.parametrize(
    ("turned", "rolled", "pull", "expected"),
    [
        (0.0043, -0.0043, 1.0, (True, True)),
        (-0.0045, 0.0, 1.0, (False, False)),
        (0.0, 0.0045, 1.0, (False, False)),
        (0.0, 0.0, 1.051, (True, False)),
        (0.0, 0.0, 0.949, (True, False)),
    ],
)
def test_gates_are_half_a_degree_per_second_and_five_percent_of_g(turned, rolled, pull, expected):
    force = np.array([0.0, 0.0, -pull * 9.80665])
    straight_, quiet = ahrs.gates(turned, rolled, 0.5, force, 9.80665, np.radians(0.5), 0.05)
    assert (bool(straight_), bool(quiet)) == expected


# --- the component ---------------------------------------------------------------------------------------------------


def test_with_perfect_sensors_the_attitude_is_exact_through_turns(native, flight):
    """Bound: Euler integration of samples of 0.1 s; the roll rate ends within samples."""
    _, error = fly(native, flight)
    for name in ("roll", "pitch", "heading"):
        assert np.max(np.abs(error[name][20:])) < 0.15, name


def test_gyro_biases_are_found_and_removed(native, flight):
    """0.1, -0.07 and 0.05 deg/s: found to 0.01 deg/s; by the end the attitude is as good as without."""
    bias = np.radians([0.1, -0.07, 0.05])
    got, error = fly(native, flight, bias=bias)
    np.testing.assert_allclose(got["gyro_bias"][-1], bias, atol=np.radians(0.01))
    for name in ("roll", "pitch", "heading"):
        assert np.max(np.abs(error[name][-800:])) < 0.5, name


def test_gyros_alone_diverge_and_gyros_alone_in_turns_are_worse(native, flight):
    """Thesis Fig 4.18: the open loop diverges, the aided does not. A biased automotive gyro, as in Table 3.2."""
    bias, noise = np.radians([0.05, 0.05, -0.05]), np.radians(0.05)
    turning = flight["turn"] & (flight["time"] > 60.0)
    _, aided = fly(native, flight, bias=bias, noise=noise)
    _, thesis = fly(native, flight, {"field_in_turns": False}, bias, noise)
    _, free = fly(native, flight, {"field_in_turns": False, "yaw_rate_limit": 0.0}, bias, noise)
    runs = {"aided": aided, "thesis": thesis, "free": free}
    worst = {name: np.max(np.abs(error["heading"][turning])) for name, error in runs.items()}
    assert worst["free"] > 20.0  # 0.05 deg/s for ten minutes are 30 degrees
    assert worst["aided"] < 2.5
    assert worst["thesis"] < worst["free"] / 3
    assert np.max(np.abs(aided["roll"][300:])) < 2.5


def test_heading_errors_are_those_of_the_magnetometer_calibration(native, flight):
    """Thesis section 3.12: a residual of 5 mG in a horizontal field of 233 mG turns the needle by 1.2 degrees."""
    residual = 5e-7
    _, error = fly(native, flight, noise=np.radians(0.05), hard_iron=np.array([residual, 0.0, 0.0]))
    limit = np.degrees(residual / (STRENGTH * np.cos(DIP)))
    rms = np.sqrt(np.mean(error["heading"][300:] ** 2))
    assert 0.2 * limit < rms < 1.5 * limit


def test_without_the_field_roll_and_pitch_are_still_aided_and_heading_drifts(native, flight):
    """The field stops after 30 s. Roll error after the last straight leg is small, heading has gone with the bias."""
    bias = np.radians([0.0, 0.0, 0.1])
    _, error = fly(native, flight, bias=bias, field_until=30.0)
    assert np.max(np.abs(error["roll"][-100:])) < 1.0
    assert np.max(np.abs(error["heading"])) > 5.0


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
    assert run.get("aiding") is True
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
