"""Standard streams that are closed, as services start programs: commands do what they do, and keep it from others."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.components import systems

pytestmark = pytest.mark.skipif(os.name == "nt", reason="a shell of POSIX")
CLOSED = ("2>&-", ">&-", "<&- >&- 2>&-", "<&- 2>&-")


def start(folder, closed: str, *words: str) -> int:
    command = ["/bin/sh", "-c", f'exec "$@" {closed}', "sh", sys.executable, *words]
    return subprocess.run(command, cwd=folder, stderr=subprocess.DEVNULL, timeout=60).returncode


@pytest.mark.parametrize("closed", CLOSED)
def test_a_run_writes_its_report(closed, tmp_path):
    """Without a place for notes it ended with the code 1 and nothing was written."""
    words = ["-m", "navfmu", "run", str(systems.tracker().resolve()), "--stop", "1", "--set", "lag.tau=1"]
    words += ["--fault", "id = 'F', target = 'lag.y', type = 'bias', value = 0.0"]  # a note
    assert start(tmp_path, closed, *words, "--report", "r") == 0
    assert {file.name for file in (tmp_path / "r").iterdir()} == {"recording.parquet", "report.html"}
    assert start(tmp_path, closed, *words, "--stop", "-1") == 2


def test_what_the_encoding_lacks_is_written_as_python_does(tmp_path):
    """After all the work it was a traceback with the code 1, which says that a requirement does not hold."""
    (tmp_path / "c.toml").write_text(f"system = {str(systems.tracker().resolve())!r}\nstop = 1\n")
    words = [sys.executable, "-m", "navfmu", "campaign", "c.toml", "--out", "中"]
    environment = os.environ | {"PYTHONIOENCODING": "cp1252"}
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, b"")
    assert rb"\u4e2d/report.html" in done.stdout


@pytest.mark.parametrize("closed", CLOSED)
def test_what_an_fmu_prints_goes_into_no_file(closed, tmp_path):
    """The first file that is opened had the number 2, and what came to the standard error stream."""
    code = "import os; from navfmu.terminal.streams import complete; complete(); file = open('recording', 'w'); "
    code += "print('for people', flush=True); [os.write(number, b'from C') for number in (1, 2)]"
    assert start(tmp_path, closed, "-c", code) == 0
    assert (tmp_path / "recording").read_text() == ""
