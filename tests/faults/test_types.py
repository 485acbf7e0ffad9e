"""Each type of fault, at an output and at a connected input, against what it makes of a known signal.

``source`` falls from 2 to 0.5 by v(k) = 0.5 + 1.5 * 0.9^k at its output y; ``lag`` follows by y <- 0.9 y + 0.1 x, where
x is what it takes over a step. With `left` what leaves at t_k, and `ahead` what is there just before t_{k+1} under the
fault of t_k, x is left (Jacobi), their mean (Gauss-Seidel along a line) or ahead (Gauss-Seidel, no line). Both engines
make every run and must agree to the last bit.
"""

import dataclasses

import numpy as np
import pytest

from navfmu.engine.link import Link
from navfmu.faults import TYPES, Fault
from navfmu.fmi.units import Unit
from tests.engine.probe import probe, simulate
from tests.faults.philox import uniform

H, STEPS = 0.1, 100
FIRST, END = 20, 50
START, DURATION = 2.0, 3.0
ALGORITHMS = pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
RECEIVERS = pytest.mark.parametrize("interpolates", [True, False], ids=["interpolating", "plain"])
TARGETS = pytest.mark.parametrize("target", ["source.y", "lag.u"])
WINDOW = np.arange(FIRST, END)


def run(*faults, algorithm="jacobi", interpolates=True, record=(), factor=1.0, offset=0.0, first="source", **more):
    components = [
        probe("source", interpolates=interpolates, start=2.0, u=0.5),
        probe("lag", interpolates=interpolates, start=2.0 * factor + offset),
        probe("other", interpolates=interpolates, start=2.0),
    ]
    components.sort(key=lambda component: component.name != first)
    links = [
        Link("source.y", "lag.u", factor, offset),
        Link("source.y", "other.u"),
        Link("source.data.sequence", "lag.number"),
        Link("source.data.valid", "lag.flag"),
    ]
    record = ["source.y", "source.y@true", "lag.u", "lag.y", "other.y", "other.u", *record]
    options = {"step": H, "stop": STEPS * H, "record": record, "algorithm": algorithm} | more
    return simulate((components, links), faults=faults, **options)


def fault(kind, target, **parameters):
    return Fault("x", target, kind, START, DURATION, parameters)


STREAM = 7


def number(j):
    return uniform(1, STREAM, 0, int(j))


def held(v, k, period):
    """The v at which the last of the periods from FIRST on began, each of so many steps."""
    return v[FIRST + (k - FIRST) // period * period]


def late(k, jitter=0.0, steps=1):
    return np.array([int(np.ceil(7 + jitter * number(n // steps))) for n in k])


# type, parameters, what leaves at k and what is there just before k + 1, from the signal v and the points k
CASES = {
    "scale": ({"factor": -0.3}, lambda v, k: v[k] * -0.3, lambda v, k: v[k + 1] * -0.3),
    "flip": ({}, lambda v, k: -v[k], lambda v, k: -v[k + 1]),
    "saturate": (
        {"low": 0.515, "high": 0.6},
        lambda v, k: np.clip(v[k], 0.515, 0.6),
        lambda v, k: np.clip(v[k + 1], 0.515, 0.6),
    ),
    "quantise": (
        {"step": 0.03},
        lambda v, k: np.rint(v[k] / 0.03) * 0.03,
        lambda v, k: np.rint(v[k + 1] / 0.03) * 0.03,
    ),
    "spike": (
        {"value": 3.0, "every": 0.7},
        lambda v, k: v[k] + 3.0 * ((k - FIRST) % 7 == 0),
        lambda v, k: v[k + 1] + 3.0 * ((k - FIRST) % 7 == 0),
    ),
    "garbage": (
        {"low": -2.0, "high": 5.0, "period": 0.4, "stream": STREAM},
        lambda v, k: np.array([-2.0 + 7.0 * number(n // 4) for n in k]),
        lambda v, k: np.array([-2.0 + 7.0 * number(n // 4) for n in k]),
    ),
    "delay": ({"delay": 0.65}, lambda v, k: v[k - 7], lambda v, k: v[k + 1 - 7]),
    "jitter": (
        {"delay": 0.7, "jitter": 0.5, "period": 0.2, "stream": STREAM},
        lambda v, k: v[k - late(k, 5.0, 2)],
        lambda v, k: v[k + 1 - late(k, 5.0, 2)],
    ),
    "slow": ({"period": 0.6}, lambda v, k: held(v, k, 6), lambda v, k: held(v, k, 6)),
    "bias": ({"value": 0.5}, lambda v, k: v[k] + 0.5, lambda v, k: v[k + 1] + 0.5),
    "drift": (
        {"rate": 0.3},
        lambda v, k: v[k] + 0.3 * (k * H - START),
        lambda v, k: v[k + 1] + 0.3 * ((k + 1) * H - START),
    ),
    "stuck": ({}, lambda v, k: np.full(len(k), v[FIRST - 1]), lambda v, k: np.full(len(k), v[FIRST - 1])),
}


def answer(left, ahead, begin, algorithm, interpolates):
    """What the lag makes of what it takes."""
    taken = left[:-1] if algorithm == "jacobi" else (left[:-1] + ahead) / 2 if interpolates else ahead
    y = [begin]
    for x in taken:
        y.append(0.9 * y[-1] + 0.1 * x)
    return np.array(y)


@ALGORITHMS
@RECEIVERS
@TARGETS
@pytest.mark.parametrize("name", CASES)
def test_what_leaves_and_what_a_lag_makes_of_it(name, target, interpolates, algorithm):
    """Wrong: a fault that ramps up to its start, that is seen one step early, or at an output by one receiver only."""
    parameters, leaves, lies_ahead = CASES[name]
    factor, offset = (2.0, 1.0) if target == "lag.u" else (1.0, 0.0)
    options = {"algorithm": algorithm, "interpolates": interpolates, "factor": factor, "offset": offset}
    kind = "delay" if name == "jitter" else name
    recording = run(fault(kind, target, **parameters), **options)
    clean = run(**options)
    assert np.array_equal(recording["source.y@true"], clean["source.y"])
    v = clean[target]
    np.testing.assert_allclose(v, factor * (0.5 + 1.5 * 0.9 ** np.arange(STEPS + 1)) + offset, rtol=1e-13)
    left, ahead = v.copy(), v[1:].copy()
    left[FIRST:END], ahead[FIRST:END] = leaves(v, WINDOW), lies_ahead(v, WINDOW)
    np.testing.assert_allclose(recording[target], left, rtol=1e-15, atol=1e-15)
    assert recording[target][:FIRST].tobytes() == v[:FIRST].tobytes()
    assert recording[target][END:].tobytes() == v[END:].tobytes()
    assert not np.array_equal(recording[target], v)
    expected = answer(left, ahead, 2.0 * factor + offset, algorithm, interpolates)
    np.testing.assert_allclose(recording["lag.y"], expected, rtol=1e-12, atol=1e-13)
    same = np.array_equal(recording["other.y"], clean["other.y"])
    assert same == (target == "lag.u")  # a fault at an input is that of one receiver
    assert np.array_equal(recording["source.y"], clean["source.y"]) == same


def test_every_type_of_a_signal_is_held_against_something():
    elsewhere = {"unit", "noise", "nan", "swap", "dropout"}
    assert {n for n, kind in TYPES.items() if "connected input" in kind.places} == (
        CASES.keys() - {"jitter"}
    ) | elsewhere


@ALGORITHMS
@RECEIVERS
@TARGETS
def test_a_number_in_a_wrong_unit(target, interpolates, algorithm):
    """2 km sent in ft is 6561.68; wrong: multiplied by the unit instead of divided, or its origin forgotten."""
    metre, kelvin = (tuple(int(name == b) for b in "kg m s A K mol cd rad".split()) for name in ("m", "K"))
    units = {"1": Unit("1", metre, 1000.0), "K": Unit("K", kelvin)}  # the probe's "1" stands for km
    source, lag = probe("source", u=2.0, start=2.0), probe("lag", interpolates=interpolates, start=2.0)

    def with_units(component):
        about = dataclasses.replace(component.description, units=units)
        return dataclasses.replace(component, fmu=dataclasses.replace(component.fmu, description=about))

    system = [with_units(source), with_units(lag)], [Link("source.y", "lag.u")]
    options = {"step": H, "stop": 10.0, "algorithm": algorithm, "record": ["lag.u", "lag.y"]}
    recording = simulate(system, faults=[fault("unit", target, unit="ft")], **options)
    n, m = (np.maximum(np.arange(STEPS + 1) - k, 0) for k in (FIRST, END))
    feet = 2000.0 / 0.3048
    np.testing.assert_allclose(recording["lag.u"][FIRST:END], feet, rtol=1e-15)
    np.testing.assert_allclose(recording["lag.y"], 2 + (feet - 2) * ((1 - 0.9**n) - (1 - 0.9**m)), rtol=1e-12)
    units["1"] = Unit("1", kelvin)
    recording = simulate(system, faults=[fault("unit", target, unit="degC")], **options)
    np.testing.assert_allclose(recording["lag.u"][FIRST:END], 2.0 - 273.15, rtol=1e-15)


@ALGORITHMS
@TARGETS
@pytest.mark.parametrize(("value", "expected"), [("nan", np.nan), ("inf", np.inf), ("-inf", -np.inf), (None, np.nan)])
def test_no_number(target, value, expected, algorithm):
    parameters = {} if value is None else {"value": value}
    recording, clean = run(fault("nan", target, **parameters), algorithm=algorithm), run(algorithm=algorithm)
    np.testing.assert_array_equal(recording[target][FIRST:END], expected)
    assert recording[target][END:].tobytes() == clean[target][END:].tobytes()
    assert np.isfinite(recording["lag.y"][: FIRST + 1]).all() and not np.isfinite(recording["lag.y"][FIRST + 1])


@ALGORITHMS
@RECEIVERS
@pytest.mark.parametrize("order", [[2, 1, 3], [2, 3, 1], [3, 2, 1]])
def test_elements_change_places_at_the_same_time(order, interpolates, algorithm):
    """Wrong: the second element gets what the first has got already, or has that as its true value."""
    targets = ["source.y", "source.seen", "source.current"]
    record = [*targets[1:], "source.seen@true", "source.current@true"]
    options = {"algorithm": algorithm, "interpolates": interpolates, "record": record}
    recording = run(fault("swap", targets, order=order), **options)
    clean = run(**options)
    for target, place in zip(targets, order, strict=True):
        expected = clean[target].copy()
        expected[FIRST:END] = clean[targets[place - 1]][FIRST:END]
        assert recording[target].tobytes() == expected.tobytes()
        assert recording[f"{target}@true"].tobytes() == clean[target].tobytes()
    v = clean[targets[order[0] - 1]]
    ahead = clean["source.y"][1:].copy()
    ahead[FIRST:END] = v[FIRST + 1 : END + 1]
    expected = answer(recording["source.y"], ahead, 2.0, algorithm, interpolates)
    np.testing.assert_allclose(recording["lag.y"], expected, rtol=1e-13)


def test_each_element_has_a_place():
    with pytest.raises(Exception, match="'order' has 3 places, the target has 2 elements"):
        run(fault("swap", ["source.y", "source.seen"], order=[2, 1, 3]))


def test_elements_of_two_components_cannot_change_places():
    with pytest.raises(Exception, match="elements of a swap must come from one component, not from 'source', 'lag'"):
        run(fault("swap", ["source.y", "lag.y"], order=[2, 1]))
    inputs = run(fault("swap", ["lag.u", "other.u"], order=[2, 1]), factor=3.0)
    assert inputs["lag.u"][FIRST] == inputs["source.y"][FIRST]
    assert inputs["other.u"][FIRST] == 3.0 * inputs["source.y"][FIRST]


def test_a_late_exchange_is_a_delay_of_one_step_at_the_input():
    """An input that gets the value of the point before: in Gauss-Seidel that of Jacobi, at one receiver only."""
    late_ = Fault("x", ["lag.u", "lag.number"], "delay", delay=H)
    options = {"interpolates": False, "record": ["lag.number", "lag.echo"]}
    recording = run(late_, algorithm="gauss_seidel", **options)
    on_time, jacobi = run(algorithm="gauss_seidel", **options), run(**options)
    for name in ("lag.y", "lag.echo"):
        assert np.array_equal(recording[name], jacobi[name]) and not np.array_equal(recording[name], on_time[name])
    for name in ("lag.u", "lag.number"):
        assert np.array_equal(recording[name][1:], on_time[name][:-1])
    assert np.array_equal(recording["other.y"], on_time["other.y"])


@ALGORITHMS
@pytest.mark.parametrize("start", [0.0, 0.3])
def test_before_the_first_value_there_is_the_first(start, algorithm):
    """A delay longer than the time so far; wrong: a value of 0, or one that has been overwritten."""
    late_ = Fault("x", "source.y", "delay", start, 1.0, {"delay": 0.5})
    recording = run(late_, algorithm=algorithm)
    v, k, first = recording["source.y@true"], np.arange(STEPS + 1), round(start / H)
    expected = np.where((k >= first) & (k < first + 10), v[np.maximum(k - 5, 0)], v)
    assert np.array_equal(recording["source.y"], expected)
    for delay in (9.9, 1e6, 1e300):
        ever = run(Fault("x", "source.y", "delay", start, 1.0, {"delay": delay}), algorithm=algorithm)
        assert np.all(ever["source.y"][first : first + 10] == 2.0)


@ALGORITHMS
@pytest.mark.parametrize("target", ["source.data", ["lag.number", "lag.flag"]])
def test_a_bundle_is_delayed_as_a_whole(target, algorithm):
    """Each with a jitter of its own would make bundles whose values do not belong to their time."""
    delayed = fault("delay", target, delay=0.2, jitter=0.8, stream=STREAM)
    names = ["source.data.sequence", "source.data.time_of_validity", "source.data.valid", "lag.number", "lag.flag"]
    recording = run(delayed, algorithm=algorithm, record=names)
    ago = np.array([int(np.ceil(2 + 8 * number(k))) for k in WINDOW])
    assert np.array_equal(recording["lag.number"][FIRST:END], WINDOW - ago)
    assert recording["lag.flag"][FIRST:END].all()
    if target == "source.data":
        seen, when = recording["source.data.sequence"], recording["source.data.time_of_validity"]
        np.testing.assert_allclose(when, seen * H, atol=1e-12)
        assert np.array_equal(seen[FIRST:END], WINDOW - ago)
    else:
        assert np.array_equal(recording["source.data.sequence"], np.arange(STEPS + 1))


@ALGORITHMS
def test_bundles_are_stuck_slow_or_no_numbers_with_all_their_members(algorithm):
    members = [f"source.data.{name}" for name in ("value", "time_of_validity", "sequence", "valid")]
    options = {"algorithm": algorithm, "record": members}
    clean = run(**options)
    stuck, slow, nan = (
        run(fault(kind, "source.data", **more), **options)
        for kind, more in (("stuck", {}), ("slow", {"period": 0.5}), ("nan", {}))
    )
    for member in members:
        v = clean[member]
        assert np.all(stuck[member][FIRST:END] == v[FIRST - 1])
        assert np.array_equal(slow[member][FIRST:END], held(v, WINDOW, 5))
        real = member in members[:2]
        assert np.isnan(nan[member][FIRST:END]).all() if real else np.array_equal(nan[member], v)
        for recording in (stuck, slow, nan):
            assert recording[member][END:].tobytes() == v[END:].tobytes()


@ALGORITHMS
def test_one_receiver_may_get_what_is_stale(algorithm):
    stale = [fault("stuck", ["lag.u", "lag.number", "lag.flag"])]
    record = ["lag.number", "lag.flag", "lag.echo", "source.data"]
    recording, clean = (run(*f, algorithm=algorithm, record=record) for f in (stale, []))
    for name in ("lag.u", "lag.number", "lag.flag"):
        assert np.all(recording[name][FIRST:END] == clean[name][FIRST - 1])
    delay = int(algorithm == "jacobi")
    assert np.array_equal(recording["lag.echo"][delay:], recording["lag.number"][: STEPS + 1 - delay])
    for name in recording.names:
        if not name.startswith("lag"):
            assert np.array_equal(recording[name], clean[name])


@ALGORITHMS
@pytest.mark.parametrize("first", ["source", "lag"])
def test_a_fault_at_an_input_acts_in_its_unit_from_the_start(first, algorithm):
    """The value that is set arrives with every bit, whatever the connection multiplies."""
    stuck = Fault("x", "lag.u", "stuck", 0.0, 3.0, {"value": 0.1})
    recording = run(stuck, factor=1 / 3, offset=0.7, algorithm=algorithm, record=["lag.current"], first=first)
    assert np.all(recording["lag.u"][:30] == 0.1) and recording["lag.current"][0] == 100.1
    clean = run(factor=1 / 3, offset=0.7, algorithm=algorithm, first=first)
    assert recording["lag.u"][30:].tobytes() == clean["lag.u"][30:].tobytes()


@ALGORITHMS
def test_a_fault_at_an_input_in_a_circle_acts_on_initial_values(algorithm):
    components = [probe("a", start=1.0), probe("b", start=2.0), probe("c", start=3.0)]
    links = [Link("a.y", "b.u"), Link("b.y", "c.u"), Link("c.y", "a.u"), Link("a.current", "c.number")][:3]
    bias = Fault("x", "b.u", "bias", 0.0, 1.0, {"value": 0.5})
    recording = simulate((components, links), step=H, stop=2.0, faults=[bias], algorithm=algorithm, record=["*", "b.u"])
    assert recording["b.current"][0] == 101.5 and recording["b.u"][0] == 1.5 and recording["a.y"][0] == 1.0


def test_input_and_output_may_fail_at_once():
    """What reaches the receiver has both, in the order in which it goes there, whatever that in the file."""
    out, into = fault("bias", "source.y", value=1.0), Fault("y", "lag.u", "scale", START, DURATION, {"factor": 10.0})
    for faults in ((out, into), (into, out)):
        recording = run(*faults, record=["other.u"])
        both = np.array([10.0 * (v + 1.0) for v in recording["source.y@true"][FIRST:END]])
        assert np.array_equal(recording["lag.u"][FIRST:END], both)
        np.testing.assert_allclose(recording["other.u"][FIRST:END], both / 10.0, rtol=1e-15)
        assert not recording.idle
