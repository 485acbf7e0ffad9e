"""Flights on recorded sensors without GPS, on a recording that is made: what it tells is known."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from evidence import flown_navigation
from evidence.recorded_sensors import baseline, flown
from evidence.recorded_sensors.flight import Flight, flights, parts
from evidence.recorded_sensors.flown import Cut, Flown
from navfmu.constants import STANDARD_GRAVITY
from navfmu.errors import NavfmuError
from navfmu.report.page import Page

LATITUDE, LONGITUDE, ALTITUDE = np.radians(45.0), np.radians(-93.0), 350.0
WIND, SPEED, TURN, LATE = np.array([-2.0, 5.0]), 18.0, 0.12, 0.3
TIME = np.arange(0.0, 140.0, 0.02)
LEGS = 10.0
"""Time of a straight leg and of a turn, s."""


def recording(folder: Path, cut: float = np.inf) -> Flight:
    """A minute and more of straight legs and turns at 18 m/s, from 8 s on, in a wind, with GPS that comes 0.3 s late.

    Sensors have no errors but a bias of the rates about z; behind ``cut`` GPS tells another track.
    """
    folder.mkdir(parents=True)
    moving = TIME >= 8.0
    turning = np.where((TIME // LEGS) % 2 == 1, TURN, 0.0)
    heading = np.concatenate([[0.0], np.cumsum(0.5 * (turning[1:] + turning[:-1]) * 0.02)])
    speed = np.clip(4.0 * (TIME - 8.0), 0.0, SPEED)
    air = speed[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    velocity = np.where(moving[:, None], air + WIND * np.clip((TIME - 8.0) / 4.0, 0.0, 1.0)[:, None], 0.0)
    roll = np.arctan(turning * speed / STANDARD_GRAVITY)
    roll = np.convolve(np.pad(roll, 25, "edge"), np.ones(51) / 51.0, "valid")
    turns = Rotation.from_euler("ZYX", np.column_stack([heading, 0.0 * roll, roll]))
    rate = (turns[:-1].inv() * turns[1:]).as_rotvec() / 0.02
    rate = np.vstack([rate, rate[-1]]) + np.array([0.0, 0.0, 1e-3])
    acceleration = np.column_stack([np.gradient(velocity, TIME, axis=0), 0.0 * TIME])
    force = turns.inv().apply(acceleration - [0.0, 0.0, STANDARD_GRAVITY])
    way = np.vstack([np.zeros(2), np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * 0.02, axis=0)])
    way[TIME > cut, 0] += 500.0
    latitude, longitude, _ = pymap3d.ned2geodetic(*way.T, 0.0, LATITUDE, LONGITUDE, ALTITUDE, deg=False)
    fixes = {"latitude": latitude, "longitude": longitude, "altitude": ALTITUDE}
    fixes |= {"velocity_north": velocity[:, 0], "velocity_east": velocity[:, 1], "velocity_down": 0.0}
    gps = pd.DataFrame({"time": TIME + LATE, **fixes})[::10]
    gps.to_parquet(folder / "gps.parquet")
    flight = Flight(folder)
    write(folder, "imu", rate=rate, specific_force=force)
    write(folder, "magnetometer", field=turns.inv().apply(flight.field_n))
    pd.DataFrame({"time": TIME, "indicated_airspeed": speed, "pressure_altitude": ALTITUDE}).to_parquet(
        folder / "air.parquet"
    )
    pd.DataFrame({"time": TIME, "yaw": heading}).to_parquet(folder / "reference.parquet")
    return flight


def write(folder: Path, name: str, **vectors: np.ndarray) -> None:
    columns = {f"{key}_{axis}": value[:, i] for key, value in vectors.items() for i, axis in enumerate("xyz")}
    pd.DataFrame({"time": TIME, **columns}).to_parquet(folder / f"{name}.parquet")


@pytest.fixture(scope="module")
def flight(tmp_path_factory) -> Flight:
    return recording(tmp_path_factory.mktemp("recorded") / "made")


@pytest.fixture(scope="module")
def done(flight, tmp_path_factory) -> Flown:
    return flown.fly(flight, tmp_path_factory.mktemp("flown"), seeds=1)


def test_when_it_flies_follows_from_gps(flight):
    """Above 8 m/s some 2 s after 8 s, and 5 s later it is said to fly; 40 s later GPS is taken away."""
    assert 14.0 <= flight.airborne[0] <= 17.0
    assert flight.airborne[1] == 140.0
    assert flight.learned == flight.airborne[0] + 40.0
    assert flight.cuts[1] - flight.cuts[0] == 10.0
    assert flight.cuts[-1] < 130.0


def test_gaps_do_not_end_a_flight_and_slow_times_do():
    """Fixes that lack say nothing of the speed; one slow fix is none of standing."""
    times = np.arange(0.0, 100.0)
    fast = (times > 20.0) & (times != 50.0)
    there = ~((times > 60.0) & (times < 75.0))
    assert parts(times[there], fast[there]) == [(21.0, 99.0)]
    fast &= ~((times > 40.0) & (times < 49.0))
    assert parts(times, fast) == [(21.0, 40.0), (49.0, 99.0)]


def test_what_does_not_fly_is_refused(tmp_path):
    flight = recording(tmp_path / "short")
    flight.gps.query("time < 50").to_parquet(tmp_path / "short" / "gps.parquet")
    with pytest.raises(NavfmuError, match="nothing in it flies for 65 s above 8 m/s"):
        _ = Flight(tmp_path / "short").airborne


def test_every_folder_with_the_streams_is_a_flight(flight, tmp_path):
    (flight.folder.parent / "empty").mkdir()
    assert [one.name for one in flights(flight.folder.parent)] == ["made"]


def test_how_late_gps_is_is_found(done):
    """0.3 s; with the sign the other way, or with positions in the place of velocities, it is 0."""
    assert done.late == pytest.approx(LATE, abs=0.021)


def test_the_baseline_reckons_a_constant_wind_exactly(flight):
    """Its heading and airspeed have no errors. With the wind of another time, or without the lateness of GPS, which is
    5 m at this speed, it would be tens of metres wrong."""
    for _, errors in baseline.distances(flight, LATE):
        assert np.max(errors) < 3.0


def test_position_is_kept_without_gps(done):
    """Sensors without errors, wind that stays: what is left is what the filters had not learned. The way of the wind
    in that time is 300 m; GPS taken for a fix of now would leave 6 m from the first second on."""
    assert np.median(flown.after(done.alone, 10.0)) < 4.0
    assert np.max(flown.after(done.alone, 60.0)) < 40.0
    assert flown_navigation.inside(done.alone) > 99.0
    assert done.alone[0].after(0.5) < 3.0


def test_the_hard_iron_that_is_found_is_taken_out(flight, tmp_path):
    """As large as half of the field. Added instead of taken out, or left, heading is tens of degrees wrong before
    the first cut."""
    folder = tmp_path / "iron"
    shutil.copytree(flight.folder, folder)
    iron = np.array([2e-5, -1e-5, 1.5e-5])
    field = pd.read_parquet(folder / "magnetometer.parquet")
    field[["field_x", "field_y", "field_z"]] += iron
    field.to_parquet(folder / "magnetometer.parquet")
    one = Flight(folder)
    one.__dict__["hard_iron"] = iron
    angles = flown.attitude(one, tmp_path / "flown", one.learned)
    log = pd.read_parquet(folder / "reference.parquet").set_index("time")["yaw"]
    error = angles["heading"] - np.interp(angles.index, log.index, log)
    error = np.degrees((error + np.pi) % (2.0 * np.pi) - np.pi)[angles.index > one.learned - 10.0]
    assert np.max(np.abs(error)) < 3.0


def test_every_navigator_is_flown(done):
    """With the same GPS, and none after the cut. What holds the last of a velocity, or integrates biases that it does
    not know, is 1000 m wrong after a minute of turns and legs."""
    assert list(done.by) == list(flown.NAVIGATORS)
    for name, cuts in done.by.items():
        assert np.max(flown.after(cuts, 5.0)) < 10.0, name
        assert np.max(flown.after(cuts, 60.0)) < 200.0, name


def test_with_dme_errors_are_those_of_a_fix_at_most(done):
    """And not zero: ranges have errors of 0.17 nmi."""
    ends = flown.after(done.ranged, np.inf)
    assert np.max(ends) < 3.0 * flown.fix_sigma()
    assert np.all(flown.after(done.ranged, 30.0) != flown.after(done.alone, 30.0))
    assert flown.fix_sigma() == pytest.approx(np.sqrt(1.5) * np.hypot(0.17, 0.004) * 1852.0)


def test_nothing_is_learned_after_a_cut(done, tmp_path):
    """Another track by GPS, from the first cut on, leaves the navigator that was cut off then as it is, bit by bit."""
    first = done.flight.learned
    other = flown.fly(recording(tmp_path / "made", cut=first), tmp_path / "flown", seeds=1)
    pd.testing.assert_frame_equal(other.alone[0].solution, done.alone[0].solution)
    assert other.alone[0].after(60.0) > 400.0
    assert not other.alone[3].solution.equals(done.alone[3].solution)


def made(flight: Flight, error: float, theirs: float) -> Flown:
    """A cut whose error grows by ``error`` m/s, to the north, and claims 2 m/s; the baseline's by ``theirs``."""
    begin, grown = float(flight.cuts[0]), np.arange(100.0)
    times = begin + grown
    table = pd.DataFrame({"north": error * grown, "east": 0.0, "nn": 4.0 * grown**2 + 1.0, "ne": 0.0, "ee": 1.0}, times)
    cut = Cut(begin, table, table)
    return Flown(flight, 0.0, {flown.OURS: [cut]}, [[cut]], [(times, theirs * grown)])


def test_claims_follow_the_errors(flight):
    """1.4 times the baseline holds, 1.6 times does not; 11 m/s is beyond three times 2 m/s, and 1089 m beyond a fix."""
    good = {claim.text.partition(": ")[2][:12]: claim for claim in flown_navigation.claimed(made(flight, 1.4, 1.0))}
    bad = {claim.text.partition(": ")[2][:12]: claim for claim in flown_navigation.claimed(made(flight, 11.0, 6.9))}
    assert good["after 60 s w"].measured == pytest.approx(1.4)
    assert [claim.holds for claim in good.values()] == [True] * 5
    assert [claim.holds for claim in bad.values()] == [False] * 5
    assert "after 180 s " not in good  # the flight is too short for that


def test_of_a_slow_inertial_unit_nothing_is_claimed(flight, monkeypatch):
    slow = replace(flight)
    slow.__dict__["interval"] = 0.1
    monkeypatch.setattr(flown_navigation.picture, "drawn", lambda one: b"")
    section = flown_navigation.section([made(slow, 1.0, 1.0)])
    assert not section.claims
    page = Page("")
    section.write(page)
    assert "made" in page.html()


def test_a_flight_that_cannot_be_flown_is_named_and_others_are_flown(done, tmp_path, monkeypatch):
    """Its reason is said; the claims of the other one stand."""
    for name in ("long", "short"):
        shutil.copytree(done.flight.folder, tmp_path / "sensors" / "flights" / name)
    done.flight.gps.query("time < 50").to_parquet(tmp_path / "sensors" / "flights" / "short" / "gps.parquet")
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    fly = flown_navigation.fly
    monkeypatch.setattr(flown_navigation, "fly", lambda flight, folder: fly(flight, folder, seeds=1))
    section = flown_navigation.run(tmp_path / "out")
    assert "short, because" in section.left_out
    assert {claim.text.partition(":")[0] for claim in section.claims} == {"long"}
    assert (tmp_path / "out" / "flown_navigation" / "long.png").exists()


def test_the_picture_is_drawn(done):
    assert flown_navigation.picture.drawn(done).startswith(b"\x89PNG")
