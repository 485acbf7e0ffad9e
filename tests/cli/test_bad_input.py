"""Whatever a user gets wrong: one sentence that names it, exit code 2, no traceback, nothing half-written."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from navfmu.cli.main import main
from navfmu.export import Component, Input, Output, Parameter, every, require
from navfmu.export.build import build
from navfmu.system import shipped
from navfmu.system.experiment import Experiment
from tests.components import systems
from tests.ssp import fmus


def navfmu(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


def refused(result: Result, *sentences: str) -> None:
    """Exit code 2, one sentence on the standard error stream, no traceback."""
    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    assert isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    for sentence in sentences:
        assert sentence in result.stderr


FAULTS = {
    "not toml": ("[[fault]\nid = 1", "line 1"),
    "an unknown type": ('[[fault]]\nid = "F"\ntarget = "lag.y"\ntype = "bais"\nvalue = 1.0\n', "line 4"),
    "no fault at all": ("# still empty\n", "holds no fault"),
    "a missing value": ('[[fault]]\nid = "F"\ntarget = "lag.y"\ntype = "bias"\n', "'value'"),
    "an unknown key": ('[[fault]]\nid = "F"\ntarget = "lag.y"\ntype = "bias"\nvalue = 1.0\nstat = 2\n', "'start'"),
    "an unknown target": ('[[fault]]\nid = "F"\ntarget = "lga.y"\ntype = "bias"\nvalue = 1.0\n', "did you mean 'lag'"),
    "a target that has no such fault": (
        '[[fault]]\nid = "F"\ntarget = "sensor.reading.valid"\ntype = "drift"\nrate = 1.0\n',
        "acts on Real outputs",
    ),
    "a parameter that cannot change": (
        '[[fault]]\nid = "F"\ntarget = "lag.tau"\ntype = "parameter"\nvalue = 1.0\n',
        "acts on tunable parameters, but 'lag.tau' is a fixed parameter",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_file_with(name, tmp_path):
    text, sentence = FAULTS[name]
    file = tmp_path / "faults.toml"
    file.write_text(text)
    out = tmp_path / "out.parquet"
    refused(navfmu("run", systems.tracker(), "--faults", file, "--out", out), str(file), sentence)
    assert not out.exists()


ARGUMENTS = {
    "a step of zero": (["--step", "0"], "step must be a positive number"),
    "a negative step": (["--step", "-0.1"], "step must be a positive number"),
    "a step that is not a number": (
        ["--step", "fast"],
        "--step is 'fast', expected a time: a number of seconds",
    ),
    "a stop of zero": (["--stop", "0"], "stop time must be a positive number"),
    "more steps than can be counted": (["--step", "1e-300"], "than can be counted exactly"),
    "a negative seed": (["--seed", "-1"], "the seed is -1, expected a whole number from 0 to"),
    "a seed beyond 32 bits": (["--seed", "2147483648"], "the seed is 2147483648, expected a whole number"),
    "a parameter set twice": (["--set", "lag.tau=1", "--set", "lag.tau=2"], "'lag.tau' is set twice"),
    "a parameter that is infinite": (["--set", "lag.tau=1e999"], "'tau' = inf s is out of range: expected a finite"),
    "a parameter that is not a number": (["--set", "lag.tau=nan"], "'tau' = nan s is out of range: expected a finite"),
    "an input that is connected": (["--set", "lag.u=1"], "connected to 'truth.y', so a value of its own would"),
    "an unknown fault file": (["--faults", "stukc"], "did you mean 'stuck'? (the system has: stuck)"),
    "an infinite stop": (["--stop", "inf"], "--stop is 'inf', expected a time"),
    "a stop between steps": (["--stop", "1.05"], "is not a multiple of the step"),
    "an unknown variant": (["--variant", "slwo"], "did you mean 'slow'"),
    "an unknown algorithm": (["--algorithm", "seidel"], "did you mean 'gauss_seidel'"),
    "an unknown component": (["--set", "lga.tau=1"], "did you mean 'lag'"),
    "an unknown parameter": (["--set", "lag.tua=1"], "did you mean 'tau'"),
    "a parameter out of range": (["--set", "sensor.sample_period=11"], "'sample_period' = 11 s is out of range"),
    "an integer that is not a number": (["--set", "sensor.seed=nan"], "expected an integer from"),
    "an integer of more than 32 bits": (["--set", "sensor.seed=4294967297"], "expected an integer from"),
    "a seed of more than 32 bits": (["--seed", "4294967297"], "expected"),
    "a parameter that is an output": (["--set", "lag.y=1"], "cannot be set: it is output"),
    "a parameter without a value": (["--set", "lag.tau"], "expected component.parameter=value"),
    "a parameter with an empty value": (["--set", "lag.tau="], "expected a number"),
    "a unit that does not convert": (["--set", "lag.tau=3 m"], "'m' cannot be converted to 's'"),
    "an unknown signal": (["--record", "lag.z"], "has no variable 'z'"),
    "a pattern that matches nothing": (["--record", "lag.z*"], "no output matches"),
    "a recording period between steps": (["--record-period", "0.15"], "is not a multiple of the step"),
    "a missing fault file": (["--faults", "nothing.toml"], "nothing.toml"),
    "an endless fault file": (["--faults", "/dev/zero"], "/dev/zero: is a device, expected a fault file"),
    "a step that no double holds": (["--step", "1e-320"], "than can be counted exactly"),
    "a recording period beyond all counting": (["--record-period", "1e300"], "is too long for the step"),
    "a stop that cannot be counted": (["--stop", "1e400"], "expected a time that can be counted"),
    "no name of a signal": (["--record", " , "], "the names of signals are empty"),
    "two faults in one": (
        ["--fault", 'id="a", target="lag.y", type="dropout" }, {id="b", target="lag.y", type="dropout"'],
        "expected the entries of one fault",
    ),
    "an option that does not exist": (["--stpo", "1"], "'--stop'"),
    "a fault file without a name": (["--faults", ""], "faults: the name of the file is empty"),
    "a result without a name": (["--out", ""], "the name of the file to write is empty; expected .parquet or .csv"),
    "a report without a name": (["--report", " "], "the name of the folder to write into is empty"),
    "a format that is not known": (["--out", "a.xlsx"], "a.xlsx: cannot tell the format from the name"),
}


@pytest.mark.parametrize("name", ARGUMENTS)
def test_run_with(name):
    arguments, sentence = ARGUMENTS[name]
    refused(navfmu("run", systems.tracker(), *arguments), sentence)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="devices")
@pytest.mark.parametrize("command", ["run", "info"])
def test_a_system_without_an_end(command):
    refused(navfmu(command, "/dev/zero"), "/dev/zero: is a device, expected an")


def test_the_version_needs_no_installation():
    from navfmu import __version__

    result = navfmu("--version")
    assert result.exit_code == 0 and result.output == f"navfmu {__version__}\n"


def test_a_shipped_fmu_that_is_misspelt_is_answered_with_the_nearest(monkeypatch, tmp_path):
    (tmp_path / "imu.fmu").write_bytes(b"")
    monkeypatch.setattr(shipped, "folders", lambda: [tmp_path])
    refused(navfmu("info", "imuu.fmu"), "imuu.fmu: no such file", "did you mean 'imu.fmu'")


FOR_AN_FMU = {
    "allan": ["allan", "none.csv"],
    "imu": ["calibrate", "imu", "none.csv", "--latitude", "47.7"],
    "gain": ["calibrate", "gain", "none.csv", "--latitude", "47.7"],
    "magnetometer": ["calibrate", "magnetometer", "none.csv"],
    "delay": ["calibrate", "delay", "none.csv", "other.csv"],
    "stations": ["stations", "none.csv", "--near", "37.7", "-121.8"],
}


@pytest.mark.parametrize("command", FOR_AN_FMU)
def test_parameters_are_for_a_file_or_a_shipped_fmu_by_name(command, monkeypatch, tmp_path):
    """Also where a folder here has that name. Wrong: the name of a system is expected; no name is this folder."""
    (tmp_path / "shipped").mkdir()
    (tmp_path / "shipped" / "imu.fmu").write_bytes(b"")
    (tmp_path / "imu").mkdir()
    monkeypatch.setattr(shipped, "folders", lambda: [tmp_path / "shipped"])
    monkeypatch.chdir(tmp_path)

    def asked(fmu):
        return navfmu(*FOR_AN_FMU[command], "--fmu", fmu, "--out", "set.ssv")

    refused(asked("imu"), "imu.fmu: is not an FMU" if command == "stations" else "none.csv: no such file")
    refused(asked("imuu"), "imuu: no such file, and no FMU of that name is shipped", "did you mean 'imu.fmu'")
    refused(asked("shipped"), "shipped: is a folder; expected an FMU")
    refused(asked(""), "the name of the FMU is empty")


def test_info_does_not_describe_an_archive_that_would_break_out_of_its_folder(tmp_path):
    evil = tmp_path / "evil.fmu"
    evil.write_bytes((systems.fmus() / "lag.fmu").read_bytes())
    with zipfile.ZipFile(evil, "a") as archive:
        archive.writestr("../evil.txt", "x")
    refused(navfmu("info", evil), "evil.fmu: entry '../evil.txt' would be written outside its folder")


def test_an_unknown_command_is_answered_with_the_nearest():
    refused(navfmu("swep"), "did you mean 'sweep'")


def bad_files(folder: Path) -> dict[str, tuple[Path, str]]:
    text, cut, foreign = folder / "text.ssp", folder / "cut.ssp", folder / "vax.fmu"
    text.write_text("hello")
    cut.write_bytes(systems.tracker().read_bytes()[:5000])
    with zipfile.ZipFile(foreign, "w") as archive:
        archive.writestr("modelDescription.xml", fmus.describe("vax", [fmus.variable("x", "parameter", reference=1)]))
        archive.writestr("binaries/vms/vax.exe", b"x")
    empty = folder / "empty"
    empty.mkdir()
    broken = folder / "broken.ssp"
    with zipfile.ZipFile(systems.tracker()) as source, zipfile.ZipFile(broken, "w") as target:
        for name in source.namelist():
            target.writestr(name, b"rubbish" if name.endswith("lag.fmu") else source.read(name))
    bomb, incomplete = folder / "bomb.fmu", folder / "incomplete.ssp"
    with zipfile.ZipFile(bomb, "w") as archive:
        entities = '<!ENTITY a "aaaaaaaaaa">' + "".join(
            f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
        )
        text_of_bomb = f"<!DOCTYPE x [{entities}]><fmiModelDescription fmiVersion='2.0' modelName='&i;'/>"
        archive.writestr("modelDescription.xml", text_of_bomb)
    with zipfile.ZipFile(systems.tracker()) as source, zipfile.ZipFile(incomplete, "w") as target:
        for name in source.namelist():
            if not name.endswith("lag.fmu"):
                target.writestr(name, source.read(name))
    evil = folder / "evil.ssp"
    with zipfile.ZipFile(evil, "w") as archive:
        archive.writestr("../evil.txt", "x")
    return {
        "missing": (folder / "none.ssp", "no such file"),
        "not an archive": (text, "is not an SSP"),
        "cut short": (cut, "is not an SSP"),
        "without a main document": (empty, "has no SystemStructure.ssd"),
        "with a corrupt FMU": (broken, "lag.fmu: is not an FMU"),
        "for another machine": (foreign, "no binary for this machine"),
        "that breaks out of its folder": (evil, "would be written outside its folder"),
        "with entities that multiply": (bomb, "modelDescription.xml: has a document type declaration"),
        "without one of its FMUs": (incomplete, "'resources/lag.fmu' is missing"),
    }


@pytest.mark.parametrize(
    "name",
    [
        "missing",
        "not an archive",
        "cut short",
        "without a main document",
        "with a corrupt FMU",
        "for another machine",
        "that breaks out of its folder",
        "with entities that multiply",
        "without one of its FMUs",
    ],
)
def test_a_file(name, tmp_path):
    path, sentence = bad_files(tmp_path)[name]
    refused(navfmu("run", path, "--stop", 1, "--step", 0.1, "--out", tmp_path / "o.csv"), str(path.name), sentence)
    assert not (tmp_path / "o.csv").exists() and not (tmp_path.parent / "evil.txt").exists()


def test_an_fmu_whose_binary_cannot_be_loaded(tmp_path):
    blunt = tmp_path / "blunt.fmu"
    with zipfile.ZipFile(systems.fmus() / "lag.fmu") as source, zipfile.ZipFile(blunt, "w") as target:
        for name in source.namelist():
            target.writestr(name, b"rubbish" if name.startswith("binaries") else source.read(name))
    refused(navfmu("run", blunt, "--stop", 1, "--step", 0.1), "component 'lag'", "cannot be loaded")


TRACKS = {
    "no suffix": (["--out", "x.zip"], "x.zip: cannot tell the format from the name; expected .fmu"),
    "a picture of another kind": (["--out", "x.fmu", "--picture", "x.jpg"], "expected .png"),
    "a result without a name": (["--out", ""], "the name of the file to write is empty; expected .fmu"),
    "a picture without a name": (
        ["--out", "x.fmu", "--picture", ""],
        "name of the file to write is empty; expected .png",
    ),
    "a model without a name": (["--out", "x.fmu", "--name", ""], "--name is empty"),
    "no lower limit": (["--out", "x.fmu", "--minimum-speed", "inf"], "expected a positive number"),
    "a missing recording": (["--out", "x.fmu"], "none.csv: no such file; expected a recorded track"),
}


@pytest.mark.parametrize("name", TRACKS)
def test_track_with(name, tmp_path, monkeypatch):
    arguments, sentence = TRACKS[name]
    monkeypatch.setattr(shipped, "path", lambda name: tmp_path / name)
    monkeypatch.chdir(tmp_path)
    refused(navfmu("track", "none.csv", *arguments), sentence)
    assert list(tmp_path.iterdir()) == []


class Fragile(Component):
    """Refuses two parameters that do not fit together."""

    u = Input("m", description="input")
    y = Output("m", description="output")
    low = Parameter("m", start=0.0, description="lower bound")
    high = Parameter("m", start=1.0, description="upper bound")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="period")

    @require("the lower bound {low} must be below the upper bound {high}")
    def ordered(self):
        return self.low < self.high

    @every("sample_period")
    def step(self):
        self.y = self.u


def test_an_fmu_that_returns_an_error_is_quoted(tmp_path):
    (file,) = build([Fragile], tmp_path)
    result = navfmu("run", file, "--stop", 1, "--step", 0.1, "--set", "fragile.low=2", "--out", tmp_path / "o.csv")
    refused(result, "component 'fragile'", "the lower bound 2 must be below the upper bound 1")
    assert not (tmp_path / "o.csv").exists()


def test_a_result_is_not_written_where_it_cannot_be(tmp_path):
    (tmp_path / "file").write_text("x")
    refused(navfmu("run", systems.tracker(), "--out", tmp_path / "file" / "o.csv"), "is not a folder")
    refused(navfmu("run", systems.tracker(), "--out", tmp_path / "o.csv" / ".."), "expected .parquet or .csv")


@pytest.mark.parametrize("words", [["--report", "link"], ["--report", "link/r"], ["--out", "link/o.csv"]])
@pytest.mark.parametrize("to", ["nowhere/at/all", "link"])
def test_a_link_to_nothing_is_in_the_way_before_the_run(words, to, tmp_path, monkeypatch):
    """It was told after the run, whose results were lost."""
    (tmp_path / "link").symlink_to(to)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Experiment, "run", lambda *_: pytest.fail("it was run"))
    refused(navfmu("run", systems.tracker().resolve(), *words), f"{tmp_path / 'link'} is not a folder")


def test_a_run_that_fails_leaves_an_older_result_alone(tmp_path):
    out = tmp_path / "o.csv"
    out.write_text("old")
    refused(navfmu("run", systems.tracker(), "--stop", -1, "--out", out))
    assert out.read_text() == "old" and [p.name for p in tmp_path.iterdir()] == ["o.csv"]


SWEEPS = {
    "one step": (["--steps", "0.1"], "at least two different steps"),
    "a step that is no number": (["--steps", "0.1,x"], "'x' is not a number"),
    "a negative step": (["--steps", "0.1,-1"], "step must be a positive number"),
    "a tolerance that nothing keeps": (["--steps", "0.1,0.2", "--tolerance", "-1"], "the tolerance is -1 %, expected"),
    "a tolerance that is no number": (["--steps", "0.1,0.2", "--tolerance", "nan"], "the tolerance is nan %, expected"),
    "steps without a common point": (["--steps", "0.1,19.9"], "share fewer than two points"),
    "signals that are not Real": (["--steps", "0.1,0.2", "--signals", "sensor.reading.valid"], "nothing to compare"),
}


@pytest.mark.parametrize("name", SWEEPS)
def test_sweep_with(name, tmp_path):
    arguments, sentence = SWEEPS[name]
    refused(navfmu("sweep", systems.tracker(), *arguments, "--out", tmp_path / "out"), sentence)
    assert not (tmp_path / "out").exists()


def test_the_tools_of_the_checkout_refuse_what_they_do_not_know(tmp_path):
    from evidence.__main__ import main as evidence
    from system_ssp.__main__ import main as documents

    refused(CliRunner().invoke(evidence, ["closur", "--out", str(tmp_path / "e")]), "no section 'closur'", "'closure'")
    (tmp_path / "file").write_text("x")
    refused(CliRunner().invoke(evidence, ["closure", "--out", str(tmp_path / "file" / "e")]), "is not a folder")
    refused(CliRunner().invoke(documents, ["everything"]), "unexpected extra argument")
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]


IN_THE_WAY = {
    "run": (["--report"], ["report.html", "recording.parquet"]),
    "sweep": (["--steps", "0.1,0.2", "--out"], ["sweep.csv", "sweep.json", "sweep.png", "report.html"]),
}


@pytest.mark.parametrize(("command", "name"), [(c, name) for c, (_, names) in IN_THE_WAY.items() for name in names])
def test_a_folder_in_the_way_of_a_result_is_told_before_the_run(command, name, tmp_path, monkeypatch):
    from navfmu.system.experiment import Experiment

    (tmp_path / name).mkdir()
    monkeypatch.setattr(Experiment, "run", lambda *_: pytest.fail("it was run"))
    words = [command, systems.tracker(), *IN_THE_WAY[command][0], tmp_path]
    refused(navfmu(*words), f"{tmp_path / name}: is a folder, where a file is to be written")


def test_a_folder_in_the_way_of_what_stands_beside_a_csv_file_is_told_before_the_run(tmp_path):
    (tmp_path / "a.csv.json").mkdir()
    refused(
        navfmu("run", systems.tracker(), "--out", tmp_path / "a.csv"), "a.csv.json: is a folder, where a file is to"
    )
    assert not (tmp_path / "a.csv").exists()
