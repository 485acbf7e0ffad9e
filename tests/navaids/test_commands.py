"""``navfmu stations`` and ``navfmu coverage``: a set that an FMU takes, tables, pictures, and sentences."""

from __future__ import annotations

import io

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.ssp.reader import read_parameters
from tests import built
from tests.navaids.made import TABLE

TRACK = "time_s,latitude_deg,longitude_deg,altitude_ft\n" + "".join(
    f"{10 * i},{37.2 + 0.02 * i:.2f},-121.5,3000\n" for i in range(20)
)


def navfmu(*words: object):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stations.csv").write_text(TABLE)
    (tmp_path / "flight.csv").write_text(TRACK)
    return tmp_path


NEAR = ("--near", 37.4, -121.5)


def test_a_parameter_set_reaches_the_receiver(files, tmp_path_factory):
    """The FMU, given the set, measures the distances to these stations. Wrong: degrees, feet, another order."""
    fmu = built.fmu("dme", tmp_path_factory)
    done = navfmu("stations", "stations.csv", *NEAR, "--altitude", 6000, "--fmu", fmu, "--out", "set.ssv")
    assert done.exit_code == 0, done.output
    values = {setting.name: setting.value for setting in read_parameters("set.ssv")}
    assert values["station_count"] == 3
    order = [round(np.degrees(values[f"station_longitude[{i}]"]), 6) for i in (1, 2, 3)]
    assert sorted(order) == [-122.0, -121.5, -121.0]
    north = order.index(-121.5) + 1
    assert values[f"station_altitude[{north}]"] == pytest.approx(304.8)
    assert values[f"station_range[{north}]"] == pytest.approx(185200.0)
    run = System.load(fmu).run(
        stop=10.0,
        step=1.0,
        parameters={
            **{f"dme.{name}": value for name, value in values.items()},
            **{"dme.mode": 3, "dme.bias_sigma": 0.0, "dme.noise_sigma": 0.0},
            **{"dme.latitude": np.radians(37.4), "dme.longitude": np.radians(-121.5), "dme.altitude": 6000 * 0.3048},
        },
        record=["dme.ranging.slant_range"],
        record_period=1.0,
    )
    ranges = run.to_numpy()[-1]
    assert ranges[north - 1] == pytest.approx(66.6e3, rel=1e-3)  # 0.6 degrees of the meridian
    assert ranges[[i for i in (0, 1, 2) if i != north - 1]] == pytest.approx(62.6e3, rel=1e-2)


def test_a_receiver_chooses_among_the_stations_of_a_table(files, tmp_path_factory):
    """The table goes into the FMU, which ranges to the same stations. Wrong: degrees, feet, another order of columns,
    a table that the FMU does not take."""
    done = navfmu("stations", "stations.csv", *NEAR, "--altitude", 6000, "--network", "network.csv")
    assert done.exit_code == 0, done.output
    fmu = built.fmu("dme", tmp_path_factory)
    done = navfmu("table", fmu, "network", "--from", "network.csv", "--out", "dme.fmu")
    assert done.exit_code == 0, done.output
    run = System.load("dme.fmu").run(
        stop=10.0,
        step=1.0,
        parameters={
            **{"dme.stations_from": "network", "dme.mode": 3, "dme.bias_sigma": 0.0, "dme.noise_sigma": 0.0},
            **{"dme.latitude": np.radians(37.4), "dme.longitude": np.radians(-121.5), "dme.altitude": 6000 * 0.3048},
        },
        record=["dme.ranging.slant_range"],
        record_period=1.0,
    )
    assert sorted(run.to_numpy()[-1][:3]) == pytest.approx([62.6e3, 62.6e3, 66.6e3], rel=1e-2)


def test_a_filter_gets_the_same_without_ranges(files, tmp_path_factory):
    done = navfmu(
        "stations", "stations.csv", "--track", "flight.csv", "--fmu", built.fmu("navigator", tmp_path_factory),
        "--out", "set.ssv",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    names = {setting.name for setting in read_parameters("set.ssv")}
    assert "station_altitude[5]" in names and not any(name.startswith("station_range") for name in names)


def test_the_table_and_the_pictures(files):
    """Each point in the table, at both heights; pictures of their sizes with more than one colour."""
    done = navfmu(
        "coverage", "stations.csv", *NEAR, "--points", 5, "--radius", 20, "--out", "c.csv", "--picture", "c.png"
    )
    assert done.exit_code == 0, done.output
    table = pd.read_csv("c.csv")
    assert len(table) == 50 and sorted(set(table["altitude (ft)"].round(6))) == [500.0, 1500.0]
    low, high = (table[table["altitude (ft)"].round() == h]["stations"].to_numpy() for h in (500, 1500))
    assert np.all(high >= low) and high.max() == 3
    done = navfmu("coverage", "stations.csv", "--track", "flight.csv", "--out", "t.csv", "--picture", "t.png")
    assert done.exit_code == 0, done.output
    assert pd.read_csv("t.csv")["time (s)"].tolist() == [10.0 * i for i in range(20)]
    for name in ("c.png", "t.png"):
        drawn = matplotlib.image.imread(io.BytesIO((files / name).read_bytes()))
        assert len(np.unique(drawn.reshape(-1, drawn.shape[-1]), axis=0)) > 10


REFUSED = {
    "no place": (("stations", "stations.csv"), "expected either --near LAT LON or --track FILE"),
    "a place and a track": (("coverage", "stations.csv", *NEAR, "--track", "flight.csv"), "expected either --near"),
    "a pole": (("stations", "stations.csv", "--near", 90, 0), "--near is 90 0; expected degrees, latitude"),
    "no number": (("stations", "stations.csv", "--near", "nan", 0), "--near is nan 0; expected"),
    "an FMU alone": (("stations", "stations.csv", *NEAR, "--fmu", "dme.fmu"), "--fmu and --out belong together"),
    "nothing heard": (("stations", "stations.csv", "--near", 0, 0), "none of its 3 stations is heard at 0 0, 5000 ft"),
    "nothing near": (("coverage", "stations.csv", "--near", 0, 0), "none of its 3 stations is near enough"),
    "a height along a track": (("coverage", "stations.csv", "--track", "flight.csv", "--height", 5), "height belongs"),
    "a radius along a track": (("coverage", "stations.csv", "--track", "flight.csv", "--radius", 9), "radius belongs"),
    "points along a track": (("coverage", "stations.csv", "--track", "flight.csv", "--points", 9), "belongs to a grid"),
    "an altitude along a track": (
        ("stations", "stations.csv", "--track", "flight.csv", "--altitude", 5000),
        "--altitude belongs to a place; a track has places and heights of its own",
    ),
    "a place below the ground": (("stations", "stations.csv", *NEAR, "--ground", 6000), "5000 ft, below the ground at"),
    "stations written over": (("coverage", "stations.csv", *NEAR, "--out", "./stations.csv"), "is a file that is read"),
    "stations by a network": (("stations", "stations.csv", *NEAR, "--network", "stations.csv"), "file that is read"),
    "a flight written over": (
        ("coverage", "stations.csv", "--track", "flight.csv", "--out", "flight.csv"),
        "--out flight.csv is a file that is read; expected another name",
    ),
    "a table as a picture": (("coverage", "stations.csv", *NEAR, "--out", "c.txt"), "expected .csv at its end"),
    "no radius": (("coverage", "stations.csv", *NEAR, "--radius", -1), "--radius is -1 nmi; expected 0.1 to 500"),
    "a count of none": (("stations", "stations.csv", *NEAR, "--count", 0), "--count is 0 stations; expected 1 to 5"),
    "no file": (("coverage", "station.csv", *NEAR), "station.csv: no such file"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_is(name, files):
    words, sentence = REFUSED[name]
    done = navfmu(*words)
    assert (files / "stations.csv").read_text() == TABLE and (files / "flight.csv").read_text() == TRACK
    assert done.exit_code == 2 and sentence in done.stderr and "Traceback" not in done.output, done.output


def test_a_station_is_heard_from_as_far_as_its_range(files):
    """From 100 000 ft over a mountain of 20 000 ft, 450 nmi. Wrong: one reach for the stations of all files."""
    (files / "stations.csv").write_text(TABLE.replace("38.0,-121.5,1000,112.0,100", "44.9,-121.5,20000,112.0,900"))
    done = navfmu("stations", "stations.csv", *NEAR, "--altitude", 100000)
    assert done.exit_code == 0 and "NORTH" in done.output, done.output


def test_an_fmu_without_places_is_refused(files, tmp_path_factory):
    done = navfmu("stations", "stations.csv", *NEAR, "--fmu", built.fmu("gps", tmp_path_factory), "--out", "set.ssv")
    assert done.exit_code == 2 and "has no places for stations" in done.stderr
    assert not (files / "set.ssv").exists()
