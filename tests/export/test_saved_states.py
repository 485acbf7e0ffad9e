"""get/set/serialise FMUstate and reset: the future repeats to the last bit, hidden parts included."""

import ctypes

import numpy as np
import pytest

from .slave import ERROR, OK, Slave


def advance(slave, start, count, seed):
    """Step with random inputs; all values after each step."""
    random = np.random.default_rng(seed)
    rows, time = [], start
    for k in range(count):
        h = float(random.uniform(0.02, 0.3))
        if "u" in slave.fmu.variables:
            slave.set("u", random.normal())
            slave.derivative("u", random.normal())
        elif "u[1]" in slave.fmu.variables:
            slave.set("u", random.normal(size=2))
            slave.derivative("u[2]", random.normal())
        elif "reading.sequence" in slave.fmu.variables and "reading.s[1]" in slave.fmu.variables:
            slave.set("reading.s", random.normal(size=2))
            slave.set("reading.sequence", k + 1 + 100 * seed)
        assert slave.step(time, h) == OK, slave.said
        time += h
        rows.append(slave.everything())
    return rows, time


NAMES = ["sensor", "listener", "source", "two_rates", "lag"]


@pytest.mark.parametrize("name", NAMES)
def test_restored_state_repeats_to_the_last_bit(unzipped, name):
    slave = Slave(unzipped[name])
    slave.initialise()
    _, time = advance(slave, 0.0, 20, 1)
    state = slave.save()
    saved = slave.everything()
    first, _ = advance(slave, time, 30, 2)
    assert slave.call("SetFMUstate", state) == OK
    assert slave.everything() == saved
    assert advance(slave, time, 30, 2)[0] == first
    assert slave.call("FreeFMUstate", ctypes.byref(state)) == OK
    assert not state
    slave.free()


@pytest.mark.parametrize("name", NAMES)
def test_serialised_state_continues_in_another_instance(unzipped, name):
    one, two = Slave(unzipped[name]), Slave(unzipped[name])
    one.initialise()
    _, time = advance(one, 0.0, 20, 1)
    state = one.save()
    data = one.serialise(state)
    expected, _ = advance(one, time, 30, 2)
    status, copy = two.deserialise(data)
    assert status == OK
    assert two.call("SetFMUstate", copy) == OK
    assert advance(two, time, 30, 2)[0] == expected
    assert two.serialise(copy) == data
    for slave, held in ((one, state), (two, copy)):
        slave.call("FreeFMUstate", ctypes.byref(held))
        slave.free()


@pytest.mark.parametrize("values", [{"sample_period": 0.2}, {"time_constant": 5.0}, {"gain": 2.0}])
def test_a_state_brings_its_parameters_into_an_instance_that_has_others(unzipped, values):
    """And what was calculated from them once and for all: else the other instance goes on with its own."""
    one, two = Slave(unzipped["lag"]), Slave(unzipped["lag"])
    one.initialise()
    two.initialise(**values)
    _, time = advance(one, 0.0, 20, 1)
    assert advance(two, 0.0, 20, 1)[0][-1] != one.everything()
    state = one.save()
    status, copy = two.deserialise(one.serialise(state))
    assert (status, two.call("SetFMUstate", copy)) == (OK, OK)
    assert advance(two, time, 30, 2)[0] == advance(one, time, 30, 2)[0]
    for slave, held in ((one, state), (two, copy)):
        slave.call("FreeFMUstate", ctypes.byref(held))
        slave.free()


@pytest.mark.parametrize("name", NAMES)
def test_reset_starts_again(unzipped, name):
    slave = Slave(unzipped[name])
    fresh = slave.everything()
    slave.initialise()
    first, _ = advance(slave, 0.0, 20, 1)
    assert slave.call("Reset") == OK
    assert slave.everything() == fresh
    assert slave.initialise() == OK
    assert advance(slave, 0.0, 20, 1)[0] == first
    slave.free()


def test_a_state_can_be_saved_over_an_older_one(unzipped):
    slave = Slave(unzipped["sensor"])
    slave.initialise()
    state = slave.save()
    address = state.value
    slave.step(0.0, 1.0)
    assert slave.call("GetFMUstate", ctypes.byref(state)) == OK
    assert state.value == address
    slave.step(1.0, 1.0)
    slave.call("SetFMUstate", state)
    assert slave.get("reading.sequence") == 10
    assert slave.step(1.0, 0.1) == OK
    slave.call("FreeFMUstate", ctypes.byref(state))
    slave.free()


def test_a_state_saved_in_initialisation_mode_is_the_one_before_outputs_were_shown(unzipped):
    slave = Slave(unzipped["source"])
    slave.call("EnterInitializationMode")
    slave.set("offset", 3.0)
    assert slave.get("x") == 3.0
    state = slave.save()
    slave.set("offset", 4.0)
    assert slave.get("x") == 4.0
    slave.call("SetFMUstate", state)
    assert slave.get("x") == 3.0
    slave.call("FreeFMUstate", ctypes.byref(state))
    slave.free()


def test_bytes_that_are_not_a_state_of_this_build_are_refused(unzipped):
    sensor, listener = Slave(unzipped["sensor"]), Slave(unzipped["listener"])
    state = sensor.save()
    data = sensor.serialise(state)
    for wrong in (data[:-1], data + b"\0", b"", b"x" * len(data)):
        assert sensor.deserialise(wrong)[0] == ERROR
        assert sensor.said == "This is not a saved state of this build of 'sensor', tables included."
    assert listener.deserialise(data)[0] == ERROR
    small = ctypes.create_string_buffer(8)
    assert sensor.call("SerializeFMUstate", state, small, ctypes.c_size_t(8)) == ERROR
    assert sensor.said == "The buffer is too small for the saved state."
    assert sensor.call("SetFMUstate", None) == ERROR
    sensor.call("FreeFMUstate", ctypes.byref(state))
    sensor.free()
    listener.free()
