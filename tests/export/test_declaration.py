"""What a component class declares, and the sentences about what is wrong with it."""

import re

import numpy as np
import pytest
import scipy.linalg
from numpy import array, full, where

from evidence.compiled import Compiled, linked
from navfmu.errors import NavfmuError
from navfmu.export import Bundle, Component, Grid, Input, Output, Parameter, State, Table, every, on_new, require, start
from navfmu.export.interpreter import Interpreter
from navfmu.export.record.graph import elements_used
from navfmu.export.tracing.lower import lower

from .components import Listener, Sensor, Source


def refused(make, *parts):
    """Call ``make``; it must raise a sentence with this file, a line, and the parts."""
    with pytest.raises(NavfmuError) as caught:
        make()
    sentence = str(caught.value)
    assert re.match(re.escape(__file__) + r", line \d+: ", sentence), sentence
    for part in parts:
        assert part in sentence, sentence


def test_variables_keep_the_order_of_declaration_and_arrays_are_contiguous():
    assert [e.name for e in Sensor.layout.elements] == [
        "u[1]", "u[2]", "broken", "sigma", "gain", "sample_period", "bias[1]", "bias[2]",
        "reading.s[1]", "reading.s[2]", "reading.valid", "reading.sequence", "reading.time_of_validity",
        "seed", "stream",
    ]  # fmt: skip
    assert [e.index for e in Sensor.layout.elements] == list(range(15))
    assert [(v.name, v.index, v.shape) for v in Sensor.layout.variables][5:8] == [
        ("bias", 6, (2,)), ("reading.s", 8, (2,)), ("reading.valid", 10, ()),
    ]  # fmt: skip


def test_matrix_elements_are_named_from_one_in_rows():
    class Grid(Component):
        """Grid."""

        m = Input((2, 3), "m", start=[[1, 2, 3], [4, 5, 6]], description="matrix")

    assert [(e.name, e.start) for e in Grid.layout.elements] == [
        ("m[1,1]", 1.0), ("m[1,2]", 2.0), ("m[1,3]", 3.0), ("m[2,1]", 4.0), ("m[2,2]", 5.0), ("m[2,3]", 6.0),
    ]  # fmt: skip


def test_name_description_and_text_come_from_the_class():
    assert (Sensor.layout.name, Sensor.layout.description) == ("sensor", "Noisy sensor.")
    assert Sensor.layout.text == "Its reading is s = u + b + w, with a random bias b."

    class AirDataComputer(Component):
        """Air data."""

    class Other(Component):
        """Other."""

        name = "chosen"

    assert AirDataComputer.layout.name == "air_data_computer"
    assert Other.layout.name == "chosen"


def test_streams_of_different_components_differ_and_do_not_change():
    def stream(component):
        return component.layout.fields["stream"].start[0]

    class Another(Component):
        """Noise."""

        T = Parameter("s", start=1.0)
        y = Output("1")

        @every("T")
        def step(self, noise):
            self.y = noise(1)[0]

    assert stream(Sensor) == 1015420848
    assert stream(Another) != stream(Sensor)
    assert "seed" not in Listener.layout.fields


def test_attributes_reach_the_lowered_model():
    model = lower(Sensor)
    by_name = {v.name: v for v in model.variables}
    assert (by_name["u"].causality, by_name["u"].variability, by_name["u"].initial) == (
        "input",
        "continuous",
        None,
    )
    assert (
        by_name["broken"].fault and by_name["broken"].type == "Boolean" and by_name["broken"].variability == "discrete"
    )
    assert (by_name["sigma"].min, by_name["sigma"].max, by_name["sigma"].variability) == ((0.0,), (10.0,), "fixed")
    assert by_name["gain"].variability == "tunable"
    assert (by_name["bias"].causality, by_name["bias"].initial) == ("local", "calculated")
    assert (by_name["reading.s"].bundle, by_name["reading.s"].initial) == ("reading", "exact")
    assert (by_name["reading.sequence"].type, by_name["reading.valid"].type) == ("Integer", "Boolean")
    assert (model.elements[model.seed].name, model.elements[model.stream].name) == ("seed", "stream")
    assert model.documentation["text"].startswith("Its reading")
    assert "self.gain * self.u" in model.documentation["tasks"][1]["source"]


def test_only_changed_variables_are_targets():
    model = lower(Listener)
    names = [model.elements[i].name for i in model.tasks[0].targets]
    assert names == ["held[1]", "held[2]", "seen_at", "updates"]

    class Half(Component):
        """Keeps its second element."""

        T = Parameter("s", start=1.0)
        x = State(2, "1")

        @every("T")
        def step(self):
            self.x = np.array([1.0, self.x[1]])

    model = lower(Half)
    assert [model.elements[i].name for i in model.tasks[0].targets] == ["x[1]"]


def test_tasks_refer_to_their_clock_and_bundle():
    model = lower(Listener)
    task, names = model.tasks[0], [e.name for e in model.elements]
    assert task.kind == "on_new"
    assert [names[i] for i in (task.clock.period, task.sequence, task.time_of_validity, task.lost)] == [
        "sample_period", "reading.sequence", "reading.time_of_validity", "reading.lost",
    ]  # fmt: skip
    sensor = lower(Sensor)
    assert [(t.kind, t.normals) for t in sensor.tasks] == [("start", 2), ("every", 2)]
    assert len({t.stream for t in sensor.tasks}) == 2


def test_source_outputs_are_calculated_at_the_start():
    model = lower(Source)
    assert {v.name: v.initial for v in model.variables}["x"] == "calculated"
    assert model.tables[0].columns == ("time", "x")
    assert [set().union(*elements_used(t.values, "time")) for t in model.tasks] == [{0}, {0}]  # searched by it


def test_a_function_can_be_a_task_of_two_components():
    def step(self):
        self.y = self.time

    def make(period):
        members = {"__doc__": "Made.", "y": Output("s"), period: Parameter("s", start=1.0), "step": every(period)(step)}
        return type("Made", (Component,), members)

    one, two = make("slow"), make("fast")
    assert [c.layout.tasks[0].argument for c in (one, two)] == ["slow", "fast"]


def test_a_task_can_be_left_out_or_replaced_by_a_subclass():
    class Quiet(Sensor):
        """Takes no samples."""

        sample = None

    class Twice(Sensor):
        """Takes others."""

        @every("sample_period")
        def sample(self):
            self.reading.publish(s=2 * self.u)

    assert [t.name for t in Quiet.layout.tasks] == ["turn_on"]
    assert [(t.name, t.uses_noise) for t in Twice.layout.tasks] == [("turn_on", True), ("sample", False)]


def test_components_can_inherit():
    class Better(Sensor):
        """Better sensor."""

        extra = Output("m")

    assert [v.name for v in Better.layout.variables][:3] == ["u", "broken", "sigma"]
    assert "extra" in Better.layout.fields
    assert "extra" not in Sensor.layout.fields
    assert [t.name for t in Better.layout.tasks] == ["turn_on", "sample"]


DECLARATIONS = {
    "no unit": (lambda: Input(3), "unit"),
    "bad kind": (lambda: Input("m", kind="reel"), "did you mean 'real'?"),
    "start of wrong shape": (lambda: Input(3, "m", start=(1, 2)), "start has shape (2,)", "(3,)"),
    "bound of wrong shape": (lambda: Parameter(3, "m", min=(1, 2)), "(2,)"),
    "start that is no number": (lambda: Parameter("m", start=np.nan), "start is nan", "finite"),
    "start without end": (lambda: Output(3, "m", start=np.inf), "start is inf", "finite"),
    "start that is a word": (lambda: Input("m", start="a"), "start is 'a'", "a number"),
    "bound without end": (lambda: Parameter("m", max=np.inf), "max is inf", "leave out"),
    "bound that is no number": (lambda: Parameter("m", min=np.nan), "min is nan"),
    "start below min": (lambda: Parameter("m", min=1.0), "start is 0, which is below its min, 1.0"),
    "start above max": (lambda: State(2, "m", start=(1, 5), max=4), "start is 5, which is above its max, 4"),
    "range upside down": (lambda: Input("m", min=1.0, max=-1.0), "min is 1.0 and max is -1.0"),
    "integer of a half": (lambda: Output(kind="integer", start=0.5), "start is 0.5", "whole number"),
    "integer too large": (lambda: Parameter(kind="integer", max=2**31), "max is 2147483648", "32 bits"),
    "boolean of two": (lambda: Input(kind="boolean", start=2), "start is 2", "True or False"),
    "boolean with a bound": (lambda: Input(kind="boolean", min=0), "no min"),
    "nominal of 0": (lambda: Output("m", nominal=0.0), "nominal is 0.0", "positive"),
    "tunable input": (lambda: Input("m", tunable=True), "parameters"),
    "fault output": (lambda: Output("m", fault=True), "inputs"),
    "mixed bundle": (lambda: Bundle(a=Input("m"), b=Output("m")), "all Input or all Output"),
    "member called valid": (lambda: Bundle(valid=Input("m")), "'valid'"),
    "member called as its view has it": (lambda: Bundle(_bundle=Output("m")), "the name '_bundle' is taken"),
    "member called as Python has it": (lambda: Bundle(__x=Output("m")), "the name '__x' is taken"),
    "member called as the option of publish": (lambda: Bundle(when=Output("m")), "the name 'when' is taken"),
    "every number": (lambda: every(0.1), "name of a Parameter"),
    "on_new without name": (lambda: on_new(None), "input Bundle"),
    "table of wrong width": (lambda: Table(columns=(("time", "s"),), rows=[[0, 1], [1, 2]]), "(2, 2)"),
    "table by a column that goes up and down": (
        lambda: Table(columns=(("time", "s"), ("x", "m")), rows=[[0, 1], [1, 3], [2, 3]], key=("time", "x")),
        "Table is searched by 'x', which does not increase",
    ),
    "table by an unknown column": (
        lambda: Table(columns=(("time", "s"), ("height", "m")), rows=[[0, 1], [1, 3]], key="hieght"),
        "no column 'hieght' to be searched by; did you mean 'height'?",
    ),
    "table without units": (
        lambda: Table(columns=("time", "height"), rows=[[0, 1], [1, 3]]),
        "Table has a column 'time'; expected (name, unit)",
    ),
    "grid without units": (
        lambda: Grid(axes=(("x", [0, 1]), ("y", [0, 1])), surfaces=(("z", "m", np.zeros((2, 2))),)),
        "Grid has an axis ('x', [0, 1]); expected (name, unit, numbers)",
    ),
    "table of a file's name": (
        lambda: Table(columns=(("time", "s"),), rows="plan.npy"),
        "Table has rows that are no array of numbers: could not convert string to float: 'plan.npy'; a file is read",
    ),
    "grid with a row that is short": (
        lambda: Grid(axes=(("x", "m", [0, 1]), ("y", "m", [0, 1])), surfaces=(("z", "m", [[0, 1], [2]]),)),
        "Grid has numbers of 'z' that are no array of numbers",
    ),
    "table by a number": (
        lambda: Table(columns=(("time", "s"),), rows=[[0], [1]], key=0),
        "Table has no column '0' to be searched by",
    ),
    "require without a sentence": (lambda: require(_quiet()), "require needs a sentence"),
    "a description that is no text": (lambda: Input("m", description=3), "3 is no text"),
    "table by nothing": (
        lambda: Table(columns=(("time", "s"),), rows=[[0], [1]], key=()),
        "is searched by nothing; expected a column",
    ),
    "table with a column twice": (
        lambda: Table(columns=(("x", "s"), ("x", "m")), rows=[[0, 1], [1, 3]]),
        "has two columns 'x'",
    ),
    "table with a hole": (
        lambda: Table(columns=(("time", "s"), ("x", "m")), rows=[[0, 1], [1, np.nan]]),
        "has a number in 'x' that is not finite",
    ),
    "grid with one axis": (
        lambda: Grid(axes=(("x", "m", [0, 1]),), surfaces=(("z", "m", [0, 1]),)),
        "has 1 axes and 1 surfaces; expected 2 axes",
    ),
    "grid without a surface": (
        lambda: Grid(axes=(("x", "m", [0, 1]), ("y", "m", [0, 1])), surfaces=()),
        "has 2 axes and 0 surfaces",
    ),
    "grid on its side": (
        lambda: Grid(axes=(("x", "m", [0, 1]), ("y", "m", [0, 1, 2])), surfaces=(("z", "m", np.zeros((3, 2))),)),
        "has 'z' of shape (3, 2), expected (2, 3)",
    ),
    "grid with an axis of two dimensions": (
        lambda: Grid(axes=(("x", "m", [[0, 1]]), ("y", "m", [0, 1])), surfaces=(("z", "m", np.zeros((2, 2))),)),
        "has 'x' of shape (1, 2), expected a list of numbers",
    ),
    "grid with an axis that stands still": (
        lambda: Grid(axes=(("x", "m", [0, 1]), ("y", "m", [1, 1])), surfaces=(("z", "m", np.zeros((2, 2))),)),
        "is searched by 'y', which does not increase",
    ),
    "grid with one column": (
        lambda: Grid(axes=(("x", "m", [0, 1]), ("y", "m", [1])), surfaces=(("z", "m", np.zeros((2, 1))),)),
        "is searched by 'y', which does not increase; expected two or more",
    ),
    "table without columns": (lambda: Table(columns=(), rows=[[], []]), "0 columns"),
    "two decorators": (lambda: on_new("a")(on_new("b")(_quiet())), "two decorators", "second method"),
    "start and every": (lambda: start(every("T")(_quiet())), "two decorators"),
    "task and requirement": (lambda: every("T")(require("no")(_quiet())), "two decorators"),
    "two requirements": (lambda: require("no")(require("never")(_quiet())), "two decorators"),
    "decorated property": (lambda: start(property(_quiet())), "plain method"),
    "table out of order": (lambda: Table(columns=(("time", "s"),), rows=[[1], [0]]), "increase"),
}


@pytest.mark.parametrize("name", DECLARATIONS)
def test_wrong_declarations_are_refused_with_file_and_line(name):
    make, *parts = DECLARATIONS[name]
    refused(make, *parts)


def _class(**members):
    return lambda: type("Made", (Component,), {"__doc__": "Made.", **members})


def _quiet():
    return lambda self: None


def _twice(variable):
    return _class(a=variable, b=variable)


def _greedy():
    return lambda self, noise, more: None


CLASSES = {
    "an instance": (Sensor, "component Sensor is made anew for each tick; give the class, as in Interpreter(Sensor)"),
    "unknown period": (_class(T=Parameter("s"), step=every("S")(_quiet())), "'S'", "Parameter in s"),
    "braces in a sentence": (_class(x=Parameter("m"), check=require("x {x} of {{x}}")(_quiet())), "no braces but"),
    "a single brace": (_class(x=Parameter("m"), check=require("x {x} }")(_quiet())), "no braces but"),
    "period of two": (_class(T=Parameter(2, "s"), step=every("T")(_quiet())), "'T'"),
    "tunable offset": (_class(T=Parameter("s", tunable=True), step=every("T", offset="T")(_quiet())), "tunable"),
    "unknown bundle": (
        _class(fix=Bundle(x=Input("m")), T=Parameter("s"), tick="T", on=on_new("fixx")(_quiet())),
        "did you mean 'fix'?",
    ),
    "output bundle": (
        _class(fix=Bundle(x=Output("m")), T=Parameter("s"), tick="T", on=on_new("fix")(_quiet())),
        "'fix'",
    ),
    "no clock": (_class(fix=Bundle(x=Input("m")), on=on_new("fix")(_quiet())), "tick ="),
    "two tasks on a bundle": (
        _class(f=Bundle(x=Input("m")), T=Parameter("s"), tick="T", a=on_new("f")(_quiet()), b=on_new("f")(_quiet())),
        "two tasks",
    ),
    "arguments": (_class(T=Parameter("s"), step=every("T")(_greedy())), "noise"),
    "reserved name": (_class(time=Input("s")), "'time'"),
    "sentence names nothing": (_class(a=Parameter("s"), c=require("{aa} is wrong")(_quiet())), "did you mean 'a'?"),
    "sentence with a format": (_class(a=Parameter("s"), c=require("{a:.2f} is wrong")(_quiet())), "without a format"),
    "sentence with a gap": (_class(a=Parameter("s"), c=require("{} is wrong")(_quiet())), "with a name"),
    "name": (_class(name="air data"), "identifier"),
    "__init__": (_class(__init__=_quiet()), "has an __init__; a component keeps nothing of its own but States"),
    "list of states": (_class(x=[State("m"), State("m")]), "'x' is a list of declarations", 'State(3, "m")'),
    "dictionary of bundles": (_class(x={"a": (Bundle(x=Input("m")),)}), "'x' is a dict of declarations"),
    "one variable, two names": (_twice(Output("m")), "'a' and 'b' are one declaration"),
    "overridden task": (lambda: type("Made", (Sensor,), {"__doc__": "Made.", "sample": _quiet()}), "'sample'", "None"),
}


@pytest.mark.parametrize("name", CLASSES)
def test_wrong_classes_are_refused_with_file_and_line(name):
    make, *parts = CLASSES[name]
    refused(make, *parts)


class Playground(Component):
    """Everything a task could touch."""

    u = Input(3, "m", start=(1, 2, 3))
    fix = Bundle(x=Input("m"))
    out = Bundle(y=Output(2, "m"))
    gain = Parameter("1", start=2.0)
    T = Parameter("s", start=1.0)
    state = State(3, "m")
    whole = Output(kind="integer")
    mode = Output(kind="enumeration", items=("search", "track"))


def _run_in(mode, body):
    class Ground(Playground):
        """Playground."""

        step = every("T")(body)

    if mode == "traced":
        lower(Ground)
    else:
        run = Interpreter(Ground)
        run.setup()
        run.do_step(0.0, 1.0)


def _set(name, value):
    return lambda self: setattr(self, name, value)


def _store(self):
    self.u[0] = 1.0


TASKS = {
    "assign an input": (_set("u", np.zeros(3)), "'u'", "input"),
    "assign a parameter": (_set("gain", 1.0), "'gain'", "parameter"),
    "assign a bundle": (_set("out", 1.0), "publish"),
    "assign the time": (_set("time", 1.0), "'time'"),
    "wrong shape": (_set("state", np.zeros(2)), "(2,)", "(3,)"),
    "number for an array": (_set("state", 1.0), "()", "(3,)"),
    "unknown name": (_set("stat", np.zeros(3)), "did you mean 'state'?"),
    "the name of an item": (
        _set("mode", "track"),
        "'mode' is assigned the text 'track', expected the number of an item: 1 for 'search', 2 for 'track'",
    ),
    "a text": (_set("whole", "3"), "'whole' is assigned the text '3', expected a number"),
    "read an unknown name": (lambda self: self.gian, "did you mean 'gain'?"),
    "unknown member": (lambda self: self.fix.xx, "did you mean 'x'?"),
    "publish an unknown member": (lambda self: self.out.publish(z=1.0), "'z'"),
    "publish a wrong shape": (lambda self: self.out.publish(y=1.0, when=self.gain > 0), "(2,)"),
    "publish an input": (lambda self: self.fix.publish(x=1.0), "input"),
    "assign a member": (lambda self: setattr(self.out, "y", 1.0), "publish(y="),
}


@pytest.mark.parametrize("mode", ["traced", "floats"])
@pytest.mark.parametrize("name", TASKS)
def test_wrong_tasks_are_refused_with_file_and_line_in_both_modes(name, mode):
    body, *parts = TASKS[name]
    refused(lambda: _run_in(mode, body), *parts)


def test_reading_gives_read_only_arrays_in_both_modes():
    refused(lambda: _run_in("traced", _store), "read-only")
    with pytest.raises(ValueError, match="read-only"):
        _run_in("floats", _store)


def test_failures_of_numpy_while_tracing_get_file_and_line():
    def wrong_shapes(self):
        self.state = self.u + np.zeros(4)

    def index(self):
        self.whole = np.array([1, 2, 3])[self.whole]

    def elsewhere(self):
        self.state = scipy.linalg.expm(np.outer(self.state, self.state))[0]

    for body in (wrong_shapes, index, elsewhere):
        refused(lambda body=body: _run_in("traced", body), "plain NumPy", f"line {body.__code__.co_firstlineno + 1}")


def test_a_truth_value_assigned_to_a_number_is_a_number_in_both_modes():
    class Counter(Component):
        """Adds truth values."""

        T = Parameter("s", start=1.0)
        u = Input("m", start=1.0)
        n = Output("1")

        @every("T")
        def step(self):
            self.n = self.u > 0
            self.n = self.n + self.n

    run = Interpreter(Counter)
    run.setup()
    run.do_step(0.0, 1.0)
    assert run.get("n") == 2.0
    (native,) = linked([Compiled(lower(Counter).tasks[0].values, (1,))])
    assert native([1.0, 1.0, 0.0]) == 2.0


def test_functions_of_numpy_that_are_imported_by_name_are_traced():
    class ByName(Component):
        """By name."""

        u = Input(2, "1")
        y = Output(2, "1")
        sample_period = Parameter("s", start=1.0)

        @every("sample_period")
        def step(self):
            pair = array([self.u[1], 2.0], float)
            self.y = where(array([self.u[0], -1.0]) > 0, np.sqrt(pair), np.maximum(full(2, self.u[0]), 3.0))

    (native,) = linked([Compiled(lower(ByName).tasks[0].values, (2,))])
    assert native([4.0, 9.0, 0.0, 0.0, 1.0]).tolist() == [3.0, 4.0]
    assert array is np.array and full is np.full


def test_a_list_of_values_for_numpy_is_told_to_be_an_array():
    class Lists(Component):
        """Lists."""

        u = Input("1")
        y = Output(2, "1")
        sample_period = Parameter("s", start=1.0)
        chooses = False

        @every("sample_period")
        def step(self):
            values = [self.u, 2.0]
            self.y = np.maximum(values, 1.0) if self.chooses else np.sqrt(values)

    class Chooses(Lists):
        """Chooses."""

        chooses = True

    refused(lambda: lower(Lists), "a list of traced values", "np.array([...])")
    refused(lambda: lower(Chooses), "a list of values where NumPy expects an array", "np.array([...]) for a list")


def test_requirements_are_over_parameters():
    class Wrong(Component):
        """Wrong."""

        u = Input("m")

        @require("u")
        def check(self):
            return self.u > 0

    refused(lambda: lower(Wrong), "'u'")


@pytest.mark.parametrize("what", ["time", "period", "a table"])
def test_requirements_do_not_see_time(what):
    """C looked at them with a time of 0, and the interpreter with that of the start."""

    class Late(Component):
        """Late."""

        limit = Parameter("s", start=2.0)
        track = Table(columns=(("time", "s"),), rows=[[1.0], [3.0]])

        @require("limit {limit} s")
        def check(self):
            return self.limit > {"time": self.time, "period": self.period, "a table": self.track.row[0]}[what]

    refused(lambda: lower(Late), "a requirement is over parameters, and this one is over time")


def test_a_task_may_use_start_twice():
    class Two(Component):
        """Two start tasks, the second sees the first."""

        x = Output("1")

        @start
        def first(self):
            self.x = 2.0

        @start
        def second(self):
            self.x = 3 * self.x

    run = Interpreter(Two)
    run.setup()
    assert run.get("x") == 6.0


BAD = {"\x01": "\\x01", "\x00": "\\x00", "\x0b": "\\x0b", "\ud800": "\\ud800", "\uffff": "\\uffff", "\x85": "\\x85"}


@pytest.mark.parametrize("character", BAD)
def test_texts_that_no_description_can_hold_are_refused_where_they_stand(character):
    text = f"bad{character}text"

    def class_text():
        class Odd(Component):
            __doc__ = text

    def task_text():
        class Odd(Component):
            """Odd."""

            T = Parameter("s", start=1.0)

            def step(self):
                pass

            step.__doc__ = text
            step = every("T")(step)

    def sentence():
        class Odd(Component):
            """Odd."""

            T = Parameter("s", start=1.0)

            @require(text)
            def holds(self):
                return self.T > 0

    makes = [
        task_text,
        sentence,
        lambda: Input("m", description=text),
        lambda: Bundle(s=Output("m"), description=text),
        lambda: Table(columns=(("time", "s"), (text, "m")), rows=[[0, 1], [1, 2]]),
        lambda: Grid(axes=((text, "m", [0, 1]), ("y", "m", [0, 1])), surfaces=(("z", "m", np.zeros((2, 2))),)),
    ]
    if character != "\ud800":  # Python itself refuses that
        makes.append(class_text)
    for make in makes:
        refused(make, f"the text has the character {BAD[character]}; expected no control characters")


def test_names_of_variables_are_those_of_fmi():
    """FMI 2.0, 2.2.9: identifiers of the structured naming convention."""

    def plain():
        class Odd(Component):
            """Odd."""

            größe = Input("m")

    def member():
        class Odd(Component):
            """Odd."""

            fix = Bundle(**{"breite": Output("m"), "höhe": Output("m")})

    def blank():
        class Odd(Component):
            """Odd."""

            fix = Bundle(**{"a b": Output("m")})

    expected = "cannot be the name of a variable of FMI 2.0: expected letters from A to Z, digits and '_'"
    for make, name in ((plain, "größe"), (member, "fix.höhe"), (blank, "fix.a b")):
        refused(make, f"'{name}' {expected}")


def test_a_member_may_be_called_self():
    """Declared or published by keyword it was taken for the object itself: TypeError."""

    class Own(Component):
        """Own."""

        T = Parameter("s", start=0.1)
        tick = "T"
        out = Bundle(**{"self": Output("m")})

        @every("T")
        def go(self):
            self.out.publish(**{"self": 2.0})

    assert "out.self" in [variable.name for variable in lower(Own).variables]


def test_integers_have_all_of_32_bits():
    low, high = -(2**31), 2**31 - 1
    for value in (low, high):
        number = Parameter(kind="integer", start=value, min=low, max=high)
        assert (number.start.tolist(), number.bound("min"), number.bound("max")) == ([value], (low,), (high,))
    for value in (low - 1, high + 1):
        refused(lambda value=value: Parameter(kind="integer", start=value), "expected a whole number of 32 bits")
