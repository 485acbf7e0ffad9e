"""``navfmu allan``: from a recording to a parameter set, and what is refused."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.calibration.allan.chart import chart
from navfmu.calibration.allan.identification import identify
from navfmu.calibration.allan.parameters import parameters
from navfmu.calibration.allan.recording import recording
from navfmu.calibration.allan.sensor import ACCELEROMETER, GYRO
from navfmu.calibration.allan.terms import FLICKER, GAUSS_MARKOV, RANDOM_WALK, WHITE
from navfmu.cli.main import main
from navfmu.constants import STANDARD_GRAVITY
from navfmu.ssp.reader import read_parameters
from tests import built
from tests.calibration import made
from tests.recorded.test_px4 import log

PERIOD = 0.1
COLUMNS = [f"{name}_{axis}" for name in ("rate", "specific_force") for axis in "xyz"]


def navfmu(*words: object):
    return CliRunner().invoke(main, ["allan", *(str(word) for word in words)])


def at_rest(fmu, values, seconds):
    """Six columns of an ``imu`` that lies still, and time."""
    run = System.load(fmu).run(
        stop=seconds,
        step=PERIOD,
        seed=7,
        parameters={f"imu.{name}": value for name, value in values.items()},
        record=["imu.reading.rate", "imu.reading.specific_force"],
        record_period=PERIOD,
    )
    return pd.DataFrame(run.to_numpy()[1:], columns=COLUMNS).assign(time=np.asarray(run.index)[1:])


@pytest.mark.slow
def test_what_an_imu_was_given_comes_back_and_its_parameter_set_makes_the_same_chart(tmp_path, tmp_path_factory):
    """2000 s of noise and a drift (gyros), noise and a random walk (accelerometers). The set that is written makes an
    ``imu`` of another seed: the chart of the first lies within five sigmas of what that one's terms make.

    Wrong: noise per root second for that of a sample, K in seconds for K in hours, the start value of the drift kept
    where there is none.
    """
    fmu = built.fmu("imu", tmp_path_factory)
    truth = {
        "sample_period": PERIOD,
        "drift_period": PERIOD,
        "wander_period": PERIOD,
        "gyro_noise_sigma": 2e-3,
        "gyro_drift_sigma": 1e-3,
        "gyro_drift_time": 20.0,
        "accelerometer_noise_sigma": 0.01,
        "accelerometer_drift_sigma": 0.0,
        "accelerometer_walk_sigma": 0.06,
    }
    file = tmp_path / "rest.parquet"
    at_rest(fmu, truth, 2000.0).to_parquet(file)
    done = navfmu(file, "--fmu", fmu, "--out", tmp_path / "set.ssv", "--picture", tmp_path / "chart.png")
    assert done.exit_code == 0, done.output
    for word in ("white noise", "Gauss-Markov", "rate random walk", "tau"):
        assert word in done.output
    assert matplotlib.image.imread(tmp_path / "chart.png").shape[2] == 4
    values = {setting.name: setting.value for setting in read_parameters(tmp_path / "set.ssv")}
    assert values["sample_period"] == pytest.approx(PERIOD)
    for i in (1, 2, 3):
        assert values[f"gyro_noise_sigma[{i}]"] == pytest.approx(2e-3, rel=0.05)
        assert values[f"accelerometer_noise_sigma[{i}]"] == pytest.approx(0.01, rel=0.05)
        assert values[f"accelerometer_drift_sigma[{i}]"] == 0.0
        assert values[f"gyro_walk_sigma[{i}]"] == 0.0
    first = recording(file, {}, {})
    again = tmp_path / "again.parquet"
    at_rest(fmu, values, 2000.0).to_parquet(again)
    second = recording(again, {}, {})
    for sensor in (GYRO, ACCELEROMETER):
        seen = chart(first.stretches[sensor], first.period)
        made_again = identify(chart(second.stretches[sensor], second.period))
        off = np.log(seen.deviation / np.sqrt(made_again.variance))
        assert np.all(np.abs(off) < 5.0 * np.sqrt(2.0) * seen.spread[:, None])


def test_parameters_are_those_of_samples_and_hours():
    """Thesis (B.10), sigma_w = N sqrt(f_s), and K in an hour; a Gauss-Markov process as it is."""
    rng = np.random.default_rng(1)
    rates = identify(chart([made.white(rng, 0.2) + made.markov(rng, 0.1, 100.0)], 0.25))
    forces = identify(chart([made.white(rng, 0.2) + made.walk(rng, 0.002)], 0.25))
    assert (rates.terms, forces.terms) == ((WHITE, GAUSS_MARKOV), (WHITE, RANDOM_WALK))
    values = parameters({GYRO: rates, ACCELEROMETER: forces}, 0.25)
    np.testing.assert_allclose(values["gyro_noise_sigma"], 0.2, rtol=0.03)
    np.testing.assert_array_equal(values["gyro_walk_sigma"], 0.0)
    np.testing.assert_array_equal(values["gyro_flicker"], 0.0)
    assert values["gyro_drift_time"] == rates.correlation_time[0] == pytest.approx(25.0, rel=0.5)
    np.testing.assert_allclose(values["accelerometer_walk_sigma"], 0.002 * np.sqrt(3600.0 / 0.25), rtol=0.5)
    assert values["drift_period"] == pytest.approx(max(0.25, rates.correlation_time[0] / 50.0))
    assert "accelerometer_drift_time" not in values
    assert "flicker_time" not in values


def test_flicker_begins_where_it_is_seen():
    """Its processes are flat from 18 of the shortest correlation time on, and must be where noise has fallen to it."""
    rng = np.random.default_rng(2)
    one = identify(chart([made.white(rng) + made.flicker(rng, 0.1)], 1.0))
    assert FLICKER in one.terms
    values = parameters({GYRO: one}, 1.0)
    assert values["flicker_time"] == pytest.approx((1.0 / 0.0664) ** 2 / 18.0, rel=0.5)
    assert 1.0 <= values["wander_period"] <= values["flicker_time"]


@pytest.fixture
def rest(tmp_path, monkeypatch):
    """A minute at 50 Hz of a unit that lies level."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(3)
    values = 0.01 * rng.standard_normal((3000, 6)) + [0.0, 0.01, 0.0, 0.0, 0.0, -STANDARD_GRAVITY]
    return pd.DataFrame(values, columns=COLUMNS).assign(time=0.02 * np.arange(3000))


def refused(frame, *options):
    frame.to_csv("rest.csv", index=False)
    done = navfmu("rest.csv", *options)
    assert done.exit_code == 2
    assert "Traceback" not in done.output
    return done.output


def test_columns_units_and_one_sensor_alone(rest):
    rest = rest.rename(columns={f"rate_{axis}": f"g{axis}" for axis in "xyz"})[["time", "gx", "gy", "gz"]]
    rest[["gx", "gy", "gz"]] = np.degrees(rest[["gx", "gy", "gz"]])
    rest["time"] *= 1e3
    rest.to_csv("rest.csv", index=False)
    done = navfmu("rest.csv", "--column", "rate=gx,gy,gz", "--unit", "rate=deg/s", "--unit", "time=ms")
    assert done.exit_code == 0, done.output
    assert "at 50 Hz" in done.output
    assert "specific_force: not in the file" in " ".join(done.output.split())
    value = float(done.output.split("N", 1)[1].split()[0])
    assert value == pytest.approx(np.degrees(0.01) * np.sqrt(0.02) * 60.0, rel=0.05)  # deg per root hour


def test_bad_input_is_a_sentence(rest):
    """What is wrong, where, and what was expected."""
    short = refused(rest[:300])
    assert "nothing is at rest for 10 s" in short
    hole = rest.copy()
    hole.loc[17, "rate_y"] = np.nan
    assert "line 19: 'rate_y' has no number" in refused(hole)
    back = rest.copy()
    back.loc[5, "time"] = 0.0
    assert "line 7: time does not increase" in refused(back)
    in_g = rest.copy()
    in_g[COLUMNS[3:]] /= STANDARD_GRAVITY
    assert "expected 9 to 10.6" in refused(in_g)
    assert "--unit specific_force=g" in refused(in_g)
    assert "did you mean 'rate'?" in refused(rest, "--unit", "rat=deg/s")
    assert "has no column 'gx' for rate" in refused(rest, "--column", "rate=gx,gy,gz")
    assert "2 columns are named; expected 3" in refused(rest, "--column", "rate=rate_x,rate_y")
    assert "has no sensor's columns" in refused(rest[["time"]])
    stuck = rest.assign(rate_z=np.where(np.arange(len(rest)) % 2, 0.0, 0.01))
    assert "rate z has 2 values only" in refused(stuck)
    in_ms = rest.assign(time=1e3 * rest["time"])
    assert "samples are 20 s apart; expected 1e-05 to 2; name the unit of the time" in refused(in_ms)
    cut_off = rest.assign(specific_force_z=np.maximum(rest["specific_force_z"], -STANDARD_GRAVITY))
    assert "specific_force z is -9.80665 m/s2 in 48 % of the samples at rest and never beyond" in refused(cut_off)
    tiny = rest.assign(rate_x=1e-300 * rest["rate_x"])
    assert "rad/s at rest; expected the noise of a sensor" in refused(tiny)
    huge = rest.assign(rate_x=np.where(np.arange(len(rest)) == 17, 1e300, rest["rate_x"]))
    assert "line 19: 'rate_x' is 1e+300; expected what was measured" in refused(huge)
    assert "'rate_x' is named twice" in refused(rest, "--column", "rate=rate_x,rate_x,rate_z")
    assert "fewer than four points" in refused(rest, "--shortest", "5")
    assert "--fmu and --out belong together" in refused(rest, "--out", "set.ssv")


def test_noise_in_steps_is_no_noise_that_is_cut_off(rest):
    """Steps of 1.2 sigma, half of one off the mean: of six levels the lowest has a tenth. Wrong: a share alone."""
    rest["rate_x"] = 0.012 * (np.round(rest["rate_x"] / 0.012 - 0.5) + 0.5)
    rest = rest[rest["rate_x"].between(-0.02, 0.04)]  # as in a recording without the few that are farther
    assert len(rest["rate_x"].unique()) == 5
    rest.assign(time=0.02 * np.arange(len(rest))).to_csv("rest.csv", index=False)
    assert navfmu("rest.csv").exit_code == 0


def test_an_interval_as_it_is_printed_has_its_value_within(tmp_path):
    """An hour at 100 Hz: three digits are coarser than the interval, and 0.1718 was from 0.172 to 0.172."""
    values = made.white(np.random.default_rng(1), 5.003e-4, 360_000)
    frame = pd.DataFrame(values, columns=COLUMNS[:3]).assign(time=0.01 * np.arange(len(values)))
    frame.to_parquet(tmp_path / "rest.parquet")
    lines = [line.split() for line in navfmu(tmp_path / "rest.parquet").output.splitlines() if "white" in line]
    assert len(lines) == 3
    for line in lines:
        value, low, high = map(float, line[line.index("N") + 1 :][:3])
        assert low < value < high


@pytest.mark.parametrize("period, hint", [(0.1, True), (20.0, False)])
def test_shorter_averages_are_left_out_where_they_are_what_is_not_explained(tmp_path, period, hint):
    """A sine is not explained around its period: 0.1 s, or 20 s of 20.48 s, where four points are not left."""
    time = 0.02 * np.arange(12000)
    sine = 0.05 * np.sin(2.0 * np.pi * time / period)
    values = made.white(np.random.default_rng(1), 0.01, len(time)) + sine[:, None]
    pd.DataFrame(values, columns=COLUMNS[:3]).assign(time=time).to_parquet(tmp_path / "rest.parquet")
    output = " ".join(navfmu(tmp_path / "rest.parquet").output.split())
    assert "the terms do not explain the chart" in output
    assert ("--shortest leaves" in output) == hint


def test_a_shorter_process_than_an_imu_has_makes_the_same_of_long_averages():
    """0.4 s: at 100 s a process of 1 s with the same sigma has 1.58 times the deviation, and the remark was all."""
    found = identify(
        chart([made.white(np.random.default_rng(1), 0.1) + made.markov(np.random.default_rng(2), 0.1, 20.0)], 0.02)
    )
    tau, values = found.correlation_time[0], parameters({GYRO: found}, 0.02)
    assert tau == pytest.approx(0.4, rel=0.1) and values["gyro_drift_time"] == 1.0
    expected = found.of(GAUSS_MARKOV) ** 2 * GAUSS_MARKOV.variance(1000.0, 0.02, tau)
    made_of = values["gyro_drift_sigma"] ** 2 * GAUSS_MARKOV.variance(1000.0, 0.02, values["gyro_drift_time"])
    np.testing.assert_allclose(made_of, expected, rtol=0.01)


def test_an_fmu_that_is_no_imu_is_refused(rest, tmp_path_factory):
    fmu = built.fmu("wind", tmp_path_factory)
    assert "is no model of an inertial unit" in refused(rest, "--fmu", fmu, "--out", "set.ssv")


def test_moving_parts_and_gaps_are_left_out(rest):
    rest.loc[1500:1549, "rate_x"] += np.linspace(0.0, 1.0, 50)
    rest.loc[2250:, "time"] += 7.0
    rest.to_csv("rest.csv", index=False)
    taken = recording("rest.csv", {}, {})
    assert [len(part) for part in taken.stretches[GYRO]] == [1400, 600, 650]
    assert "in 3 stretches of 12 to 28 s" in taken.sentences[0]


def test_a_log_of_px4_is_read(rest):
    """Its stamps are whole microseconds. Wrong: a table is expected, or fields are taken in another order."""
    rows = [(t, *six[:3], 20000, *six[3:]) for t, six in zip(rest["time"] + 1.0, rest[COLUMNS].to_numpy(), strict=True)]
    taken = recording(log(Path("rest.ulg"), sensor_combined=rows), {}, {})
    np.testing.assert_allclose(np.vstack(taken.stretches[GYRO]), rest[COLUMNS[:3]][50:2950], rtol=1e-6)
    assert taken.period == pytest.approx(0.02, rel=1e-4)
