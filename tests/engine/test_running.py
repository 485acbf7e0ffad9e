"""Progress, interruption and threads."""

import re
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from navfmu.engine import compiled, library, reference
from navfmu.engine.compiled import Compiled
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.export import toolchain
from tests.engine.probe import chain, ring

ROOT = Path(__file__).parents[2]


def test_progress_is_told_while_running_and_ends_at_the_last_step():
    seen = []
    compiled.run(make_plan(*ring(), step=0.001, stop=100.0, record=[]), lambda done, all_: seen.append((done, all_)))
    assert len(seen) > 3
    assert seen == sorted(seen)
    assert seen[-1] == (100_000, 100_000)


def test_ctrl_c_gets_its_turn():
    def press(done, all_):
        if done > 1000:
            raise KeyboardInterrupt

    plan = make_plan(*ring(), step=0.001, stop=100_000.0, record=[])
    with Compiled(plan) as engine, pytest.raises(KeyboardInterrupt):
        engine.run(press)
    assert engine.k < plan.clock.steps


def test_another_thread_can_watch_and_stop_a_run():
    plan = make_plan(*ring(), step=0.001, stop=1_000_000.0, record=["lag0.y"], record_period=1000.0)
    with Compiled(plan) as engine:
        engine.initialise()
        runner = threading.Thread(target=engine.advance)
        runner.start()
        while engine.k == 0:
            time.sleep(0.001)
        assert runner.is_alive()  # the loop holds no lock
        engine.interrupt()
        runner.join(timeout=10)
        assert not runner.is_alive()
        assert 0 < engine.k < plan.clock.steps
        assert len(engine.recording().time) == engine.k // 1_000_000 + 1


def test_engines_in_threads_do_what_one_does():
    plan = make_plan(*chain(5, start=1.0, interpolates=True), step=0.001, stop=20.0)
    alone = compiled.run(plan).values.tobytes()
    with ThreadPoolExecutor(4) as pool:
        assert all(r.values.tobytes() == alone for r in pool.map(compiled.run, [plan] * 8))


def test_many_engines_are_made_and_freed():
    plan = make_plan(*ring(), step=0.1, stop=0.2)
    with Compiled(plan):  # another one that stays
        assert {compiled.run(plan).values.tobytes() for _ in range(200)} == {compiled.run(plan).values.tobytes()}


def test_an_engine_that_was_dropped_is_no_reason_for_the_end_of_a_process():
    """A process that ended well long after a run got exit code 2, and an FMU from memory given back was blamed."""
    code = """
import ctypes
from navfmu.engine.compiled import Compiled
from navfmu.engine.plan import make_plan
from tests.engine.probe import chain

engine = Compiled(make_plan(*chain(2), step=0.1, stop=1.0))
engine.initialise()
engine.advance()
del engine
others = [bytes([7]) * size for size in range(16, 200) for _ in range(200)]
ctypes.CDLL(None).exit(0)
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("stop", [1e12, 1e15])
@pytest.mark.parametrize("engine", [compiled, reference])
def test_a_recording_that_no_memory_can_hold_is_refused(engine, stop):
    with pytest.raises(NavfmuError, match=r"3 signals at .* points in time would take \d+ GB of memory; record fewer"):
        engine.run(make_plan(*ring(3), step=0.5, stop=stop, record=["lag*.y"]))


def test_the_binary_is_named_after_its_sources(monkeypatch):
    path = library.binary()
    assert library.source_hash() in path.name
    assert path.parent.name == library.host() == toolchain.host()
    assert library.build(library.host()) == path
    monkeypatch.setattr(library, "source_hash", lambda: "0" * 12)
    monkeypatch.setattr(toolchain, "compile_shared", refuse)
    with pytest.raises(NavfmuError, match=r"the engine has no binary for .* and cannot be built: no compiler"):
        library.build(library.host())


def test_the_sources_are_all_files_that_the_compiler_reads():
    known = {path.name for path in library.sources()}
    for unit in library.sources():
        included = re.findall(r'^\s*#include "(.+)"', unit.read_text(), re.MULTILINE)
        assert set(included) <= known, f"{unit.name} includes what is not hashed"
    assert known >= {path.name for path in library.SOURCE.iterdir()}


def test_another_compiler_with_the_same_sources_is_another_binary(monkeypatch, tmp_path):
    hashes = []
    for flags in ("-O2", "-O0"):  # as another version would: other code of the same sources
        other = toolchain.compile_shared(
            library.UNITS, tmp_path / "engine.so", include=(library.SOURCE, library.RUNTIME), flags=(flags,)
        )
        monkeypatch.setattr(library, "binary", lambda other=other: other)
        library.binary_hash.cache_clear()
        hashes.append(library.binary_hash())
    library.binary_hash.cache_clear()
    assert hashes[0] != hashes[1]


def refuse(*_args, **_options):
    raise NavfmuError("no compiler")


def test_running_needs_neither_exporter_nor_compiler():
    code = "import sys, navfmu.engine.compiled; print([m for m in sys.modules if m.startswith('navfmu.export')])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
