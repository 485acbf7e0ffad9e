"""Faults that wait for a condition, or act while it holds, against closed forms. Both engines make every run.

``source.data.value`` is 10 t, so that the point at which a condition on it becomes true is known beforehand.
"""

import numpy as np
import pytest

from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.reference import Reference
from navfmu.engine.trigger import SPANS
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from navfmu.faults.file import parse_fault
from tests.engine.probe import probe, simulate

H, STEPS = 0.1, 100
BEFORE = " just before any point at which it could act"
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
RECEIVERS = pytest.mark.parametrize("interpolates", [True, False], ids=["interpolating", "plain"])
K = np.arange(STEPS + 1)
T = K / 10


def system(interpolates=True):
    components = [probe("source", start=2.0, u=0.5), probe("lag", interpolates=interpolates, start=2.0)]
    return components, [Link("source.y", "lag.u"), Link("source.data.sequence", "lag.number")]


def run(*faults, algorithm="jacobi", interpolates=True, record=(), **more):
    record = ["source.y", "source.y@true", "lag.y", *record]
    options = {"step": H, "stop": STEPS * H, "algorithm": algorithm, "record": record} | more
    return simulate(system(interpolates), faults=faults, **options)


def bias(name="x", start=0.0, **more):
    return Fault(name, "source.y", "bias", start, value=1.0, **more)


def acted(recording):
    """At which points a bias of 1 was there."""
    changed = recording["source.y"] - recording["source.y@true"]
    assert set(np.round(changed, 9)) <= {0.0, 1.0}
    return changed > 0.5


@ALGORITHMS
@RECEIVERS
def test_once_a_condition_is_true_it_acts_one_step_later_for_its_duration(algorithm, interpolates):
    """10 t reaches 30 at 3.0 s: it acts from 3.1 to 5.0 s. Wrong: from 3.0 s on, or as long as the condition holds."""
    fault = bias(when="source.data.value >= 30", duration=2.0)
    recording = run(fault, algorithm=algorithm, interpolates=interpolates)
    acts = (K >= 31) & (K < 51)
    assert np.array_equal(acted(recording), acts) and recording.acted == {"x": ((3.1, 5.1),)}
    answer = [0.0]
    for k in range(STEPS):
        answer.append(0.9 * answer[-1] + 0.1 * acts[k])
    clean = run(algorithm=algorithm, interpolates=interpolates)
    np.testing.assert_allclose(recording["lag.y"] - clean["lag.y"], answer, atol=1e-14)


@ALGORITHMS
def test_without_a_duration_it_stays(algorithm):
    recording = run(bias(when="source.data.value >= 30"), algorithm=algorithm)
    assert np.array_equal(acted(recording), K >= 31)
    assert recording.acted == {"x": ((3.1, 10.0),)}


@ALGORITHMS
def test_a_drift_grows_from_where_it_begins(algorithm):
    fault = Fault("x", "source.y", "drift", when="source.data.value >= 30", rate=2.0, duration=2.0)
    recording = run(fault, algorithm=algorithm)
    added = np.where((K >= 31) & (K < 51), 2.0 * (T - 3.1), 0.0)
    np.testing.assert_allclose(recording["source.y"] - recording["source.y@true"], added, atol=1e-12)


@ALGORITHMS
def test_it_comes_once_although_its_condition_comes_again(algorithm):
    fault = bias(when="1 <= time < 2 or 5 <= time < 6", duration=0.5)
    assert np.array_equal(acted(run(fault, algorithm=algorithm)), (K >= 11) & (K < 16))


@ALGORITHMS
def test_a_condition_must_have_held_for_a_time(algorithm):
    """It is true at 1.0 to 1.3 s, which is too short, and from 3.0 s on: at 3.5 s it has been for 0.5 s."""
    fault = bias(when="1 <= time <= 1.3 or time >= 3", hold=0.5)
    assert np.array_equal(acted(run(fault, algorithm=algorithm)), K >= 36)
    held = bias(when="1 <= time <= 1.3 or time >= 3", hold=0.3)
    assert np.array_equal(acted(run(held, algorithm=algorithm)), K >= 14)


@ALGORITHMS
def test_it_does_not_come_before_its_start(algorithm):
    """True since 3.0 s: it acts at 5.0 s, at which the point before is looked at. Wrong: one step after that."""
    fault = bias(start=5.0, when="source.data.value >= 30", duration=1.0)
    assert np.array_equal(acted(run(fault, algorithm=algorithm)), (K >= 50) & (K < 60))
    passed = bias(start=5.0, when="3 <= time < 4.9")
    recording = run(passed, algorithm=algorithm)
    assert recording.idle == {"x": "never acted: '3 <= time < 4.9' did not hold" + BEFORE}
    assert not acted(recording).any() and recording.acted == {"x": ()}


@ALGORITHMS
@RECEIVERS
def test_during_a_phase_it_acts_at_the_points_after_those_of_the_phase(algorithm, interpolates):
    fault = bias(during="2 <= time < 4 or 6 <= time < 7")
    recording = run(fault, algorithm=algorithm, interpolates=interpolates)
    acts = ((K >= 21) & (K < 41)) | ((K >= 61) & (K < 71))
    assert np.array_equal(acted(recording), acts)
    assert recording.acted == {"x": ((2.1, 4.1), (6.1, 7.1))}
    answer = [0.0]
    for k in range(STEPS):
        answer.append(0.9 * answer[-1] + 0.1 * acts[k])
    clean = run(algorithm=algorithm, interpolates=interpolates)
    np.testing.assert_allclose(recording["lag.y"] - clean["lag.y"], answer, atol=1e-14)


@ALGORITHMS
def test_each_time_of_a_phase_it_begins_anew(algorithm):
    fault = Fault("x", "source.y", "drift", rate=2.0, during="2 <= time < 4 or 6 <= time < 7", hold=0.5)
    recording = run(fault, algorithm=algorithm)
    added = np.where((K >= 26) & (K < 41), 2.0 * (T - 2.6), 0.0) + np.where((K >= 66) & (K < 71), 2.0 * (T - 6.6), 0.0)
    np.testing.assert_allclose(recording["source.y"] - recording["source.y@true"], added, atol=1e-12)
    stuck = run(Fault("x", "source.y", "stuck", during="2 <= time < 4 or 6 <= time < 7"), algorithm=algorithm)
    v = stuck["source.y@true"]
    expected = np.where((K >= 21) & (K < 41), v[20], np.where((K >= 61) & (K < 71), v[60], v))
    assert np.array_equal(stuck["source.y"], expected)


@ALGORITHMS
def test_a_phase_and_a_window_must_both_be(algorithm):
    fault = bias(start=3.0, duration=2.5, during="2 <= time < 4 or 5 <= time < 7")
    recording = run(fault, algorithm=algorithm)
    assert np.array_equal(acted(recording), ((K >= 30) & (K < 41)) | ((K >= 51) & (K < 55)))
    flicker = Fault("x", "source.y", "drift", 1.0, rate=2.0, on=0.5, off=0.7, during="2 <= time < 4")
    added = run(flicker, algorithm=algorithm)
    phase = (K - 10) % 12
    acts = (K >= 21) & (K < 41) & (phase < 5)
    since = np.where(K - phase < 21, 21, K - phase)
    expected = np.where(acts, 2.0 * (T - since / 10), 0.0)
    np.testing.assert_allclose(added["source.y"] - added["source.y@true"], expected, atol=1e-12)


@ALGORITHMS
def test_failures_at_random_during_a_phase_are_those_at_random_and_of_the_phase(algorithm):
    always = acted(run(bias(mttf=0.8, mttr=0.6), algorithm=algorithm, seed=5))
    phase = acted(run(bias(mttf=0.8, mttr=0.6, during="3 <= time < 7"), algorithm=algorithm, seed=5))
    assert np.array_equal(phase, always & (K >= 31) & (K < 71)) and 5 < phase.sum() < always.sum()


@ALGORITHMS
@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_a_fault_that_waits_for_another_sees_the_point_before_in_whatever_order_they_stand(algorithm, order):
    first = Fault("first", "source.data", "stuck", 2.0, 1.0)
    second = bias("second", during="active(first)")
    recording = run(*[first, second][order], algorithm=algorithm, record=["source.data"])
    assert np.array_equal(acted(recording), (K >= 21) & (K < 31))


@ALGORITHMS
def test_what_a_fault_does_may_end_it(algorithm):
    """It acts at the points after those at which it did not: nothing else sees what left at one point only once."""
    recording = run(bias(during="not active(x)"), algorithm=algorithm)
    assert np.array_equal(acted(recording), K % 2 == 1)
    fed_back = run(bias(during="source.y < source.y@true + 0.5"), algorithm=algorithm)
    assert np.array_equal(acted(fed_back), K % 2 == 1)


@ALGORITHMS
def test_times_for_which_there_is_no_room_lengthen_the_last(algorithm):
    recording = run(bias(during="not active(x)"), algorithm=algorithm, step=0.01, stop=5.0)
    spans = recording.acted["x"]
    assert len(spans) == SPANS and spans[:2] == ((0.01, 0.02), (0.03, 0.04)) and spans[-1] == (1.99, 5.0)


@ALGORITHMS
def test_steps_are_lost_during_a_phase(algorithm):
    recording = run(Fault("x", "lag", "lost_step", during="2 <= time < 2.5"), algorithm=algorithm)
    y = recording["lag.y"]
    assert len(set(y[21:27])) == 1 and y[27] != y[26] and y[21] != y[20]


@ALGORITHMS
def test_an_input_of_nobody_is_driven_during_a_phase(algorithm):
    recording = run(Fault("x", "source.u", "input", value=3.0, during="2 <= time < 4"), record=["source.u"])
    assert np.array_equal(recording["source.u"], np.where((K >= 21) & (K < 41), 3.0, 0.5))


@ALGORITHMS
def test_a_phase_has_a_name(algorithm):
    phases = {"cruise": "source.data.value >= 20 and not descent", "descent": "time >= 4"}
    assert np.array_equal(acted(run(bias(during="cruise"), algorithm=algorithm, phases=phases)), (K >= 21) & (K < 41))


@ALGORITHMS
@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_going_back_goes_back_to_what_was_waited_for(kind, algorithm):
    """Wrong: a snapshot without how long a condition has held, that it has come already, or when it acted."""
    faults = [
        bias("once", when="2 <= time < 3 or time >= 6", hold=0.4, duration=2.0),
        Fault("phase", "lag.y", "drift", rate=0.3, during="time >= 1.5 and not 4 < time < 5", hold=0.2),
        Fault("last", "source.data", "stuck", during="active(once)"),
    ]
    plan = make_plan(*system(), step=H, stop=10.0, algorithm=algorithm, faults=faults)
    with kind(plan) as engine:
        straight = engine.run()
    assert straight.acted == {
        "once": ((2.5, 4.5),),
        "phase": ((1.8, 4.2), (5.3, 10.0)),
        "last": ((2.6, 4.6),),
    }
    with kind(plan) as engine:
        engine.initialise()
        for k in (0, 17, 23, 25, 30, 44, 46, 60, 90):
            engine.advance(k)
            snapshot = engine.snapshot()
            engine.advance()
            engine.restore(snapshot)
            until = plan.clock.time(k)
            seen = {
                name: tuple((a, min(b, until)) for a, b in spans if a <= until)
                for name, spans in straight.acted.items()
            }
            assert engine.recording().acted == seen
            engine.advance()
            assert engine.recording().values.tobytes() == straight.values.tobytes()
            assert engine.recording().acted == straight.acted
            engine.restore(snapshot)
            engine.free(snapshot)


# ---- what cannot be --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entries", "sentence"),
    [
        ('when = "time > "', "'when': in 'time > ', character 7: it ends, expected a value"),
        ('when = ""', "'when' must be a text that is not empty, not ''"),
        ("when = 3", "when"),
        ('when = "time > 1", during = "time > 2"', "'when' and 'during' exclude each other"),
        ('when = "time > 1", on = 1, off = 1', "'when' and 'on' exclude each other"),
        ('when = "time > 1", mttf = 5', "'when' and 'mttf' exclude each other"),
        ("hold = 3", "'hold' needs 'when' or 'during' beside it"),
        ('during = "time > 1", hold = -3', "'hold' must be a time in s, 0 or longer, not -3"),
        ('dring = "time > 1"', "did you mean 'during'?"),
    ],
)
def test_entries_that_do_not_go_together_are_told(entries, sentence):
    with pytest.raises(NavfmuError) as caught:
        parse_fault(f'id = "x", target = "source.y", type = "bias", value = 1, {entries}')
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("condition", "sentence"),
    [
        ("time", "fault 'x': 'when': in 'time', character 1: expected a truth value"),
        ("source.z > 1", "component 'source' has no variable 'z'"),
        ("cruse", "there is no signal 'cruse'; did you mean 'cruise'?"),
        ("source.y > 1 and active(y)", "there is no fault 'y'"),
    ],
)
def test_a_condition_that_the_system_does_not_have_is_told(condition, sentence):
    with pytest.raises(NavfmuError) as caught:
        run(bias(when=condition), phases={"cruise": "time > 1"})
    assert sentence in str(caught.value)


def test_a_condition_that_never_holds_is_told():
    recording = run(bias(when="source.data.value > 1000", hold=2.0))
    assert recording.idle == {"x": "never acted: 'source.data.value > 1000' did not hold for 2 s" + BEFORE}


def test_a_condition_that_holds_where_it_cannot_act_is_not_said_never_to_hold():
    """It holds, but at the last point only, or outside of the windows. Wrong: "did not hold at 2 s or later"."""
    last = run(bias(when="time >= 9.95"))
    assert last.idle == {"x": "never acted: 'time >= 9.95' did not hold" + BEFORE}
    beside = run(bias(start=2.0, duration=1.0, during="time >= 3"))
    assert beside.idle == {"x": "never acted: 'time >= 3' did not hold" + BEFORE}


def test_a_failure_at_random_that_misses_its_phase_is_a_note_and_no_finding():
    """As one that comes after the end of the run. Wrong: some seeds of a campaign are findings by chance."""
    recording = run(bias(mttf=0.8, mttr=0.3, during="false"), seed=5)
    told = "fault 'x' does not occur: it fails at random, and 'false' did not hold" + BEFORE
    assert recording.idle == {} and recording.notes == (told,) and recording.acted == {"x": ()}
    rare = run(bias(mttf=1e9, during="false"))
    assert rare.idle == {} and rare.notes == ()  # the plan says so


def test_what_may_come_at_any_time_hides_nothing_beforehand():
    """A stuck value that waits would hide the bias only if it came; wrong: it is said to be hidden all the time."""
    stuck = Fault("y", "source.y", "stuck", value=1.0, when="time > 1000")
    assert make_plan(*system(), step=H, stop=10.0, faults=[bias(), stuck]).idle == {}
    always = Fault("y", "source.y", "stuck", value=1.0)
    hidden = make_plan(*system(), step=H, stop=10.0, faults=[bias(when="time > 2"), always]).idle
    assert hidden == {"x": "is hidden: all the time another fault sets 'source.y'"}


def test_a_signal_that_only_a_condition_looks_at_is_looked_at():
    """The bias goes nowhere but into the condition of another fault, and changes when that one comes."""
    seen = Fault("seen", "source.data.value", "bias", value=20.0)
    recording = simulate(
        system(),
        step=H,
        stop=10.0,
        faults=[seen, bias(when="source.data.value >= 30")],
        record=["source.y", "source.y@true"],
    )
    assert np.array_equal(acted(recording), K >= 11) and recording.idle == {}
