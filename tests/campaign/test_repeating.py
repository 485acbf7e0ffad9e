"""The command that repeats a run: from every folder, and never another experiment without a word."""

from __future__ import annotations

import json
import shlex
import shutil

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.campaign.executor import run_campaign
from navfmu.campaign.file import load_campaign
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.system.result import read
from tests.foreign.stepper import write

CAMPAIGN = """system = "stepper.fmu"
stop = 2.0
step = 0.125
seeds = "1"
record = ["stepper.x"]
[parameters]
stepper.u = 1.0
[[case]]
name = "jump"
faults = "jump.toml"
"""
FAULT = """[[fault]]
id = "F1"
target = "stepper.x"
type = "bias"
start = 1.0
value = %s
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with a campaign, and beside it one to be in."""
    place = tmp_path / "there"
    place.mkdir()
    write(place / "stepper.fmu")
    (place / "jump.toml").write_text(FAULT % 3.0)
    (place / "campaign.toml").write_text(CAMPAIGN)
    (tmp_path / "here").mkdir()
    return place


def fly(path, out):
    """The outcome of a campaign, and its only recording."""
    outcome = run_campaign(load_campaign(path), out, jobs=1, workers="thread")
    (file,) = (out / "runs").glob("*.parquet")
    return outcome, file


def again(words, out):
    """What the command says that repeats a run."""
    program, *rest = shlex.split(words)
    assert program == "navfmu"
    return CliRunner().invoke(main, [*rest, "--out", str(out)])


def test_it_works_from_every_folder_and_the_recording_does_not_depend_on_it(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path / "here")
    outcome, file = fly("../there/campaign.toml", tmp_path / "out")
    monkeypatch.chdir(folder)
    _, same = fly("campaign.toml", tmp_path / "out2")
    assert file.read_bytes() == same.read_bytes()
    assert (tmp_path / "out" / "report.html").read_bytes() == (tmp_path / "out2" / "report.html").read_bytes()
    kept = read(file)
    about = json.loads((tmp_path / "out" / "campaign.json").read_text())
    monkeypatch.chdir("/")
    for words in (kept.attrs["provenance"]["command"], outcome.runs[0].run.experiment.command()):
        done = again(words, tmp_path / "again.parquet")
        assert done.exit_code == 0, done.output
        assert read(tmp_path / "again.parquet").equals(kept)
    assert about["command"] == f"navfmu campaign {folder}/campaign.toml --seeds 1"


def test_a_fault_file_of_another_content_is_refused(folder, tmp_path):
    """The recording is used again after its fault file was renamed; the old name is then given to another one."""
    _, file = fly(folder / "campaign.toml", tmp_path / "out")
    old = read(file).attrs["provenance"]["command"]
    shutil.move(folder / "jump.toml", folder / "leap.toml")
    (folder / "campaign.toml").write_text(CAMPAIGN.replace("jump.toml", "leap.toml"))
    (folder / "jump.toml").write_text(FAULT % 4.0)
    outcome, reused = fly(folder / "campaign.toml", tmp_path / "out")
    assert reused == file and read(file).attrs["provenance"]["command"] == old
    report = (tmp_path / "out" / "report.html").read_text()
    assert "leap.toml" in report and "jump.toml" not in report
    done = again(old, tmp_path / "again.parquet")
    assert done.exit_code == 2 and not (tmp_path / "again.parquet").exists()
    assert "the faults in the fault files are not what the command was written for" in " ".join(done.stderr.split())
    new = outcome.runs[0].run.experiment.command()
    assert again(new, tmp_path / "again.parquet").exit_code == 0
    assert read(tmp_path / "again.parquet").equals(read(file))


def test_another_system_of_the_same_name_is_refused(folder, tmp_path):
    command = System.load(folder / "stepper.fmu").experiment(stop=1.0, step=0.125).command()
    assert again(command, tmp_path / "a.csv").exit_code == 0
    write(folder / "stepper.fmu", canInterpolateInputs="true")
    done = again(command, tmp_path / "b.csv")
    assert done.exit_code == 2 and not (tmp_path / "b.csv").exists()
    said = " ".join(done.stderr.split())
    assert f"the system in {folder}/stepper.fmu is not what the command was written for" in said
    words = shlex.split(command)
    at = words.index("--expect")
    assert again(shlex.join(words[:at] + words[at + 2 :]), tmp_path / "c.csv").exit_code == 0


def test_a_sweep_is_repeated_alike(folder, tmp_path):
    experiment = System.load(folder / "stepper.fmu").experiment(stop=1.0, step=0.125, faults=folder / "jump.toml")
    words = shlex.join([*experiment.words("sweep"), "--steps", "0.125,0.25"])
    (folder / "jump.toml").write_text(FAULT % 4.0)
    _, *rest = shlex.split(words)
    done = CliRunner().invoke(main, rest)
    assert done.exit_code == 2 and "--expect" in done.stderr


def test_what_lies_in_the_current_folder_is_not_meant_by_a_campaign(folder, tmp_path, monkeypatch):
    """A path in a campaign file is seen from that file, wherever the command is given."""
    here = tmp_path / "here"
    monkeypatch.chdir(here)
    shutil.move(folder / "jump.toml", here / "jump.toml")
    with pytest.raises(NavfmuError, match=r"there is no fault file 'jump.toml'"):
        load_campaign(folder / "campaign.toml")
    (folder / "jump.toml").write_text(FAULT % 3.0)
    shutil.move(folder / "stepper.fmu", here / "stepper.fmu")
    with pytest.raises(NavfmuError, match=r"stepper\.fmu' is not shipped|stepper\.fmu: no such file"):
        load_campaign(folder / "campaign.toml")
