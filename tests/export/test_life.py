"""One life for native FMU, interpreter and twin: random calls, wrong ones included, give the same status, values and
messages.
"""

import ctypes
import itertools
import math

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, every, life, require
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.life import State
from navfmu.export.printing.codegen import generate
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin

from .arrays import Cube, Receiver
from .components import Iterating, Listener, Mixed, Modes, Named, Sensor, Source, Ticking
from .slave import ERROR, OK, Slave, Unzipped

COMPONENTS = {
    "mixed": Mixed,
    "modes": Modes,
    "named": Named,
    "sensor": Sensor,
    "listener": Listener,
    "source": Source,
    "ticking": Ticking,
    "iterating": Iterating,
    "cube": Cube,
    "receiver": Receiver,
}
KINDS = ("Real", "Integer", "Boolean", "String")
TEXTS = ("", "TUL", "Zürich", "12345678", "123456789", 101 * "x", 50 * "ü")
FATAL, DISCARD = 4, 2


class Native:
    """An FMU by its C functions."""

    def __init__(self, fmu):
        self.slave = Slave(fmu, logging=1)
        self.saved = None

    def do(self, call, *arguments):
        """Return status, values, and what was said as (category, sentence)."""
        self.slave.messages.clear()
        status, values = getattr(self, call)(*arguments)
        return status, values, [(category, message) for _, category, message in self.slave.messages]

    def setup(self, start, stop):
        real = ctypes.c_double
        return self.slave.call("SetupExperiment", 0, real(0), real(start), int(stop is not None), real(stop or 0)), None

    def mode(self, name):
        return self.slave.call(name), None

    def get(self, kind, references):
        status, values = self.slave.get_references(kind, references)
        return status, values if status == OK else None

    def set(self, kind, references, values):
        return self.slave.set_references(kind, references, values), None

    def slopes(self, references, orders, values):
        n = len(references)
        numbers, slopes = (ctypes.c_uint * n)(*references), (ctypes.c_double * n)(*values)
        status = self.slave.call(
            "SetRealInputDerivatives", numbers, ctypes.c_size_t(n), (ctypes.c_int * n)(*orders), slopes
        )
        return status, None

    def step(self, t, h):
        return self.slave.step(t, h), None

    def save(self):
        if self.saved is None:
            self.saved = self.slave.save()
        return OK, None

    def restore(self):
        return OK if self.saved is None else self.slave.call("SetFMUstate", self.saved), None

    def free(self):
        if self.saved is not None:
            self.slave.call("FreeFMUstate", ctypes.byref(self.saved))
        self.slave.free()


class Floats:
    """The interpreter; what it raises is what an FMU logs as an error."""

    def __init__(self, component):
        self.run = Interpreter(component)
        self.saved = None

    def do(self, call, *arguments):
        try:
            status, values, error = OK, getattr(self, call)(*arguments), []
        except NavfmuError as told:
            status, values, error = ERROR, None, [("logStatusError", str(told))]
        events = [("logEvents", event) for event in self.run.events]
        self.run.events.clear()
        return status, values, events + error

    def setup(self, start, stop):
        self.run.setup_experiment(start, stop)

    def mode(self, name):
        calls = {
            "EnterInitializationMode": self.run.enter_initialization,
            "ExitInitializationMode": self.run.exit_initialization,
            "Terminate": self.run.terminate,
            "Reset": self.run.reset,
        }
        calls[name]()

    def get(self, kind, references):
        return self.run.get_values(kind, references)

    def set(self, kind, references, values):
        self.run.set_values(kind, references, values)

    def slopes(self, references, orders, values):
        self.run.set_derivatives(references, orders, values)

    def step(self, t, h):
        self.run.do_step(t, h)

    def save(self):
        self.saved = self.saved or self.run.get_state()

    def restore(self):
        if self.saved:
            self.run.set_state(self.saved)


ODD = (math.nan, math.inf, -math.inf, -0.0, 1e308, 0.5)


class Host:
    """Draws calls: most of them in order, some not."""

    def __init__(self, component, random, derivatives=True):
        self.component, self.random, self.derivatives = component, random, derivatives
        self.elements = component.layout.elements
        self.time = 0.0

    def choose(self, *items):
        return items[self.random.integers(len(items))]

    def references(self, kind):
        right = [e.index for e in self.elements if e.variable.type == kind] or [0]
        count = int(self.random.integers(1, 4))
        wrong = [int(self.random.integers(len(self.elements))), len(self.elements), 2**32 - 1]
        return [self.choose(*wrong) if self.random.random() < 0.05 else self.choose(*right) for _ in range(count)]

    def value(self, kind):
        if kind == "String":
            return None if self.derivatives and self.random.random() < 0.1 else self.choose(*TEXTS)
        if kind == "Real":
            return self.choose(*ODD) if self.random.random() < 0.1 else self.choose(-1.0, 0.0, 1.0, 1.0, 2.0, 3.0, 0.5)
        return int(self.random.integers(-1, 6)) if kind == "Integer" else int(self.random.integers(2))

    def call(self):
        """Return the name and the arguments of a call."""
        pick = self.random.random()
        if pick < 0.05:
            self.start = self.choose(0.0, 0.0, 100.0, 1.7e9, math.nan)
            return "setup", self.start, self.choose(None, None, self.start + 2.0, self.start - 1.0, math.nan)
        if pick < 0.13:
            return "mode", "EnterInitializationMode"
        if pick < 0.21:
            return "mode", "ExitInitializationMode"
        if pick < 0.22:
            return "mode", "Terminate"
        if pick < 0.25:
            return "mode", "Reset"
        if pick < 0.28:
            return ("save",)
        if pick < 0.31:
            return ("restore",)
        kind = self.choose(*KINDS)
        if pick < 0.40:
            return "get", kind, self.references(kind)
        if pick < 0.60:
            references = self.references(kind)
            return "set", kind, references, [self.value(kind) for _ in references]
        if pick < 0.70 and self.derivatives:
            references = self.references("Real")
            orders = [self.choose(1, 1, 1, 1, 2) for _ in references]
            return "slopes", references, orders, [self.value("Real") for _ in references]
        h = self.choose(0.05, 0.1, 0.1, 0.25, 0.25, 1.0, 0.0, -0.1, math.nan)
        return "step", self.time + (self.choose(0.1, -0.1, 1e-10, math.nan) if self.random.random() < 0.1 else 0.0), h


def same(native, floats):
    """Compare two answers; a model's own error carries its line in front."""
    (status, values, said), (theirs, numbers, told) = native, floats
    errors = " ".join(sentence for category, sentence in said if category == "logStatusError")
    others = " ".join(sentence for category, sentence in told if category == "logStatusError")
    assert status == theirs, (said, told)
    assert [s for s in said if s[0] != "logStatusError"] == [s for s in told if s[0] != "logStatusError"]
    assert others.endswith(errors) and bool(others) == bool(errors), (said, told)
    assert (values is None) == (numbers is None)
    if values and isinstance(values[0], str):
        assert values == numbers
    elif values is not None:
        assert np.allclose(values, np.array(numbers, float), rtol=1e-12, atol=1e-12, equal_nan=True), (values, numbers)


@pytest.mark.filterwarnings("ignore:invalid value", "ignore:overflow", "ignore:divide by zero")
@pytest.mark.parametrize("name", COMPONENTS)
def test_native_fmu_and_interpreter_agree_whatever_a_host_calls(name, unzipped):
    component = COMPONENTS[name]
    by_kind = [(kind, [e.index for e in component.layout.elements if e.variable.type == kind]) for kind in KINDS]
    seen = set()
    for seed in range(150):
        random = np.random.default_rng([7, seed])
        host, native, floats = Host(component, random), Native(unzipped[name]), Floats(component)
        for _ in range(60):
            host.time = floats.run.time
            call = host.call()
            answer = native.do(*call)
            same(answer, floats.do(*call))
            seen |= {(call[0], answer[0]), *(category for category, _ in answer[2]), floats.run.state}
            if random.random() < 0.5:
                for kind, references in by_kind:
                    same(native.do("get", kind, references), floats.do("get", kind, references))
        native.free()
    wanted = set(itertools.product(("setup", "mode", "get", "set", "slopes", "step"), (OK, ERROR)))
    assert wanted - seen <= (set() if "u" in component.layout.fields else {("slopes", OK)}), "all was taken and refused"
    assert {*State} - seen <= (set() if name in ("mixed", "modes") else {State.FAILED})
    assert ("logEvents" in seen) == (name in ("listener", "receiver"))


@pytest.mark.filterwarnings("ignore:invalid value", "ignore:overflow", "ignore:divide by zero")
def test_the_twin_agrees_up_to_the_first_refusal(unzipped, tmp_path):
    """PythonFMU knows two ways to refuse: a step is discarded, any other call is fatal and ends the instance."""
    fmu = Unzipped(build_twin(Mixed, tmp_path), tmp_path / "twin")
    refused = set()
    for seed in range(150):
        random = np.random.default_rng([8, seed])
        host, native, twin = Host(Mixed, random, derivatives=False), Native(unzipped["mixed"]), Native(fmu)
        floats = Floats(Mixed)
        for _ in range(60):
            host.time = floats.run.time
            call = host.call()
            if call[0] in ("save", "restore"):
                continue
            floats.do(*call)
            (status, values, said), (theirs, numbers, told) = native.do(*call), twin.do(*call)
            assert (status == OK) == (theirs == OK), (call, said, told)
            assert np.array_equal(values or [], numbers or [], equal_nan=True)
            if status == ERROR:
                assert theirs == (DISCARD if call[0] == "step" else FATAL)
                assert said[0][1] in told[0][1]
                assert call[0] != "step" or told[0][0] == "logStatusError"
                refused.add(call[0])
                if theirs == FATAL:
                    break
        native.free()
        twin.slave.free()
    assert refused == {"setup", "mode", "get", "set", "step"}


def test_the_access_rules_are_those_of_the_standard():
    """Table of section 4.2.4 of FMI 2.0, restrictions 1, 3 and 6."""
    early = State.INSTANTIATED | State.INITIALIZATION
    assert life.settable("input", "continuous", None) == early | State.STEPPING
    assert life.settable("parameter", "tunable", "exact") == early | State.STEPPING
    assert life.settable("parameter", "fixed", "exact") == early
    for causality in ("output", "local"):
        assert life.settable(causality, "discrete", "exact") == early
        assert life.settable(causality, "continuous", "calculated") == State(0)
    assert life.CALLS["fmi2SetRealInputDerivatives"] == early | State.STEPPING


def test_both_sides_know_which_variables_are_calculated(unzipped):
    """A bundle or an array that a start task assigns is calculated as a whole."""
    for name, component in COMPONENTS.items():
        calculated = {e.name for e in Interpreter(component).elements if e.variable.initial == "calculated"}
        described = {n for n, v in unzipped[name].variables.items() if v.get("initial") == "calculated"}
        assert calculated == described
    assert {"first", "begun"} == {v.name for v in Interpreter(Mixed).variables if v.initial == "calculated"}


def test_a_state_with_a_start_value_can_be_set_before_initialisation_and_counts(unzipped):
    native, floats = Slave(unzipped["mixed"]), Interpreter(Mixed)
    assert native.set("covariance", [7.0, 8.0]) == OK
    floats.set("covariance", [7.0, 8.0])
    assert native.initialise() == OK
    floats.setup()
    assert native.get("first") == floats.get("first") == 8.0
    assert native.set("covariance", [1.0, 2.0]) == ERROR
    assert native.said == (
        "Variable 'covariance[1]' cannot be set after initialisation: it is fixed once initialisation has ended."
    )
    native.free()


def test_a_call_that_is_refused_changes_nothing(unzipped):
    native, floats = Slave(unzipped["mixed"]), Interpreter(Mixed)
    native.initialise()
    floats.setup()
    u, stride = unzipped["mixed"].reference("u"), unzipped["mixed"].reference("stride")
    assert native.set_references("Real", [u, stride], [3.0, 5.0]) == ERROR
    with pytest.raises(NavfmuError, match="stride"):
        floats.set_values("Real", [u, stride], [3.0, 5.0])
    assert native.get("u") == floats.get("u") == 0.0
    native.free()


def test_an_integer_that_would_get_a_fraction_fails_the_step_and_reset_helps(unzipped):
    native, floats = Slave(unzipped["mixed"]), Interpreter(Mixed)
    native.initialise(stride=0.5)
    assert native.step(0.0, 0.1) == ERROR
    assert native.said == "'count' is an Integer and is assigned 0.5."
    assert native.step(0.0, 0.1) == ERROR
    assert native.said == "fmi2DoStep is not allowed after a step that failed."
    assert native.get("count") == 0, "values can be looked at"
    assert native.call("Reset") == OK
    assert native.initialise() == OK
    assert native.step(0.0, 0.1) == OK
    assert native.get("count") == 1
    native.free()
    floats.set("stride", 0.5)
    floats.setup()
    with pytest.raises(NavfmuError, match=r"line \d+: component Mixed: 'count' is an Integer and is assigned 0\.5\."):
        floats.do_step(0.0, 0.1)
    assert floats.state == State.FAILED
    with pytest.raises(NavfmuError, match="'level' is an Integer"):
        Interpreter(Mixed).set("level", 0.5)


@pytest.mark.parametrize("sentence", ['why "{x}" ???/', 'wie "{x}" ü ??/ ?'])
def test_a_requirement_says_what_it_was_given_to_say(sentence, tmp_path):
    """In C99, ??/ in a text is a backslash, which takes the character behind it along, or the end of the text."""

    class Asks(Component):
        """Asks."""

        x = Parameter("m", start=1.0)
        y = Output("m")
        sample_period = Parameter("s", start=0.1)

        @every("sample_period")
        def step(self):
            self.y = self.x

        @require(sentence)
        def hold(self):
            return self.x < 2.0

    (path,) = build([Asks], tmp_path, pictures=False)
    native, floats = Slave(Unzipped(path, tmp_path / "asks")), Interpreter(Asks)
    assert native.initialise(x=3.0) == ERROR
    floats.set("x", 3.0)
    with pytest.raises(NavfmuError) as told:
        floats.setup()
    assert native.said == str(told.value) == sentence.replace("{x}", "3")
    native.free()


def test_the_generated_c_code_takes_its_rules_from_the_table():
    text = generate(lower(Mixed), "{guid}")
    assert "REAL | INSTANTIATED | INITIALIZATION | STEPPING" in text
    header = life.header()
    assert "#define IN_fmi2DoStep 32" in header
    for name, message in life.MESSAGES.items():
        assert f'#define SAY_{name} {message.category}, "{message.sentence}"' in header
