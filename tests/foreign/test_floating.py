"""FMUs that change how their thread calculates: nobody else's bits depend on it, and it is said."""

from __future__ import annotations

import ctypes
import struct
import sys
from pathlib import Path

import pytest

from navfmu.engine import compiled, floating, reference
from navfmu.engine.compiled import Compiled
from navfmu.engine.component import Component
from navfmu.engine.library import RUNTIME
from navfmu.engine.loading import engine_library
from navfmu.engine.plan import make_plan
from navfmu.export import toolchain
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.fmu import Fmu
from tests.engine.probe import compile_fmu

SOURCE = Path(__file__).with_name("stray.c")
ENGINES = pytest.mark.parametrize("engine", [compiled, reference])
CALLS = ("instantiate", "enter", "exit", "get", "step", "terminate", "free")
OUTPUTS = ("sum", "tiny", "nothing")
SAID = {
    "rounding": "how numbers are rounded",
    "subnormals": "what becomes of subnormal numbers",
    "traps": "which calculations end the process",
}
WHAT = [*SAID] if toolchain.host().startswith("x86_64") else ["rounding", "subnormals"]


def stray(name: str, binary: Path | None = None) -> Component:
    """An instance that does what its name says."""
    binary = binary or compile_fmu(SOURCE)
    variables = tuple(
        Variable(output, number, "Real", "output", "continuous", "calculated") for number, output in enumerate(OUTPUTS)
    )
    description = Description("stray", "{stray}", "stray", variables=variables)
    return Component(name, Fmu(binary, "", binary.parent, binary, description), {})


def plan(*names: str, step: float = 0.125, **options):
    return make_plan([stray(name, **options) for name in names], [], step=step, stop=4.0, record=["*.*"])


def bits(recording, name="clean"):
    return [recording[f"{name}.{output}"].tobytes() for output in OUTPUTS]


def notes(recording):
    return [note for note in recording.notes if "not finite" not in note]


@pytest.fixture(scope="module")
def ordinary():
    recording = compiled.run(plan("clean"))
    assert recording["clean.tiny"][-1] == 1e-310
    assert struct.pack("d", recording["clean.sum"][-1]) == struct.pack("d", sum([0.1] * 32))
    return bits(recording)


@ENGINES
@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("what", WHAT)
def test_a_run_has_the_same_bits_after_and_beside_an_fmu_that_changes_them(engine, call, what, ordinary):
    beside = engine.run(plan(f"{call}_{what}", "clean"))
    assert bits(beside) == bits(beside, f"{call}_{what}") == ordinary
    after = engine.run(plan("clean"))
    assert bits(after) == ordinary
    assert notes(after) == []
    assert notes(beside) == [f"component '{call}_{what}' changed {SAID[what]}: put back after each of its calls"]


@ENGINES
@pytest.mark.parametrize("call", ["step", "status"])
@pytest.mark.parametrize("what", WHAT)
def test_how_far_a_discarded_step_got_is_calculated_in_the_ordinary_way(engine, call, what):
    """Of an FMU that traps what is not exact it was said that it crashed: the engine had, on 0.8 s."""
    recording = engine.run(plan(f"{call}_{what}_ends", "clean", step=0.1))
    assert recording.time[-1] == 0.8
    assert notes(recording)[-1].endswith(f"changed {SAID[what]}: put back after each of its calls")


@ENGINES
def test_what_a_library_changes_while_it_is_loaded_is_put_back_without_a_note(engine, ordinary, tmp_path):
    """It is loaded once in a process: a note would depend on what has run before."""
    name = f"loading-{engine.__name__.rpartition('.')[2]}.so"
    binary = toolchain.compile_shared([SOURCE], tmp_path / name, include=[RUNTIME], flags=["-DSTRAY_LOAD"])
    for _ in range(2):
        recording = engine.run(plan("clean", binary=binary))
        assert (bits(recording), notes(recording)) == (ordinary, [])
    assert floating.make_ordinary() == 0


@ENGINES
def test_what_the_caller_has_set_does_not_matter_and_stays(engine, ordinary):
    library = engine_library()
    with floating.ordinary():
        library.put_back(library.floating_now() ^ changed())
        try:
            recording = engine.run(plan("clean", "step_rounding"))
            recording_again = engine.run(plan("clean"))
            assert floating.make_ordinary() == 1 | 2
        finally:
            floating.make_ordinary()
    assert bits(recording) == bits(recording_again) == ordinary
    assert floating.make_ordinary() == 0


def changed() -> int:
    """Bits of the way of calculating: rounding upward, and no subnormal numbers."""
    return 0xC040 if toolchain.host().startswith("x86_64") else 0x01400000


def test_between_the_pieces_of_a_run_the_caller_calculates_in_the_ordinary_way(ordinary):
    with Compiled(plan("clean", "get_rounding")) as engine:
        engine.initialise()
        for point in range(1, 33):
            engine.advance(point)
            assert floating.make_ordinary() == 0
        assert bits(engine.recording()) == ordinary


@pytest.mark.skipif(sys.platform == "win32", reason="there long double is double")
def test_long_double_is_rounded_in_the_ordinary_way():
    if not toolchain.host().startswith("x86_64"):
        pytest.skip("long double obeys the same register as double")
    libc = ctypes.CDLL(None)
    assert libc.fegetround() == 0
    compiled.run(plan("step_rounding"))
    assert libc.fegetround() == 0
