"""Sampling inside a step: the same samples at every communication step size, in the order that was declared."""

import math

import numpy as np
import pytest

from navfmu.export.interpreter import Interpreter

from .components import Sensor, Source, TwoRates
from .slave import ERROR, OK, Slave


def run(fmu, steps, record, inputs=lambda t: {}, **values):
    """Values of ``record`` at the end of each step."""
    slave = Slave(fmu)
    assert slave.initialise(**values) == OK, slave.said
    time, rows = 0.0, []
    for h in steps:
        for name, value in inputs(time).items():
            slave.set(name, value)
        assert slave.step(time, h) == OK, slave.said
        time += h
        rows.append([slave.get(name) for name in record])
    slave.free()
    return rows


@pytest.mark.parametrize("steps", [[0.05] * 40, [0.2] * 10, [2.0], [0.3, 0.01, 0.69, 0.5, 0.5]])
def test_samples_do_not_depend_on_the_communication_step(unzipped, steps):
    expected = run(unzipped["sensor"], [0.1] * 20, ["reading.s", "reading.sequence", "reading.time_of_validity"])[-1]
    assert expected[1] == 20
    assert run(unzipped["sensor"], steps, ["reading.s", "reading.sequence", "reading.time_of_validity"])[-1] == expected


def test_an_experiment_that_starts_at_a_time_of_the_calendar_samples_as_one_that_starts_at_0(unzipped):
    start = 1_767_225_600.0  # s, whose last place is 0.2 microseconds
    native, floats = Slave(unzipped["sensor"]), Interpreter(Sensor)
    native.initialise(start)
    floats.setup(start)
    for k in range(1, 200):
        native.step(start + (k - 1) * 0.1, 0.1)
        floats.do_step(start + (k - 1) * 0.1, 0.1)
        assert native.get("reading.sequence") == floats.get("reading.sequence") == k
    native.free()


def test_noise_depends_on_seed_and_stream(unzipped):
    def reading(**values):
        return run(unzipped["sensor"], [1.0], ["reading.s"], **values)[0][0]

    assert reading() == reading(seed=1)
    assert reading() != reading(seed=2)
    assert reading() != reading(stream=3)


@pytest.mark.parametrize("component", [Sensor, TwoRates, Source])
def test_native_fmu_and_interpreter_agree(unzipped, component):
    name = component.layout.name
    slave, twin = Slave(unzipped[name]), Interpreter(component)
    slave.initialise()
    twin.setup_experiment(0.0, None)
    twin.enter_initialization()
    twin.exit_initialization()
    random = np.random.default_rng(3)
    time = 0.0
    for _ in range(100):
        h = float(random.uniform(0.01, 0.4))
        if "u" in component.layout.fields:
            u = random.normal(size=component.layout.fields["u"].shape)
            assert slave.set("u", np.ravel(u)) == OK
            twin.set("u", u)
        assert slave.step(time, h) == OK
        twin.do_step(time, h)
        time += h
        native = slave.everything()
        assert native == pytest.approx(list(twin.values), rel=1e-13, abs=1e-13)
    slave.free()


def test_ticks_count_in_whole_periods_over_a_long_run(unzipped):
    slave = Slave(unzipped["two_rates"])
    slave.initialise(fast=0.01, slow=0.07)
    for k in range(20000):
        assert slave.step(k * 0.01, 0.01) == OK
        assert slave.get("count[1]") == k + 1
    assert slave.get("count[2]") == 20000 // 7
    assert slave.get("times")[0] == 20000 * 0.01
    slave.free()


def test_two_clocks_that_meet_run_in_the_order_of_declaration(unzipped):
    rows = run(unzipped["two_rates"], [0.1] * 9, ["count", "slow_sees"])
    assert rows[2] == [[3.0, 1.0], 3.0]
    assert rows[8] == [[9.0, 3.0], 9.0]


def test_a_tick_at_the_end_of_a_step_belongs_to_it(unzipped):
    rows = run(unzipped["sensor"], [0.1 - 1e-6, 1e-6, 0.1], ["reading.sequence"])
    assert rows == [[0], [1], [2]]


def test_a_step_of_no_length_is_refused_as_the_standard_says(unzipped):
    slave = Slave(unzipped["sensor"])
    slave.initialise()
    assert slave.step(0.0, 0.0) == ERROR
    assert slave.said == "The communication step size is 0 s at 0 s; expected a positive number."
    assert slave.step(0.0, 0.1) == OK
    slave.free()


def test_inputs_follow_their_derivative_over_the_coming_step_only(unzipped):
    slave = Slave(unzipped["two_rates"])
    slave.initialise()
    slave.set("u", 1.0)
    assert slave.derivative("u", 2.0) == OK
    slave.step(0.0, 0.2)
    assert slave.get("sampled") == 1.0 + 2.0 * 0.2
    assert slave.get("u") == 1.0
    slave.step(0.2, 0.2)
    assert slave.get("sampled") == 1.0
    slave.derivative("u", 2.0)
    slave.set("u", 3.0)
    slave.step(0.4, 0.2)
    assert slave.get("sampled") == 3.0 + 2.0 * 0.2, "the derivative holds, also when the value comes after it"
    slave.free()


@pytest.mark.parametrize("slope", [0.0, -0.0])
def test_a_derivative_of_0_changes_no_bit_of_an_input(slope, unzipped):
    """-0 + 0 is +0."""
    slave = Slave(unzipped["two_rates"])
    slave.initialise()
    slave.set("u", -0.0)
    assert slave.derivative("u", slope) == OK
    slave.step(0.0, 0.1)
    assert math.copysign(1.0, slave.get("sampled")) == -1.0
    slave.free()


def test_a_derivative_can_be_set_in_every_state_in_which_the_value_can(unzipped):
    for enter in ([], ["EnterInitializationMode"], ["EnterInitializationMode", "ExitInitializationMode"]):
        slave = Slave(unzipped["two_rates"])
        for call in enter:
            assert slave.call(call) == OK
        assert slave.derivative("u", 2.0) == OK
        assert slave.set("u", 1.0) == OK
        for call in ["EnterInitializationMode", "ExitInitializationMode"][len(enter) :]:
            assert slave.call(call) == OK
        assert slave.step(0.0, 0.2) == OK
        assert slave.get("sampled") == 1.0 + 2.0 * 0.2
        assert slave.call("Terminate") == OK
        assert slave.derivative("u", 2.0) == ERROR
        assert slave.said == "fmi2SetRealInputDerivatives is not allowed after fmi2Terminate."
        slave.free()


def test_discrete_inputs_have_no_derivative(unzipped):
    slave = Slave(unzipped["listener"])
    slave.initialise()
    assert slave.derivative("reading.s[1]", 1.0) == ERROR
    slave.free()


def test_new_data_is_used_once_when_its_time_has_come(unzipped):
    slave = Slave(unzipped["listener"])
    slave.initialise()
    slave.set("reading.s", [1.0, 2.0])
    slave.set("reading.valid", 1)
    slave.set("reading.sequence", 1)
    slave.set("reading.time_of_validity", 0.25)
    slave.step(0.0, 0.2)
    assert slave.get("updates") == 0
    slave.step(0.2, 0.8)
    assert (slave.get("updates"), slave.get("held")) == (1, [1.0, 2.0])
    assert slave.get("seen_at") == pytest.approx(0.3)
    slave.free()


def test_lost_samples_are_counted(unzipped):
    slave = Slave(unzipped["listener"])
    slave.initialise()
    for k, sequence in enumerate((1, 2, 5, 6, 9)):
        slave.set("reading.sequence", sequence)
        slave.step(k * 0.1, 0.1)
    assert (slave.get("updates"), slave.get("reading.lost")) == (5, 4)
    slave.set("reading.sequence", 1)  # the source was restarted: new, but nothing lost
    slave.step(0.5, 0.1)
    assert (slave.get("updates"), slave.get("reading.lost")) == (6, 4)
    slave.free()


def test_sources_show_their_outputs_in_initialisation_mode(unzipped):
    slave = Slave(unzipped["source"])
    slave.call("EnterInitializationMode")
    assert slave.get("x") == 0.5
    slave.set("offset", 2.0)
    assert slave.get("x") == 2.0
    assert slave.get("x") == 2.0
    slave.call("ExitInitializationMode")
    assert slave.get("x") == 2.0
    assert slave.set("x", 1.0) == ERROR
    assert slave.said == "Variable 'x' cannot be set after initialisation: it is calculated."
    slave.free()


def test_tables_are_searched_by_time_and_clamped_at_both_ends(unzipped):
    rows = run(unzipped["source"], [0.5, 0.5, 1.0, 1.0, 7.0], ["x"])
    assert [row[0] - 0.5 for row in rows] == pytest.approx([1.0, 2.0, 1.0, 0.0, 0.0], abs=1e-12)
    slave = Slave(unzipped["source"])
    slave.initialise(start=-5.0)
    slave.step(-5.0, 1.0)
    assert slave.get("x") == 0.5
    slave.free()


def test_ticks_count_from_the_start_time(unzipped):
    slave = Slave(unzipped["two_rates"])
    slave.initialise(start=100.0)
    slave.step(100.0, 0.35)
    assert slave.get("times") == pytest.approx([100.3, 100.3], rel=1e-15)
    assert math.isclose(slave.get("count[1]"), 3.0)
    slave.free()
