"""A sabotaged system gives, to the last bit, what the master's own injection gives, in every master at hand.

Where inputs are set before each step only, as in libcosim, Ecos and this project's Jacobi, what passes through a
saboteur is one communication step late: the same as a ``delay`` of one step before the faults. Saboteurs of inputs
that nothing else drives are not late. Nor is anything in a master that steps one component after the other, or sets
inputs and reads outputs that follow them directly at the same point.
"""

from __future__ import annotations

import warnings

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from navfmu import Fault, System
from navfmu.engine.link import TYPES as SORTS
from navfmu.faults import TYPES
from navfmu.fmi import names
from navfmu.ssp.writer import SystemSource
from tests.components import systems
from tests.sabotage.sabotaged import READING, RECEIVERS, STEPS, H, fly, foreign, last, late, own, package, same

START, DURATION = 2.0, 7.0  # s, of 10 s: the lag still knows of it at the end
TYPE = {
    "bias": {"value": 1.0},
    "scale": {"factor": -0.7},
    "flip": {},
    "drift": {"rate": 0.5},
    "unit": {"unit": "ft"},
    "saturate": {"low": -3.0, "high": 4.0},
    "quantise": {"step": 0.3},
    "stuck": {},
    "delay": {"delay": 0.5, "jitter": 1.0, "period": 0.5},
    "slow": {"period": 0.7},
    "noise": {"sigma": 1.0, "period": 0.25},
    "spike": {"value": 5.0, "every": 0.6},
    "garbage": {"low": -2.0, "high": 3.0, "period": 0.3},
    "nan": {"value": "inf"},
}


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # samples are lost, as the step is longer than their period
        yield


@pytest.fixture(scope="module")
def system():
    return System.load(systems.tracker())


def check(system, folder, targets, *faults, **given):
    """In all masters: the same as the faults themselves one step late, and something else than without the delay."""
    expected = own(system, *late(*targets), *faults, **given)
    package(system, folder / "it.ssp", *faults, **given)
    sabotaged = System.load(folder / "it.ssp")
    assert same(fly(sabotaged), expected)
    if targets:
        assert not same(own(system, *faults, **given), expected)
    for host, values in foreign(folder / "it.ssp", folder / "it").items():
        assert values == pytest.approx(last(expected), rel=0, abs=0, nan_ok=True), host
    return expected


@pytest.mark.parametrize("kind", TYPE)
def test_each_type_of_fault(system, tmp_path, kind):
    """A fault that begins or ends one point early or late fails, and so does a period counted from there."""
    check(system, tmp_path, ["truth.y"], Fault("it", "truth.y", kind, START, DURATION, TYPE[kind]))


def test_what_leaves_is_recorded_at_the_saboteur(system, tmp_path):
    """The component itself shows the true value."""
    fault = Fault("it", "truth.y", "bias", START, DURATION, value=1.0)
    package(system, tmp_path / "it.ssp", fault)
    found = fly(System.load(tmp_path / "it.ssp"), record=["truth.y", "truth_saboteur.y"])
    expected = own(system, *late("truth.y"), fault, record=["truth.y@true", "truth.y"])
    np.testing.assert_array_equal(found.to_numpy(), expected.to_numpy())


def test_all_types_of_signals_are_tried():
    others = {"dropout", "swap", "input", "parameter", "lost_step"}
    assert set(TYPE) | others == set(TYPES)


def test_several_faults_in_their_order_at_several_places(system, tmp_path):
    """An output that fails fails before the input of one receiver; the other receiver sees the output only."""
    faults = [
        Fault("a", "truth.y", "bias", 1.0, value=0.5),
        Fault("b", "lag.u", "scale", 2.0, 3.0, factor=2.0),
        Fault("c", "truth.y", "stuck", 4.0, 2.0),
        Fault("d", "sensor.reading.length", "quantise", 0.0, step=0.1),
    ]
    check(system, tmp_path, ["truth.y", "sensor.reading"], *faults)


@pytest.mark.parametrize("start", [0.0, 1e-3], ids=["at the first point", "at the second"])
def test_from_the_beginning(system, tmp_path, start):
    """What leaves at t = 0 leaves in initialisation mode."""
    check(system, tmp_path, ["truth.y"], Fault("it", "truth.y", "bias", start, 9.5, value=1.0))


def test_at_the_input_of_one_receiver(system, tmp_path):
    check(system, tmp_path, ["lag.u"], Fault("it", "lag.u", "drift", START, DURATION, rate=0.5))


def test_at_an_input_of_the_component_whose_output_it_is(tmp_path):
    """The input is not one more output of the component, to be taken from there."""
    source = SystemSource("loop", fmus=systems.fmus(), stop_time=STEPS * H, step=H)
    source.component("one", "lag.fmu").component("two", "lag.fmu").connect("one.y", "one.u").connect("one.y", "two.u")
    system = System.load(source.parameters("one", {"y0": 1.0}).pack(tmp_path / "loop.ssp"))
    fault = Fault("it", "one.u", "bias", START, 1.0, value=1.0)
    expected = own(system, *late("one.u"), fault, record=["one.y", "two.y"])
    package(system, tmp_path / "it.ssp", fault)
    assert same(fly(System.load(tmp_path / "it.ssp"), record=["one.y", "two.y"]), expected)


@pytest.mark.parametrize("kind", ["dropout", "stuck"])
def test_a_bundle(system, tmp_path, kind):
    check(system, tmp_path, ["sensor.reading"], Fault("it", "sensor.reading", kind, START, DURATION))


@pytest.mark.parametrize("target", ["sensor.reading.length", "estimator.reading.length"])
def test_a_bundle_stays_whole(system, tmp_path, target):
    """With one member alone late, a new number would announce the length of before."""
    late_ones = ["sensor.reading"] if target.startswith("sensor") else READING
    check(system, tmp_path, late_ones, Fault("it", target, "scale", START, DURATION, factor=2.0))


def test_windows_in_turns_and_at_random(system, tmp_path):
    """Random times are those of the seed that the package was written for."""
    faults = [
        Fault("turns", "truth.y", "bias", 1.0, on=0.5, off=0.7, value=1.0),
        Fault("chance", "sensor.reading", "dropout", mttf=2.0, mttr=0.5, shape=1.5),
    ]
    values = [check(system, tmp_path, ["truth.y", "sensor.reading"], *faults, seed=seed) for seed in (3, 4)]
    assert not same(*values)


def test_an_input_that_nothing_else_drives_is_not_late(system, tmp_path):
    check(system, tmp_path, [], Fault("it", "lag.bias", "input", START, DURATION, value=2.0))


def test_the_seed_of_noise_is_a_parameter(system, tmp_path):
    """The run's seed goes to the saboteur, as it does to every component that has one."""
    noise = Fault("it", "truth.y", "noise", sigma=1.0, period=0.25)
    package(system, tmp_path / "it.ssp", noise, seed=3)
    sabotaged = System.load(tmp_path / "it.ssp")
    assert sabotaged.value("truth_saboteur.seed") == 3
    for seed in (3, 8):
        assert same(fly(sabotaged, seed=seed), own(system, *late("truth.y"), noise, seed=seed))


def test_elements_change_places_at_the_same_time(tmp_path):
    """One after the other, the first would be lost."""
    system = System.load(systems.pair())
    swap = Fault("it", ["truth.y", "truth.z"], "swap", START, DURATION, order=[2, 1])
    record = ["one.y", "two.y"]
    expected = own(system, *late("truth.y", "truth.z"), swap, record=record)
    package(system, tmp_path / "it.ssp", swap)
    assert same(fly(System.load(tmp_path / "it.ssp"), record=record), expected)


def test_one_component_after_the_other_nothing_of_a_bundle_is_late(system, tmp_path):
    fault = Fault("it", "sensor.reading", "dropout", START, DURATION)
    package(system, tmp_path / "it.ssp", fault)
    sabotaged = fly(System.load(tmp_path / "it.ssp"), algorithm="gauss_seidel")
    assert same(sabotaged, own(system, fault, algorithm="gauss_seidel"))


@pytest.mark.parametrize(
    "fault",
    [
        Fault("it", "truth.y", "bias", START, DURATION, value=1.0),
        Fault("it", "lag.bias", "input", START, DURATION, value=1.0),
    ],
    ids=["passed on", "driven"],
)
def test_one_component_after_the_other_a_continuous_value_comes_as_a_line(system, tmp_path, fault):
    """It begins a step early, where the master's own begins as a step: what the page on saboteurs admits."""
    package(system, tmp_path / "it.ssp", fault)
    given = {"algorithm": "gauss_seidel", "record": ["lag.y"]}
    clean, sabotaged = fly(system, seed=3, **given), fly(System.load(tmp_path / "it.ssp"), **given)
    first = [int(np.argmax((frame != clean).to_numpy())) for frame in (own(system, fault, **given), sabotaged)]
    assert first == [START / H + 1, START / H]


# -- a master that sets inputs and reads outputs that follow them, at the same communication point ---------------------


@pytest.mark.parametrize("kind", TYPE)
def test_direct_nothing_is_late_where_values_pass_on_at_once(system, tmp_path, kind):
    fault = Fault("it", "truth.y", kind, START, DURATION, TYPE[kind])
    package(system, tmp_path / "it.ssp", fault, direct=True)
    expected = own(system, fault)
    found = passed_on(System.load(tmp_path / "it.ssp"))
    for name in expected:
        np.testing.assert_array_equal(found[name], expected[name].to_numpy(dtype=float), name)


def test_direct_gains_nothing_elsewhere_and_ecos_remembers_what_it_does_not_pass_on(system, tmp_path):
    """It reads outputs again after it has set inputs: the last value before `stuck` is not the one that left."""
    fault = Fault("it", "truth.y", "stuck", START, DURATION)
    package(system, tmp_path / "it.ssp", fault, direct=True)
    expected = own(system, *late("truth.y"), fault)
    assert same(fly(System.load(tmp_path / "it.ssp")), expected)
    found = foreign(tmp_path / "it.ssp", tmp_path / "it")
    assert found["libcosim"] == last(expected) != found["Ecos"]


def passed_on(system: System) -> dict[str, list[float]]:
    """All outputs at all points, by FMPy's calls in the order in which values that follow inputs directly pass on."""
    slaves = {name: Instance(name, fmu) for name, fmu in system.fmus.items()}
    for name, slave in slaves.items():
        slave.set(system.values[name])
        slave.fmu.enterInitializationMode()
    order = ["truth", "truth_saboteur", "lag", "sensor", "estimator"]
    assert set(order) == set(slaves)

    def exchange():
        for name in order:
            given = [link for link in system.links if names.split(link.target)[0] == name]
            for link in given:
                source, output = names.split(link.source)
                slaves[name].set({names.split(link.target)[1]: slaves[source].get(output)})
            if name == "truth_saboteur":
                for output in slaves[name].outputs:
                    slaves[name].get(output)

    recorded = {f"{name}.{output}": [] for name in RECEIVERS for output in slaves[name].outputs}

    def record():
        for name, values in recorded.items():
            component, output = names.split(name)
            values.append(float(slaves[component].get(output)))

    exchange()
    for slave in slaves.values():
        slave.fmu.exitInitializationMode()
    record()
    exchange()
    for k in range(STEPS):
        for slave in slaves.values():
            slave.fmu.doStep(k * H, H)
        record()
        exchange()
    for slave in slaves.values():
        slave.fmu.terminate()
        slave.fmu.freeInstance()
    return recorded


class Instance:
    """An FMU by the names of its variables."""

    def __init__(self, name, fmu):
        self.variables = {v.name: v for v in fmu.description.variables}
        self.outputs = [v.name for v in fmu.description.variables if v.causality == "output"]
        about = fmpy.read_model_description(str(fmu.path))
        identifier = about.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(
            guid=about.guid, unzipDirectory=str(fmu.folder), modelIdentifier=identifier, instanceName=name
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)

    def set(self, values):
        for name, value in values.items():
            variable = self.variables[name]
            assert variable.type in SORTS
            getattr(self.fmu, f"set{variable.type}")([variable.reference], [value])

    def get(self, name):
        variable = self.variables[name]
        return getattr(self.fmu, f"get{variable.type}")([variable.reference])[0]
