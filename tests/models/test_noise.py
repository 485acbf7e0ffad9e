"""Random numbers of every component that has any: the same for all step sizes, independent for different seeds."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from benchmarks.everything_on import EVERYTHING, SKY
from navfmu import System
from tests.built import components, fmu

HERE = {"latitude": np.radians(37.75), "longitude": np.radians(-121.6), "altitude": 1500.0}
NORTH = {"velocity_n": (46.3, 0.0, 0.0)}
# what each is told, which of its outputs are looked at, and how often they change, s
NOISY = {
    "air_data": ({**NORTH, "altitude": 1500.0}, ["air.calibrated_airspeed", "air.pressure_altitude"], 0.1),
    "aircraft": ({}, ["specific_force[2]"], 0.1),
    "azimuth_detector": (HERE, ["azimuth.magnetic_heading"], 0.05),
    "dme": ({**HERE, **NORTH, "mode": 1}, ["ranging.slant_range[1]"], 1.0),
    "doppler_radar": (NORTH, [f"velocity.velocity_b[{i}]" for i in (1, 2, 3)], 1 / 7.5),
    "gps": (HERE, ["fix.altitude", "fix.velocity_n[1]", "attitude.roll"], 1.0),
    "gps_attitude": ({**HERE, **SKY, "oldest": 1e9}, ["attitude.roll", "attitude.pitch", "attitude.heading"], 0.5),
    "gps_errors": ({"own_time": 60.0}, ["range_error[1]", "range_error[32]", "zenith_error"], 1.0),
    "gps_signals": (HERE, ["clock_drift"], 1.0),
    "imu": ({}, [f"reading.{what}[{i}]" for what in ("rate", "specific_force") for i in (1, 2, 3)], 0.01),
    "loran": ({**HERE, **NORTH}, ["fix.latitude", "fix.longitude"], 1.0),
    "magnetometer": (HERE, [f"field.field_b[{i}]" for i in (1, 2, 3)], 0.1),
    "radar_fix": (HERE, ["fix.latitude"], 4.8),
    "ring_laser": ({"pulse": 1e-9}, [f"increment.angle[{i}]" for i in (1, 2, 3)], 0.01),
    "vor": ({**HERE, **NORTH}, ["bearing.radial[1]", "bearing.radial[2]"], 1.0),
    "weather": (NORTH, ["temperature_deviation", "sea_level_pressure"], 1.0),
    "wind": (NORTH, ["wind_n[1]", "wind_n[2]"], 1.0),
}
SAMPLES = 600
BEYOND = 5.0
"""Sigmas: one of two dozen outputs is beyond with a probability of 1e-5."""


def test_every_component_with_random_numbers_is_here():
    noisy = {name for name, component in components().items() if component.layout.uses_noise}
    assert noisy == set(NOISY) == set(EVERYTHING)


@pytest.fixture(params=NOISY)
def run(request, tmp_path_factory):
    """Run one component alone; all outputs."""
    system = System.load(fmu(request.param, tmp_path_factory))
    told, watched, period = NOISY[request.param]

    def run(step: float, stop: float, seed: int, record_period: float, record=("*",), told=told) -> pd.DataFrame:
        parameters = {f"{request.param}.{name}": value for name, value in told.items()}
        return system.run(
            stop=stop, step=step, seed=seed, record=list(record), record_period=record_period, parameters=parameters
        )

    run.watched, run.period = [f"{request.param}.{name}" for name in watched], period
    run.everything = EVERYTHING[request.param]
    return run


def test_the_same_numbers_for_every_step_size(run):
    """Catches noise that is drawn for each call, or numbered by calls, and a process that is advanced by the step."""
    expected = run(0.01, 60.0, seed=3, record_period=1.0)
    for step in (0.05, 0.25, 1.0):
        pd.testing.assert_frame_equal(run(step, 60.0, seed=3, record_period=1.0), expected, check_exact=True)


def test_the_same_numbers_for_every_step_size_with_every_error_on(run):
    """What is off at first has clocks and random numbers of its own. The steps do not divide into whole samples."""
    expected = run(0.01, 21.0, seed=3, record_period=1.05, told=run.everything)
    for step in (0.035, 0.15, 1.05):
        found = run(step, 21.0, seed=3, record_period=1.05, told=run.everything)
        pd.testing.assert_frame_equal(found, expected, check_exact=True)
    other = run(0.01, 21.0, seed=4, record_period=1.05, told=run.everything)
    assert all(np.any(other[name] != expected[name]) for name in run.watched)


def test_every_error_of_the_inertial_unit_is_on():
    """Whatever is 0 at first, and so off."""
    fields, given = components()["imu"].layout.fields, EVERYTHING["imu"]
    own = {name for name, field in fields.items() if field.causality in ("parameter", "input")}
    assert set(given) <= own
    off = {name for name in own if not np.any(fields[name].start)}
    assert off <= {name for name in given if np.any(given[name])}


def test_seeds_have_streams_of_their_own(run):
    """Catches a seed without effect, streams that are shifts of one another, and outputs that share one.

    Of changes from one sample to the next, so that what is constant after turn-on has no part. The variance of a
    correlation of two independent series is sum rho_1(k) rho_2(k) / n (Bartlett).
    """
    stop = (SAMPLES + 100) * run.period
    runs = [run(run.period, stop, seed, run.period, run.watched).iloc[100:].diff().iloc[1:] for seed in (1, 2)]
    series = [(f"{name}, seed {seed}", x[name]) for seed, x in enumerate(runs, 1) for name in run.watched]
    series = [(name, np.asarray((x - x.mean()) / x.std(ddof=0))) for name, x in series]
    for i, (one, a) in enumerate(series):
        for other, b in series[:i]:
            rho = [np.correlate(x, x, "full")[len(x) - 1 :] / len(x) for x in (a, b)]
            sigma = np.sqrt((1.0 + 2.0 * np.sum(np.prod(rho, axis=0)[1 : len(a) // 10])) / len(a))
            every_shift = np.correlate(a, b, "full") / len(a)
            assert abs(every_shift[len(a) - 1]) < BEYOND * sigma, (one, other)
            assert np.max(np.abs(every_shift)) < 0.9, (one, other)
