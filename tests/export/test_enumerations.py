"""Enumerations: numbers that have names, from the declaration to a system that connects them."""

from enum import IntEnum
from pathlib import Path

import fmpy
import numpy as np
import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.export import Component, Input, Output, Parameter, State, every
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.page.documentation import page
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin
from navfmu.faults import Fault
from navfmu.ssp.writer import SystemSource

from .components import Lock, Modes
from .slave import ERROR, OK, Slave, Unzipped

LOCK = [("SEARCH", "1"), ("TRACK", "2"), ("MEMORY", "3")]


def test_the_description_has_the_items_as_fmpy_reads_them(unzipped):
    description = fmpy.read_model_description(str(unzipped["modes"].folder))
    types = {kind.name: [(item.name, item.value) for item in kind.items] for kind in description.typeDefinitions}
    assert types == {"Lock": LOCK, "Command": [("off", "1"), ("hold", "2"), ("go on", "3")]}
    found = {v.name: v for v in description.modelVariables if v.type == "Enumeration"}
    assert {name: v.declaredType.name for name, v in found.items()} == {
        "command": "Command", "first": "Lock", "mode": "Lock", "history[1]": "Lock", "history[2]": "Lock",
    }  # fmt: skip
    starts = {name: v.start for name, v in found.items()}
    assert starts == {"command": "2", "first": "2", "mode": None, "history[1]": "3", "history[2]": "1"}
    assert {v.variability for v in found.values()} == {"discrete", "fixed"}


@pytest.mark.parametrize("form", ["native", "twin", "floats"])
def test_the_value_is_the_number_of_the_item(form, unzipped, tmp_path):
    """Catches counting from 0."""
    if form == "floats":
        run = Interpreter(Modes)
        run.set("first", 1)
        run.setup()
        run.set("command", 3)
        seen = []
        for k in range(2):
            run.do_step(0.1 * k, 0.1)
            seen.append((run.get("mode"), list(run.get("history")), run.get("seen")))
    else:
        fmu = unzipped["modes"] if form == "native" else Unzipped(build_twin(Modes, tmp_path), tmp_path / "twin")
        slave = Slave(fmu)
        assert slave.initialise(first=1) == OK
        slave.set("command", 3)
        seen = []
        for k in range(2):
            assert slave.step(0.1 * k, 0.1) == OK
            seen.append((slave.get("mode"), slave.get("history"), slave.get("seen")))
        slave.free()
    assert seen == [(Lock.TRACK, [Lock.SEARCH, Lock.MEMORY], 1.0), (Lock.MEMORY, [Lock.TRACK, Lock.SEARCH], 0.5)]


def test_a_task_that_assigns_a_number_of_no_item_fails_the_step(unzipped):
    slave, floats = Slave(unzipped["modes"]), Interpreter(Modes)
    slave.initialise(first=3)
    floats.set("first", 3)
    floats.setup()
    slave.set("command", 3)
    floats.set("command", 3)
    assert slave.step(0.0, 0.1) == ERROR
    assert slave.said == "'mode' is an Enumeration from 1 to 3 and is assigned 4."
    assert slave.get("mode") == 3
    with pytest.raises(NavfmuError, match="component Modes: 'mode' is an Enumeration from 1 to 3 and is assigned 4"):
        floats.do_step(0.0, 0.1)
    slave.free()


def test_a_parameter_outside_its_items_ends_initialisation(unzipped):
    slave = Slave(unzipped["modes"])
    assert slave.initialise(first=4) == ERROR
    assert slave.said == "Parameter 'first' is 4; expected a value from 1 to 3."
    slave.free()


def test_an_item_may_have_any_number_that_leaves_no_gap():
    class Sign(IntEnum):
        """A sign."""

        MINUS = -1
        NONE = 0
        PLUS = 1

    variable = Output(kind="enumeration", items=Sign)
    assert variable.start == -1, "the first item"
    assert (variable.min, variable.max) == (-1, 1)
    assert Output(kind="enumeration", items=Sign, start="NONE").start == 0
    several = State((2, 2), kind="enumeration", items=("a", "b"), start=[["a", "b"], [2, "a"]])
    assert list(several.start) == [1, 2, 2, 1]


def test_the_page_names_the_items():
    html = page(lower(Modes))
    assert "SEARCH\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}1, TRACK" in html, "no line ends within an item"
    html = html.replace("\N{NO-BREAK SPACE}", " ")
    assert "SEARCH = 1, TRACK = 2, MEMORY = 3" in html
    assert "off = 1, hold = 2, go on = 3" in html
    assert "<td>hold</td>" in html.replace(' class="number"', "")


class Gap(IntEnum):
    """A number is missing."""

    A = 1
    B = 3


WRONG = {
    "no items": (lambda: Input(kind="enumeration"), 'items and kind="enumeration" go together'),
    "items of a real": (lambda: Input("m", items=("a", "b")), 'items and kind="enumeration" go together'),
    "one text": (lambda: Input(kind="enumeration", items="ab"), "items are 'ab', expected names"),
    "nothing": (lambda: Input(kind="enumeration", items=()), "expected names, each of them once, or an IntEnum"),
    "twice": (lambda: Input(kind="enumeration", items=("a", "a")), "expected names, each of them once"),
    "numbers": (lambda: Input(kind="enumeration", items=(1, 2)), "expected names, each of them once"),
    "a class": (
        lambda: Input(kind="enumeration", items=Interpreter),
        "expected names, each of them once, or an IntEnum",
    ),
    "a gap": (lambda: Input(kind="enumeration", items=Gap), "items have the numbers A = 1, B = 3; expected numbers"),
    "start": (
        lambda: Input(kind="enumeration", items=("off", "on"), start="onn"),
        "start is 'onn', expected one of off, on; did you mean 'on'?",
    ),
    "number": (
        lambda: Input(kind="enumeration", items=("off", "on"), start=3),
        "start is 3, which is above its max, 2",
    ),
    "kind": (lambda: Input(kind="enumeratoin"), "boolean, enumeration or string; did you mean 'enumeration'?"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_declarations_are_refused_with_a_sentence(name):
    make, sentence = WRONG[name]
    with pytest.raises(NavfmuError) as refused:
        make()
    assert "test_enumerations.py, line " in str(refused.value) and sentence in str(refused.value)


def test_a_name_stands_for_one_enumeration_of_a_component():
    def declare(**members):
        period = Parameter("s", start=0.1)
        task = every("sample_period")(lambda self: None)
        return type("Made", (Component,), {"__doc__": "Made.", "sample_period": period, "step": task, **members})

    other = IntEnum("Lock", ["SEARCH", "TRACK"])
    with pytest.raises(NavfmuError, match="its items are another 'Lock' than those of another variable"):
        declare(a=Output(kind="enumeration", items=Lock), b=Output(kind="enumeration", items=other))
    with pytest.raises(NavfmuError, match="'Lock' is the name of a variable and that of an enumeration"):
        declare(Lock=Output("1"), a=Output(kind="enumeration", items=Lock))


class Follower(Component):
    """Does what another one's mode is."""

    told = Input(kind="enumeration", items=Lock, description="mode of the other")
    sample_period = Parameter("s", start=0.1, description="sampling period")
    mode = Output(kind="enumeration", items=Lock, description="its own mode")

    @every("sample_period")
    def step(self):
        self.mode = self.told


@pytest.fixture(scope="module")
def pair(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("pair")
    build([Modes, Follower], folder, pictures=False)
    source = SystemSource("pair", fmus=folder, stop_time=1.0, step=0.1)
    source.component("a", "modes.fmu").component("b", "follower.fmu")
    source.connect("a.mode", "b.told").parameters("a", {"first": "SEARCH"})
    return source.pack(folder / "pair.ssp")


def test_a_system_connects_them_sets_them_by_name_and_its_faults_know_the_names(pair):
    """Both engines; numbers are recorded."""
    system = System.load(pair)
    fault = Fault("stuck", "a.mode", "stuck", value="MEMORY", start=0.5, duration=0.2)
    results = [system.run(seed=1, faults=[fault], engine=engine) for engine in ("compiled", "reference")]
    for result in results:
        assert list(result["a.mode"]) == [1, 1, 1, 1, 1, 3, 3, 1, 1, 1, 1]
        assert list(result["b.mode"])[1:] == [1, 1, 1, 1, 3, 3, 1, 1, 1, 1]
    assert np.array_equal(system.run(parameters={"a.first": "MEMORY"})["a.mode"], np.full(11, 3.0))
    with pytest.raises(NavfmuError, match="expected one of SEARCH, TRACK, MEMORY; did you mean 'MEMORY'"):
        system.run(parameters={"a.first": "MEMROY"})


def test_what_has_items_that_another_does_not_know_is_not_connected(tmp_path, pair):
    class Switch(Component):
        """Knows two of three."""

        told = Input(kind="enumeration", items=("SEARCH", "TRACK"))
        sample_period = Parameter("s", start=0.1)
        y = Output("1")

        @every("sample_period")
        def step(self):
            self.y = self.told + 0.5

    build([Switch], pair.parent, pictures=False)
    source = SystemSource("wrong", fmus=pair.parent, stop_time=1.0, step=0.1)
    source.component("a", "modes.fmu").component("b", "switch.fmu").connect("a.mode", "b.told")
    with pytest.raises(NavfmuError, match=r"one enumeration \(SEARCH = 1, TRACK = 2, MEMORY = 3\) to another \(SEARCH"):
        System.load(source.pack(tmp_path / "wrong.ssp"))


def test_the_interpreter_takes_names_of_items_and_refuses_other_texts_and_shapes():
    """float('TRACK') and NumPy's sentence on broadcasting were what one was told."""

    class Several(Component):
        """Of each kind."""

        mode = Input(kind="enumeration", items=("search", "track"))
        modes = Input(2, kind="enumeration", items=("search", "track"))
        noises = Parameter(4, "m", start=1.0)

    run = Interpreter(Several)
    run.set("mode", "track")
    run.set("modes", "track")
    run.set("noises", [1.0, 2.0, 3.0, 4.0])
    assert (run.get("mode"), run.get("modes").tolist(), run.get("noises").tolist()) == (2, [2, 2], [1, 2, 3, 4])
    for name, value, told in (
        ("mode", "trakc", "'mode' is set to the text 'trakc'; expected one of search, track; did you mean 'track'?"),
        ("noises", "one", "'noises' is set to the text 'one'; expected a number"),
        ("noises", [1.0, 2.0], "'noises' is set to values of shape (2,); expected (4,), or one for all"),
        ("mode", [1, 2], "'mode' is set to values of shape (2,); expected (), or one for all"),
    ):
        with pytest.raises(NavfmuError) as refused:
            run.set(name, value)
        assert str(refused.value) == told
