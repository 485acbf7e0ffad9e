"""The C interface of FMI 2.0: what it does, what it refuses, and with which sentence."""

import ctypes
import math

import pytest

from .slave import ERROR, OK, Slave


@pytest.fixture
def sensor(unzipped):
    slave = Slave(unzipped["sensor"])
    yield slave
    slave.free()


def test_version_and_platform(unzipped):
    assert unzipped["sensor"].library.fmi2GetVersion() == b"2.0"
    assert unzipped["sensor"].library.fmi2GetTypesPlatform() == b"default"


def test_another_guid_is_refused(unzipped):
    slave = Slave(unzipped["sensor"], guid="{other}")
    assert not slave.component
    status, category, message = slave.messages[0]
    assert (status, category) == (ERROR, "logStatusError")
    assert message == (
        f"The GUID '{{other}}' was given, but this binary of 'sensor' belongs to '{unzipped['sensor'].guid}': "
        "the model description is of another build."
    )


def test_model_exchange_and_missing_names_are_refused(unzipped):
    assert "model exchange" in Slave(unzipped["sensor"], kind=0).said
    assert Slave(unzipped["sensor"], name=b"").said == "The instance has no name."


def test_calls_in_the_wrong_order_are_refused(sensor):
    assert sensor.step(0.0, 0.1) == ERROR
    assert sensor.said == "fmi2DoStep is not allowed before initialisation."
    assert sensor.call("ExitInitializationMode") == ERROR
    assert sensor.call("Terminate") == ERROR
    assert sensor.call("EnterInitializationMode") == OK
    assert sensor.step(0.0, 0.1) == ERROR
    assert sensor.said == "fmi2DoStep is not allowed in initialisation mode."
    assert sensor.call("ExitInitializationMode") == OK
    assert sensor.call("EnterInitializationMode") == ERROR
    assert sensor.said == "fmi2EnterInitializationMode is not allowed after initialisation."
    assert sensor.call("Terminate") == OK
    assert sensor.step(0.0, 0.1) == ERROR
    assert sensor.said == "fmi2DoStep is not allowed after fmi2Terminate."
    assert sensor.set("u[1]", 1.0) == ERROR
    assert sensor.said == "fmi2SetReal is not allowed after fmi2Terminate."
    assert sensor.get("u[1]") == 0.0


def test_variables_can_be_set_when_the_standard_says(sensor):
    assert [sensor.set(n, 1.0) for n in ("u[1]", "sigma", "gain", "sample_period", "reading.s[1]")] == [OK] * 5
    assert sensor.set("seed", 7) == OK
    assert sensor.set("bias[1]", 1.0) == ERROR
    assert sensor.said == "Variable 'bias[1]' cannot be set before initialisation: it is calculated."
    sensor.set("sigma", 0.1)
    assert sensor.initialise() == OK
    assert sensor.set("u[1]", 2.0) == OK
    assert sensor.set("gain", 2.0) == OK
    for name in ("sigma", "sample_period", "reading.s[1]"):
        assert sensor.set(name, 1.0) == ERROR
        assert sensor.said == (
            f"Variable '{name}' cannot be set after initialisation: it is fixed once initialisation has ended."
        )
    assert sensor.set("seed", 1) == ERROR


def test_a_value_that_was_refused_is_not_taken(sensor):
    sensor.initialise()
    sensor.set("sigma", 5.0)
    sensor.set("gain", 0.1)
    assert sensor.said == "Parameter 'gain' is 0.1; expected a value of at least 0.5."
    assert (sensor.get("sigma"), sensor.get("gain")) == (0.1, 1.0)


def test_types_and_value_references_are_checked(sensor):
    fmu = sensor.fmu
    seed, u = fmu.reference("seed"), fmu.reference("u[1]")
    assert sensor.get_references("Real", [u, seed])[0] == ERROR
    assert sensor.said == f"Variable 'seed' (value reference {seed}) is Integer, not Real."
    assert sensor.set_references("Boolean", [u], [1]) == ERROR
    assert sensor.said == f"Variable 'u[1]' (value reference {u}) is Real, not Boolean."
    for call in (sensor.get_references("Integer", [99999])[0], sensor.set_references("Integer", [2**32 - 1], [1])):
        assert call == ERROR
    assert "value reference 4294967295" in sensor.said
    assert sensor.call("GetString", None, ctypes.c_size_t(0), None) == OK
    assert sensor.call("SetString", (ctypes.c_uint * 1)(0), ctypes.c_size_t(1), (ctypes.c_char_p * 1)(b"x")) == ERROR
    assert sensor.said == "Variable 'u[1]' (value reference 0) is Real, not String."


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("sigma", -1.0, "Parameter 'sigma' is -1 m; expected a value from 0 to 10 m."),
        ("sigma", 11.0, "Parameter 'sigma' is 11 m; expected a value from 0 to 10 m."),
        ("sigma", math.nan, "Parameter 'sigma' is nan m; expected a value from 0 to 10 m."),
        ("sample_period", 0.0, "Parameter 'sample_period' is 0 s; expected a value of at least 0.001 s."),
        ("sample_period", math.inf, "Parameter 'sample_period' is inf s; expected a period longer than 0 s."),
        ("seed", -3, "Parameter 'seed' is -3; expected a value of at least 0."),
        ("sigma", 0.5, "sigma 0.5 m must be below a tenth of gain 1"),
    ],
)
def test_wrong_parameters_end_initialisation_with_a_sentence(sensor, name, value, sentence):
    assert sensor.initialise(**{name: value}) == ERROR
    assert sensor.said == sentence
    assert sensor.step(0.0, 0.1) == ERROR
    sensor.call("Reset")
    assert sensor.initialise() == OK


def test_all_wrong_parameters_are_told(sensor):
    assert sensor.initialise(sigma=-1.0, seed=-1) == ERROR
    assert [message[2].split("'")[1] for message in sensor.messages] == ["sigma", "seed"]


def test_nonsense_inputs_do_not_crash(unzipped):
    for value in (math.nan, math.inf, -math.inf, 1e308):
        slave = Slave(unzipped["sensor"])
        slave.initialise()
        slave.set("u", [value, value])
        assert slave.step(0.0, 1.0) == OK
        assert not math.isfinite(slave.get("reading.s")[0]) or value == 1e308
        slave.free()
    slave = Slave(unzipped["listener"])
    slave.initialise()
    slave.set("reading.time_of_validity", math.nan)
    slave.set("reading.sequence", -(2**31))
    assert slave.step(0.0, 1.0) == OK
    assert slave.get("updates") == 0
    slave.free()


def test_impossible_steps_are_refused(sensor):
    sensor.initialise(stop=1.0)
    assert sensor.step(0.0, -0.1) == ERROR
    assert sensor.said == "The communication step size is -0.1 s at 0 s; expected a positive number."
    assert sensor.step(0.0, math.nan) == ERROR
    assert sensor.step(0.0, math.inf) == ERROR
    assert sensor.step(0.5, 0.1) == ERROR
    assert sensor.said == (
        "A step from 0.5 s was asked for, but this instance is at 0 s; to go back, restore a saved state."
    )
    assert sensor.step(0.0, 1.1) == ERROR
    assert sensor.said == "A step to 1.1 s was asked for, but the experiment ends at 1 s."
    assert sensor.step(0.0, 1.0) == OK
    status = ctypes.c_int(9)
    assert sensor.call("GetStatus", 0, ctypes.byref(status)) == OK
    assert status.value == OK


def test_status_functions(sensor):
    sensor.initialise()
    sensor.step(0.0, 0.25)
    time, flag, text = ctypes.c_double(), ctypes.c_int(9), ctypes.c_char_p()
    assert sensor.call("GetRealStatus", 2, ctypes.byref(time)) == OK
    assert time.value == 0.25
    assert sensor.call("GetBooleanStatus", 3, ctypes.byref(flag)) == OK
    assert flag.value == 0
    assert sensor.call("GetStringStatus", 1, ctypes.byref(text)) == OK
    assert sensor.call("GetIntegerStatus", 0, ctypes.byref(flag)) == ERROR
    assert sensor.call("GetStatus", 2, ctypes.byref(flag)) == ERROR
    assert sensor.call("CancelStep") == ERROR
    assert sensor.said == "There is no step to cancel: this FMU does not run asynchronously."


def test_what_the_fmu_does_not_offer_is_refused_with_a_sentence(sensor):
    sensor.initialise()
    one, none = ctypes.c_size_t(1), None
    assert sensor.call("GetDirectionalDerivative", none, one, none, one, none, none) == ERROR
    assert sensor.said.startswith("This FMU has no directional derivatives")
    assert sensor.call("GetRealOutputDerivatives", none, one, none, none) == ERROR
    assert sensor.said == "This FMU has no derivatives of outputs (maxOutputDerivativeOrder is 0)."
    assert sensor.derivative("sigma", 1.0) == ERROR
    assert sensor.said.startswith("A derivative of order 1 was set for 'sigma'; expected")
    assert sensor.derivative("u[1]", 1.0, order=2) == ERROR
    assert sensor.said.startswith("A derivative of order 2 was set for 'u[1]'; expected order 1")


def test_errors_are_told_even_when_logging_is_off_and_events_only_when_on(unzipped):
    for logging, expected in ((0, []), (1, ["logEvents"])):
        slave = Slave(unzipped["listener"], logging=logging)
        slave.initialise()
        slave.set("reading.sequence", 4)
        slave.step(0.0, 0.1)
        assert [category for _, category, _ in slave.messages] == expected
        slave.step(0.0, 0.1)
        assert slave.messages[-1][1] == "logStatusError"
        slave.free()


def test_log_categories_can_be_chosen(unzipped):
    slave = Slave(unzipped["listener"])
    names = (ctypes.c_char_p * 1)(b"logEvents")
    assert slave.call("SetDebugLogging", 1, ctypes.c_size_t(1), names) == OK
    slave.initialise()
    assert slave.step(1.0, 0.1) == ERROR
    (told,) = slave.messages
    assert told[:2] == (ERROR, "logStatusError"), "why a call was refused is told whatever was asked for"
    slave.messages.clear()
    slave.set("reading.sequence", 3)
    slave.step(0.0, 0.1)
    assert slave.messages == [
        (
            OK,
            "logEvents",
            "At 0.1 s 2 samples of 'reading.sequence' were lost: the communication step is longer than their period.",
        )
    ]
    assert slave.call("SetDebugLogging", 1, ctypes.c_size_t(0), None) == OK
    assert slave.call("SetDebugLogging", 1, ctypes.c_size_t(1), (ctypes.c_char_p * 1)(b"logSpam")) == ERROR
    assert slave.said.startswith("There is no log category 'logSpam'; expected logEvents")
    slave.free()


def test_calls_without_an_instance_return_an_error(unzipped):
    library = unzipped["sensor"].library
    real = ctypes.c_double
    assert library.fmi2DoStep(None, real(0), real(1), 1) == ERROR
    assert library.fmi2GetReal(None, None, ctypes.c_size_t(0), None) == ERROR
    assert library.fmi2Reset(None) == ERROR
    library.fmi2FreeInstance(None)


def test_instances_do_not_share_anything(unzipped):
    one, two = Slave(unzipped["sensor"]), Slave(unzipped["sensor"])
    one.initialise()
    two.initialise(seed=2)
    before = two.everything()
    one.set("u", [5.0, 6.0])
    one.step(0.0, 1.0)
    assert two.everything() == before
    one.free()
    two.step(0.0, 1.0)
    assert two.get("reading.sequence") == 10
    two.free()
