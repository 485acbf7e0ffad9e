"""Each fault type against a closed form. Both engines make every run and must agree to the last bit.

``source`` holds 2 at its output y; ``lag`` follows it by y <- 0.9 y + 0.1 u (tau = 1 s, h = 0.1 s) from 2 on.
"""

import numpy as np
import pytest

from navfmu.engine import compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.faults import Fault
from tests.engine.probe import probe, rows, simulate

H = 0.1
FIRST, END = 20, 50  # communication points of the window
START, DURATION = 2.0, 3.0
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
RECEIVERS = pytest.mark.parametrize("interpolates", [True, False], ids=["interpolating", "plain"])
RECORD = ["source.y", "source.y@true", "lag.y", "lag.seen", "lag.slope", "lag.current"]


def run(*faults, algorithm="jacobi", record=RECORD, interpolates=True, step=H, **start):
    source = probe("source", **({"start": 2.0, "u": 2.0} | start))
    components = [source, probe("lag", interpolates=interpolates, start=2.0)]
    connections = [
        Link("source.y", "lag.u"),
        Link("source.data.sequence", "lag.number"),
        Link("source.data.valid", "lag.flag"),
    ]
    return simulate((components, connections), step=step, stop=10.0, algorithm=algorithm, faults=faults, record=record)


def fault(kind, target="source.y", start=START, duration=DURATION, **parameters):
    return Fault("x", target, kind, start, duration, parameters)


def inside(k):
    return (k >= FIRST) & (k < END)


def response(k):
    """Answer of the lag to a unit pulse over the window."""
    n, m = np.maximum(k - FIRST, 0), np.maximum(k - END, 0)
    return (1 - 0.9**n) - (1 - 0.9**m)


@ALGORITHMS
@RECEIVERS
@pytest.mark.parametrize(
    ("kind", "parameters"),
    [("bias", {"value": 1.0}), ("stuck", {"value": 7.0}), ("noise", {"sigma": 1.0, "period": 0.1})],
)
def test_the_first_effect_on_a_lag_is_seen_one_step_after_the_start(algorithm, interpolates, kind, parameters):
    """At 0.6 s and not at 0.5 s, and the last one step after the end, where source and lag move."""
    options = {"algorithm": algorithm, "interpolates": interpolates, "u": 0.0}
    clean, faulted = run(**options), run(fault(kind, start=0.5, duration=0.3, **parameters), **options)
    pushed = faulted["lag.y"][1:] - 0.9 * faulted["lag.y"][:-1]  # 0.1 * the input over each step
    usual = clean["lag.y"][1:] - 0.9 * clean["lag.y"][:-1]
    assert np.flatnonzero(np.abs(pushed - usual) > 1e-12).tolist() == [5, 6, 7]
    assert faulted["lag.y"][5] == clean["lag.y"][5] and faulted["lag.y"][6] != clean["lag.y"][6]


@RECEIVERS
def test_a_drift_is_continued_to_the_end_of_the_step(interpolates):
    """It is 0 at its start, so that its first effect is what it has grown by half a step, or a whole one, later."""
    recording = run(
        fault("drift", start=0.5, duration=0.3, rate=1.0), algorithm="gauss_seidel", interpolates=interpolates
    )
    pushed = recording["lag.y"][1:] - 0.9 * recording["lag.y"][:-1] - 0.2
    later = 0.05 if interpolates else 0.1
    np.testing.assert_allclose(pushed[4:9], 0.1 * np.array([0, later, 0.1 + later, 0.2 + later, 0]), atol=1e-15)


@RECEIVERS
def test_what_is_not_continuous_is_the_newest_with_its_fault(interpolates):
    """The source's samples are discrete: the receiver gets what left at the end of the step."""
    components = [probe("source"), probe("lag", interpolates=interpolates)]
    links = [Link("source.data.value", "lag.u"), Link("source.data.sequence", "lag.number")]
    faults = [
        Fault("value", "source.data.value", "bias", 0.5, 0.3, {"value": 100.0}),
        Fault("number", "source.data.sequence", "stuck", 0.5, 0.3, {"value": 99}),
    ]
    record = ["lag.seen", "lag.echo", "source.data.value", "source.data.sequence"]
    recording = simulate((components, links), step=H, stop=2.0, faults=faults, record=record)
    assert np.array_equal(recording["lag.seen"], recording["source.data.value"])
    assert np.array_equal(recording["lag.echo"], recording["source.data.sequence"])
    assert np.flatnonzero(recording["lag.echo"] == 99).tolist() == [5, 6, 7]


@ALGORITHMS
@RECEIVERS
def test_bias_acts_from_the_first_point_to_the_last_and_not_before(algorithm, interpolates):
    recording = run(fault("bias", value=0.5), algorithm=algorithm, interpolates=interpolates)
    k = rows(recording)
    assert np.array_equal(recording["source.y"], np.where(inside(k), 2.5, 2.0))
    assert np.array_equal(recording["source.y@true"], np.full(101, 2.0))
    np.testing.assert_allclose(recording["lag.y"], 2.0 + 0.5 * response(k), rtol=1e-14)
    assert not recording["lag.slope"].any()  # a step at the communication point, not a ramp before it


@RECEIVERS
def test_bias_adds_to_a_moving_signal_without_touching_its_slope(interpolates):
    clean = run(algorithm="gauss_seidel", u=0.0, interpolates=interpolates)
    biased = run(fault("bias", value=0.5), algorithm="gauss_seidel", u=0.0, interpolates=interpolates)
    k = rows(clean)
    np.testing.assert_allclose(biased["lag.slope"], clean["lag.slope"], atol=1e-14)
    np.testing.assert_allclose(biased["lag.y"] - clean["lag.y"], 0.5 * response(k), atol=1e-14)


@ALGORITHMS
@RECEIVERS
def test_drift_grows_from_the_start_and_is_cleared_at_once(algorithm, interpolates):
    recording = run(fault("drift", rate=0.3), algorithm=algorithm, interpolates=interpolates)
    k = rows(recording)
    np.testing.assert_allclose(recording["source.y"], 2.0 + np.where(inside(k), 0.3 * (k - FIRST) * H, 0), rtol=1e-15)
    n = np.arange(END - FIRST + 1)
    # y <- 0.9 y + 0.1 * (r h n) has the solution r h (n - 10 (1 - 0.9^n)); the line between the points adds r h / 2,
    # the value at the end of each step r h
    ramp = 0.3 * H * (n - 10 * (1 - 0.9**n))
    if algorithm == "gauss_seidel":
        ramp += (0.3 * H / 2 if interpolates else 0.3 * H) * (1 - 0.9**n)
    np.testing.assert_allclose(recording["lag.y"][FIRST : END + 1], 2.0 + ramp, rtol=1e-13)
    np.testing.assert_allclose(recording["lag.y"][END:], 2.0 + ramp[-1] * 0.9 ** np.arange(101 - END), rtol=1e-13)
    assert np.all(recording["source.y"][END:] == 2.0)


@ALGORITHMS
@RECEIVERS
def test_stuck_at_a_given_value(algorithm, interpolates):
    recording = run(fault("stuck", value=5.0), algorithm=algorithm, u=0.0, interpolates=interpolates)
    k = rows(recording)
    clean = run(algorithm=algorithm, u=0.0, interpolates=interpolates)
    assert np.array_equal(recording["source.y"], np.where(inside(k), 5.0, clean["source.y"]))
    begin = clean["lag.y"][FIRST]
    n = np.arange(END - FIRST + 1)
    np.testing.assert_allclose(recording["lag.y"][FIRST : END + 1], 5.0 + (begin - 5.0) * 0.9**n, rtol=1e-13)


@ALGORITHMS
def test_stuck_at_the_last_value_that_left_before_the_window(algorithm):
    recording = run(fault("stuck"), algorithm=algorithm, u=0.0)
    clean = run(algorithm=algorithm, u=0.0)
    k = rows(recording)
    last = clean["source.y"][FIRST - 1]
    assert np.array_equal(recording["source.y"], np.where(inside(k), last, clean["source.y"]))
    assert np.array_equal(recording["source.y@true"], clean["source.y"])
    assert not recording["lag.slope"][FIRST + 1 : END + 1].any()


@ALGORITHMS
def test_a_whole_number_and_a_truth_value_can_be_stuck(algorithm):
    faults = [
        Fault("n", "source.data.sequence", "stuck", START, DURATION, {"value": 7}),
        Fault("b", "source.data.valid", "stuck", START, DURATION, {"value": False}),
    ]
    recording = run(*faults, algorithm=algorithm, record=["source.data", "lag.echo", "lag.flag_echo"])
    k = rows(recording)
    assert np.array_equal(recording["source.data.sequence"], np.where(inside(k), 7, k))
    delay = 1 if algorithm == "jacobi" else 0
    seen, flags = recording["source.data.sequence"], recording["source.data.valid"]
    assert np.array_equal(recording["lag.echo"][delay:], seen[: 101 - delay])
    assert np.array_equal(recording["lag.flag_echo"][delay:], flags[: 101 - delay])


@ALGORITHMS
def test_dropout_holds_the_bundle_and_makes_it_invalid(algorithm):
    members = [f"source.data.{name}" for name in ("valid", "sequence", "value", "time_of_validity")]
    record = [*members, *(f"{name}@true" for name in members)]
    recording = run(fault("dropout", "source.data"), algorithm=algorithm, record=record)
    k = rows(recording)
    assert np.array_equal(recording["source.data.valid"], (k > 0) & ~inside(k))
    for name in members[1:]:
        true = recording[f"{name}@true"]
        assert np.array_equal(recording[name], np.where(inside(k), true[FIRST - 1], true))
    assert np.array_equal(recording["source.data.sequence@true"], k)


@ALGORITHMS
def test_noise_has_its_own_period_and_does_not_depend_on_the_step(algorithm):
    noisy = fault("noise", sigma=0.2, period=0.25)
    coarse, fine = run(noisy, algorithm=algorithm), run(noisy, algorithm=algorithm, step=H / 2)
    assert np.array_equal(coarse["source.y"], fine["source.y"][::2])
    k = rows(coarse)
    added = coarse["source.y"] - coarse["source.y@true"]
    assert not added[~inside(k)].any()
    number = k * 2 // 5  # floor(t / 0.25 s) in whole numbers
    for j in set(number[inside(k)]):
        assert len(set(coarse["source.y"][inside(k) & (number == j)])) == 1
    assert len(set(coarse["source.y"][inside(k)])) == 12
    assert not coarse["lag.slope"].any()


@ALGORITHMS
@RECEIVERS
def test_the_lag_answers_noise_as_it_answers_its_samples(algorithm, interpolates):
    recording = run(fault("noise", sigma=0.2, period=0.1), algorithm=algorithm, interpolates=interpolates)
    expected = [2.0]
    for u in recording["source.y"][:-1]:
        expected.append(expected[-1] + 0.1 * (u - expected[-1]))
    np.testing.assert_allclose(recording["lag.y"], expected, rtol=1e-14)


def test_two_seeds_give_two_noises_and_one_seed_the_same():
    system = [probe("a")], []
    faults = [fault("noise", "a.y", 0.0, 10.0, sigma=1.0, period=0.1)]
    plans = [make_plan(*system, step=H, stop=10.0, faults=faults, seed=seed) for seed in (1, 1, 2)]
    first, again, other = (compiled.run(plan)["a.y"] for plan in plans)
    assert np.array_equal(first, again)
    assert not np.any(first[:-1] == other[:-1])  # the last point lies behind the window


@ALGORITHMS
def test_an_unconnected_input_is_driven_and_given_back(algorithm):
    recording = run(fault("input", "source.u", value=3.0), algorithm=algorithm, record=["source.y", "source.u"])
    k = rows(recording)
    assert np.array_equal(recording["source.u"], np.where(inside(k), 3.0, 2.0))
    np.testing.assert_allclose(recording["source.y"], 2.0 + response(k), rtol=1e-14)


@ALGORITHMS
def test_a_truth_value_input_is_driven_to_true(algorithm):
    drive = fault("input", "source.flag")
    recording = run(drive, algorithm=algorithm, record=["source.flag", "source.flag_echo"])
    k = rows(recording)
    assert np.array_equal(recording["source.flag"], inside(k))
    assert np.array_equal(recording["source.flag_echo"][1:], inside(k)[:-1])  # held from t_k to the next


@ALGORITHMS
def test_a_tunable_parameter_changes_and_comes_back(algorithm):
    doubled = fault("parameter", "source.gain", value=2.0)
    recording = run(doubled, algorithm=algorithm, record=["source.y", "source.gain"])
    k = rows(recording)
    assert np.array_equal(recording["source.gain"], np.where(inside(k), 2.0, 1.0))
    np.testing.assert_allclose(recording["source.y"], 2.0 + 2.0 * response(k), rtol=1e-14)


@ALGORITHMS
def test_a_parameter_comes_back_to_its_start_value_of_this_run(algorithm):
    recording = run(fault("parameter", "source.gain", value=2.0), algorithm=algorithm, record=["source.gain"], gain=0.5)
    assert np.array_equal(recording["source.gain"], np.where(inside(rows(recording)), 2.0, 0.5))


@ALGORITHMS
@RECEIVERS
def test_a_fault_from_the_start_acts_on_the_initial_outputs(algorithm, interpolates):
    recording = run(fault("bias", start=0.0, value=0.5), algorithm=algorithm, interpolates=interpolates)
    assert recording["source.y"][0] == 2.5
    assert recording["lag.current"][0] == 102.5  # what the lag computed from its input while initialising
    driven = run(fault("input", "source.u", start=0.0, value=3.0), algorithm=algorithm, record=["source.current"])
    assert driven["source.current"][0] == 103.0
    stuck = run(fault("stuck", start=0.0), algorithm=algorithm, u=0.0)
    assert np.all(stuck["source.y"][:30] == 2.0)
    assert stuck["source.y"][30] == stuck["source.y@true"][30] != 2.0


@ALGORITHMS
def test_faults_on_one_signal_act_in_the_order_of_the_file(algorithm):
    bias = Fault("bias", "source.y", "bias", START, DURATION, {"value": 1.0})
    stuck = Fault("stuck", "source.y", "stuck", START, DURATION, {"value": 5.0})
    assert run(bias, stuck, algorithm=algorithm)["source.y"][FIRST] == 5.0
    assert run(stuck, bias, algorithm=algorithm)["source.y"][FIRST] == 6.0
    hold = Fault("hold", "source.y", "stuck", START, DURATION)
    held = run(hold, bias, algorithm=algorithm, u=0.0)
    assert np.all(held["source.y"][FIRST:END] == held["source.y"][FIRST - 1] + 1.0)


@ALGORITHMS
def test_clearing_a_fault_restores_the_output_bit_for_bit(algorithm):
    clean = run(algorithm=algorithm, u=0.7, record=["source.*"])
    faults = [
        fault("bias", value=0.1),
        Fault("d", "source.y", "drift", START, DURATION, {"rate": 0.1}),
        Fault("s", "source.seen", "stuck", START, DURATION),
        Fault("n", "source.slope", "noise", START, DURATION, {"sigma": 1.0, "period": 0.1}),
        Fault("o", "source.data", "dropout", START, DURATION),
    ]
    faulted = run(*faults, algorithm=algorithm, u=0.7, record=["source.*"])
    assert faulted.values[:FIRST].tobytes() == clean.values[:FIRST].tobytes()
    assert faulted.values[END:].tobytes() == clean.values[END:].tobytes()
    assert faulted.values[FIRST:END].tobytes() != clean.values[FIRST:END].tobytes()


@ALGORITHMS
@pytest.mark.parametrize("seed", range(12))
def test_random_faults_act_alike_in_both_engines(seed, algorithm):
    rng = np.random.default_rng(seed)
    menu = [
        ("source.y", "bias", lambda: {"value": float(rng.normal())}),
        ("source.y", "drift", lambda: {"rate": float(rng.normal())}),
        ("source.y", "stuck", lambda: {}),
        ("lag.y", "stuck", lambda: {"value": float(rng.normal())}),
        ("lag.data", "dropout", lambda: {}),
        ("source.data", "dropout", lambda: {}),
        ("source.y", "noise", lambda: {"sigma": 0.3, "period": float(rng.choice([0.01, 0.07, 0.1, 1 / 3]))}),
        ("lag.seen", "noise", lambda: {"sigma": 0.3, "period": 0.1, "stream": int(rng.integers(100))}),
        ("source.flag", "input", lambda: {}),
        ("source.number", "input", lambda: {"value": int(rng.integers(10))}),
        ("source.u", "input", lambda: {"value": float(rng.normal())}),
        ("lag.gain", "parameter", lambda: {"value": float(rng.uniform(0, 2))}),
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
    for number in range(12):
        target, kind, parameters = menu[rng.integers(len(menu))]
        start, duration = float(rng.choice([0.0, rng.uniform(0, 8)])), float(rng.uniform(0.2, 8))
        turns = {"on": 0.1 * int(rng.integers(1, 9)), "off": 0.1 * int(rng.integers(1, 9))}
        given = parameters() | (turns if rng.integers(2) else {})
        faults.append(Fault(f"f{number}", target, kind, start, duration, given))
    record = ["*", "source.*@true", "lag.*@true"]
    recording = run(*faults, algorithm=algorithm, u=1.0, interpolates=bool(seed % 2), record=record)
    assert np.isfinite(recording.values).all()
