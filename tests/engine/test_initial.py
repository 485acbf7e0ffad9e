"""Initial values go round in the order of the variables, whatever the order of the components in the system."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.faults import Fault
from navfmu.fmi.fmu import load
from tests.engine.probe import declared, known, probe, run_both, simulate
from tests.foreign.stepper import DEPENDENCIES, stepper, write

ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
H = {"step": 0.1, "stop": 1.0}


@pytest.fixture
def step(tmp_path, monkeypatch):
    """``step(name, dependencies, **start)``: a stepper, whose outputs follow its inputs in initialisation mode."""
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    files = itertools.count()

    def make(name, dependencies=DEPENDENCIES, **start):
        return stepper(name, write(tmp_path / f"{next(files)}.fmu", dependencies=dependencies), **start)

    return make


@ALGORITHMS
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("say", [lambda c: declared(c, y=(), current=("u",)), lambda c: known(c, "y")])
def test_a_system_without_an_algebraic_loop_starts_alike_in_any_order(algorithm, order, say):
    """``current`` is computed when a component leaves initialisation, ``y`` before."""
    components = [say(probe("a", start=1.0)), say(probe("b"))]
    links = [Link("a.y", "b.u"), Link("b.current", "a.u")]
    plan = make_plan([components[i] for i in order], links, algorithm=algorithm, record=["*.current"], **H)
    recording = run_both(plan)
    assert (recording["b.current"][0], recording["a.current"][0]) == (101.0, 201.0)
    assert not any("loop" in note for note in plan.notes)


@ALGORITHMS
@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_values_go_to_and_fro_between_components_in_initialisation_mode(step, algorithm, order):
    """a.fixed = 3 -> b: direct = 2 * 3 + 1 -> c: direct = 7 -> a: direct = 7 + 3 -> d, outside."""
    system = [step("a", bias=3.0), step("b", gain=2.0, bias=1.0), step("c", gain=1.0)]
    links = [Link("a.fixed", "b.u"), Link("b.direct", "c.u"), Link("c.direct", "a.u", factor=10.0, offset=0.5)]
    outside = step("d"), Link("a.direct", "d.u")
    plan = make_plan(
        [outside[0], *(system[i] for i in order)], [*links, outside[1]], algorithm=algorithm, record=["*.direct"], **H
    )
    recording = run_both(plan)
    assert [recording[f"{name}.direct"][0] for name in "abcd"] == [73.5, 7.0, 7.0, 73.5]
    assert not any("loop" in note for note in plan.notes)


@ALGORITHMS
def test_a_component_feeds_itself(step, algorithm):
    plan = make_plan([step("a", bias=3.0)], [Link("a.fixed", "a.u")], algorithm=algorithm, record=["a.direct"], **H)
    assert run_both(plan)["a.direct"][0] == 6.0
    assert not any("loop" in note for note in plan.notes)


@ALGORITHMS
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_whole_numbers_and_truth_values_go_round(step, algorithm, order):
    """Only the Integers and Booleans of a and b form a cycle of components; c feeds it, a fault drives it."""
    system = [step("a", number=3), step("b", flag=True), step("c", number=7, u=1.0)]
    links = [
        Link("a.double", "b.number"),
        Link("b.not", "a.flag"),
        Link("c.double", "a.u"),
        Link("a.direct", "b.u"),
    ]
    faults = [
        Fault("number", "a.number", "input", 0.0, 1.0, {"value": 5}),
        Fault("stuck", "b.not", "stuck", 0.0, 1.0, {"value": True}),
        Fault("bias", "a.direct", "bias", 0.0, 1.0, {"value": 0.5}),
    ]
    system = [system[i] for i in order]
    clean = simulate((system, links), algorithm=algorithm, record=["*"], **H)
    faulted = simulate((system, links), algorithm=algorithm, record=["*"], faults=faults, **H)
    record = ["b.double", "a.not", "b.direct"]
    assert [clean[name][0] for name in record] == [12.0, 1.0, 14.0]
    assert [faulted[name][0] for name in record] == [20.0, 0.0, 14.5]


@ALGORITHMS
def test_an_algebraic_loop_is_named_and_starts_from_the_start_values(step, algorithm):
    system = [step("a", bias=1.0), step("b", bias=2.0)]
    links = [Link("a.direct", "b.u"), Link("b.direct", "a.u")]
    plan = make_plan(system, links, algorithm=algorithm, record=["*.direct"], **H)
    loop = "algebraic loop: a.direct -> b.u -> b.direct -> a.u; the start value of 'a.direct' is used"
    assert [note for note in plan.notes if "loop" in note] == [loop]
    run_both(plan)


def test_where_an_fmu_does_not_say_the_loop_tells(step):
    silent = DEPENDENCIES | {"direct": None}
    system = [step("a"), step("b", silent)]
    plan = make_plan(system, [Link("a.direct", "b.u"), Link("b.direct", "a.u")], **H)
    (note, *_) = plan.notes
    assert note.startswith(
        "algebraic loop: a.direct -> b.u -> b.direct -> a.u (no dependencies are declared for b.direct)"
    )
    plan = make_plan([step("a"), step("b", silent)], [Link("a.fixed", "b.u"), Link("b.direct", "a.u")], **H)
    assert not any("loop" in note for note in plan.notes)


def test_many_loops_are_counted(step):
    system = [step(name) for name in "abcdef"]
    links = [Link(f"{a}.direct", f"{b}.u") for a, b in ("ab", "ba", "cd", "dc", "ef", "fe")]
    loops = [note for note in make_plan(system, links, **H).notes if "algebraic loop" in note]
    assert len(loops) == 3


def test_components_that_need_nothing_of_each_other_leave_one_after_the_other():
    """The value that ``b`` computes on leaving is there for the two that need each other, and theirs for ``c``."""
    say = {"data.sequence": (), "current": ("u",)}
    ring = [declared(probe(name, start=float(n)), **say) for n, name in enumerate("pq")]
    system = [probe("c"), ring[0], ring[1], probe("b", u=5.0)]
    links = [
        Link("b.current", "p.u"),
        Link("p.current", "q.u"),
        Link("q.data.sequence", "p.number"),
        Link("q.current", "c.u"),
    ]
    recording = simulate((system, links), record=["*.current"], **H)
    assert [recording[f"{name}.current"][0] for name in "bpqc"] == [105.0, 205.0, 305.0, 405.0]


def test_model_structure_is_read(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    said = {"x": "", "direct": "1 8 5", "double": None}  # u, number, gain
    about = load(write(tmp_path / "s.fmu", dependencies=said)).description
    assert about.dependencies == {"x": (), "direct": ("u", "number")}
    found = {name: about.initial_inputs(about.by_name[name]) for name in ("x", "direct", "double", "fixed")}
    assert found == {
        "x": (),
        "direct": ("u", "number"),
        "double": ("u", "number", "flag"),
        "fixed": ("u", "number", "flag"),
    }
    again = load(write(tmp_path / "t.fmu", dependencies=said)).description  # from the cache
    assert again.dependencies == about.dependencies


def test_a_dependency_on_another_unknown_is_one_on_its_inputs(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    about = load(write(tmp_path / "s.fmu", dependencies={"direct": "4", "fixed": "9", "double": "8 3"})).description
    assert about.dependencies["direct"] == ("number",)
    about = load(write(tmp_path / "t.fmu", dependencies={"direct": "4", "fixed": None})).description
    assert "direct" not in about.dependencies


def test_the_first_row_is_finite_in_a_ring_with_faults():
    lags = [declared(probe(f"lag{i}", start=float(i)), y=(), current=("u",)) for i in range(3)]
    links = [Link(f"lag{i}.y", f"lag{(i + 1) % 3}.u") for i in range(3)]
    faults = [
        Fault("held", "lag0.y", "stuck", 0.0, 0.5),
        Fault("noise", "lag1.y", "noise", 0.0, 0.5, {"sigma": 1.0, "period": 0.2}),
    ]
    recording = simulate((lags, links), record=["*.current", "*.y", "*.y@true"], faults=faults, **H)
    for i in range(3):
        assert recording[f"lag{(i + 1) % 3}.current"][0] == recording[f"lag{i}.y"][0] + 100.0
    assert recording["lag0.y"][0] == 0.0
    assert recording["lag1.y"][0] != recording["lag1.y@true"][0] == 1.0
    assert np.isfinite(recording.values).all()
