"""FMUs that look at what a master says with each step, or want to end the run, or allow one instance only."""

from __future__ import annotations

import threading
import warnings

import numpy as np
import pandas
import pytest

from navfmu import System
from navfmu.engine import compiled, reference
from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.engine.reference import Reference
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from navfmu.sweep.compare import difference
from navfmu.sweep.recommendation import recommendation
from navfmu.sweep.sweep import sweep
from tests.engine.probe import probe

from .stepper import stepper, write

KINDS = pytest.mark.parametrize("kind", [Compiled, Reference])
ENGINES = pytest.mark.parametrize("engine", [compiled, reference])
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def file(tmp_path):
    return write(tmp_path / "stepper.fmu", canGetAndSetFMUstate="true")


# -- when are start values set? ----------------------------------------------------------------------------------------


@KINDS
def test_start_values_are_set_where_no_fmu_forgets_them(kind, file):
    """FMUs made with 20-sim forget in fmi2SetupExperiment what was set before it."""
    start = {"u": 1.0, "gain": 3.0, "bias": 0.5, "number": 4, "flag": True}
    record = ["s.x", "s.direct", "s.fixed", "s.double", "s.not"]
    with kind(make_plan([stepper("s", file, **start)], [], step=0.125, stop=1.0, record=record)) as engine:
        whole = engine.run()
    assert [whole[name][-1] for name in record] == [1.0, 3.5, 0.5, 8.0, 0.0]


# -- may a state before the step be set again? -------------------------------------------------------------------------


@KINDS
def test_a_step_may_be_repeated_only_while_a_snapshot_is_held(kind, file):
    """The FMU starts each step over from the last state that was certain."""
    plan = make_plan([stepper("s", file, u=1.0)], [], step=0.125, stop=1.0, record=["s.x"])
    with kind(plan) as engine:
        engine.initialise()
        engine.advance(4)
        snapshot = engine.snapshot()
        engine.advance(6)
        engine.restore(snapshot)
        engine.free(snapshot)
        engine.advance()
        np.testing.assert_array_equal(engine.recording()["s.x"], np.arange(9) * 0.125)


@KINDS
def test_while_a_snapshot_is_held_fmus_are_told(kind, file):
    plan = make_plan([stepper("s", file, u=1.0)], [], step=0.125, stop=1.0, record=["s.x"])
    with kind(plan) as engine:
        engine.initialise()
        first, second = engine.snapshot(), engine.snapshot()
        engine.free(first)
        engine.advance(2)
        assert engine.recording()["s.x"].tolist() == [0.0, 0.125, 0.125]  # it starts over: it was told that it may
        engine.free(second)
        engine.advance(3)
        assert engine.recording()["s.x"].tolist() == [0.0, 0.125, 0.125, 0.25]


# -- the end that an FMU wants -----------------------------------------------------------------------------------------


@ENGINES
@ALGORITHMS
@pytest.mark.parametrize(("ends_at", "rows"), [(0.5, 5), (0.45, 4), (0.375, 4)])
def test_an_fmu_that_wants_no_more_ends_the_run_with_a_note(engine, algorithm, file, ends_at, rows):
    system = [probe("before", start=1.0), stepper("s", file, u=1.0, ends_at=ends_at), probe("after")]
    links = [Link("before.y", "s.u"), Link("s.x", "after.u")]
    plan = make_plan(system, links, step=0.125, stop=2.0, algorithm=algorithm, record=["before.y", "s.x", "after.y"])
    done = []
    recording = engine.run(plan, lambda made, all_: done.append((made, all_)))
    assert recording.time.tolist() == [0.125 * row for row in range(rows)]
    assert np.isfinite(recording.values).all()
    assert recording["s.x"][-1] > 0.25
    assert recording.notes == (f"component 's' ended the run at t = {ends_at:g} s, before the stop time 2 s",)
    assert done[-1] == (16, 16)


@ENGINES
def test_an_end_at_the_stop_time_is_none_before_it(engine, file):
    recording = engine.run(make_plan([stepper("s", file, ends_at=1.0)], [], step=0.125, stop=1.0))
    assert len(recording.time) == 9 and recording.notes == ()


@KINDS
def test_a_run_that_was_ended_goes_on_from_a_snapshot_before_its_end(kind, file):
    plan = make_plan([stepper("s", file, u=1.0, ends_at=0.5)], [], step=0.125, stop=2.0, record=["s.x"])
    with kind(plan) as engine:
        engine.initialise()
        engine.advance(2)
        snapshot = engine.snapshot()
        for _ in range(2):
            engine.advance()
            assert engine.k == 4 and len(engine.recording().time) == 5
            engine.advance()
            assert engine.k == 4
            engine.restore(snapshot)
            assert engine.recording().notes == ()
        engine.free(snapshot)


@ENGINES
def test_another_discarded_step_is_an_error_that_tells_how_far_it_got(engine, file):
    plan = make_plan([stepper("s", file, ends_at=0.45, stubborn=True)], [], step=0.125, stop=2.0)
    with pytest.raises(RunError) as raised:
        engine.run(plan)
    assert str(raised.value) == (
        "component 's': it gave no reason (fmi2DoStep returned Discard at t = 0.375 s); it got as far as t = 0.45 s"
    )
    assert len(raised.value.recording.time) == 4


def test_a_sweep_compares_up_to_the_first_end(file):
    system = System.load(file)
    result = sweep(
        system.experiment(stop=2.0, step=0.125, parameters={"stepper.u": 1.0, "stepper.ends_at": 0.9}), [0.125, 0.25]
    )
    assert any("ended the run at t = 0.9 s" in note for note in result.notes)
    assert {row.rms for row in result.rows} == {0.0}


@pytest.mark.parametrize("longest", [0.3, 0.05])
def test_a_step_at_which_the_fmu_ends_the_run_at_once_is_not_recommended(file, longest):
    """All runs were cut to the shortest, and one point without an error recommended every step."""
    parameters = {"stepper.u": 1.0, "stepper.longest": longest}
    result = sweep(System.load(file).experiment(stop=2.0, step=0.1, parameters=parameters), [0.1, 0.2, 0.4])
    text = recommendation(result)
    if longest < 0.1:
        assert "Use" not in text and "x is recorded at t = 0 s only (gauss_seidel, 0.1 s, 0.2 s, 0.4 s)" in text
        return
    assert {row.step for row in result.problems} == {0.4}
    assert "Use gauss_seidel with steps up to 0.2 s" in text
    assert "At 0.4 s: stepper.x is recorded up to 0 s, and up to 2 s at the smallest step" in text


def test_a_sweep_tells_of_a_fault_that_changed_nothing(file):
    late = Fault("late", "stepper.x", "bias", 1.0, parameters={"value": 1.0})
    experiment = System.load(file).experiment(stop=2.0, step=0.125, parameters={"stepper.ends_at": 0.9}, faults=[late])
    result = sweep(experiment, [0.125, 0.25])
    assert "fault 'late' starts at 1 s, but the run ended at 0.875 s" in result.notes


def test_a_run_that_should_have_ended_is_not_like_one_that_has():
    short, long = (pandas.DataFrame({"a.y": [1.0] * count}, index=np.arange(count) * 0.5) for count in (3, 5))
    short.attrs["units"] = long.attrs["units"] = {}
    assert difference(long, short, "a.y")[2] == "is recorded up to 2 s, and up to 1 s at the smallest step"


# -- one instance in a process -----------------------------------------------------------------------------------------


@pytest.fixture
def lonely(tmp_path):
    return write(tmp_path / "lonely.fmu", canBeInstantiatedOnlyOncePerProcess="true")


@KINDS
def test_a_second_run_in_the_process_does_not_get_the_only_instance(kind, lonely):
    plan = make_plan([probe("other"), stepper("s", lonely, u=1.0)], [], step=0.125, stop=1.0)
    with (
        kind(plan),
        pytest.raises(NavfmuError, match="component 's': the FMU 'stepper' allows one instance in a process"),
    ):
        compiled.run(plan)
    with kind(plan) as engine:  # it was given back
        engine.run()
    assert len(compiled.run(plan).time) == 9


@KINDS
def test_an_instance_that_was_never_made_is_given_back(kind):
    stranger, own = probe("p", single=True, guid="{other}"), probe("p", single=True)
    with pytest.raises(RunError, match="could not be instantiated"):
        kind(make_plan([stranger], [], step=0.125, stop=1.0))
    with kind(make_plan([own], [], step=0.125, stop=1.0)) as engine:
        engine.run()


def test_a_sweep_runs_such_an_fmu_one_after_the_other(lonely, monkeypatch):
    threads = set()
    monkeypatch.setattr(compiled.Compiled, "initialise", remembering(compiled.Compiled.initialise, threads))
    sweep(System.load(lonely).experiment(stop=2.0, step=0.125), [0.125, 0.25, 0.5], jobs=4)
    assert len(threads) == 1


def remembering(method, threads):
    def called(self):
        threads.add(threading.get_ident())
        return method(self)

    return called


def test_such_an_fmu_runs_twice_one_after_the_other(lonely):
    system = System.load(lonely)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        first, second = (system.run(stop=1.0, step=0.125) for _ in range(2))
    assert first.equals(second)
