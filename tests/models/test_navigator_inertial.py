"""The inertial navigator on made flights: what it learns, what it makes of what comes late, and of what is none."""

from functools import cache

import numpy as np
import pytest

from fmus import examples
from fmus.navigation.navigator_inertial import STATES, NavigatorInertial
from models.attitude import attitude
from models.earth import earth
from models.filters import kalman
from models.navigation import inertial
from tests.models.native import Native

STEP, FIX = 0.02, 1.0
LONGEST = 150.0
ROLL = np.arctan(60.0 * 0.05 / 9.8)
BIAS_RATE, BIAS_FORCE = np.array([0.02, -0.02, 0.01]) * np.radians(1.0), np.array([0.03, -0.02, 0.05])
RECORD = [
    *(f"solution.{name}" for name in ("latitude", "longitude", "altitude")),
    "solution.velocity_n", "mode", "north_sigma", "east_sigma", "gyro_bias", "accelerometer_bias",
    "angles.roll", "angles.pitch", "angles.heading", "state_sigma", "position_covariance",
]  # fmt: skip


@cache
def circle():
    """Time, heading, velocity, position, specific force and rate of a level circle at 60 m/s and 0.05 rad/s, banked as
    it must be, from the equations of motion in n."""
    time = np.arange(0.0, LONGEST + 3 * STEP, STEP)
    heading = 0.05 * time
    velocity = np.stack([60.0 * np.cos(heading), 60.0 * np.sin(heading), 0.0 * time], axis=1)
    place, position, force, rate = np.array([0.65, -2.1, 1000.0]), [], [], []
    for k, now in enumerate(velocity):
        moved, gained, turning = inertial.rates(place, now, np.zeros(3))
        dcm = attitude.dcm(ROLL, 0.0, heading[k])
        position.append(place)
        force.append(dcm.T @ (0.05 * np.array([-now[1], now[0], 0.0]) - gained))
        rate.append(dcm.T @ (turning + np.array([0.0, 0.0, 0.05])))
        mean = 0.5 * (now + velocity[min(k + 1, len(time) - 1)])
        place = place + STEP * inertial.rates(place + 0.5 * STEP * moved, mean, np.zeros(3))[0]
    return heading, velocity, np.array(position), np.array(force), np.array(rate)


class Circling:
    """That circle as inputs: fixes ``late`` s, and what is ``spoilt`` in some times."""

    def __init__(self, late=0.0, spoilt=None):
        self.late, self.spoilt = late, spoilt or {}
        self.heading, self.velocity, self.position, self.force, self.rate = circle()

    def __call__(self, t):
        k = round(t / STEP)
        fix = int((t + 1e-9) / FIX)
        then = max(round((fix * FIX - self.late) / STEP), 0)
        given = {
            "imu.sequence": k + 1, "imu.valid": True, "imu.time_of_validity": k * STEP,
            "imu.rate": self.rate[k] + BIAS_RATE, "imu.specific_force": self.force[k] + BIAS_FORCE,
            "attitude.valid": True, "attitude.roll": ROLL, "attitude.pitch": 0.0,
            "attitude.heading": attitude.wrap(self.heading[k]), "attitude.yaw_rate": 0.05,
            "attitude.time_of_validity": k * STEP,
            "air.sequence": int(t * 10 + 1e-6) + 1, "air.valid": True, "air.pressure_altitude": 1040.0,
            "air.time_of_validity": int(t * 10 + 1e-6) / 10,
            "fix.sequence": fix + 1, "fix.valid": True, "fix.time_of_validity": then * STEP,
            "fix.latitude": self.position[then, 0], "fix.longitude": self.position[then, 1],
            "fix.altitude": self.position[then, 2], "fix.velocity_n": self.velocity[then],
        }  # fmt: skip
        for (begin, end), values in self.spoilt.items():
            if begin <= t < end:
                given |= values
        return given

    def error(self, run):
        """Of the solution, north and east, m, shape (samples, 2)."""
        truth = self.position[: len(run["solution.latitude"])]
        scale = np.array(inertial.metres(truth[0, 0], truth[0, 2]))[:2]
        solution = np.stack([run["solution.latitude"], run["solution.longitude"]], axis=1)
        return (solution - truth[:, :2]) * scale


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(NavigatorInertial, tmp_path_factory.mktemp("inertial"))


def fly(native, stop, late=0.0, spoilt=None, **parameters):
    flight = Circling(late, spoilt)
    return flight, native.run(stop, STEP, RECORD, parameters, flight)


def test_biases_are_learned_and_carry_it_without_gps(native):
    """Two minutes of circles, then 30 s alone. Biases with the wrong sign would double; a tilt that is corrected the
    wrong way round diverges within seconds."""
    flight, run = fly(native, 150.0, spoilt={(120.0, 151.0): {"fix.valid": False}})
    at = round(119.0 / STEP)
    sigmas = run["state_sigma"][at]
    assert np.all(np.abs(run["gyro_bias"][at] - BIAS_RATE) < 3.0 * sigmas[12:15])
    assert np.all(np.abs(run["accelerometer_bias"][at] - BIAS_FORCE) < 3.0 * sigmas[9:12])
    assert np.all(sigmas[12:15] < 0.6 * run["state_sigma"][round(5.0 / STEP)][12:15])
    assert run["mode"][at] == 1 and run["mode"][-1] == 2
    error = flight.error(run)
    assert np.hypot(*error[at]) < 0.5
    assert np.hypot(*error[-1]) < 30.0 < 3.0 * np.hypot(run["north_sigma"][-1], run["east_sigma"][-1])


def test_a_fix_is_compared_with_what_was_when_it_was_valid(native):
    """0.38 s late in a turn of 3 m/s2: compared with the position of now it is 23 m behind, and with velocity times
    age 0.2 m; compared with the velocity of now it is wrong by 1.1 m/s, which turns the heading."""
    flight, run = fly(native, 60.0, late=0.38)
    settled = slice(round(30.0 / STEP), None)
    assert np.max(np.abs(flight.error(run)[settled])) < 0.7
    truth = flight.velocity[: len(run["mode"])]
    assert np.max(np.abs(run["solution.velocity_n"] - truth)[settled]) < 0.1


@pytest.mark.parametrize(
    "spoilt",
    [
        {"imu.rate": [np.nan, 0.0, 0.0]},
        {"imu.specific_force": [0.0, np.inf, 0.0]},
        {"imu.rate": [1e18, 0.0, 0.0]},
        {"imu.valid": False, "imu.specific_force": [1e3, 0.0, 0.0]},
        {"fix.latitude": np.nan},
        {"fix.velocity_n": [np.inf, 0.0, 0.0]},
        {"air.pressure_altitude": np.nan},
        {"attitude.heading": np.nan},
        {"ranging.slant_range": [np.nan] * 5, "ranging.measured": [True] * 5, "ranging.sequence": 7},
    ],
    ids=lambda spoilt: "-".join(spoilt),
)
def test_what_is_no_number_leaves_nothing_behind(native, spoilt):
    """For half a second, in flight: what follows is as good as before."""
    flight, run = fly(native, 60.0, spoilt={(30.0, 30.5): spoilt})
    assert all(np.all(np.isfinite(run[name])) for name in RECORD)
    assert np.max(np.abs(flight.error(run)[-1])) < 1.0


def test_after_a_gap_it_waits_for_a_fix(native):
    """2 s without samples, over the limit of 1 s: it says that it knows nothing, and begins with the next fix."""
    frozen = {"imu.sequence": 1000, "imu.valid": True}
    flight, run = fly(native, 40.0, spoilt={(20.02, 22.0): frozen})
    during, after = round(21.5 / STEP), round(24.0 / STEP)
    assert run["mode"][during] == 0
    assert run["mode"][after] == 1 and np.max(np.abs(flight.error(run)[after])) < 5.0


def test_a_fix_far_away_is_believed_and_the_filter_lives_on(native):
    """GPS that jumps by 10 km for 5 s, and back: the family believes GPS, and is right again within seconds."""
    flight = Circling()
    away = {"fix.latitude": flight.position[1000, 0] + 0.0016}
    flight.spoilt = {(30.0, 35.0): away}
    run = native.run(60.0, STEP, RECORD, {}, flight)
    assert np.max(np.abs(flight.error(run)[-1])) < 5.0
    assert (
        np.max(np.abs(np.degrees(attitude.wrap(run["angles.heading"][-1] - flight.heading[round(60.0 / STEP) - 1]))))
        < 3.0
    )


def test_covariance_stays_one_for_six_hours():
    """Predictions of 1 s, a position every 10 s and nothing for an hour in between: scaled to variances of one, no
    eigenvalue is negative by more than rounding."""
    rng = np.random.default_rng(3)
    position, velocity = np.array([0.7, 0.1, 1000.0]), np.array([60.0, 20.0, 0.0])
    scale = np.array(inertial.metres(position[0], position[2]))
    sigmas = np.concatenate([2.0 / scale, [0.1] * 3, [0.02] * 3, [0.05] * 3, [1e-3] * 3])
    upper = kalman.of_variances(sigmas**2)
    noise = np.concatenate([np.zeros(3), [1e-4] * 3, [1e-6] * 3, [1e-6] * 3, [1e-10] * 3])
    lowest = 0.0
    for second in range(6 * 3600):
        dcm = attitude.dcm(0.2 * np.sin(0.01 * second), 0.05, 0.002 * second)
        force = dcm @ np.array([0.5, 0.0, -earth.gravity(0.7, 0.0)]) + 0.1 * rng.standard_normal(3)
        rows = inertial.transition(inertial.dynamics(position, velocity, force, dcm), 1.0)
        upper = kalman.propagate(upper, rows, np.full(6, 0.999), noise)
        if second % 10 == 0 and not 7200 < second < 10800:
            for place in range(3):
                row = np.eye(15)[place]
                _, upper, _ = kalman.update(np.zeros(15), upper, row, (2.0 / scale[place]) ** 2, 0.0)
        if second % 600 == 599:
            matrix = kalman.unpack(upper)
            root = np.sqrt(np.diag(matrix))
            lowest = min(lowest, np.linalg.eigvalsh(matrix / np.outer(root, root))[0])
    assert lowest > -1e-9


def test_example_learns_and_coasts():
    """What its page shows: the inputs are those of the flight of the other navigators."""
    time = np.arange(0.0, 2.0, 0.05)
    inputs = examples.inertial_inputs(time)
    assert inputs["imu.rate"].shape == (len(time), 3) and STATES == 21
