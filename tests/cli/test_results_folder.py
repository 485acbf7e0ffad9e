"""A report never takes the place of one of another kind, and none is written into a system."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.system.run_report import write_report
from tests.components import systems

WORK = {
    "a run": ["run", "{tracker}", "--stop", "1", "--report"],
    "a sweep": ["sweep", "{tracker}", "--stop", "1", "--steps", "0.1,0.2", "--out"],
    "figures": ["figures", "thesis", "--only", "T26", "--out"],
    "a campaign": ["campaign", "{folder}/campaign.toml", "--out"],
}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A folder of results of each kind."""
    folder = tmp_path_factory.mktemp("results")
    (folder / "campaign.toml").write_text(f"system = '{systems.tracker()}'\nstop = 1\nseeds = '1'\n")
    for kind in WORK:
        assert navfmu(kind, folder, folder / kind) == (0, "")
    return folder


def navfmu(kind: str, folder: Path, into: Path) -> tuple[int, str]:
    words = [word.format(tracker=systems.tracker(), folder=folder) for word in WORK[kind]]
    answer = CliRunner().invoke(main, [*words, str(into)])
    return answer.exit_code, answer.stderr if answer.exit_code else ""


def contents(folder: Path) -> dict[Path, str]:
    files = (file for file in folder.rglob("*") if file.is_file())
    return {file: hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


@pytest.mark.parametrize("kind", WORK)
@pytest.mark.parametrize("other", WORK)
def test_a_folder_holds_results_of_one_kind(kind, other, done):
    before = contents(done / other)
    code, said = navfmu(kind, done, done / other)
    if kind == other:
        assert code == 0
    else:
        wanted = f"holds the results of {other}, where the results of {kind} are to be written; name another folder"
        assert (code, said) == (2, f"navfmu: {done / other}: {wanted}\n")
        assert contents(done / other) == before


@pytest.mark.parametrize("kind", WORK)
def test_a_system_is_no_folder_for_results(kind, done, tmp_path):
    subprocess.run([sys.executable, "-m", "zipfile", "-e", str(systems.tracker()), str(tmp_path)], check=True)
    before = contents(tmp_path)
    code, said = navfmu(kind, done, tmp_path)
    assert code == 2 and f"{tmp_path}: is the folder of a system (it has SystemStructure.ssd), where" in said
    assert contents(tmp_path) == before


def test_a_campaign_that_was_interrupted_counts_and_what_else_is_there_does_not(done, tmp_path):
    (tmp_path / "runs").mkdir()
    for name in ("runs/notes.json", "report.html", "notes.toml"):
        (tmp_path / name).write_text("mine")
    assert navfmu("a sweep", done, tmp_path)[0] == 0
    answer = next((done / "a campaign" / "runs").glob("*.json"))
    begun = tmp_path / "begun"
    (begun / "runs").mkdir(parents=True)
    (begun / "runs" / answer.name).write_bytes(answer.read_bytes())
    assert "holds the results of a campaign" in navfmu("a sweep", done, begun)[1]


def test_in_python_too(done):
    experiment = System.load(systems.tracker()).experiment(stop=1)
    with pytest.raises(NavfmuError, match="holds the results of a campaign"):
        write_report(experiment.run(), experiment, done / "a campaign")
