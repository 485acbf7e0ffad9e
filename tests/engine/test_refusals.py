"""An FMU that refuses a call ends its run with its own words; what was recorded before is kept."""

import ctypes
import re

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from navfmu.engine import compiled, reference
from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.engine.reference import Reference
from navfmu.errors import NavfmuError
from tests.engine.probe import library, probe

ENGINES = pytest.mark.parametrize("engine", [compiled, reference])
STEP, EXIT, GET, SET, WARN, ENTER, TERMINATE = range(7)
DISCARD, ERROR, FATAL, PENDING = 2, 3, 4, 5


def plan(call, status, fail_at=0.5, **options):
    bad = probe("bad", fail_call=call, fail_status=status, fail_at=fail_at, label="sensor 100% out", **options)
    system = [probe("good", start=1.0), bad], [Link("good.y", "bad.u")]
    return make_plan(*system, step=0.1, stop=1.0, record=["good.y", "bad.y"])


@ENGINES
@pytest.mark.parametrize(("status", "name"), [(DISCARD, "Discard"), (ERROR, "Error"), (FATAL, "Fatal")])
def test_a_refused_step_ends_the_run_with_the_message_of_the_fmu(engine, status, name):
    with pytest.raises(RunError) as raised:
        engine.run(plan(STEP, status, fail_at=0.45))
    assert str(raised.value) == (
        f"component 'bad': sensor 100% out gave up at 0.5 s after 42 (fmi2DoStep returned {name} at t = 0.4 s)"
    )
    recorded = raised.value.recording
    assert np.array_equal(recorded.time, [0.0, 0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(recorded["good.y"], 0.9 ** np.arange(5))


@ENGINES
@pytest.mark.parametrize("call", [ENTER, EXIT, STEP, TERMINATE])
def test_a_status_that_fmi_does_not_have_is_none_after_which_a_run_goes_on(engine, call):
    """A negative one is less than that of a warning."""
    with pytest.raises(RunError, match=r"gave up at .* returned status -1 at t = "):
        engine.run(plan(call, -1, fail_at=0.0))


@ENGINES
def test_an_asynchronous_step_is_refused(engine):
    with pytest.raises(RunError, match=r"asynchronous steps are not supported \(fmi2DoStep returned Pending"):
        engine.run(plan(STEP, PENDING))


@ENGINES
@pytest.mark.parametrize(("call", "name"), [(GET, "fmi2GetReal"), (SET, "fmi2SetReal")])
def test_every_call_is_checked(engine, call, name):
    with pytest.raises(RunError, match=re.escape(f"({name} returned Error at t = 0.")):
        engine.run(plan(call, ERROR))


@ENGINES
def test_a_refusal_during_initialisation(engine):
    with pytest.raises(RunError, match=r"42 \(fmi2ExitInitializationMode returned Error at t = 0 s\)") as raised:
        engine.run(plan(EXIT, ERROR, fail_at=0.0))
    assert raised.value.recording is None


@ENGINES
def test_an_fmu_that_cannot_be_instantiated(engine):
    stranger = probe("stranger", guid="{other}")
    with pytest.raises(RunError, match=r"component 'stranger' could not be instantiated: guid {other} is not mine"):
        engine.run(make_plan([stranger], [], step=0.1, stop=1.0))


def test_a_binary_that_is_none_is_named(tmp_path):
    text = tmp_path / "probe.so"
    text.write_text("not a library")
    broken = probe("broken", binary=text)
    with pytest.raises(NavfmuError, match=r"component 'broken': the binary .*probe.so cannot be loaded"):
        compiled.run(make_plan([broken], [], step=0.1, stop=1.0))


@ENGINES
def test_components_are_terminated_unless_they_returned_an_error_or_never_left_initialisation(engine, monkeypatch):
    ended = []
    if engine is compiled:
        monkeypatch.setattr(
            compiled.fmi2(probe("a").fmu.library), "terminate", lambda instance: ended.append(instance) or 0
        )
    else:
        monkeypatch.setattr(FMU2Slave, "terminate", lambda slave: ended.append(slave))
    engine.run(make_plan([probe("a"), probe("b")], [], step=0.1, stop=1.0))
    assert len(ended) == len(set(ended)) == 2
    for call, left in ((STEP, 1), (EXIT, 0)):
        ended.clear()
        with pytest.raises(RunError, match="component 'bad'"):
            engine.run(plan(call, ERROR, fail_at=0.0))
        assert len(ended) == left


def test_warnings_go_on_and_are_told():
    recording = compiled.run(plan(WARN, 1))
    assert len(recording.time) == 11
    (warning,) = recording.notes
    assert warning == "component 'bad' warned 6 times, at last: sensor 100% out gave up at 1 s after 42"


def test_a_run_that_failed_leaves_the_others_alone():
    with pytest.raises(RunError):
        compiled.run(plan(STEP, ERROR))
    assert compiled.run(plan(STEP, 0)).time[-1] == 1.0


def calls_after_fatal() -> int:
    """How many functions of the probe were called after one of its instances had returned Fatal."""
    return ctypes.CDLL(str(library())).calls_after_fatal()


@ENGINES
@pytest.mark.parametrize("call", [STEP, EXIT, GET, ENTER, TERMINATE])
def test_after_a_fatal_error_no_instance_of_that_fmu_is_called(engine, call):
    """FMI 2.0, 2.1.3: the model computations are irreparably corrupted for all instances."""
    bad = probe("bad", fail_call=call, fail_status=FATAL, fail_at=0.0)
    with pytest.raises(RunError, match=r"component 'bad': .* returned Fatal"):
        engine.run(make_plan([bad, probe("good"), probe("other")], [], step=0.1, stop=1.0))
    assert calls_after_fatal() == 0
    assert engine.run(make_plan([probe("new")], [], step=0.1, stop=1.0)).time[-1] == 1.0, "a new beginning"


@ENGINES
def test_a_fatal_answer_to_the_question_whether_a_run_has_ended_counts(engine):
    bad = probe("asked", fail_call=STEP, fail_status=DISCARD, fail_at=0.0)
    with pytest.raises(RunError, match=r"\(fmi2GetBooleanStatus returned Fatal at t = 0 s\)"):
        engine.run(make_plan([bad, probe("good")], [], step=0.1, stop=1.0))
    assert calls_after_fatal() == 0


@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_a_fatal_error_in_another_run_of_the_process_ends_this_one(kind):
    bad = probe("bad", fail_call=STEP, fail_status=FATAL, fail_at=0.0)
    with kind(make_plan([probe("good")], [], step=0.1, stop=1.0)) as engine:
        engine.initialise()
        engine.advance(3)
        snapshot = engine.snapshot()
        with pytest.raises(RunError, match="component 'bad'"):
            kind(make_plan([bad], [], step=0.1, stop=1.0)).run()
        sentence = "component 'good': its FMU 'probe' returned Fatal in another run of this process, after which none"
        for go_on in (engine.advance, engine.snapshot, lambda: engine.restore(snapshot)):
            with pytest.raises(RunError, match=sentence) as raised:
                go_on()
            assert len(raised.value.recording.time) == 4
        engine.free(snapshot)
    assert calls_after_fatal() == 0
