"""Faults that come and go, in turns or at random, against closed forms. Both engines make every run."""

import math

import numpy as np
import pytest
from scipy import stats

from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from tests.engine.probe import probe, run_both, simulate
from tests.faults.philox import words

H, STEPS = 0.1, 100
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
RECEIVERS = pytest.mark.parametrize("interpolates", [True, False], ids=["interpolating", "plain"])
K = np.arange(STEPS + 1)


def run(*faults, algorithm="jacobi", interpolates=True, record=(), **more):
    components = [probe("source", start=2.0, u=0.5), probe("lag", interpolates=interpolates, start=2.0)]
    links = [Link("source.y", "lag.u"), Link("source.data.sequence", "lag.number")]
    record = ["source.y", "source.y@true", "lag.y", *record]
    options = {"step": H, "stop": STEPS * H, "algorithm": algorithm, "record": record} | more
    return simulate((components, links), faults=faults, **options)


def plan(*faults, step=H, stop=10.0, seed=1):
    return make_plan([probe("source")], [], step=step, stop=stop, faults=faults, seed=seed)


def windows(fault, **more):
    return [(first, end) for first, end, _ in plan(fault, **more).windows.tolist()]


def bias(name="x", **more):
    return Fault(name, "source.y", "bias", value=1.0, **more)


@ALGORITHMS
@RECEIVERS
def test_on_and_off_in_turns(algorithm, interpolates):
    """From 1 s to 7 s, 0.5 s on and 0.7 s off: at 10-14, 22-26, 34-38, 46-50, 58-62; wrong: in rounded steps."""
    flicker = bias(start=1.0, duration=6.0, on=0.5, off=0.7)
    recording = run(flicker, algorithm=algorithm, interpolates=interpolates)
    acts = (K >= 10) & (K < 70) & ((K - 10) % 12 < 5)
    assert np.array_equal(recording["source.y"], recording["source.y@true"] + acts)
    answer = [0.0]
    for k in range(STEPS):
        answer.append(0.9 * answer[-1] + 0.1 * acts[k])
    clean = run(algorithm=algorithm, interpolates=interpolates)
    np.testing.assert_allclose(recording["lag.y"] - clean["lag.y"], answer, atol=1e-14)


@ALGORITHMS
@RECEIVERS
def test_a_drift_begins_anew_each_time_where_it_begins(algorithm, interpolates):
    """1.03 s is no communication point: it has grown by 0.07 s at 1.1 s. Wrong: it goes on where it was."""
    drift = Fault("x", "source.y", "drift", 1.03, rate=2.0, on=0.5, off=0.7)
    recording = run(drift, algorithm=algorithm, interpolates=interpolates)
    phase = (K * H - 1.03 + 1e-9) % 1.2
    added = np.where((K * H >= 1.03) & (phase < 0.5), 2.0 * phase, 0.0)
    np.testing.assert_allclose(recording["source.y"] - recording["source.y@true"], added, atol=1e-8)
    pushed = recording["lag.y"][1:] - 0.9 * recording["lag.y"][:-1]
    clean = run(algorithm=algorithm, interpolates=interpolates)["lag.y"]
    later = 0.0 if algorithm == "jacobi" else 2.0 * H / 2 if interpolates else 2.0 * H
    usual = clean[1:] - 0.9 * clean[:-1]
    np.testing.assert_allclose(pushed - usual, 0.1 * (added + later * (added > 0))[:-1], atol=1e-8)


@ALGORITHMS
def test_what_is_stuck_sticks_each_time_at_another_value(algorithm):
    recording = run(Fault("x", "source.y", "stuck", 1.0, on=0.5, off=0.7), algorithm=algorithm)
    v = recording["source.y@true"]
    begin = K - (K - 10) % 12
    assert np.array_equal(recording["source.y"], np.where((K >= 10) & ((K - 10) % 12 < 5), v[begin - 1], v))
    assert len(set(recording["source.y"][10:15])) == 1 and recording["source.y"][10] != recording["source.y"][22]


@ALGORITHMS
def test_periods_are_counted_anew_each_time(algorithm):
    spike = Fault("x", "source.y", "spike", 1.0, value=4.0, every=0.3, on=0.5, off=0.7)
    recording = run(spike, algorithm=algorithm)
    n = (K - 10) % 12
    added = np.where((K >= 10) & ((n == 0) | (n == 3)), 4.0, 0.0)
    np.testing.assert_allclose(recording["source.y"] - recording["source.y@true"], added, atol=1e-14)
    slow = run(Fault("x", "source.y", "slow", 1.0, period=0.3, on=0.5, off=0.7), algorithm=algorithm)
    v = slow["source.y@true"]
    assert np.array_equal(slow["source.y"], np.where((K >= 10) & (n < 5), v[np.maximum(K - n % 3, 0)], v))


@ALGORITHMS
def test_an_input_is_given_back_each_time(algorithm):
    drive = Fault("x", "source.u", "input", 1.0, value=3.0, on=0.5, off=0.7)
    recording = run(drive, algorithm=algorithm, record=["source.u"])
    assert np.array_equal(recording["source.u"], np.where((K >= 10) & ((K - 10) % 12 < 5), 3.0, 0.5))


@ALGORITHMS
def test_what_is_seen_in_one_of_its_times_only_is_seen(algorithm):
    """Another fault hides it all the time but for its third one; wrong: it is looked at in the first one only."""
    late = bias(start=1.0, on=0.5, off=0.7)
    hides = Fault("y", "source.y", "stuck", 0.0, 3.4, value=1.0)
    assert not run(late, hides, algorithm=algorithm).idle
    assert set(run(late, Fault("y", "source.y", "stuck", value=1.0), algorithm=algorithm).idle) == set()
    assert plan(late, Fault("y", "source.y", "stuck", value=1.0)).idle == {
        "x": "is hidden: all the time another fault sets 'source.y'"
    }


# ---- at random -------------------------------------------------------------------------------------------------------


def drawn(name, seed, n, mttf, mttr, shape=1.0):
    """From when to when the first n failures last (s)."""
    import zlib

    key = seed, 2**32 + (zlib.crc32(name.encode()) & 0x7FFFFFFF)
    time, found = 0.0, []
    for j in range(n):
        up, down = (((word >> 11) + 0.5) * 2.0**-53 for word in words(key, (0, j, 0, 1))[:2])
        time += mttf / math.gamma(1 + 1 / shape) * (-math.log(up)) ** (1 / shape)
        found.append((time, time - mttr * math.log(down)))
        time = found[-1][1]
    return found


@ALGORITHMS
@RECEIVERS
@pytest.mark.parametrize("shape", [None, 2.5])
def test_times_at_random_are_those_of_the_seed(shape, interpolates, algorithm):
    more = {} if shape is None else {"shape": shape}
    faults = [bias(mttf=1.5, mttr=0.8, **more)]
    recording = run(*faults, algorithm=algorithm, interpolates=interpolates, seed=5)
    acts = sum((K * H >= a) & (K * H < b) for a, b in drawn("x", 5, 40, 1.5, 0.8, shape or 1.0))
    assert np.array_equal(recording["source.y"], recording["source.y@true"] + acts) and 5 < acts.sum() < 95
    clean, answer = run(algorithm=algorithm, interpolates=interpolates), [0.0]
    for k in range(STEPS):
        answer.append(0.9 * answer[-1] + 0.1 * acts[k])
    np.testing.assert_allclose(recording["lag.y"] - clean["lag.y"], answer, atol=1e-14)


def test_times_at_random_do_not_depend_on_the_step_or_on_other_faults():
    fault = bias(mttf=1.5, mttr=0.8)
    one = plan(fault, step=0.1).windows["start"]
    two = plan(bias("y", mttf=0.3, mttr=0.3), fault, step=0.05).windows["start"]
    assert set(one) <= set(two) and len(one) > 2
    assert set(plan(fault, seed=2).windows["start"]).isdisjoint(one)


def test_a_failure_stays_without_a_time_to_repair_and_ends_with_its_duration():
    ((time, _),) = drawn("x", 1, 1, 1.5, 1.0)
    assert windows(bias(mttf=1.5)) == [(math.ceil(time / H), 2**62)]
    (end,) = {end for _, end in windows(bias(start=1.0, duration=8.0, mttf=1.5))}
    assert end == 90
    on = windows(bias(mttf=1.5, on=0.5, off=0.5))
    assert [first - on[0][0] for first, _ in on] == [10 * n for n in range(len(on))]


@pytest.mark.parametrize("shape", [1.0, 2.0, 0.7])
def test_times_to_failure_and_repair_have_their_distributions(shape):
    """2000 failures: Kolmogorov-Smirnov at 0.1 %, mean within 4 standard errors; wrong: scale taken for mean."""
    found = plan(bias(mttf=100.0, mttr=20.0, shape=shape), step=0.01, stop=300_000.0).windows
    start, end = found["start"], found["end"] * 0.01
    up, down = np.diff(start) - (end - start)[:-1], (end - start)
    up, down = up[:2000], down[:2000]
    assert len(up) == 2000
    scale = 100.0 / math.gamma(1 + 1 / shape)
    assert stats.kstest(up, "weibull_min", args=(shape, 0, scale)).pvalue > 1e-3
    assert stats.kstest(down, "expon", args=(0, 20.0)).pvalue > 1e-3
    assert abs(up.mean() - 100.0) < 4 * stats.weibull_min.std(shape, 0, scale) / math.sqrt(2000)
    assert abs(down.mean() - 20.0) < 4 * 20.0 / math.sqrt(2000)
    assert abs(stats.spearmanr(up, down[: len(up)]).statistic) < 4 / math.sqrt(2000)


def test_faults_of_one_cause_fail_at_the_same_times_and_others_do_not():
    def pair(**more):
        one, two = (
            Fault(n, f"source.{v}", "bias", value=1.0, mttf=1.0, mttr=1.0, **more)
            for n, v in (("a", "y"), ("b", "seen"))
        )
        made = plan(one, two)
        rows = [made.windows[t["window"] : t["last"]].tolist() for t in made.triggers]
        return rows[0], rows[1]

    one, two = pair(cause="bus")
    assert one == two and len(one) > 2
    one, two = pair()
    assert one != two
    assert pair(cause="bus")[0] != pair(cause="bus 2")[0] != one


def test_a_fault_at_random_that_does_not_occur_is_told_and_no_finding():
    rare = bias(mttf=1e9)
    made = plan(rare)
    assert not made.idle
    assert made.notes == ("fault 'x' does not occur: it fails at random, and not before the end of the run",)
    assert not run_both(made).idle
    assert plan(bias(mttf=1e9, duration=5.0)).notes == made.notes
    assert run(bias(mttf=1e9, duration=5.0)).idle == {}


@pytest.mark.parametrize("kind", [{"type": "stuck"}, {"type": "delay", "delay": 0.3}, {"type": "slow", "period": 0.3}])
def test_what_would_remember_a_fault_but_does_not_occur_remembers_nothing(kind):
    """Wrong: what remembers is asked for its last time, and has none."""
    rare = Fault("y", "source.y", duration=5.0, mttf=1e9, **kind)
    made = make_plan([probe("source")], [], step=H, stop=10.0, faults=[bias(start=1.0), rare], record_period=1.0)
    assert not made.idle and not run_both(made).idle


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"on": 1.0}, "'on' needs 'off' beside it"),
        ({"off": 1.0}, "'off' needs 'on' beside it"),
        ({"on": 0.0, "off": 1.0}, "'on' must be a positive time in s, not 0"),
        ({"on": 0.05, "off": 1.0}, r"'on' 0\.05 s is shorter than the step 0\.1 s; some of its times would hold no"),
        ({"on": "1 s", "off": "50 ms"}, r"'off' 0\.05 s is shorter than the step 0\.1 s"),
        ({"mttr": 1.0}, "'mttr' needs 'mttf' beside it"),
        ({"cause": "bus"}, "'cause' needs 'mttf' beside it"),
        ({"shape": 2}, "'shape' needs 'mttf' beside it"),
        ({"mttf": 1.0, "shape": 0}, "'shape' must be a positive number, not 0"),
        ({"mttf": "1 x"}, "'x' is no unit of time"),
        ({"mttf": 1e-9}, "'mttf' 1e-09 s is shorter than the step"),
        ({"mttf": 1.0, "cause": ""}, "'cause' must be a text that is not empty"),
        ({"shap": 1.0}, "type 'bias' has no parameter 'shap'; did you mean 'shape'"),
    ],
)
def test_what_cannot_be_is_a_sentence(given, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan(bias(**given))


def test_faults_of_one_cause_have_the_same_times():
    one, two = (bias(name, mttf=1.0, mttr=mttr, cause="bus") for name, mttr in (("a", 1.0), ("b", 2.0)))
    with pytest.raises(NavfmuError, match="fault 'b': it has the cause 'bus' of fault 'a', but another 'mttr'"):
        plan(one, two)
    with pytest.raises(NavfmuError, match="but another 'start'"):
        plan(one, bias("b", mttf=1.0, mttr=1.0, cause="bus", start=1.0))
