"""``navfmu calibrate magnetometer``: a recording becomes a table, a picture and a parameter set, or is refused."""

from __future__ import annotations

import json

import matplotlib.image
import numpy as np
import pandas as pd
import pygeomag
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.calibration.magnetometer.place import field_at
from navfmu.cli.main import main
from navfmu.ssp.reader import read_parameters
from navfmu.system import shipped
from tests import built
from tests.calibration.turned import CENTRE, FIELD, GAINED, measured

COLUMNS = ["field_x", "field_y", "field_z"]
NOISE = 3e-7


def navfmu(*words: object):
    return CliRunner().invoke(main, ["calibrate", "magnetometer", *(str(word) for word in words)])


def table(path, samples, **more):
    frame = pd.DataFrame(samples, columns=COLUMNS).assign(time=0.1 * np.arange(len(samples)), **more)
    frame.to_csv(path, index=False)
    return path


@pytest.fixture
def sphere(tmp_path):
    return table(tmp_path / "sphere.csv", measured(np.random.default_rng(3), np.pi, 800, NOISE))


def test_what_a_magnetometer_was_given_comes_back_as_its_parameters(tmp_path, tmp_path_factory):
    """The FMU ``magnetometer`` is turned through 120 attitudes, and its errors are those of the set that is written.

    Wrong: hard iron as measured for that of (3.28), the matrix for its inverse, its rows and columns exchanged, the
    field's north for its strength.
    """
    fmu = built.fmu("magnetometer", tmp_path_factory)
    given = {
        "hard_iron": [9e-6, -4e-6, 6e-6], "scale_factor": [0.06, -0.04, 0.02],
        "soft_iron": [[0.0, 0.03, 0.01], [0.0315, 0.0, -0.02], [0.0099, -0.0188, 0.0]],
    }  # fmt: skip
    clean = {
        "noise_sigma": [0.0] * 3, "crustal_level": 0.0, "hard_iron_sigma": [0.0] * 3, "soft_iron_sigma": 0.0,
        "scale_factor_sigma": [0.0] * 3, "misalignment_sigma": [0.0] * 3, "latitude": 0.79, "longitude": -1.6,
    }  # fmt: skip
    symmetric = np.diag(1.0 + np.array(given["scale_factor"])) @ (np.eye(3) + np.array(given["soft_iron"]))
    given["soft_iron"] = (
        np.linalg.solve(np.diag(np.diag(symmetric)), 0.5 * (symmetric + symmetric.T)) - np.eye(3)
    ).tolist()

    def fields(values):
        rng, found = np.random.default_rng(4), []
        for angles in rng.uniform([-3.0, -1.4, -3.0], [3.0, 1.4, 3.0], (120, 3)):
            turned = dict(zip(("roll", "pitch", "heading"), angles, strict=True))
            parameters = {f"magnetometer.{name}": value for name, value in {**clean, **values, **turned}.items()}
            run = System.load(fmu).run(
                stop=1.1, step=0.1, parameters=parameters, record=["magnetometer.field.field_b"], seed=1
            )
            found.append(run.to_numpy()[-1])
        return np.array(found)

    raw = fields(given)
    file = table(tmp_path / "turned.csv", raw + 2e-8 * np.random.default_rng(5).standard_normal(raw.shape))
    strength = f"{1e6 * np.mean(np.linalg.norm(fields({}), axis=1)):.6f} uT"
    done = navfmu(file, "--field", strength, "--fmu", fmu, "--out", tmp_path / "set.ssv")
    assert done.exit_code == 0, done.output
    assert "ellipsoid" in done.output
    assert not any(f"not {name}" in done.output for name in ("ellipsoid", "axes"))
    values = {setting.name: setting.value for setting in read_parameters(tmp_path / "set.ssv")}
    for i in range(3):
        assert values[f"hard_iron[{i + 1}]"] == pytest.approx(given["hard_iron"][i], abs=3e-8)
        assert values[f"scale_factor[{i + 1}]"] == pytest.approx(given["scale_factor"][i], abs=1e-3)
        for j in range(3):
            assert values[f"soft_iron[{i + 1},{j + 1}]"] == pytest.approx(given["soft_iron"][i][j], abs=1e-3)
        assert values[f"noise_sigma[{i + 1}]"] == pytest.approx(2e-8, rel=0.4)
    for name in ("field_correction", "ahrs"):
        words = ("--field", strength, "--fmu", built.fmu(name, tmp_path_factory), "--out", tmp_path / f"{name}.ssv")
        assert navfmu(file, *words).exit_code == 0
    undone = {setting.name: setting.value for setting in read_parameters(tmp_path / "field_correction.ssv")}
    assert undone == {name: value for name, value in values.items() if "sigma" not in name}
    left = {setting.name: setting.value for setting in read_parameters(tmp_path / "ahrs.ssv")}
    assert left.keys() == {"field_sigma", "hard_iron_sigma"}
    assert max(left.values()) < 2e-3
    refused = navfmu(
        file, "--field", strength, "--fmu", built.fmu("wind", tmp_path_factory), "--out", tmp_path / "x.ssv"
    )
    assert refused.exit_code == 2
    assert "expected a triad" in refused.output


def test_it_prints_and_writes_what_it_found(sphere, tmp_path):
    """Wrong: T for uT, a share for percent, a value without its sigma."""
    done = navfmu(sphere, "--field", "50 uT", "--table", tmp_path / "iron.json", "--picture", tmp_path / "iron.png")
    assert done.exit_code == 0, done.output
    told = json.loads((tmp_path / "iron.json").read_text())
    assert told["method"] == "ellipsoid"
    values = {row["name"]: (row["value"], row["sigma"], row["unit"]) for row in told["values"]}
    iron = np.linalg.solve(GAINED, CENTRE)
    for axis, true in zip("xyz", iron, strict=True):
        value, sigma, unit = values[f"hard iron {axis}"]
        assert unit == "uT"
        assert abs(value - 1e6 * true) < 5.0 * sigma < 0.5
    value, sigma, unit = values["scale factor z"]
    assert unit == "%"
    assert abs(value - 10.0) < 5.0 * sigma < 1.0
    assert matplotlib.image.imread(tmp_path / "iron.png").shape[2] == 4
    assert navfmu(sphere, "--table", tmp_path / "iron.csv").exit_code == 0
    assert (tmp_path / "iron.csv").read_text().startswith("name,value,sigma,unit\nhard iron x,")


def test_units_and_axes_of_the_file_are_told(sphere, tmp_path):
    """Milligauss, and a triad whose y and z point left and up. Wrong: the centre in the axes of the file."""
    frame = pd.read_csv(sphere)
    other = pd.DataFrame({"bx": 1e7 * frame.field_x, "by": -1e7 * frame.field_y, "bz": -1e7 * frame.field_z})
    other.to_csv(tmp_path / "other.csv", index=False)
    words = ("--column", "field=bx,by,bz", "--unit", "field=mG", "--axes", "x,-y,-z", "--field", "500 mG")
    assert navfmu(tmp_path / "other.csv", *words, "--table", tmp_path / "other.json").exit_code == 0
    assert navfmu(sphere, "--field", "50 uT", "--table", tmp_path / "same.json").exit_code == 0
    one, two = (json.loads((tmp_path / name).read_text())["values"] for name in ("other.json", "same.json"))
    for a, b in zip(one, two, strict=True):
        assert a["value"] == pytest.approx(b["value"], rel=1e-3, abs=1e-3)


@pytest.mark.parametrize(
    ("method", "why"),
    [("ellipsoid", "the iteration diverged; "), ("batch", "the iteration diverged; "), ("two-step", "")],
)
def test_a_level_flight_gives_no_ellipsoid_and_says_what_is_missing(tmp_path, method, why):
    """Fields of turns with 6 degrees of roll, dip 60 degrees: least squares of the thesis's cost lead to an ellipsoid
    without end. What another method tells instead is right.

    Wrong: gains of z from a strip, a strip that is not told, where an iteration happened to be.
    """
    rng = np.random.default_rng(8)
    turn, roll = rng.uniform(0.0, 2.0 * np.pi, 900), np.radians(6.0) * rng.standard_normal(900)
    level = np.stack([0.5 * np.cos(turn), -0.5 * np.sin(turn), np.full(900, np.sqrt(0.75))], axis=1)
    y, z = level[:, 1], level[:, 2]
    turned = np.stack([level[:, 0], np.cos(roll) * y + np.sin(roll) * z, np.cos(roll) * z - np.sin(roll) * y], axis=1)
    file = table(tmp_path / "level.csv", FIELD * turned + CENTRE + 1.5e-6 * rng.standard_normal((900, 3)))
    done = navfmu(file, "--method", method, "--field", "50 uT", "--table", tmp_path / "found.json")
    assert done.exit_code == 0, done.output
    told = json.loads((tmp_path / "found.json").read_text())
    assert told["method"] in ("sphere", "hard-iron")
    refused = next(text for text in told["sentences"] if text.startswith(f"not {method}: {why}errors of"))
    assert "span a strip of" in refused
    assert "needed" in refused
    for row, true in zip(told["values"], CENTRE, strict=False):
        assert abs(row["value"] - 1e6 * true) < 5.0 * row["sigma"]


def test_a_level_turn_gives_x_and_y(tmp_path):
    """CMFD-2, z standing still. Wrong: a centre of z from nothing, the strength for its horizontal part."""
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    level = np.stack([2.1e-5 * np.cos(turn), -1.9e-5 * np.sin(turn), np.full(400, 4e-5)], axis=1)
    samples = level + CENTRE + 5e-8 * np.random.default_rng(2).standard_normal((400, 3))
    done = navfmu(table(tmp_path / "turn.csv", samples), "--method", "ellipse", "--table", tmp_path / "turn.json")
    assert done.exit_code == 0, done.output
    values = {row["name"]: row["value"] for row in json.loads((tmp_path / "turn.json").read_text())["values"]}
    assert set(values) == {"hard iron x", "hard iron y", "scale factor x", "scale factor y"}
    ratio = (100.0 + values["scale factor x"]) / (100.0 + values["scale factor y"])
    assert ratio == pytest.approx(21.0 / 19.0, rel=2e-3)
    automatic = navfmu(tmp_path / "turn.csv")
    assert "ellipse" in automatic.output.split("- not")[0]


def test_the_strength_at_a_place_is_that_of_pygeomag(sphere, tmp_path, tmp_path_factory, monkeypatch):
    """The World Magnetic Model of 2010 in Minnesota, 2012. Wrong: latitude for longitude, radians for degrees, the
    horizontal part for the whole, the model of another date, an anomaly of the crust."""
    fmu = built.fmu("magnetometer", tmp_path_factory)
    monkeypatch.setattr(shipped, "folders", lambda: [fmu.parent])
    found = field_at(np.radians(45.33), np.radians(-93.23), 2012.77)
    model = pygeomag.GeoMag(coefficients_file="wmm/WMM_2010.COF")
    expected = model.calculate(glat=45.33, glon=-93.23, alt=0.0, time=2012.77)
    assert found.strength == pytest.approx(1e-9 * expected.f, abs=2e-9)
    assert found.horizontal == pytest.approx(1e-9 * expected.h, abs=2e-9)
    words = ("--place", 45.33, -93.23, "--date", 2012.77, "--table", tmp_path / "found.json")
    assert navfmu(sphere, *words).exit_code == 0
    values = {row["name"]: row["value"] for row in json.loads((tmp_path / "found.json").read_text())["values"]}
    assert values["scale factor z"] == pytest.approx(100.0 * (1.1 * 50.0 / (1e-3 * expected.f) - 1.0), abs=0.3)


def test_a_swing_is_calibrated_in_the_heading_domain(tmp_path, tmp_path_factory):
    """Eight headings, three samples at each, and the FMU that gets what they tell. Wrong: degrees for radians, the
    strength for the horizontal field, the heading's sign."""
    heading = np.repeat(np.arange(0.0, 360.0, 45.0), 3)
    turn = np.radians(heading)
    level = 2.3e-5 * np.stack([np.cos(turn), -np.sin(turn)], axis=1) + np.array([6e-7, -4e-7])
    rng = np.random.default_rng(6)
    samples = np.hstack([level, np.full((24, 1), 4e-5)]) + 2e-8 * rng.standard_normal((24, 3))
    many = np.concatenate([samples] * 3)
    file = table(tmp_path / "swing.csv", many, heading=np.concatenate([heading] * 3))
    done = navfmu(
        file, "--method", "swinging", "--unit", "heading=deg", "--table", tmp_path / "swing.json",
        "--picture", tmp_path / "swing.png", "--fmu", built.fmu("magnetometer", tmp_path_factory),
        "--out", tmp_path / "swing.ssv",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    values = {row["name"]: row["value"] for row in json.loads((tmp_path / "swing.json").read_text())["values"]}
    assert values["B"] == pytest.approx(np.degrees(-6e-7 / 2.3e-5), abs=0.1)
    assert values["C"] == pytest.approx(np.degrees(4e-7 / 2.3e-5), abs=0.1)
    in_degrees = navfmu(file, "--method", "swinging")
    assert in_degrees.exit_code == 2
    assert "as in --unit heading=deg" in " ".join(in_degrees.output.split())
    assert matplotlib.image.imread(tmp_path / "swing.png").shape[2] == 4
    written = {setting.name: setting.value for setting in read_parameters(tmp_path / "swing.ssv")}
    assert written["hard_iron[1]"] == pytest.approx(6e-7, abs=4e-8)
    assert written["hard_iron[2]"] == pytest.approx(-4e-7, abs=4e-8)
    assert written["hard_iron[3]"] == 0.0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--method", "elipsoid"], "did you mean 'ellipsoid'?"),
        (["--unit", "field=nT"], "name the unit of the file"),
        (["--unit", "field=kg"], "not known here"),
        (["--column", "field=a,b,c"], "has no column 'a' for field"),
        (["--axes", "x,y,-z"], "mirror image"),
        (["--field", "5 uT"], "--field is 5 uT; expected 10 to 100"),
        (["--field", "50"], "--field is 5e+07 uT; expected 10 to 100"),
        (["--field", "50 uT", "--place", "45", "9", "--date", "2020"], "expected one of them"),
        (["--place", "45", "9"], "--place and --date belong together"),
        (["--method", "swinging"], "has no column 'heading'"),
        (["--column", "field=field_x,field_x,field_z"], "'field_x' is named twice"),
        (["--begin", "79"], "samples are too few"),
        (["--begin", "790"], "no row is from 790 to 79.9 s; expected --begin and --end in its time, 0 to 79.9 s"),
        (["--end", "nan"], "no row is from 0 to nan s"),
        (["--out", "x.ssv"], "belong together"),
        (["--picture", "x.jpg"], "expected .png"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_a_sentence(sphere, words, sentence):
    """Wrong: a traceback, or an answer."""
    done = navfmu(sphere, *words)
    assert done.exit_code == 2
    assert sentence in " ".join(done.output.split())


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda frame: frame.assign(field_y=np.where(frame.index == 7, np.nan, frame.field_y)), "line 9"),
        (lambda frame: frame.assign(field_y=np.where(frame.index == 7, 0.01, frame.field_y)), "line 9: the field is"),
        (lambda frame: frame.assign(field_z=4e-5), "along z has one value only"),
        (lambda frame: frame.iloc[:20], "20 samples are too few"),
        (lambda frame: frame.drop(columns="field_x"), "has no column 'field_x'"),
        (lambda frame: frame.iloc[[5] * 400] + 1e-8 * np.random.default_rng(1).random((400, 4)), "no calibration"),
    ],
)  # fmt: skip
def test_a_file_that_tells_nothing_is_a_sentence(sphere, tmp_path, change, sentence):
    """Rows without a number, too few, flat, at rest. Wrong: a wild answer."""
    change(pd.read_csv(sphere)).to_csv(tmp_path / "bad.csv", index=False)
    done = navfmu(tmp_path / "bad.csv", "--field", "50 uT")
    assert done.exit_code == 2, done.output
    assert sentence in " ".join(done.output.split())
