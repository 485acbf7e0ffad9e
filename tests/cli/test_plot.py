"""``navfmu plot``: any recording becomes a picture, and what cannot be drawn is a sentence."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas
import pytest
from click.testing import CliRunner
from matplotlib import image

from navfmu import System
from navfmu.cli.main import main
from navfmu.report.pictures import lines
from navfmu.system import result
from tests.components import systems


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Path:
    frame = System.load(systems.tracker()).run(seed=2, faults="stuck", record=["sensor", "lag", "estimator.sigma"])
    return result.write(frame, tmp_path_factory.mktemp("plot") / "flight.parquet")


@pytest.fixture
def scenes(monkeypatch) -> list:
    """What was drawn: scenes and signals."""
    kept, draw = [], lines.draw
    monkeypatch.setattr(
        lines, "draw", lambda scene, names, title: kept.append((scene, names)) or draw(scene, names, title)
    )
    return kept


def call(*arguments: object, code: int = 0) -> str:
    done = CliRunner().invoke(main, ["plot", *map(str, arguments)])
    assert done.exit_code == code, done.output + done.stderr
    return done.output if code == 0 else done.stderr


def test_a_picture_stands_beside_the_recording(recording, scenes):
    out = call(recording, "lag.y", "sensor.reading")
    assert out == f"wrote 5 signals to {recording.with_suffix('.png')}\n"
    height, width, _ = image.imread(recording.with_suffix(".png")).shape
    assert width > 900 and height > 400
    ((scene, names),) = scenes
    assert names[0] == "lag.y" and set(names[1:]) == {
        f"sensor.reading.{member}" for member in ("length", "valid", "sequence", "time_of_validity")
    }
    assert scene.label == "tracker, seed 2" and scene.unit("lag.y") == "m"
    assert [(w.name, w.spans) for w in scene.windows] == [("F1", ((5.0, 10.0),))]


def test_patterns_components_and_lists_with_commas_name_signals(recording, scenes, tmp_path):
    for names, drawn in (
        (["*.length"], ["sensor.reading.length"]),
        (["lag"], ["lag.y"]),
        (["estimator.sigma,lag.y"], ["estimator.sigma", "lag.y"]),
    ):
        call(recording, *names, "--out", tmp_path / "p.png")
        assert scenes[-1][1] == drawn
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")


def test_without_a_signal_it_lists_what_is_there(recording):
    recording.with_suffix(".png").unlink(missing_ok=True)
    out = call(recording)
    assert "6 signals, 0 to 20 s" in out and "estimator.sigma" in out and "remark" not in out
    assert not recording.with_suffix(".png").exists()
    frame = result.read(recording)
    frame.iloc[3, list(frame.columns).index("lag.y")] = np.nan
    broken = result.write(frame, recording.with_name("broken.parquet"))
    assert "not finite at 1 of 201 points" in call(broken)


def test_csv_files_are_drawn_with_and_without_what_stands_beside_them(recording, scenes, tmp_path):
    file = result.write(result.read(recording), tmp_path / "flight.csv")
    call(file, "sensor.reading")
    assert scenes[-1][0].unit("sensor.reading.length") == "m" and scenes[-1][0].windows
    Path(f"{file}.json").unlink()
    call(file, "sensor.reading")
    assert scenes[-1][0].label == "flight.csv" and not scenes[-1][0].windows


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["flight.parquet", "sensor.lenght"], "there is no signal 'sensor.lenght'; did you mean 'sensor.reading"),
        (["flight.parquet", "senser"], "there is no signal 'senser'; did you mean 'sensor'?"),
        (["flight.parquet", "*.nothing"], "there is no signal '*.nothing'"),
        (["flight.parquet", "lag.y", "--out", "x.jpg"], "x.jpg: cannot tell the format from the name; expected .png"),
        (["none.parquet", "lag.y"], "none.parquet: no such file"),
        (["text.txt", "lag.y"], "text.txt: is not a recording; expected a file whose name ends in .parquet or .csv"),
        (["people.parquet", "lag.y"], "is not a recording of a run: 'name' holds texts"),
        (["numbers.parquet", "lag.y"], "is not a recording of a run: it has no column 'time' of numbers"),
        (["empty.csv", "lag.y"], "empty.csv: holds no recorded values"),
        (["noise.parquet", "lag.y"], "noise.parquet: cannot be read"),
        (["flight.parquet", ""], "the names of signals are empty"),
        (["flight.parquet", "lag.y", "--out", ""], "the name of the file to write is empty"),
        (["", "lag.y"], "the name of a file is empty; expected that of a recording"),
        (["back.csv"], "back.csv, line 4: time is 1 after 2; expected times that go up from row to row"),
        (["again.parquet", "lag.y"], "again.parquet, row 2: time is 0 after 0; expected times that go up"),
        (["never.csv", "lag.y"], "never.csv, line 2: time is nan; expected times that go up"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_a_sentence(recording, tmp_path, monkeypatch, arguments, sentence):
    monkeypatch.chdir(tmp_path)
    shutil.copy(recording, "flight.parquet")
    Path("text.txt").write_text("lag.y")
    pandas.DataFrame({"time": [0.0], "name": ["x"]}).to_parquet("people.parquet")
    pandas.DataFrame({"lag.y": [0.0]}).to_parquet("numbers.parquet")
    pandas.DataFrame({"time": [0.0, 0.0], "lag.y": [1.0, 2.0]}).to_parquet("again.parquet")
    Path("back.csv").write_text("time,lag.y\n0,1\n2,1\n1,1\n")
    Path("never.csv").write_text("time,lag.y\nnan,1\n1.5,1\n")
    Path("empty.csv").write_text("time,lag.y\n")
    Path("noise.parquet").write_bytes(b"no parquet at all")
    before = sorted(Path().iterdir())
    assert sentence in call(*arguments, code=2)
    assert sorted(Path().iterdir()) == before
