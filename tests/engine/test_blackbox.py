"""What is left of a run when an FMU ends the process."""

import errno
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from navfmu.engine import compiled
from navfmu.engine.blackbox import BlackBox
from navfmu.engine.compiled import Compiled
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.export import toolchain
from tests.engine.probe import probe, ring
from tests.engine.wrecked_run import CALLS, plan

ENDS = {"segfault": -signal.SIGSEGV, "abort": -signal.SIGABRT, "exit": 0, "hang": -signal.SIGKILL}
# where it is found, and how many rows there are by then (of every second communication point)
FOUND = {
    "instantiate": ("fmi2Instantiate at t = 0 s", 0),
    "enterInitializationMode": ("fmi2EnterInitializationMode at t = 0 s", 0),
    "exitInitializationMode": ("fmi2ExitInitializationMode at t = 0 s", 0),
    "getReal": ("fmi2GetReal at t = 0 s", 0),
    "doStep": ("fmi2DoStep at t = 0.4 s", 3),
    "terminate": ("fmi2Terminate at t = 1 s", 6),
}


def start(path: Path, way: str, call: str) -> subprocess.Popen:
    """The run in a process of its own."""
    command = [sys.executable, "-m", "tests.engine.wrecked_run", str(path), way, call]
    no_core = lambda: resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # noqa: E731
    return subprocess.Popen(command, stderr=subprocess.DEVNULL, preexec_fn=no_core)


def wait_for(condition) -> None:
    end = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.parametrize("call", ["instantiate", *CALLS])
@pytest.mark.parametrize("way", ENDS)
def test_the_place_and_the_rows_survive_the_process(tmp_path, way, call):
    flight, path = plan(way, call), tmp_path / "box"
    BlackBox.create(path, flight).close()
    child = start(path, way, call)
    where, rows = FOUND[call]
    if way == "hang":
        with BlackBox.open(path, flight) as box:
            hangs = f"component 'bad' in {where}"
            wait_for(lambda: box.whereabouts() == hangs and (box.said() or call == "instantiate"))
            assert box.place.rows == rows  # seen from outside while it hangs
        child.kill()
    assert child.wait(30) == ENDS[way]
    with BlackBox.open(path, flight) as box:
        assert box.whereabouts() == f"component 'bad' in {where}"
        assert box.said().startswith("" if call == "instantiate" else "probe gave up at ")
        recorded = box.recording()
    assert (recorded is not None) == (rows > 0)
    if recorded is not None:
        assert np.array_equal(recorded.time, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0][:rows])
        np.testing.assert_allclose(recorded["good.y"], 0.9 ** (2 * np.arange(rows)))


def test_a_binary_that_ends_the_process_while_it_is_loaded_is_named(tmp_path):
    source, path = tmp_path / "bomb.c", tmp_path / "box"
    source.write_text("#include <stdlib.h>\n__attribute__((constructor)) static void go(void) { _Exit(0); }\n")
    bomb = probe("bomb", binary=toolchain.compile_shared([source], tmp_path / "bomb.so"))
    flight = make_plan([probe("good"), bomb], [], step=0.1, stop=1.0, record=["good.y"])
    child = os.fork()
    if child == 0:
        compiled.run(flight, memory=BlackBox.create(path, flight))
        os._exit(1)
    assert os.waitpid(child, 0)[1] == 0
    with BlackBox.open(path, flight) as box:
        assert box.whereabouts() == "component 'bomb' in the loading of its binary at t = 0 s"
        assert (box.said(), box.recording()) == ("", None)


def test_a_run_that_ends_well_leaves_nobody_to_blame_and_the_same_rows(tmp_path):
    flight, path = make_plan(*ring(), step=0.1, stop=5.0, record_period=0.2), tmp_path / "box"
    with BlackBox.create(path, flight) as box:
        done = compiled.run(flight, memory=box)
    with BlackBox.open(path, flight) as box:
        assert box.whereabouts() == "in no component, at t = 5 s"
        kept = box.recording()
    assert kept.names == done.names
    assert kept.values.tobytes() == done.values.tobytes() == compiled.run(flight).values.tobytes()
    assert kept.time.tobytes() == done.time.tobytes()


def test_between_calls_nobody_is_blamed_and_going_back_takes_rows_back(tmp_path):
    flight = make_plan(*ring(), step=0.1, stop=1.0)
    with BlackBox.create(tmp_path / "box", flight) as box, Compiled(flight, box) as engine:
        assert (box.place.component, box.place.rows, box.recording()) == (-1, 0, None)
        engine.initialise()
        assert (box.place.component, box.place.k, box.place.rows) == (-1, 0, 1)
        engine.advance(4)
        snapshot = engine.snapshot()
        engine.advance(9)
        assert (box.place.component, box.place.k, box.place.rows) == (-1, 9, 10)
        engine.restore(snapshot)
        assert (box.place.component, box.place.k, box.place.rows) == (-1, 4, 5)


def test_a_file_that_is_not_the_black_box_of_this_run_is_refused(tmp_path):
    flight, path = make_plan(*ring(), step=0.1, stop=1.0), tmp_path / "box"
    with pytest.raises(NavfmuError, match="box: cannot be read: No such file"):
        BlackBox.open(path, flight)
    BlackBox.create(path, flight).close()
    content = path.read_bytes()
    for other in (make_plan(*ring(5), step=0.1, stop=1.0), make_plan(*ring(), step=0.1, stop=2.0)):
        with pytest.raises(NavfmuError, match="is the black box of another run"):
            BlackBox.open(path, other)
    for damaged, why in ((content[:-8], "its length is wrong"), (b"", "is not the"), (b"x" * 900, "is not the")):
        path.write_bytes(damaged)
        with pytest.raises(NavfmuError, match=why):
            BlackBox.open(path, flight)


def test_a_file_that_cannot_be_made_is_refused_and_not_left_behind(tmp_path):
    with pytest.raises(NavfmuError, match="cannot be written: No such file"):
        BlackBox.create(tmp_path / "nowhere" / "box", make_plan(*ring(), step=0.1, stop=1.0))
    too_large = r"(No space|too large|Cannot allocate).*; .* MB there: record fewer|GB of memory; record fewer"
    with pytest.raises(NavfmuError, match=too_large):
        BlackBox.create(tmp_path / "box", make_plan(*ring(3), step=0.5, stop=1e15, record=["lag*.y"]))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EFBIG])
def test_a_full_disk_is_told_as_one(number, tmp_path, monkeypatch):
    """A small recording once "would take 0 GB of memory"."""

    def full(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("os.posix_fallocate", full)
    with pytest.raises(NavfmuError) as refused:
        BlackBox.create(tmp_path / "box", make_plan(*ring(3), step=0.5, stop=10.0, record=["lag*.y"]))
    said = f"{tmp_path}/box: cannot be written: {os.strerror(number)}; the recording of a run takes 0.0"
    assert str(refused.value).startswith(said) and "GB" not in str(refused.value)
    assert list(tmp_path.iterdir()) == []
