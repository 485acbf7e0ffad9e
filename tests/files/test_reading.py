"""What is not a file with an end is told at once, wherever a file is named, and never waited for."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from navfmu.errors import NavfmuError
from navfmu.files.reading import read_bytes, regular, what_is
from tests.components import systems

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes, sockets and devices of Unix")


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    return path


def test_a_file_is_read_and_what_is_none_is_named(tmp_path, pipe, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"ab")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind("socket")
    assert read_bytes("file", "a text", 2) == b"ab" and what_is("none") is None
    for path, words in {".": "a folder", pipe: "a pipe", "socket": "a socket", "/dev/null": "a device"}.items():
        with pytest.raises(NavfmuError) as caught:
            read_bytes(path, "a text")
        assert str(caught.value) == f"{path}: is {words}, expected a text"
    listener.close()


@pytest.mark.parametrize("name", ["none", "file/none", "n" * 5000, "nul\0"])
def test_what_is_not_there_or_cannot_be_is_a_sentence(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_bytes(b"ab")
    with pytest.raises(NavfmuError, match=r"no such file; expected a text|cannot be reached: "):
        regular(name, "a text")


PLACES = {
    "faults": ["run", "{tracker}", "--faults", "{pipe}"],
    "a system": ["run", "{pipe}"],
    "a system of its own": ["run", "{pipe}.ssd"],
    "an FMU": ["run", "{pipe}.fmu"],
    "an FMU to look into": ["info", "{pipe}.fmu"],
    "a main document": ["run", "{folder}/system"],
    "a campaign": ["campaign", "{pipe}"],
    "a recording": ["plot", "{pipe}"],
    "a recording as CSV": ["plot", "{pipe}.csv"],
    "a recording as Parquet": ["plot", "{pipe}.parquet", "lag.y"],
    "a device that is no recording": ["plot", "/dev/zero"],
    "a track": ["track", "{pipe}", "--out", "{folder}/t.fmu"],
    "an FMU with a table": ["table", "{pipe}"],
    "numbers for a table": ["table", "{folder}/t.fmu", "t", "--from", "{pipe}.csv", "--out", "{folder}/u.fmu"],
    "a device that is no track": ["track", "/dev/zero", "--out", "{folder}/t.fmu"],
    "a result": ["run", "{tracker}", "--out", "{pipe}.csv"],
}


@pytest.mark.parametrize("place", PLACES)
def test_a_command_does_not_wait_for_a_pipe(place, tmp_path, pipe, monkeypatch):
    for suffix in (".csv", ".parquet", ".ssd", ".fmu"):
        os.mkfifo(f"{pipe}{suffix}")
    (tmp_path / "system").mkdir()
    os.mkfifo(tmp_path / "system" / "SystemStructure.ssd")
    words = [word.format(tracker=systems.tracker(), pipe=pipe, folder=tmp_path) for word in PLACES[place]]
    said = navfmu(*words)
    kind = "a device" if "device" in place else "a pipe"
    assert (
        said.startswith(f"navfmu: {tmp_path if kind == 'a pipe' else '/dev/zero'}") and f": is {kind}, expected" in said
    )
    assert not (tmp_path / "t.fmu").exists()


def navfmu(*words: str) -> str:
    """What the command says, which is one sentence and code 2; by itself, because it could wait for ever."""
    command = [sys.executable, "-m", "navfmu", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=Path(__file__).parents[2])
    assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
    return done.stderr


def test_documents_of_a_folder_are_files(tmp_path):
    folder = tmp_path / "tracker"
    subprocess.run([sys.executable, "-m", "zipfile", "-e", str(systems.tracker()), str(folder)], check=True)
    campaign = tmp_path / "campaign.toml"
    campaign.write_text('system = "tracker"\nstop = 1\n[[case]]\nname = "a"\nfaults = "stuck.toml"\n')
    os.mkfifo(tmp_path / "stuck.toml")
    assert "stuck.toml: is a pipe, expected a fault file" in navfmu("campaign", str(campaign))
    for file in (folder / "extra" / "faults" / "stuck.toml", folder / "resources" / "lag.fmu"):
        content = file.read_bytes()
        file.unlink()
        os.mkfifo(file)
        assert f"{file.name}: is a pipe, expected " in navfmu("run", str(folder), "--faults", "stuck")
        file.unlink()
        file.write_bytes(content)
