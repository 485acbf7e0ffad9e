"""What the system does not let us see, and names that no file can have, are a sentence wherever a path is named."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli import main as line
from navfmu.errors import LENGTH, NavfmuError
from navfmu.files import cache
from navfmu.files.reading import located, what_is
from tests.components import systems

LONG = "a" * 5000
FAULTS = "[[fault]]\nid = 'F1'\n" * 20
PLACES = {
    "a system": ["run", "{path}"],
    "a main document": ["run", "{path}.ssd"],
    "a package": ["sweep", "{path}.ssp", "--steps", "0.1"],
    "an FMU": ["info", "{path}.fmu"],
    "faults": ["run", "{tracker}", "--faults", "{path}"],
    "a campaign": ["campaign", "{path}.toml"],
    "a recording": ["plot", "{path}.csv"],
    "a track": ["track", "{path}.csv", "--out", "{folder}/t.fmu"],
    "an FMU to write": ["track", "{folder}/track.csv", "--out", "{path}.fmu"],
    "the FMU of a table": ["table", "{path}.fmu"],
    "a table to write": ["table", "{tracker}", "t", "--out", "{path}.csv"],
    "numbers for a table": ["table", "{tracker}", "t", "--from", "{path}.csv", "--out", "{folder}/t.fmu"],
    "orbits": ["orbits", "{path}"],
    "a table of orbits to write": ["orbits", "{folder}/track.csv", "--out", "{path}.csv"],
    "a folder for a component": ["new", "radio", "--folder", "{path}"],
    "a result": ["run", "{tracker}", "--out", "{path}.csv"],
    "a report": ["run", "{tracker}", "--report", "{path}"],
    "a report of a sweep": ["sweep", "{tracker}", "--steps", "0.1", "--out", "{path}"],
    "a campaign's folder": ["campaign", "{folder}/c.toml", "--out", "{path}"],
    "the system of a campaign": ["campaign", "{folder}/system.toml"],
    "the faults of a campaign": ["campaign", "{folder}/faults.toml"],
}


@pytest.fixture
def locked(tmp_path, monkeypatch):
    """A folder that may not be entered, for root too."""
    folder, stat = tmp_path / "locked", os.stat

    def refused(path, *args, **more):
        if isinstance(path, str | os.PathLike) and folder in Path(os.path.abspath(path)).parents:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return stat(path, *args, **more)

    folder.mkdir()
    monkeypatch.setattr(os, "stat", refused)
    return folder / "in"


def commands(place: str, path: str, folder: Path) -> list[str]:
    (folder / "track.csv").write_text(
        "time_s,latitude_deg,longitude_deg,altitude_ft\n" + "".join(f"{t},{t / 1000},0,100\n" for t in range(9))
    )
    tracker = systems.tracker()
    (folder / "c.toml").write_text(f"system = '{tracker}'\nstop = 1\n")
    (folder / "system.toml").write_text(f"system = {path!r}\nstop = 1\n")
    (folder / "faults.toml").write_text(f"system = '{tracker}'\nstop = 1\n[[case]]\nname = 'a'\nfaults = {path!r}\n")
    return [word.format(path=path, tracker=tracker, folder=folder) for word in PLACES[place]]


def sentence(*words: str) -> str:
    """What the command says, which is one sentence and code 2."""
    done = CliRunner().invoke(line.main, words)
    assert done.exit_code == 2 and done.stderr.count("\n") == 1, done.output
    assert len(done.stderr) < 3 * LENGTH, done.stderr
    return done.stderr


@pytest.mark.parametrize("place", PLACES)
def test_a_path_in_a_folder_that_may_not_be_entered(place, locked, tmp_path):
    said = sentence(*commands(place, str(locked), tmp_path))
    assert str(locked) in said and ": Permission denied" in said


@pytest.mark.parametrize("place", PLACES)
def test_a_name_that_is_too_long(place, tmp_path):
    said = sentence(*commands(place, LONG, tmp_path))
    assert "aaa... " in said and " more characters: " in said and ": File name too long" in said


def test_the_text_of_a_fault_file_for_its_name():
    assert "cannot be reached: File name too long" in sentence("run", str(systems.tracker()), "--faults", FAULTS)


def test_in_python_too():
    with pytest.raises(NavfmuError, match=r"^a{500}\.\.\. 4500 more characters: cannot be reached: File name too long"):
        System.load(LONG)


def test_a_cache_that_is_out_of_reach(tmp_path, monkeypatch, locked):
    for name in (LONG, str(locked)):
        monkeypatch.setenv("NAVFMU_CACHE", name)
        assert "cannot be reached: " in sentence("cache") and "cannot be reached: " in sentence("cache", "--clear")
    monkeypatch.setenv("NAVFMU_CACHE", LONG)
    with pytest.raises(NavfmuError, match="the cache folder cannot be written: File name too long; set NAVFMU_CACHE"):
        cache.keep("built", "0" * 32, lambda folder: None)


def test_what_is_not_there_is_no_error_and_a_link_to_itself_neither(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "file").touch()
    assert [what_is(tmp_path / name) for name in ("none", "file/none", "loop", "nul\0")] == [None] * 4
    assert located(tmp_path / "loop" / "name").name == "name"
    with pytest.raises(NavfmuError, match=r"cannot be reached: "):
        located("nul\0/name")


def test_below_all_of_them_is_a_net(monkeypatch):
    @click.command()
    def command() -> None:
        os.listdir("no/folder")

    monkeypatch.setattr(line._Commands, "get_command", lambda *_: command)
    assert sentence("info") == "navfmu: no/folder: cannot be reached: No such file or directory\n"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError(errno.EMFILE, "Too many open files"), "the system refuses: Too many open files"),
        (OSError("cannot load library"), "the system refuses: cannot load library"),
        (OSError(), "the system refuses: OSError"),
    ],
)
def test_what_the_system_refuses_without_the_name_of_a_file(error, said, monkeypatch):
    """It was a traceback."""

    @click.command()
    def command() -> None:
        raise error

    monkeypatch.setattr(line._Commands, "get_command", lambda *_: command)
    assert sentence("info") == f"navfmu: {said}\n"


@pytest.mark.skipif(os.name == "nt", reason="there the current folder cannot be removed")
@pytest.mark.parametrize("program", ["navfmu run {tracker} --stop 1 --report r", "navfmu.export --out dist"])
def test_the_current_folder_is_gone(program, tmp_path):
    words = program.format(tracker=systems.tracker().resolve()).split()
    gone = f"import os, sys, runpy; os.rmdir(os.getcwd()); sys.argv = {words!r}; "
    gone += "runpy.run_module(sys.argv[0], run_name='__main__', alter_sys=True)"
    done = subprocess.run([sys.executable, "-c", gone], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    said = f"{words[0]}: the current folder: cannot be reached: No such file or directory\n"
    assert (done.returncode, done.stderr) == (2, said)


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="only root can become nobody")
def test_as_the_system_has_it(tmp_path):
    """Not as a test plays it: as a user who may not enter the folder."""
    tmp_path.chmod(0o700)
    program = "import os, sys; from navfmu.cli.main import main; import navfmu.system.system; os.seteuid(65534); main()"
    folder = str(tmp_path / "in")
    done = subprocess.run([sys.executable, "-c", program, "run", folder], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (2, f"navfmu: {folder}: cannot be reached: Permission denied\n")


@pytest.mark.parametrize(("name", "why"), [("%00", "embedded null byte"), (LONG, "File name too long")])
def test_the_file_that_a_document_names(name, why, tmp_path):
    subprocess.run([sys.executable, "-m", "zipfile", "-e", str(systems.tracker()), str(tmp_path)], check=True)
    document = tmp_path / "SystemStructure.ssd"
    document.write_text(document.read_text().replace("resources/lag.fmu", name))
    with pytest.raises(NavfmuError, match=rf"^{document}, line \d+: .*: cannot be reached: {why}$"):
        System.load(tmp_path)
