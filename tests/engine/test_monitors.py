"""What monitors see, against closed forms and against a second reading of the whole recording; in both engines."""

import math
import random
from itertools import groupby

import numpy as np
import pytest

from navfmu.engine import compiled, reference
from navfmu.engine.link import Link
from navfmu.engine.monitor import Monitor
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from tests.engine.probe import chain, probe, run_both, simulate

H = {"step": 0.1, "stop": 10.0}
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])


def decay(*monitors, **options):
    """y = 0.9^k, the lag of 1 s from 1 to 0."""
    return simulate(chain(1, start=1.0), monitors=monitors, record=["lag0.y"], **H | options).observed


def test_a_bound_on_a_decay():
    seen = decay(Monitor("m", "lag0.y", most=0.5))["m"]  # 0.9^6 = 0.53, 0.9^7 = 0.48
    assert (seen.points, seen.outside, seen.episodes, seen.missing) == (101, 7, 1, 0)
    assert (seen.first_outside, seen.last_outside, seen.first_inside, seen.last_inside) == pytest.approx(
        (0, 0.6, 0.7, 10)
    )
    assert seen.longest == pytest.approx(0.7)
    assert (seen.worst, seen.worst_time) == (1.0, 0.0)
    assert seen.greatest == 1.0
    assert seen.rms == pytest.approx(math.sqrt((1 - 0.81**101) / (1 - 0.81) / 101), rel=1e-12)


def test_the_worst_of_what_is_inside_is_the_nearest_to_a_bound():
    seen = decay(Monitor("m", "lag0.y", most=2.0, least=-0.2, begin=1.0, end=2.0))["m"]
    assert (seen.points, seen.outside) == (11, 0)
    assert (seen.worst, seen.worst_time) == (pytest.approx(0.9**20, rel=1e-12), 2.0)
    assert math.isnan(seen.first_outside) and math.isnan(seen.last_outside)


@pytest.mark.parametrize(("tolerance", "counted"), [(0.0, 7), (0.6, 7), (0.69, 7), (0.7, 0), (0.71, 0)])
def test_what_is_outside_for_no_longer_than_tolerated_does_not_count(tolerance, counted):
    seen = decay(Monitor("m", "lag0.y", most=0.5, tolerance=tolerance))["m"]
    assert (seen.outside, seen.episodes) == (counted, int(counted > 0))
    assert seen.longest == pytest.approx(0.7)
    assert seen.first_outside == 0.0 if counted else math.isnan(seen.first_outside)


def test_a_truth_value_needs_no_bounds_and_when_limits_the_question():
    seen = decay(
        Monitor("low", "lag0.y < 0.5"),
        Monitor("late", "lag0.y < 0.2", when="time >= 1 s and lag0.y > 0.1"),
        Monitor("never", "false", when="lag0.y > 5"),
    )
    assert seen["low"].outside == 7
    assert seen["late"].points == 21 - 10 + 1  # 0.9^21 = 0.109, 0.9^22 = 0.098
    assert seen["late"].outside == 15 - 10 + 1  # 0.9^15 = 0.206
    assert seen["never"].points == seen["never"].outside == 0
    assert math.isnan(seen["never"].worst) and math.isnan(seen["never"].rms)


def test_a_pause_of_the_question_ends_a_row():
    """Outside at 0.3 to 0.6 s and at 0.9 to 1.2 s, not asked between: two rows of 0.4 s, none of a whole second."""
    window = "0.3 s <= time <= 0.6 s or 0.9 s <= time <= 1.2 s"
    seen = decay(Monitor("m", "false", when=window, tolerance=0.3))["m"]
    assert (seen.points, seen.outside, seen.episodes) == (8, 8, 2)
    assert seen.longest == pytest.approx(0.4)


@ALGORITHMS
def test_nothing_between_recorded_points_escapes(algorithm):
    """A bias of one point that no row of the recording shows; the true value is another signal."""
    spike = Fault("spike", "lag0.y", "bias", start=1.3, duration=0.1, value=10.0)
    monitors = Monitor("seen", "lag0.y", most=5.0), Monitor("true", "lag0.y@true", most=5.0)
    recording = simulate(
        chain(1, start=1.0),
        algorithm=algorithm,
        monitors=monitors,
        faults=[spike],
        record=["lag0.y"],
        record_period=1.0,
        **H,
    )
    assert recording["lag0.y"].max() == 1.0
    assert not recording.idle  # who asks for it has seen it
    seen, true = recording.observed["seen"], recording.observed["true"]
    assert (seen.outside, seen.worst_time) == (1, 1.3)
    assert seen.worst == pytest.approx(10.0 + 0.9**13)
    assert (true.outside, true.worst) == (0, 1.0)


def test_an_input_is_what_its_source_sends_with_what_scales_it():
    lags, _ = chain(2, start=1.0)
    monitor = Monitor("u", "lag1.u", most=2.0)
    options = {"monitors": [monitor], "record": ["lag1.y"], **H}
    seen = simulate((lags, [Link("lag0.y", "lag1.u", 3.0, -0.5)]), **options).observed["u"]
    assert seen.worst == 2.5
    assert seen.outside == 2  # 3 0.9^k - 0.5 > 2


@ALGORITHMS
def test_whether_a_fault_acts_can_be_asked(algorithm):
    """At the points 3 to 5 and from 8 on; a connected input as target has a trigger of the engine's own beside it."""
    first = Fault("first one", "lag0.y", "bias", 0.3, 0.3, value=1.0)
    second = Fault("second", "lag1.u", "bias", 0.8, value=1.0)
    seen = simulate(
        chain(2, start=1.0),
        algorithm=algorithm,
        faults=[first, second],
        monitors=[
            Monitor("one", "not active('first one')"),
            Monitor("two", "not active(second)"),
            Monitor("any", "not active()"),
            Monitor("other", "not active(elsewhere)"),
            Monitor("while", "false", when="active() and not active(second)"),
        ],
        record=["lag1.y"],
        step=0.1,
        stop=1.0,
    ).observed
    assert [seen[name].outside for name in ("one", "two", "any", "other", "while")] == [3, 3, 6, 0, 3]
    assert (seen["any"].episodes, seen["one"].first_outside, seen["two"].first_outside) == (2, 0.3, 0.8)


def test_no_number_is_outside_of_every_bound():
    seen = decay(Monitor("m", "sqrt(lag0.y - 0.5)"))["m"]  # 0.9^7 is below 0.5
    assert (seen.points, seen.not_finite, seen.outside) == (101, 94, 94)
    assert math.isnan(seen.worst) and seen.worst_time == 0.7
    assert seen.greatest == pytest.approx(math.sqrt(0.5))
    assert seen.rms == pytest.approx(math.sqrt(np.mean(0.9 ** np.arange(7) - 0.5)))


def test_points_that_an_early_end_leaves_out_are_missing():
    plan = make_plan(
        *chain(1, start=1.0),
        monitors=[Monitor("m", "lag0.y", begin=2.0, end=8.0)],
        record=["lag0.y"],
        **H,
    )
    for engine in (compiled.Compiled, reference.Reference):
        with engine(plan) as run:
            run.initialise()
            run.advance(50)
            seen = run.recording().observed["m"]
            assert (seen.points, seen.missing) == (31, 30)
            run.advance()
            seen = run.recording().observed["m"]
            assert (seen.points, seen.missing) == (61, 0)


@pytest.mark.parametrize("engine", [compiled.Compiled, reference.Reference])
def test_a_restored_run_sees_the_same_again(engine):
    plan = make_plan(*chain(1, start=1.0), monitors=[Monitor("m", "lag0.y", most=0.3)], record=["lag0.y"], **H)
    with engine(plan) as run:
        run.initialise()
        run.advance(10)
        kept = run.snapshot()
        run.advance()
        first = run.recording().observed
        run.restore(kept)
        assert run.recording().observed["m"].points == 11
        run.advance()
        assert repr(run.recording().observed) == repr(first)


def second_reading(monitor, recording, values, asked):
    """The same numbers from whole columns, in another way."""
    time = recording.time
    rows, place = [], 0
    inside = (values >= monitor.least) & (values <= monitor.most)
    points = [(k, bool(inside[k])) if asked[k] else (k, None) for k in range(len(time))]
    for state, group in groupby(points, key=lambda point: point[1]):
        group = list(group)
        if state is False:
            rows.append([k for k, _ in group])
        place += len(group)
    long = [row for row in rows if len(row) > round(monitor.tolerance / 0.1)]
    finite = np.isfinite(values) & asked
    return {
        "points": int(asked.sum()),
        "outside": sum(map(len, long)),
        "episodes": len(long),
        "not_finite": int((asked & ~np.isfinite(values)).sum()),
        "longest": max(map(len, rows), default=0) * 0.1,
        "first_outside": time[long[0][0]] if long else math.nan,
        "last_outside": time[long[-1][-1]] if long else math.nan,
        "first_inside": time[np.argmax(inside & asked)] if (inside & asked).any() else math.nan,
        "greatest": np.abs(values[finite]).max() if finite.any() else math.nan,
        "rms": math.sqrt(np.mean(values[finite] ** 2)) if finite.any() else math.nan,
    }


@ALGORITHMS
def test_a_second_reading_of_the_whole_recording_agrees(algorithm):
    """Random bounds, conditions, tolerances and faults on a ring of three lags that swings."""
    draw = random.Random(5)
    for _ in range(25):
        lags = [probe(f"l{i}", start=draw.uniform(-1, 1), tau=draw.uniform(0.2, 1), gain=-1.4) for i in range(3)]
        links = [Link(f"l{i}.y", f"l{(i + 1) % 3}.u") for i in range(3)]
        fault = Fault("n", "l1.y", "noise", draw.uniform(0, 5), sigma=draw.uniform(0.1, 1), period=0.3)
        bound, low, high = draw.uniform(0.1, 0.6), draw.uniform(0, 4), draw.uniform(4, 11)
        monitor = Monitor(
            "m", "l0.y - 2 * l1.y", -bound, bound, low, high, "abs(l2.y) > 0.1 or time > 7", draw.choice([0, 0.1, 0.3])
        )
        plan = make_plan(
            lags, links, algorithm=algorithm, monitors=[monitor], faults=[fault], record=["*.y"], seed=3, **H
        )
        recording = run_both(plan)
        y = [recording[f"l{i}.y"] for i in range(3)]
        t = recording.time
        asked = (t >= low) & (t <= high) & ((np.abs(y[2]) > 0.1) | (t > 7))
        expected = second_reading(monitor, recording, y[0] - 2 * y[1], asked)
        seen = recording.observed["m"]
        for name, value in expected.items():
            assert getattr(seen, name) == pytest.approx(value, rel=1e-12, nan_ok=True), name


def test_what_cannot_be_asked_is_a_sentence():
    for monitor, sentence in (
        (Monitor("NAV-1", "lag0.z"), "'NAV-1', value: in 'lag0.z', character 1: component 'lag0' has no variable 'z'"),
        (Monitor("NAV-1", "lag0.y", when="lag0.y"), "'NAV-1', when: in 'lag0.y', character 1: expected a truth value"),
    ):
        with pytest.raises(NavfmuError, match=sentence.replace("(", r"\(")):
            make_plan(*chain(1), monitors=[monitor], **H)


# ---- counted from faults ---------------------------------------------------------------------------------------------


def bias(name, start, duration=2.0, **more):
    return Fault(name, "lag0.y", "bias", start, duration, value=1.0, **more)


@ALGORITHMS
def test_from_the_first_onset_of_a_fault(algorithm):
    """It acts from 3 to 5 s and the question comes true at 4.3 s. Wrong: counted from the start of the run."""
    seen = decay(
        Monitor("own", "time >= 4.25 s", counts_from="onset", fault="x"),
        Monitor("window", "false", counts_from="onset", fault="x", begin=0.5, end=1.5),
        Monitor("other", "time >= 4.25 s", counts_from="onset", fault="y"),
        Monitor("any", "time >= 4.25 s", counts_from="onset"),
        Monitor("nobody", "time >= 4.25 s", counts_from="onset", fault="z"),
        faults=[bias("x", 3.0), bias("y", 2.0, on=0.5, off=0.7)],
        algorithm=algorithm,
    )
    assert (seen["own"].origin, seen["own"].first_inside, seen["own"].points) == (3.0, 4.3, 71)
    assert seen["own"].left == pytest.approx(7.0)
    assert (seen["window"].points, seen["window"].first_outside, seen["window"].last_outside) == (11, 3.5, 4.5)
    assert (seen["other"].origin, seen["any"].origin, seen["any"].points) == (2.0, 2.0, 81)
    assert seen["nobody"].points == seen["nobody"].missing == 0 and math.isnan(seen["nobody"].origin)


@ALGORITHMS
def test_from_where_a_fault_is_over(algorithm):
    """It is over at 5 s, and the question true from 6.1 s on: 1.1 s later."""
    seen = decay(
        Monitor("own", "time > 6 s", counts_from="over", fault="x"),
        Monitor("at once", "true", counts_from="over", fault="x"),
        Monitor("stays", "false", counts_from="over", fault="stays"),
        faults=[bias("x", 3.0), bias("stays", 9.0, math.inf)],
        algorithm=algorithm,
    )
    assert (seen["own"].origin, seen["own"].points, seen["own"].last_outside) == (5.0, 51, 6.0)
    assert seen["own"].latest == pytest.approx(1.1) and seen["at once"].latest == 0.0
    assert seen["stays"].points == 0


@ALGORITHMS
def test_each_time_a_fault_is_over_it_is_counted_anew_and_the_longest_is_kept(algorithm):
    """On from 1.0 to 1.9, 3.0 to 3.9 s and so on: over at 2.0 and 4.0 s. Wrong at 2.0 to 2.4 s and at 4.0 to 4.2 s."""
    text = "not (1.95 s < time < 2.45 s or 3.95 s < time < 4.25 s or 3 s <= time < 3.5 s)"
    loose = bias("x", 1.0, 4.0, on=1.0, off=1.0)
    seen = decay(Monitor("m", text, counts_from="over", fault="x"), faults=[loose], algorithm=algorithm)["m"]
    assert seen.latest == pytest.approx(0.5) and seen.origin == 4.0 and seen.outside == 5 + 3


@ALGORITHMS
def test_without_a_name_it_is_over_where_none_acts(algorithm):
    faults = [bias("x", 1.0, 3.0), bias("y", 3.0, 2.0), bias("later", 1.5, 0.5)]
    seen = decay(Monitor("m", "time > 6 s", counts_from="over"), faults=faults, algorithm=algorithm)["m"]
    assert seen.origin == 5.0 and seen.latest == pytest.approx(1.1) and seen.points == 51


@ALGORITHMS
def test_from_where_a_condition_has_begun_a_fault(algorithm):
    waits = bias("x", 0.0, 2.0, when="lag0.y < 0.5")  # 0.9^7 = 0.48, at 0.7 s: it acts from 0.8 s on
    seen = decay(Monitor("m", "time >= 2 s", counts_from="onset"), faults=[waits], algorithm=algorithm)["m"]
    assert (seen.origin, seen.first_inside) == (0.8, 2.0)
