"""``navfmu analyse fix`` and ``navfmu analyse observability``: tables, pictures, sentences."""

from __future__ import annotations

import io

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from navfmu.cli.main import main
from tests.navaids.made import TABLE

HEADER = "time_s,latitude_deg,longitude_deg,altitude_ft\n"
TRACK = HEADER + "".join(f"{10 * i},{37.2 + 0.005 * i:.3f},-121.5,3000\n" for i in range(60))
STANDING = HEADER + "".join(f"{10 * i},37.2,-121.5,3000\n" for i in range(60))
NEAR = ("--near", 37.4, -121.5)


def navfmu(*words: object):
    return CliRunner().invoke(main, ["analyse", *(str(word) for word in words)])


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")
    (tmp_path / "stations.csv").write_text(TABLE)
    (tmp_path / "flight.csv").write_text(TRACK)
    (tmp_path / "standing.csv").write_text(STANDING)
    return tmp_path


def drawn(path) -> int:
    """How many colours a picture has."""
    picture = matplotlib.image.imread(io.BytesIO(path.read_bytes()))
    return len(np.unique(picture.reshape(-1, picture.shape[-1]), axis=0))


def test_fixes_at_a_place(files):
    """Two stations 24 nmi to each side and to the south: 90 degrees, so the distances have a circle. Wrong: a table in
    other units than the screen, the second place on the same side."""
    done = navfmu("fix", "stations.csv", *NEAR, "--stations", "A,B", "--out", "f.csv", "--picture", "f.png")
    assert done.exit_code == 0, done.output
    told = " ".join(done.output.split())
    assert "rho-rho A B: the circles cross a second time 47.8 nmi away, at 36.60" in told.replace("47.83", "47.8")
    assert "by chance it would be" not in told
    table = pd.read_csv("f.csv")
    axes = [float(table[f"rho-rho A B {which} axis (m)"].iloc[0]) for which in ("long", "short")]
    assert axes == pytest.approx([314.8, 314.8], rel=0.02)
    assert drawn(files / "f.png") > 100


def test_maps_and_tracks_of_fixes(files):
    done = navfmu(
        "fix", "stations.csv", *NEAR, "--stations", "A,B", "--radius", 30, "--out", "m.csv", "--picture", "m.png"
    )
    assert done.exit_code == 0, done.output
    table = pd.read_csv("m.csv")
    middle = table.iloc[len(table) // 2]
    assert len(table) == 81**2 and middle["rho-rho A B long axis (m)"] == pytest.approx(315.7, rel=0.02)
    assert np.any(table["rho-rho A B long axis (m)"] == -1.0)  # on the line
    assert 0.0 < np.mean(table["all of A B long axis (m)"] == -1.0) < 0.002  # in both cones, of half a mile
    done = navfmu("fix", "stations.csv", "--track", "flight.csv", "--out", "t.csv", "--picture", "t.png")
    assert done.exit_code == 0, done.output
    assert pd.read_csv("t.csv")["time (s)"].tolist() == [10.0 * i for i in range(60)]
    assert min(drawn(files / name) for name in ("m.png", "t.png")) > 100


def test_an_ellipse_that_is_too_simple_is_told(files):
    """1.1 nmi from the line through both."""
    done = navfmu("fix", "stations.csv", "--near", 37.02, -121.5, "--stations", "A,B")
    told = " ".join(done.output.split())
    assert done.exit_code == 0 and "so far its lines are not straight" in told and "have no solution" in told


def test_a_place_on_the_line_says_why(files):
    done = navfmu("fix", "stations.csv", "--near", 37.003, -121.5, "--stations", "A,B")
    told = " ".join(done.output.split())
    assert done.exit_code == 0 and "rho-rho A B: its lines cross at 0.5" in told and "they must cross" in told


def test_observability_along_a_track(files):
    """C lies ahead of the track and A beside it. Wrong: windows that end after the track."""
    done = navfmu(
        "observability", "stations.csv", "--track", "flight.csv", "--stations", "A,C", "--window", "4 min",
        "--out", "o.csv", "--picture", "o.png",
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    assert "all 4 directions are observable in 100 % of the windows" in " ".join(done.output.split())
    table = pd.read_csv("o.csv")
    assert table["time (s)"].tolist() == [15.0 * i for i in range(24)]
    assert set(table["observable"]) == {4} and set(table["distances"]) == {17}
    assert drawn(files / "o.png") > 100


def test_what_is_not_told_is_said(files):
    done = navfmu("observability", "stations.csv", "--track", "flight.csv", "--model", "sensors", "--wind", 270, 20)
    told = " ".join(done.output.split())
    assert done.exit_code == 0 and "tells 4 of 6 directions; not told, or hardly: " in told, told
    assert "heading +2.5 deg with wind" in told and "airspeed +2.6 m/s with wind" in told


FLIGHT = ("observability", "stations.csv", "--track", "flight.csv")
REFUSED = {
    "no place": (("fix", "stations.csv"), "expected either --near LAT LON for a place or --track FILE"),
    "nothing heard": (("fix", "stations.csv", "--near", 0, 0), "none of its 3 stations is heard there"),
    "another station": (("fix", "stations.csv", *NEAR, "--stations", "A,D"), "has no station 'D'"),
    "one twice": (("fix", "stations.csv", *NEAR, "--stations", "A,A"), "expected each station once"),
    "draws of a map": (("fix", "stations.csv", *NEAR, "--radius", 9, "--draws", 2000), "--draws belongs to a place"),
    "draws of a track": (("fix", "stations.csv", "--track", "flight.csv", "--draws", 2000), "--draws belongs"),
    "few draws": (("fix", "stations.csv", *NEAR, "--draws", 9), "--draws is 9 fixes; expected 1000 to"),
    "no sigma": (("fix", "stations.csv", *NEAR, "--distance-sigma", 0), "--distance-sigma is 0 nmi"),
    "a file written over": (("fix", "stations.csv", *NEAR, "--out", "stations.csv"), "is a file that is read"),
    "below the ground": (
        ("fix", "stations.csv", *NEAR, "--altitude", 100, "--ground", 2000),
        "--altitude is 100 ft, below the ground at 2000 ft",
    ),
    "no fix there": (
        ("fix", "stations.csv", "--near", 37, -122, "--stations", "A"),
        "there is no fix at this place: rho-theta A: A stands too steep below for a bearing",
    ),
    "no fix anywhere": (
        ("fix", "stations.csv", "--near", 0, 0, "--radius", 9, "--stations", "A,B"),
        "there is no fix at any point",
    ),
    "one station": ((*FLIGHT, "--stations", "A"), "A is the only station"),
    "no motion": (("observability", "stations.csv", "--track", "standing.csv"), "ing.csv: the track does not move"),
    "too short": ((*FLIGHT, "--window", "20 min"), "flight.csv: the track is too short, 590 s"),
    "another model": ((*FLIGHT, "--model", "ful"), "position, reduced, sensors, full; did you mean 'full'?"),
    "a wind from nowhere": ((*FLIGHT, "--wind", 400, 10), "--wind is 400 deg; expected 0 to 360"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_is(name, files):
    words, sentence = REFUSED[name]
    done = navfmu(*words)
    assert (files / "stations.csv").read_text() == TABLE
    assert done.exit_code == 2 and sentence in done.stderr and "Traceback" not in done.output, done.output
