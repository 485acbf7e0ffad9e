"""``navfmu calibrate imu``: a recording becomes a table, a picture, a covariance and a parameter set, or is refused."""

from __future__ import annotations

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from evidence.sensors.turntable import ALTITUDE, LATITUDE, eight_by_three, shown, truth, turns
from navfmu.cli.main import main
from navfmu.ssp.reader import read_parameters
from tests import built
from tests.calibration.test_imu_stands import PERIOD, QUIET

GIVEN = {
    "misalignment": [0.004, -0.003, 0.005],
    "gyro_scale_factor": [0.01, -0.02, 0.005],
    "gyro_null_shift": [0.02, -0.01, 0.03],
    "gyro_g_sensitivity": [[1e-4, 2e-4, 3e-4], [-1e-4, 0.0, 5e-5], [4e-4, -2e-4, 1e-4]],
    "accelerometer_scale_factor": [0.004, 0.006, -0.008],
    "accelerometer_nonorthogonality": [0.002, -0.003, 0.001],
    "accelerometer_null_shift": [0.1, -0.2, 0.05],
}
NOISE = {"gyro_noise_sigma": 1e-3, "accelerometer_noise_sigma": 0.02}
WHERE = ("--latitude", np.degrees(LATITUDE), "--altitude", ALTITUDE)


def navfmu(*words: object):
    return CliRunner().invoke(main, ["calibrate", "imu", *(str(word) for word in words)])


@pytest.fixture(scope="module")
def unit(tmp_path_factory):
    """The FMU, and a table of its readings in 24 positions and 6 turns, which begin at random."""
    fmu = built.fmu("imu", tmp_path_factory)
    still = eight_by_three()
    stands = np.vstack([np.column_stack([still, np.zeros(len(still))]), turns([10.0])])
    order = np.random.default_rng(1).permutation(len(stands))
    frame = shown(fmu, truth(stands[order], 14.0, 3.0, PERIOD), {**QUIET, **NOISE, **GIVEN}, seed=4)
    file = tmp_path_factory.mktemp("unit") / "table.parquet"
    frame.to_parquet(file)
    return fmu, file


def test_what_an_imu_was_given_comes_back_as_its_parameters(tmp_path, unit):
    """Each element within 4.5 of its sigma (27 of them: by chance once in 5000), which is that of what is drawn.

    Wrong: rows of G for its columns, sigma of a reading, elements of the leaning in another order, a set of degrees.
    """
    fmu, file = unit
    wrote = {option: tmp_path / name for option, name in (
        ("--out", "unit.ssv"), ("--covariance", "unit.csv"), ("--picture", "unit.png"),
    )}  # fmt: skip
    done = navfmu(file, *WHERE, "--fmu", fmu, *(word for pair in wrote.items() for word in pair))
    assert done.exit_code == 0, done.output
    values = {setting.name: setting.value for setting in read_parameters(wrote["--out"])}
    table = pd.read_csv(wrote["--covariance"], index_col=0)
    for name, given in GIVEN.items():
        for place, true in np.ndenumerate(given):
            at = ",".join(str(number + 1) for number in place)
            sigma = values.get(f"{name}_sigma[{at}]", values.get(f"{name}_sigma"))
            assert 0.0 < sigma < 0.1 * np.max(np.abs(given))
            assert abs(values[f"{name}[{at}]"] - true) < 4.5 * sigma
    row = table.loc["gyro_scale_factor_y"]
    assert row["value"] == pytest.approx(values["gyro_scale_factor[2]"]) and row["told"]
    assert np.sqrt(row["gyro_scale_factor_y"]) == pytest.approx(values["gyro_scale_factor_sigma[2]"])
    assert not any("square" in name or "anisoelastic" in name for name in values)
    assert "accelerometer_square, gyro_anisoelasticity: not among the parameters" in done.output
    assert matplotlib.image.imread(wrote["--picture"]).shape[2] == 4


def test_without_a_table_the_turns_and_what_they_tell_are_missing(tmp_path, unit):
    """Wrong: a scale factor of gyros that were never turned among the parameters."""
    fmu, file = unit
    alone = tmp_path / "alone.csv"
    pd.read_parquet(file).drop(columns=["roll", "pitch", "heading", "table_rate"]).to_csv(alone, index=False)
    done = navfmu(alone, *WHERE, "--fmu", fmu, "--out", tmp_path / "alone.ssv")
    assert done.exit_code == 0, done.output
    assert "6 steady turns are left out" in done.output
    assert "gyro_scale_factor: not told by these stands; needs turns" in done.output
    names = {setting.name for setting in read_parameters(tmp_path / "alone.ssv")}
    assert "accelerometer_scale_factor[1]" in names and "gyro_null_shift[3]" in names
    assert not any(name.startswith(("gyro_scale_factor", "misalignment")) for name in names)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--out", "x.ssv"], "--fmu and --out belong together"),
        (["--picture", "x.pdf"], ".png"),
        (["--without", "gyro_bias"], "--without gyro_bias: there is no such error"),
        (["--column", "rates=a,b,c"], "--column rates: there is no such quantity"),
        (["--unit", "roll=m"], "roll"),
        (["--axes", "x,y"], "--axes: x,y are no three axes"),
        (["--latitude", "200"], "--latitude"),
    ],
)
def test_what_cannot_be_meant_is_one_sentence(unit, words, sentence):
    """Exit code 2. Wrong: a traceback, a result beside the complaint."""
    done = navfmu(unit[1], *WHERE, *words)
    assert done.exit_code == 2 and sentence in done.output
    assert "Traceback" not in done.output
