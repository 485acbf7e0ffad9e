"""What is learned and measured on recorded flights, on sensors and attitudes that are made."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from evidence.sensors import flown_attitude
from evidence.sensors.flown_attitude import ANGLES, LOG, OURS, Flight, Flown
from navfmu.constants import STANDARD_GRAVITY
from navfmu.report.page import Page

TIME = np.arange(0.0, 100.0, 0.02)
ANGLES_TRUE = np.column_stack([0.4 * np.sin(0.2 * TIME), 0.1 * np.sin(0.3 * TIME), 0.05 * TIME])
TURNS = Rotation.from_euler("ZYX", ANGLES_TRUE[:, ::-1])
VELOCITY_N = np.column_stack([15.0 * np.cos(0.05 * TIME), 15.0 * np.sin(0.05 * TIME), 0.0 * TIME])


def flight(folder: Path, delay: float = 0.0) -> Flight:
    """A flight whose log has the true attitude, and GPS that is late by ``delay``."""
    force_n = np.gradient(VELOCITY_N, TIME, axis=0) - [0.0, 0.0, STANDARD_GRAVITY]
    force = TURNS.inv().apply(force_n)
    named = dict(zip([f"specific_force_{x}" for x in "xyz"], force.T, strict=True))
    pd.DataFrame({"time": TIME, **named}).to_parquet(folder / "imu.parquet")
    velocity = dict(zip(("velocity_north", "velocity_east"), VELOCITY_N.T[:2], strict=True))
    here = {"latitude": 0.79, "longitude": -1.63, "altitude": 300.0}
    pd.DataFrame({"time": TIME + delay, **velocity, **here})[::10].to_parquet(folder / "gps.parquet")
    named = dict(zip(("roll", "pitch", "yaw"), ANGLES_TRUE.T, strict=True))
    pd.DataFrame({"time": TIME, **named}).to_parquet(folder / "reference.parquet")
    return Flight(folder, 0.02, (10.0, 95.0), 2014.0, delay, ("air", {}))


def angles(turned: Rotation) -> pd.DataFrame:
    return pd.DataFrame((turned * TURNS).as_euler("ZYX")[:, ::-1], columns=list(ANGLES), index=TIME)


@pytest.mark.parametrize(("bank", "turn", "found"), [(30.0, np.pi, [3e-5, -2e-5, 4e-5]), (0.5, 0.01, [0.0, 0.0, 0.0])])
def test_hard_iron_is_that_of_the_first_minute(tmp_path, bank, turn, found):
    """Fields of flight with noise of 1 %; what comes before and after has another iron. Where it flies straight, there
    is none: taken all the same, it would be wrong by all of the field."""
    one = flight(tmp_path)
    earth = one.field_n
    rng, count = np.random.default_rng(3), len(TIME)
    roll = np.radians(bank) * rng.uniform(-1.0, 1.0, count)
    attitudes = Rotation.from_euler("ZYX", np.column_stack([rng.uniform(-turn, turn, count), 0.0 * roll, roll]))
    iron = np.where((TIME >= 10.0) & (TIME <= 70.0), 1.0, 3.0)[:, None] * [3e-5, -2e-5, 4e-5]
    field = attitudes.inv().apply(earth) + iron + 5e-7 * rng.standard_normal((count, 3))
    named = dict(zip([f"field_{x}" for x in "xyz"], field.T, strict=True))
    pd.DataFrame({"time": TIME, **named}).to_parquet(tmp_path / "magnetometer.parquet")
    np.testing.assert_allclose(one.hard_iron, found, atol=6e-7)


def test_errors_count_to_the_log_after_learning(tmp_path):
    """A turn about the vertical by 3 degrees is one of heading; what is wrong before 70 s does not count."""
    made = angles(Rotation.from_rotvec([0.0, 0.0, np.radians(3.0)]))
    made[made.index < 69.0] = 1.0
    less, sizes = flown_attitude.apart(flight(tmp_path), made)
    np.testing.assert_allclose(sizes, [3.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(less["heading"], 3.0, atol=1e-6)
    assert less.index[0] > 70.0
    sigmas = {f"{name}_sigma": np.radians(1.5) for name in ANGLES}
    np.testing.assert_allclose(flown_attitude.squares(flight(tmp_path), made.assign(**sigmas))[2], 4.0, atol=1e-5)


def test_gps_tells_a_level_that_is_wrong(tmp_path):
    """By 4 degrees it is g sin(4 deg) in a second on one of two axes; the right one leaves nothing."""
    right = flown_attitude.unexplained(flight(tmp_path), angles(Rotation.identity()))
    wrong = flown_attitude.unexplained(flight(tmp_path), angles(Rotation.from_rotvec([np.radians(4.0), 0.0, 0.0])))
    assert right < 0.01
    assert wrong == pytest.approx(STANDARD_GRAVITY * np.sin(np.radians(4.0)) / np.sqrt(2.0), rel=0.02)


def test_gps_that_comes_late_is_taken_when_it_was_valid(tmp_path):
    """Half a second late, in a turn, it would leave 0.013 m/s instead of nothing."""
    assert flown_attitude.unexplained(flight(tmp_path, 0.5), angles(Rotation.identity())) < 0.005


@pytest.mark.parametrize(("size", "holds"), [(1.0, True), (3.0, False)])
def test_what_is_claimed_is_said_as_it_is(tmp_path, size, holds):
    """Level errors of 1 degree hold, of 3 do not; the page has a row for each filter."""
    flown = []
    for name in ("thor75", "swisslog1"):
        (tmp_path / name).mkdir()
        one = flight(tmp_path / name)
        turned = angles(Rotation.from_rotvec([np.radians(size), 0.0, 0.0]))
        turned = turned.assign(**{f"{angle}_sigma": 0.02 for angle in ANGLES})
        flown += [Flown(one, OURS, turned), Flown(one, LOG, flown_attitude.logged(one))]
    section = flown_attitude.section(flown)
    assert section.claims[0].holds == holds
    page = Page("")
    section.write(page)
    assert f"<td>{size:.2f}" in page.html().replace(' class="n"', "")


def test_without_recordings_it_is_left_out(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in flown_attitude.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    assert "thor75" in flown_attitude.run(tmp_path).left_out
