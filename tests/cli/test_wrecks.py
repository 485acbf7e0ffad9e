"""FMUs that end the process, in commands that call them themselves: a sentence, and never the exit code 0."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

from tests.campaign.wreck import ABORT, ERROR, EXIT, HANG, SEGFAULT, wreck

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals")
COMMANDS = {"run": ["--step", "0.1"], "sweep": ["--steps", "0.1,0.2"]}
ENDS = {"exit": (EXIT, "ended the process"), "segfault": (SEGFAULT, "crashed"), "abort": (ABORT, "aborted")}


def start(folder, command, way, call=0):
    settings = ["--set", f"probe.fail_status={way}", "--set", "probe.fail_at=0.75", "--set", f"probe.fail_call={call}"]
    words = [sys.executable, "-m", "navfmu", command, "probe.fmu", "--stop", "2", *COMMANDS[command], *settings]
    return subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return wreck(tmp_path_factory.mktemp("wreck")).parent


@pytest.mark.parametrize("way", ENDS)
@pytest.mark.parametrize("command", COMMANDS)
def test_who_ended_the_process_is_told(folder, command, way):
    status, word = ENDS[way]
    process = start(folder, command, status)
    _, errors = process.communicate(timeout=60)
    assert process.returncode not in (0, 1)
    (line,) = [line for line in errors.splitlines() if line.startswith("navfmu: ")]
    assert "component 'probe' in fmi2DoStep at t = 0." in line and word in line


def test_two_runs_that_end_the_process_at_once_do_not_end_it_well(folder):
    """While the first waits to say so, to a full pipe, the second ended it with the FMU's own exit code."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with suppress(BlockingIOError):
        while True:
            os.write(writing, b" " * 4096)
    os.set_blocking(writing, True)
    words = [sys.executable, "-m", "navfmu", "sweep", "probe.fmu", "--stop", "2", "--steps", "0.1,0.2"]
    settings = ["--set", f"probe.fail_status={EXIT}", "--set", "probe.fail_at=0.75"]
    process = subprocess.Popen([*words, *settings], cwd=folder, stdout=subprocess.DEVNULL, stderr=writing)
    os.close(writing)
    try:
        assert process.wait(timeout=60) == 2
    finally:
        process.kill()
        os.close(reading)


def test_python_does_not_end_well_either(folder):
    """A test session ended green where an FMU called exit(0)."""
    code = (
        "from navfmu import System; System.load('probe.fmu').run(stop=2, step=0.1, "
        f"parameters={{'probe.fail_status': {EXIT}, 'probe.fail_at': 0.75}})"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 2 and "component 'probe' in fmi2DoStep" in done.stderr


def test_a_refusal_to_terminate_is_one_of_the_run(folder):
    process = start(folder, "run", ERROR, call=6)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2 and "fmi2Terminate returned Error at t = 2 s" in errors


@pytest.mark.parametrize("command", COMMANDS)
def test_a_hanging_fmu_can_be_interrupted(folder, command):
    process = start(folder, command, HANG)
    time.sleep(3.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert process.returncode == 130 and "interrupted" in errors and "Traceback" not in errors
