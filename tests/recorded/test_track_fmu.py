"""The FMU that plays a recorded track."""

from __future__ import annotations

import dataclasses
import os
import shutil
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner
from fmpy.validation import validate_fmu

from evidence.strapdown import navigate
from fmus.motion.aircraft import Aircraft
from fmus.motion.track import Track
from models.attitude import attitude
from navfmu.cli.track import command
from navfmu.errors import NavfmuError
from navfmu.export import Input, Output
from navfmu.recorded.archive import write_fmu
from navfmu.recorded.importer import import_track
from navfmu.recorded.picture import draw
from tests import built
from tests.recorded.made import flight, recorded


@pytest.fixture(scope="module")
def csv(tmp_path_factory):
    path = tmp_path_factory.mktemp("track") / "made.csv"
    recorded(flight(), jitter=0.5).to_csv(path, index=False)
    return path


@pytest.fixture(scope="module")
def imported(csv):
    return import_track(csv)


@pytest.fixture(scope="module")
def player(tmp_path_factory):
    return built.fmu("track", tmp_path_factory)


@pytest.fixture(scope="module")
def fmu(imported, player, tmp_path_factory):
    return write_fmu(imported, player, tmp_path_factory.mktemp("track") / "made.fmu")


def play(fmu, stop, wind=(0.0, 0.0, 0.0), period=0.01):
    start = {f"wind_n[{i + 1}]": w for i, w in enumerate(wind)}
    return fmpy.simulate_fmu(str(fmu), stop_time=stop, output_interval=period, start_values=start)


def vector(result, name):
    return np.stack([result[f"{name}[{i}]"] for i in (1, 2, 3)], axis=1)


def test_has_the_inputs_and_outputs_of_aircraft():
    def interface(component):
        return {
            name: (type(v), v.shape, v.unit, v.kind)
            for name, v in vars(component).items()
            if isinstance(v, Input | Output)
        }

    assert interface(Track) == interface(Aircraft)


def test_is_valid_and_describes_the_flight(fmu, imported):
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    assert description.modelName == "made"
    assert "made.csv" in description.description
    assert float(description.defaultExperiment.stopTime) == imported.flight.duration
    with zipfile.ZipFile(fmu) as archive:
        account, page = (archive.read(f"documentation/{name}").decode() for name in ("import.txt", "index.html"))
    assert "timing jitter" in account and "along track" in account
    assert "<title>made</title>" in page and "timing jitter" in page
    assert "two minutes of level flight" not in page and "<h2>Response</h2>" not in page


def test_a_file_may_have_any_name(imported, tmp_path):
    """Matplotlib reads what is between two $."""
    draw(dataclasses.replace(imported, source="$\\no{$.csv"), tmp_path / "track.png")
    assert (tmp_path / "track.png").stat().st_size > 10_000


def test_plays_the_smoothed_flight_exactly(fmu, imported):
    stop = imported.flight.duration
    result = play(fmu, stop, period=0.5)
    time = result["time"]
    for name in ("latitude", "longitude"):
        assert np.max(np.abs(result[name] - getattr(imported.flight, name)(time))) < 1e-14
    assert np.max(np.abs(result["altitude"] - imported.flight.altitude(time))) < 1e-9
    for axis, expected in enumerate(imported.flight.velocity(time)):
        assert np.max(np.abs(vector(result, "velocity_n")[:, axis] - (expected if axis < 2 else -expected))) < 1e-8


@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (8.0, -6.0, 0.0)])
def test_integrating_its_force_and_rate_returns_the_flight(fmu, imported, wind):
    """Closure over the whole flight: an independent strapdown navigator drifts by less than a centimetre."""
    stop = 0.02 * np.floor(imported.flight.duration / 0.02 - 1.0)
    result = play(fmu, stop, wind)
    euler = [float(result[name][0]) for name in ("roll", "pitch", "heading")]
    latitude, longitude, altitude, c_nb = navigate(
        0.01,
        vector(result, "specific_force"),
        vector(result, "rate"),
        *(float(result[name][0]) for name in ("latitude", "longitude", "altitude")),
        vector(result, "velocity_n")[0],
        euler,
    )
    north = 6.37e6 * (latitude - result["latitude"])
    east = 6.37e6 * np.cos(result["latitude"]) * (longitude - result["longitude"])
    assert np.hypot(north, east).max() < 0.01
    assert np.max(np.abs(altitude - result["altitude"])) < 0.01
    final = attitude.dcm(*(float(result[name][-1]) for name in ("roll", "pitch", "heading")))
    assert np.max(np.abs(final - c_nb)) < 1e-6


def test_starts_in_the_wind_and_with_the_lift_that_it_needs(fmu):
    """Heading is that of the velocity relative to the wind from the first row on; alpha follows the load factor."""
    result = play(fmu, 120.0, (8.0, -6.0, 0.0), period=0.1)
    relative = vector(result, "velocity_n") - (8.0, -6.0, 0.0)
    difference = attitude.wrap(result["heading"] - np.arctan2(relative[:, 1], relative[:, 0]))
    banked = np.abs(result["roll"])
    # in a bank the nose is off by alpha sin(roll), to the inside
    assert np.all(np.abs(difference) < 0.01 + np.max(np.abs(result["angle_of_attack"])) * np.sin(banked))
    np.testing.assert_allclose(result["true_airspeed"], np.linalg.norm(relative, axis=1), rtol=1e-12)
    np.testing.assert_allclose(result["sideslip"], 0.0, atol=1e-6)
    density = 1.225 * (1.0 - 2.25577e-5 * result["altitude"][0]) ** 4.2559
    force, alpha = vector(result, "specific_force"), result["angle_of_attack"]
    load = (force[:, 0] * np.sin(alpha) - force[:, 2] * np.cos(alpha)) / 9.80665  # across the flow
    expected = -0.0603 + 2.0 * 1960.0 * load / (density * result["true_airspeed"] ** 2 * 5.14)
    flying = expected < 0.1  # far from the stall, near which the flight begins
    np.testing.assert_allclose(alpha[flying], expected[flying], atol=np.radians(0.1))
    assert np.mean(flying) > 0.5 and np.ptp(alpha[flying]) > np.radians(1.0)


def test_heading_is_continuous_through_north(fmu, imported):
    result = play(fmu, imported.flight.duration, period=0.1)
    assert np.max(np.abs(np.diff(result["heading"]))) < 0.05
    assert np.ptp(result["heading"]) > np.pi


def test_goes_on_straight_behind_the_last_row(fmu, imported):
    stop = imported.flight.duration
    result = play(fmu, stop + 20.0, period=1.0)
    after = result["time"] > stop
    assert after.sum() > 10
    assert np.ptp(vector(result, "velocity_n")[after][:, 0]) < 0.05
    assert np.all(np.abs(result["roll"][after]) < 0.01)


def test_two_tracks_in_one_process_are_two_flights(fmu, player, tmp_path):
    recorded(flight(latitude=-33.9, longitude=151.2)).to_csv(tmp_path / "other.csv", index=False)
    other = write_fmu(import_track(tmp_path / "other.csv"), player, tmp_path / "other.fmu")
    assert fmpy.read_model_description(str(other)).guid != fmpy.read_model_description(str(fmu)).guid
    assert play(fmu, 1.0)["latitude"][-1] > 0 > play(other, 1.0)["latitude"][-1]


def test_written_twice_is_the_same_file(imported, player, tmp_path):
    first = write_fmu(imported, player, tmp_path / "a.fmu").read_bytes()
    assert write_fmu(imported, player, tmp_path / "b.fmu").read_bytes() == first


def test_any_other_archive_is_refused_as_player(imported, tmp_path):
    with zipfile.ZipFile(tmp_path / "no.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
    with pytest.raises(NavfmuError, match=r"no.fmu: has no table 'track'; its tables are: none"):
        write_fmu(imported, tmp_path / "no.fmu", tmp_path / "out.fmu")


def test_command_writes_the_fmu_and_shows_residuals(csv, player, tmp_path, monkeypatch):
    monkeypatch.setattr("navfmu.system.shipped.path", lambda name: player)
    arguments = [str(csv), "--out", str(tmp_path / "out.fmu"), "--picture", str(tmp_path / "out.png")]
    outcome = CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert outcome.exit_code == 0
    assert "timing jitter" in outcome.output and "along track" in outcome.output
    assert validate_fmu(str(tmp_path / "out.fmu")) == []
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.skipif(os.name == "nt", reason="there are no such names on Windows")
def test_names_that_no_document_can_hold_are_written_as_one_writes_them_in_python(csv, player, tmp_path):
    source = Path(shutil.copy(csv, tmp_path / "a\x01\udc80.csv"))
    fmu = write_fmu(import_track(source), player, tmp_path / "odd.fmu")
    described = fmpy.read_model_description(str(fmu))
    assert described.modelName == r"a\x01\udc80"
    assert validate_fmu(str(fmu)) == []
