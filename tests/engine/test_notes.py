"""What a recording says beside its numbers: warnings of FMUs, lost samples, values that are no numbers."""

import dataclasses

import numpy as np
import pytest

from navfmu.engine import compiled, reference
from navfmu.engine.compiled import Compiled
from navfmu.engine.component import Component
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.engine.reference import Reference
from navfmu.faults import Fault
from tests.engine.probe import probe

ENGINES = pytest.mark.parametrize("engine", [compiled, reference])
STEP, EXIT, GET, SET, WARN, ENTER, TERMINATE, FREE = range(8)
COMPLAIN = 19  # an error is logged, the call is well


def counting(name: str, **options) -> Component:
    """A probe whose counter of steps, "data.sequence", is called "data.lost"."""
    component = probe(name, **options)
    about = component.description
    variables = tuple(
        dataclasses.replace(v, name="data.lost") if v.name == "data.sequence" else v for v in about.variables
    )
    fmu = dataclasses.replace(component.fmu, description=dataclasses.replace(about, variables=variables))
    return dataclasses.replace(component, fmu=fmu)


def plan(*components, stop=1.0, **options):
    return make_plan(components, [], step=0.1, stop=stop, **({"record": ["*.y"]} | options))


@ENGINES
def test_lost_samples_are_read_at_the_end_without_being_recorded(engine):
    recording = engine.run(plan(counting("a"), probe("b"), counting("c")))
    assert recording.lost == {"a.data.lost": 10, "c.data.lost": 10}
    assert recording.names == ("a.y", "b.y", "c.y")
    why = "were lost (more than one came in a communication step, or in a tick of what sends them)"
    assert recording.notes == (f"10 samples of 'a.data' {why}", f"10 samples of 'c.data' {why}")


@ENGINES
def test_one_lost_sample_is_one_and_a_fault_may_have_held_it_back(engine):
    late = Fault("late", "a.y", "bias", 0.0, 1.0, {"value": 1.0})
    (note,) = engine.run(plan(counting("a"), stop=0.1, faults=[late])).notes
    assert note.startswith("1 sample of 'a.data' was lost (") and note.endswith(", or a fault held them back)")


@ENGINES
def test_no_sample_lost_is_no_note(engine):
    recording = engine.run(plan(probe("b")))
    assert (recording.lost, recording.notes) == ({}, ())


@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_counters_of_an_engine_that_is_closed_are_those_read_last(kind):
    with kind(plan(counting("a"))) as engine:
        engine.initialise()
        engine.advance(3)
        assert engine.recording().lost == {"a.data.lost": 3}
        engine.advance()
        assert engine.recording().lost == {"a.data.lost": 10}
    assert engine.recording().lost == {"a.data.lost": 10}


@ENGINES
def test_nobody_is_asked_after_a_refusal(engine):
    with pytest.raises(RunError, match="gave up") as raised:
        engine.run(plan(counting("a"), probe("b", fail_call=STEP, fail_status=4, fail_at=0.55)))
    assert raised.value.recording.lost == {}
    assert len(raised.value.recording.time) == 6


@ENGINES
def test_a_counter_that_cannot_be_read_does_not_spoil_the_run(engine):
    """Nothing of it is recorded: the only call of a getter is the one for the counter."""
    bad = counting("bad", fail_call=GET, fail_status=3, fail_at=0.95)
    recording = engine.run(plan(bad, probe("b"), record=["b.y"]))
    assert (recording.lost, len(recording.time)) == ({}, 11)
    assert recording.notes == ("component 'bad' reported an error, and the run went on: probe gave up at 1 s after 42",)


@ENGINES
@pytest.mark.parametrize(
    ("fail_at", "note"),
    [
        (0.55, "component 'a' warned 5 times, at last: probe gave up at 1 s after 42"),
        (0.95, "component 'a' warned once: probe gave up at 1 s after 42"),
    ],
)
def test_warnings_are_told_alike_by_both_engines(engine, fail_at, note):
    assert engine.run(plan(probe("a", fail_call=WARN, fail_status=1, fail_at=fail_at))).notes == (note,)


@ENGINES
def test_warnings_without_a_message_count(engine):
    silent = probe("a", fail_call=WARN, fail_status=1, fail_at=0.75, label="")
    assert engine.run(plan(silent)).notes == ("component 'a' warned 3 times, at last: it gave no reason",)


@ENGINES
@pytest.mark.parametrize("call", [ENTER, EXIT, TERMINATE, FREE])
def test_warnings_outside_the_steps_are_told(engine, call):
    said = {ENTER: "0 s", EXIT: "0 s", TERMINATE: "1 s", FREE: "1 s"}[call]
    notes = engine.run(plan(probe("a", fail_call=call, fail_status=1, fail_at=0.0))).notes
    assert notes == (f"component 'a' warned once: probe gave up at {said} after 42",)


@ENGINES
@pytest.mark.parametrize(
    ("component", "times"),
    [
        (probe("early"), "once"),  # in fmi2SetupExperiment
        (probe("a", fail_call=ENTER, fail_status=1, fail_at=0.0, label=""), "once"),
        (probe("a", fail_call=TERMINATE, fail_status=1, fail_at=0.0, label=""), "once"),
        (counting("a", fail_call=GET, fail_status=1, fail_at=0.95, label=""), "2 times, at last"),
    ],
)
def test_statuses_of_warning_outside_the_steps_count_in_silence_too(component, times, engine):
    (note, *_) = engine.run(plan(component)).notes
    assert note == f"component '{component.name}' warned {times}: it gave no reason"


@ENGINES
def test_warnings_about_start_values_are_told(engine):
    """Those of the Integers, which make it warn, and of the Boolean that is set after them."""
    (note,) = engine.run(plan(probe("a", fail_call=SET, fail_status=1, fail_at=0.0, flag=True))).notes
    assert note == "component 'a' warned 2 times, at last: probe gave up at 0 s after 42"


@ENGINES
@pytest.mark.parametrize("call", [STEP, TERMINATE, FREE])
def test_an_error_that_is_logged_without_a_refusal_is_told(engine, call):
    recording = engine.run(plan(probe("a", fail_call=call, fail_status=COMPLAIN, fail_at=0.95), probe("b")))
    assert recording.notes == ("component 'a' reported an error, and the run went on: probe is unwell",)
    assert len(recording.time) == 11


@ENGINES
def test_an_error_that_ends_the_run_is_told_once(engine):
    with pytest.raises(RunError, match="gave up") as raised:
        engine.run(plan(probe("a", fail_call=TERMINATE, fail_status=3, fail_at=0.0), probe("b")))
    assert raised.value.recording.notes == ()
    assert len(raised.value.recording.time) == 11


@ENGINES
def test_values_that_are_no_numbers_are_told_with_place_and_time(engine):
    """tau = 0.01 at a step of 0.1 s grows by -9 each step; the gain is infinite in the end."""
    wild = probe("wild", tau=1e-3, start=1e300)
    recording = engine.run(plan(wild, probe("tame"), record=["*.y", "wild.seen"]))
    first = int(np.flatnonzero(~np.isfinite(recording["wild.y"]))[0])
    count = int((~np.isfinite(recording["wild.y"])).sum())
    assert 0 < first and count > 1
    assert recording.not_finite == {"wild.y": (count, pytest.approx(0.1 * first))}
    sentence = f"'wild.y' is not finite at {count} of 11 recorded points, first at t = {0.1 * first:.9g} s"
    assert recording.notes == (sentence,)


def test_a_partial_recording_is_looked_at_too():
    wild = probe("wild", tau=1e-3, start=1e300, fail_call=STEP, fail_status=3, fail_at=0.85)
    with pytest.raises(RunError) as raised:
        compiled.run(plan(wild))
    (note,) = raised.value.recording.notes
    assert "of 9 recorded points" in note
