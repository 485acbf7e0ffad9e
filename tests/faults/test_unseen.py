"""A fault that changes nothing is told: the engines compare each value with the one that would be there without it."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.engine import compiled
from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.recording import RunError
from navfmu.engine.reference import Reference
from navfmu.faults import Fault
from tests.engine.probe import probe, run_both
from tests.foreign.stepper import stepper, write

ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
NOTHING = "changed nothing: without it every value that was recorded, or went to a component, would have been the same"
LINKS = [Link("source.y", "lag.u"), Link("source.data.sequence", "lag.number"), Link("source.data.valid", "lag.flag")]


def plan(*faults: Fault, links=LINKS, interpolates=True, stop=4.0, **options):
    source = probe("source", u=1.0, start=2.0)
    lag = probe("lag", interpolates=interpolates, start=1.0)
    return make_plan([source, lag], links, step=0.1, stop=stop, faults=faults, **options)


def idle(*faults: Fault, **options) -> dict[str, str]:
    """Those that cannot act, and those that have not, in both engines."""
    made = plan(*faults, **options)
    return {**made.idle, **run_both(made).idle}


def bias(value=1.0, target="source.y", start=1.0, duration=1.0, name="bias"):
    return Fault(name, target, "bias", start, duration, {"value": value})


def stuck(start, duration, value=None, target="source.y", name="stuck"):
    return Fault(name, target, "stuck", start, duration, {} if value is None else {"value": value})


@ALGORITHMS
def test_what_others_hide_changed_nothing(algorithm):
    """Certified once: only one later fault with a value, over the whole time, was recognised."""
    options = {"algorithm": algorithm}
    assert idle(bias(), stuck(1.0, 1.0), **options) == {"bias": NOTHING}
    assert not idle(bias(), stuck(1.1, 1.0), **options)
    two = stuck(0.5, 1.0, 7.0, name="a"), stuck(1.5, 1.0, 7.0, name="b")
    assert idle(bias(), *two, **options) == {"bias": NOTHING}
    assert not idle(bias(duration=1.6), *two, **options)
    assert idle(bias(target="source.data.value"), Fault("drop", "source.data", "dropout", 1.0, 1.0), **options) == {
        "bias": NOTHING
    }


@ALGORITHMS
def test_what_is_remembered_of_a_hidden_fault_is_seen(algorithm):
    """The bias is hidden as long as it lasts, but what is stuck afterwards holds it."""
    faults = bias(), stuck(2.0, 1.0, name="hold"), stuck(1.0, 1.0, 5.0, name="five")
    assert not idle(*faults, algorithm=algorithm)
    again = stuck(2.0, 1.0, 6.0, name="six")
    assert set(idle(*faults, again, algorithm=algorithm)) == {"bias", "hold"}


@ALGORITHMS
def test_what_is_there_anyway_changed_nothing(algorithm):
    first = Fault("off", "lag.gain", "parameter", 1.0, 1.0, {"value": 1.0})
    second = Fault("on", "lag.gain", "parameter", 3.0, 1.0, {"value": 2.0})
    assert idle(first, second, algorithm=algorithm) == {"off": NOTHING}
    assert idle(stuck(1.0, 1.0, True, "source.data.valid"), algorithm=algorithm) == {"stuck": NOTHING}
    assert idle(bias(1e-300), algorithm=algorithm) == {"bias": NOTHING}
    assert not idle(bias(1e-15), algorithm=algorithm)


def test_a_drift_of_one_point_is_seen_by_whoever_gets_the_end_of_the_step():
    drift = Fault("drift", "source.y", "drift", 1.0, 0.1, {"rate": 1.0})
    assert not idle(drift) and not idle(drift, interpolates=False)
    assert idle(drift, algorithm="jacobi") == {"drift": NOTHING}
    assert idle(drift, links=LINKS[1:]) == {"drift": NOTHING}


def test_a_signal_that_goes_nowhere_is_told_before_the_run():
    assert plan(bias(target="lag.y"), record=["source.y"]).idle == {
        "bias": "acts on 'lag.y', which goes nowhere: it is neither connected nor recorded nor asked for"
    }
    assert not plan(bias(target="lag.y"), record=["lag.y"]).idle
    assert not plan(bias(), record=["lag.y"]).idle
    assert not plan(bias(), record=["lag.u"]).idle  # the recorded input is the output
    assert plan(bias(target="lag.y"), record=["lag.y@true"]).idle


def test_a_window_between_recorded_points_is_told_before_the_run():
    between = bias(target="lag.y", start=1.1, duration=0.3)
    assert plan(between, record=["lag.y"], record_period=0.5).idle == {
        "bias": "acts on 'lag.y', which is not connected, and at no point at which it is recorded"
    }
    assert not plan(bias(target="lag.y", start=1.1, duration=0.5), record=["lag.y"], record_period=0.5).idle
    assert not idle(bias(start=1.1, duration=0.3), record=["lag.y"], record_period=0.5)


def test_what_a_later_fault_remembers_is_recorded_with_that():
    """A campaign was refused in which the bias filled the signal for three seconds."""
    between = bias(target="lag.y", start=1.1, duration=0.2)
    options = {"record": ["lag.y"], "record_period": 0.5}
    assert not idle(between, stuck(1.3, 1.0, target="lag.y"), **options)
    assert idle(between, stuck(1.3, 1.0, 5.0, target="lag.y"), **options)["bias"].endswith("at which it is recorded")
    assert idle(between, stuck(1.3, 0.1, target="lag.y"), **options)["bias"].endswith("at which it is recorded")


def test_an_input_or_parameter_that_is_recorded_is_seen_at_the_last_point():
    """It was told that it cannot act, beside a recording in which it did."""
    flag = Fault("flag", "source.number", "input", 4.0, 1.0, {"value": 3})
    gain = Fault("gain", "lag.gain", "parameter", 4.0, 1.0, {"value": 2.0})
    assert not idle(flag, gain, record=["source.number", "lag.gain"])
    found = plan(flag, gain, record=["source.number", "lag.gain"], record_period=0.3).idle
    assert set(found.values()) == {"starts at 4 s, the last communication point"} and set(found) == {"flag", "gain"}
    assert set(plan(flag, gain).idle) == {"flag", "gain"}


def test_at_the_last_point_only_who_looks_there_sees_it():
    last = bias(start=4.0)
    assert not idle(last)
    assert (
        plan(last, record=["lag.y"], algorithm="jacobi").idle["bias"] == "starts at 4 s, the last communication point"
    )
    assert plan(last, record=["lag.y"]).idle
    assert not plan(bias(start=4.0, target="source.data.value"), links=[Link("source.data.value", "lag.u")]).idle


@ALGORITHMS
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("value", [0.0, 1.0, 2.0])
def test_what_went_round_before_0_s_is_compared_as_it_left(tmp_path, value, backwards, algorithm):
    """a.direct is 1 + a.u / 2 and b.direct is b.u: stuck at 2, the value comes back as 2 from the circle.

    The bias of -1 makes it come back as the 1 that it is anyway.
    """
    file = write(tmp_path / "stepper.fmu")
    components = [stepper("a", file, gain=0.5, bias=1.0), stepper("b", file)][:: -1 if backwards else 1]
    links = [Link("a.direct", "b.u"), Link("b.direct", "a.u")]
    options = {"step": 0.1, "stop": 1.0, "algorithm": algorithm, "record": ["*"]}
    for more in ((), (bias(-1.0, "b.direct", 0.0, name="b"),)):
        without = compiled.run(make_plan(components, links, faults=more, **options))
        made = make_plan(components, links, faults=(stuck(0.0, 0.1, value, "a.direct"), *more), **options)
        found = run_both(made)
        assert ("stuck" in found.idle) == (found.values.tobytes() == without.values.tobytes())
        assert ("stuck" in found.idle) == (value == 1.0 and bool(more) and not backwards)


@ALGORITHMS
@pytest.mark.parametrize("backwards", [False, True])
def test_a_fault_that_makes_an_fmu_end_the_run_has_changed_something(tmp_path, backwards, algorithm):
    """It was told that it changed nothing, and the campaign that looked for just that failed for it."""
    file = write(tmp_path / "stepper.fmu")
    driven = Fault("gust", "b.u", "input", 2.0, 9.0, {"value": 100.0})
    alone = [stepper("b", file, u=1.0, most=50.0)]
    for links, fault in (([], driven), ([Link("a.x", "b.u")], bias(100.0, "a.x", 2.0, 9.0))):
        components = [stepper("a", file, u=1.0), *alone][:: -1 if backwards else 1]
        late = stuck(2.2, 1.0, target="a.x", name="late")
        made = make_plan(components, links, step=0.1, stop=4.0, faults=(fault, late), algorithm=algorithm)
        found = run_both(made)
        assert found.time[-1] == 2.0 and set(found.idle) == {"late"}


@ALGORITHMS
def test_what_a_step_that_is_not_complete_has_not_come_to_was_not_taken(tmp_path, algorithm):
    """b ends the run. What goes to c is taken before that in Jacobi only, what leaves after it is recorded nowhere."""
    file = write(tmp_path / "stepper.fmu")
    components = [stepper("a", file, u=1.0), stepper("b", file, most=50.0), stepper("c", file)]
    gust = Fault("gust", "b.u", "input", 2.0, 9.0, {"value": 100.0})
    to_c = Fault("to_c", "c.u", "input", 2.0, 9.0, {"value": 3.0})
    left = bias(1.0, "a.x", 2.1, name="left")
    made = make_plan(components, [], step=0.1, stop=4.0, faults=(gust, to_c, left), algorithm=algorithm)
    found = run_both(made).idle
    assert found.pop("left") == "starts at 2.1 s, but the run ended at 2 s"
    assert set(found) == ({"to_c"} if algorithm == "gauss_seidel" else set())


@pytest.mark.parametrize(("start", "changed"), [(0.4, True), (0.5, True), (0.6, False)])
def test_who_has_taken_the_value_before_the_step_has_not_taken_the_one_at_its_end(tmp_path, start, changed):
    """e ends the run in the step from 0.5 s. r gets what left before it, t would get what leaves at 0.6 s."""
    file = write(tmp_path / "stepper.fmu")
    components = [stepper("r", file), stepper("s", file), stepper("e", file, ends_at=0.55), stepper("t", file)]
    links = [Link("r.double", "s.number"), Link("s.double", "r.number"), Link("s.double", "t.number")]
    links += [Link("s.x", "e.u"), Link("e.x", "t.u")]
    made = make_plan(components, links, step=0.1, stop=1.0, faults=(stuck(start, 0.2, 7, "s.double"),), record=["e.x"])
    assert made.order == (0, 1, 2, 3)
    assert ("stuck" not in run_both(made).idle) == changed


@ALGORITHMS
@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_a_fault_that_an_fmu_refuses_in_the_step_in_which_another_ends_the_run(tmp_path, kind, algorithm):
    file = write(tmp_path / "stepper.fmu")
    components = [stepper("b", file, ends_at=2.1), stepper("c", file, most=50.0, stubborn=True)]
    gust = Fault("gust", "c.u", "input", 2.0, 9.0, {"value": 100.0})
    made = make_plan(components, [], step=0.1, stop=4.0, faults=(gust,), algorithm=algorithm)
    with kind(made) as engine, pytest.raises(RunError) as raised:
        engine.run()
    assert raised.value.recording.time[-1] == 2.0 and not raised.value.recording.idle


def test_two_that_do_the_same_are_both_told():
    assert set(idle(stuck(1.0, 1.0, 5.0, name="a"), stuck(1.0, 1.0, 5.0, name="b"))) == {"a", "b"}


@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_what_was_seen_after_a_snapshot_is_forgotten_with_it(kind):
    made = plan(bias(1e-300), bias(start=2.0, name="late"), stuck(2.0, 9.0, name="hold"))
    with kind(made) as engine:
        engine.initialise()
        engine.advance(15)
        snapshot = engine.snapshot()
        for _ in range(2):
            engine.advance()
            assert engine.recording().idle == {"bias": NOTHING, "late": NOTHING}
            engine.restore(snapshot)
            assert engine.recording().idle == {}  # it is not over
        engine.free(snapshot)


@ALGORITHMS
@pytest.mark.parametrize("seed", range(30))
def test_a_fault_is_told_if_and_only_if_the_run_without_it_is_the_same(seed, algorithm):
    rng = np.random.default_rng(seed)
    menu = [
        ("source.y", "bias", lambda: {"value": float(rng.choice([1.0, 1e-300]))}),
        ("source.y", "drift", lambda: {"rate": 0.5}),
        ("source.y", "stuck", lambda: {}),
        ("source.y", "stuck", lambda: {"value": 3.0}),
        ("source.y", "noise", lambda: {"sigma": float(rng.choice([0.1, 1e-300])), "period": 0.2}),
        ("source.data", "dropout", lambda: {}),
        ("source.data.sequence", "stuck", lambda: {"value": int(rng.integers(3))}),
        ("source.data.valid", "stuck", lambda: {"value": bool(rng.integers(2))}),
        ("source.data.value", "bias", lambda: {"value": 1.0}),
        ("source.number", "input", lambda: {"value": int(rng.integers(2))}),
        ("lag.gain", "parameter", lambda: {"value": float(rng.choice([1.0, 2.0]))}),
        ("source.y", "scale", lambda: {"factor": float(rng.choice([-1.0, 0.5]))}),
        ("source.y", "quantise", lambda: {"step": float(rng.choice([0.3, 1e-300]))}),
        ("source.y", "saturate", lambda: {"high": float(rng.choice([0.5, 9.0]))}),
        ("source.y", "spike", lambda: {"value": 1.0, "every": 0.25}),
        ("source.y", "garbage", lambda: {"low": -1.0, "high": 1.0, "period": 0.2}),
        (
            "source.y",
            "delay",
            lambda: {"delay": float(rng.choice([0.0, 0.1, 0.5])), "jitter": float(rng.choice([0, 0.4]))},
        ),
        ("source.y", "slow", lambda: {"period": float(rng.choice([0.1, 0.3]))}),
        (["source.y", "source.seen"], "swap", lambda: {"order": [2, 1]}),
        ("source.data", "delay", lambda: {"delay": 0.2}),
        ("lag.u", "bias", lambda: {"value": 1.0}),
        ("lag.u", "stuck", lambda: {"value": 3.0}),
        ("lag.u", "delay", lambda: {"delay": 0.3}),
        ("lag.number", "stuck", lambda: {}),
    ]
    faults = []
    for number in range(10):
        target, kind, parameters = menu[rng.integers(len(menu))]
        start, duration = 0.1 * rng.integers(0, 12), 0.1 * rng.integers(1, 8)
        faults.append(Fault(f"f{number}", target, kind, float(start), float(duration), parameters()))
    options = {"algorithm": algorithm, "interpolates": bool(seed % 2), "stop": 2.0}
    for more in ({"record": ["*"]}, {"record": ["lag.*"], "record_period": 0.4}):
        told, whole = idle(*faults, **options, **more), compiled.run(plan(*faults, **options, **more)).values
        for fault in faults:
            others = [other for other in faults if other is not fault]
            same = compiled.run(plan(*others, **options, **more)).values.tobytes() == whole.tobytes()
            assert same if fault.id in told else not same or len(more) > 1, fault
