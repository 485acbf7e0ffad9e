"""The delay of GPS velocity by an inertial unit: closed forms, made recordings with known delays, what is refused."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from navfmu.calibration.delay.carried import carry, rotation
from navfmu.calibration.delay.fit import determine
from navfmu.calibration.delay.recording import recording
from navfmu.cli.main import main
from navfmu.constants import STANDARD_GRAVITY

SPEED, TURN, SLOW = 25.0, 0.35, 0.11
"""m/s, rad/s: heading swings by TURN / SLOW rad to either side."""


def motion(time):
    """Velocity (rows, 3) and its derivative, and attitude, of coordinated turns with climbs between."""
    heading = TURN / SLOW * np.sin(SLOW * time)
    rate, up = TURN * np.cos(SLOW * time), 3.0 * np.sin(0.5 * time)
    velocity = np.stack([SPEED * np.cos(heading), SPEED * np.sin(heading), up], axis=1)
    change = np.stack(
        [-SPEED * rate * np.sin(heading), SPEED * rate * np.cos(heading), 1.5 * np.cos(0.5 * time)], axis=1
    )
    bank = np.arctan(SPEED * rate / STANDARD_GRAVITY)
    return velocity, change, Rotation.from_euler("ZYX", np.column_stack([heading, 0.0 * heading, bank]))


def made(folder, delay=(0.3, 0.3), seed=1, jitter=0.03, noise=0.1, bias=0.01, seconds=300.0, moves=True, late=0.0):
    """An inertial unit at 50 Hz and a receiver at 2 Hz whose stamps are late and scatter by ``jitter``."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 0.02)
    _, change, attitude = motion(time)
    half = 1e-4
    before, after = motion(time - half)[2], motion(time + half)[2]
    rate = (before.inv() * after).as_rotvec() / (2.0 * half)
    force = attitude.inv().apply(change - [0.0, 0.0, STANDARD_GRAVITY])
    if not moves:
        rate, force = 0.0 * rate, np.tile([0.0, 0.0, -STANDARD_GRAVITY], (len(time), 1))
    rate = rate + bias * np.array([1.0, -1.0, 0.5]) + random.normal(0.0, 0.002, rate.shape)
    force = force + 0.2 + random.normal(0.0, 0.1, force.shape)
    moments = np.arange(0.0, seconds, 0.5)
    scatter = random.uniform(-jitter, jitter, len(moments))
    parts = [
        motion(moments - one + scatter)[0][:, axis] for axis, one in zip((0, 1, 2), (delay[0], *delay), strict=True)
    ]
    velocity = np.stack(parts, axis=1) * (1.0 if moves else 0.0) + random.normal(0.0, noise, (len(moments), 3))
    names = [f"{name}_{axis}" for name in ("rate", "specific_force") for axis in "xyz"]
    pd.DataFrame(np.column_stack([time, rate, force]), columns=["time", *names]).to_parquet(folder / "imu.parquet")
    names = [f"velocity_{axis}" for axis in ("north", "east", "down")]
    table = pd.DataFrame(np.column_stack([moments + late, velocity]), columns=["time", *names])
    table.to_parquet(folder / "gps.parquet")
    return folder / "imu.parquet", folder / "gps.parquet"


def navfmu(*arguments):
    return CliRunner().invoke(main, [str(one) for one in arguments])


def test_rotations_are_those_of_an_independent_implementation():
    vectors = np.random.default_rng(1).normal(0.0, 1.5, (50, 3))
    vectors[0] = 0.0
    np.testing.assert_allclose(rotation(vectors), Rotation.from_rotvec(vectors).as_matrix(), atol=1e-12)


def test_biases_change_what_is_carried_as_the_derivatives_say():
    """M b - S a, by integrating anew without biases. Wrong: the other sign, or M that begins where S does not."""
    time = np.arange(0.0, 30.0, 0.02)
    random = np.random.default_rng(2)
    rate, force = np.cumsum(random.normal(0.0, 0.02, (2, len(time), 3)), axis=1)
    b, a = np.array([1.0, -2.0, 0.5]) * 1e-6, np.array([-1.0, 0.3, 2.0]) * 1e-6
    moments, start = np.array([11.0, 15.5, 21.0]), 10.0
    u, bent, turned = carry(time, rate, force).at(moments, start)
    other, again = carry(time, rate - b, force - a), carry(time, rate, force)
    # the frame at the start of the stretch is what the attitude of the stretch takes up
    turn = np.eye(3) - np.cross(np.eye(3), -again.at(np.array([start]), 0.0)[2][0] @ b)
    expected = other.at(moments, start)[0] @ turn.T
    np.testing.assert_allclose(expected - u, bent @ b - turned @ a, atol=3e-8)


@pytest.mark.parametrize("delay", [(0.0, 0.12), (0.36, 0.3)])
def test_delays_are_found_within_their_intervals(tmp_path, delay):
    """Eight recordings, two delays: of 16 intervals of 95 % more than 4 are missed with a probability of 1e-3;
    and they are narrow, 0.03 s. Wrong: the sign, horizontal for vertical, an interval of white noise where each stretch
    errs as one."""
    missed = 0
    for seed in range(8):
        found = determine(recording(*made(tmp_path, delay, seed), {}, {}))
        missed += np.sum(np.abs(found.delay - delay) > found.half)
        assert np.all(found.half < 0.03)
    assert missed <= 4


def test_without_velocity_down_the_horizontal_delay_is_found(tmp_path):
    inertial, receiver = made(tmp_path, (0.2, 0.2))
    pd.read_parquet(receiver).drop(columns="velocity_down").to_parquet(receiver)
    found = determine(recording(inertial, receiver, {}, {}))
    assert found.axes == ("horizontal",)
    assert abs(found.delay[0] - 0.2) < 0.02


def test_the_command_tells_and_draws_it(tmp_path):
    files = made(tmp_path)
    result = navfmu("calibrate", "delay", *files, "--picture", tmp_path / "delay.png")
    assert result.exit_code == 0, result.output
    assert "horizontal" in result.output and "--age 0.3" in " ".join(result.output.split())
    assert (tmp_path / "delay.png").read_bytes()[:4] == b"\x89PNG"


REFUSED = {
    "too short": ({"seconds": 50.0}, "are too short; expected 4 stretches of 20 s at least"),
    "no motion": ({"moves": False}, "no motion tells a delay"),
    "no overlap": ({"late": 5000.0}, "files that count time from the same moment"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_tells_no_delay_is_refused(tmp_path, name):
    made_of, sentence = REFUSED[name]
    result = navfmu("calibrate", "delay", *made(tmp_path, **made_of))
    assert result.exit_code == 2 and sentence in " ".join(result.output.split())


@pytest.mark.parametrize("window", [("--begin", "nan"), ("--begin", "200", "--end", "100"), ("--begin", "900")])
def test_a_window_without_velocities_is_that_of_the_options(tmp_path, window):
    """Not that of the files, which are sound."""
    result = navfmu("calibrate", "delay", *made(tmp_path, seconds=120.0), *window)
    assert result.exit_code == 2
    assert "expected --begin and --end in its time, 0 to 119.5 s" in " ".join(result.output.split())
