"""Lost steps against closed forms. Both engines make every run and must agree to the last bit.

``source`` falls from 2 to 0.5 by v(k) = 0.5 + 1.5 * 0.9^k; ``lag`` follows by y <- y + n h (x - y) in a step of n h,
where x is what it takes over it; ``last`` follows the lag.
"""

import numpy as np
import pytest

from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.reference import Reference
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from tests.engine.probe import probe, run_both

H, STEPS = 0.1, 60
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
RECEIVERS = pytest.mark.parametrize("interpolates", [True, False], ids=["interpolating", "plain"])
FIRST, END = 20, 24


def plan(*faults, algorithm="jacobi", interpolates=True, **more):
    components = [
        probe("source", start=2.0, u=0.5),
        probe("lag", interpolates=interpolates, start=2.0),
        probe("last", interpolates=interpolates, start=2.0),
    ]
    links = [Link("source.y", "lag.u"), Link("source.data.sequence", "lag.number"), Link("lag.y", "last.u")]
    record = ["*.y", "lag.y@true", "lag.slope", "lag.seen", "lag.echo", "lag.data"]
    options = {"step": H, "stop": STEPS * H, "algorithm": algorithm, "record": record} | more
    return make_plan(components, links, faults=faults, **options)


def run(*faults, **more):
    return run_both(plan(*faults, **more))


def lost(target="lag", start=FIRST * H, duration=(END - FIRST) * H, **more):
    return Fault("x", target, "lost_step", start, duration, **more)


def followed(v, lost_steps, algorithm, interpolates):
    """What the lag does; the steps from these points are lost."""
    y, behind, begin = [2.0], 0, v[0]
    for k in range(len(v) - 1):
        if k in lost_steps:
            behind += 1
            y.append(y[-1])
            continue
        x = v[k] if algorithm == "jacobi" else (begin + v[k + 1]) / 2 if interpolates else v[k + 1]
        y.append(y[-1] + (behind + 1) * H * (x - y[-1]))
        behind, begin = 0, v[k + 1]
    return np.array(y)


@ALGORITHMS
@RECEIVERS
def test_one_long_step_makes_up_for_what_was_lost(algorithm, interpolates):
    """Wrong: the long step is as long as any other, ends too early, or begins with the inputs of its end."""
    recording = run(lost(), algorithm=algorithm, interpolates=interpolates)
    v = 0.5 + 1.5 * 0.9 ** np.arange(STEPS + 1)
    np.testing.assert_allclose(recording["source.y"], v, rtol=1e-13)
    expected = followed(v, range(FIRST, END), algorithm, interpolates)
    np.testing.assert_allclose(recording["lag.y"], expected, rtol=1e-13)
    assert len(set(recording["lag.y"][FIRST : END + 1])) == 1
    np.testing.assert_allclose(recording["last.y"], followed(expected, (), algorithm, interpolates), rtol=1e-13)
    when = recording["lag.data.time_of_validity"]
    k = np.arange(STEPS + 1)
    stands = np.where((k > FIRST) & (k <= END), FIRST, k)
    np.testing.assert_allclose(when, stands * H, atol=1e-12)
    assert recording["lag.data.sequence"][-1] == STEPS - (END - FIRST)
    if algorithm == "gauss_seidel" and interpolates:
        np.testing.assert_allclose(recording["lag.slope"][END + 1], (v[END + 1] - v[FIRST]) / (5 * H), rtol=1e-12)


@ALGORITHMS
def test_inputs_that_are_not_continuous_are_the_newest_of_the_long_step(algorithm):
    recording = run(lost(), algorithm=algorithm)
    echo = recording["lag.echo"]
    late = int(algorithm == "jacobi")
    assert np.all(echo[FIRST + 1 : END + 1] == FIRST - late)
    assert echo[END + 1] == END + 1 - late


@ALGORITHMS
@RECEIVERS
def test_other_faults_go_on_at_outputs_that_are_held(algorithm, interpolates):
    drift = Fault("d", "lag.y", "drift", 1.0, rate=0.5)
    recording = run(drift, lost(), algorithm=algorithm, interpolates=interpolates)
    alone = run(lost(), algorithm=algorithm, interpolates=interpolates)
    assert np.array_equal(recording["lag.y@true"], alone["lag.y"])
    added = 0.5 * np.maximum(np.arange(STEPS + 1) * H - 1.0, 0.0)
    np.testing.assert_allclose(recording["lag.y"], alone["lag.y"] + added, rtol=1e-14)


@ALGORITHMS
def test_steps_are_lost_in_turns_and_by_two_faults_at_once(algorithm):
    """Every other step by one fault, four in a row by another."""
    turns = Fault("t", "lag", "lost_step", 1.0, on=0.1, off=0.1)
    recording = run(turns, lost(), algorithm=algorithm)
    missing = {k for k in range(STEPS) if (k >= 10 and k % 2 == 0) or FIRST <= k < END}
    v = 0.5 + 1.5 * 0.9 ** np.arange(STEPS + 1)
    np.testing.assert_allclose(recording["lag.y"], followed(v, missing, algorithm, True), rtol=1e-12)
    assert not recording.idle


@ALGORITHMS
def test_steps_from_the_first_to_the_last_may_be_lost(algorithm):
    recording = run(lost(["source", "lag"], 0.0, 100.0), algorithm=algorithm)
    assert np.all(recording["source.y"] == 2.0) and np.all(recording["lag.y"] == 2.0) and not recording.idle
    assert np.all(run(lost("source", 0.0, 0.5), algorithm=algorithm)["source.y"][:6] == 2.0)


@ALGORITHMS
@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_what_was_lost_belongs_to_a_snapshot(kind, algorithm):
    with kind(plan(lost(), algorithm=algorithm)) as engine:
        engine.initialise()
        engine.advance(FIRST + 2)
        snapshot = engine.snapshot()
        engine.advance()
        first = engine.recording().values.copy()
        engine.restore(snapshot)
        engine.advance()
        assert engine.recording().values.tobytes() == first.tobytes()
        engine.free(snapshot)


def test_what_cannot_be_is_a_sentence():
    stiff = [probe("a", any_step=False)], []
    with pytest.raises(NavfmuError, match="component 'a' cannot make up for lost steps: its FMU takes no steps of ano"):
        make_plan(*stiff, step=H, stop=1.0, faults=[lost("a")])
    with pytest.raises(NavfmuError, match="target 'lga': there is no component 'lga'; did you mean 'lag'"):
        plan(lost("lga"))
    with pytest.raises(NavfmuError, match=r"'target' must be the name of a component, not 'lag\.y'"):
        lost("lag.y")
    with pytest.raises(NavfmuError, match="type 'lost_step' has no parameter 'value'"):
        lost(value=1)


def test_a_step_that_does_not_begin_cannot_be_lost():
    why = {"x": "starts at 6 s, and no step begins there or later"}
    assert plan(lost(start=6.0)).idle == why
    assert plan(lost(start=5.9)).idle == {}
    assert plan(lost(start=5.9, on=0.1, off=0.1)).idle == {}
