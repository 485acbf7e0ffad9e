"""String parameters: texts in places of their own in the state of an instance, and who sets them."""

import ctypes
import re
from pathlib import Path

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner
from fmpy.validation import validate_fmu

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.export import Component, Example, Input, Output, Parameter, State, every, require
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.page.documentation import page
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin
from navfmu.ssp.writer import SystemSource

from .components import Named
from .slave import ERROR, OK, Slave, Unzipped

STARTS = {"station": "TUL", "others[1]": "", "others[2]": "a b", "others[3]": "Zürich"}


def texts(slave):
    return {name: slave.get(name) for name in STARTS}


def test_the_description_has_the_start_values_as_fmpy_reads_them(unzipped):
    description = fmpy.read_model_description(str(unzipped["named"].folder))
    found = {v.name: v for v in description.modelVariables if v.type == "String"}
    assert {name: v.start for name, v in found.items()} == STARTS
    assert {(v.causality, v.variability, v.initial) for v in found.values()} == {("parameter", "fixed", "exact")}
    assert found["station"].description == "name of the station (at most 8 bytes)"
    assert validate_fmu(str(unzipped["named"].folder)) == []


@pytest.mark.parametrize("form", ["native", "twin"])
def test_texts_are_set_read_and_reset(form, unzipped, tmp_path):
    """Catches places that overlap, or that are a byte short: neighbours are filled to the last byte."""
    fmu = unzipped["named"] if form == "native" else Unzipped(build_twin(Named, tmp_path), tmp_path / "twin")
    slave = Slave(fmu)
    assert texts(slave) == STARTS
    full = {"station": "12345678", "others[1]": 100 * "a", "others[2]": 50 * "ü", "others[3]": 100 * "c"}
    for name, text in full.items():
        assert slave.set(name, text) == OK, slave.said
    assert texts(slave) == full
    assert slave.set("others[2]", "b") == OK
    assert texts(slave) == full | {"others[2]": "b"}
    assert slave.initialise() == OK
    assert slave.step(0.0, 0.1) == OK
    assert texts(slave) == full | {"others[2]": "b"}
    slave.call("Reset")
    assert texts(slave) == STARTS
    slave.free()


def test_the_caller_keeps_its_own_texts(unzipped):
    """What was set is copied, FMI 2.0.4, section 2.1.7: catches a pointer that is kept."""
    slave, buffer = Slave(unzipped["named"]), ctypes.create_string_buffer(b"SGF")
    one, reference = ctypes.c_size_t(1), (ctypes.c_uint * 1)(unzipped["named"].reference("station"))
    assert slave.call("SetString", reference, one, (ctypes.c_char_p * 1)(ctypes.addressof(buffer))) == OK
    buffer.value = b"XXX"
    assert slave.get("station") == "SGF"
    slave.free()


def test_a_longer_text_is_refused_with_its_bound_and_changes_nothing(unzipped):
    slave, floats = Slave(unzipped["named"]), Interpreter(Named)
    both = ["station", "others[1]"]
    references = [unzipped["named"].reference(name) for name in reversed(both)]
    assert slave.set_references("String", references, ["first", "Tulsa DME"]) == ERROR
    assert slave.said == "'station' is set to a text of 9 bytes; expected at most 8 bytes of UTF-8."
    assert texts(slave) == STARTS
    with pytest.raises(NavfmuError) as refused:
        floats.set_values("String", references, ["first", "Tulsa DME"])
    assert str(refused.value) == slave.said
    assert [floats.get(name) for name in STARTS] == list(STARTS.values())
    assert slave.set("station", "Zürich-X") == ERROR, "9 bytes are 8 characters"
    assert slave.set_references("String", references, ["x", None]) == ERROR
    assert slave.said == "'station' is a String and is set to no text."
    with pytest.raises(NavfmuError, match="'station' is a String and is set to no text"):
        floats.set("station", 5)
    slave.free()


@pytest.mark.parametrize(
    ("data", "byte"),
    [
        (b"Z\xc3", 2),  # cut in the middle of a character
        (b"a\xe2\x82b", 2),
        (b"\xfcber", 1),  # Latin-1
        (b"\xc0\x80", 1),  # 0 in two bytes
        (b"\xe0\x80\x80", 1),
        (b"\xf0\x80\x80\x80", 1),
        (b"ab\xed\xa0\x80", 3),  # half of a character of UTF-16
        (b"\xf4\x90\x80\x80", 1),
        (b"\xf5\x80\x80\x80", 1),
        (b"\x80", 1),
        ("Zü€😀".encode()[:-1], 7),
        ("éé€".encode(), None),
        ("😀\U0010ffff".encode(), None),
        ("\ud7ff\ue000".encode(), None),
    ],
)
def test_a_text_is_utf_8(data, byte, unzipped):
    """Which texts are is Python's judgement. Catches a text that is cut to its bound in the middle of a character,
    which other hosts cannot read."""
    slave = Slave(unzipped["named"])
    try:
        data.decode()
    except UnicodeDecodeError as error:
        assert byte == error.start + 1
    status = slave.set_references("String", [unzipped["named"].reference("others[2]")], [data[:8]])
    if byte is None:
        assert status == OK and slave.get("others[2]") == data.decode()
    else:
        assert status == ERROR and slave.get("others[2]") == "a b"
        assert slave.said == f"'others[2]' is set to a text whose byte {byte} begins no character; expected UTF-8."
    slave.free()


def test_a_text_that_c_cannot_have_is_refused_with_floats_too():
    floats = Interpreter(Named)
    for text in ("\udcff", "ü\0", "\ud800"):
        with pytest.raises(NavfmuError, match=f"whose byte {len(text) if text[0] != 'ü' else 3} begins no character"):
            floats.set("station", text)


def test_texts_stand_once_initialisation_has_ended(unzipped):
    slave, floats = Slave(unzipped["named"]), Interpreter(Named)
    slave.initialise()
    floats.setup()
    assert slave.set("station", "SGF") == ERROR
    with pytest.raises(NavfmuError) as refused:
        floats.set("station", "SGF")
    assert slave.said == str(refused.value)
    assert slave.said.endswith("cannot be set after initialisation: it is fixed once initialisation has ended.")
    assert slave.get("station") == floats.get("station") == "TUL"
    slave.free()


def test_saved_states_hold_the_texts_and_equal_texts_are_equal_bytes(unzipped):
    """Catches what is left behind of a longer text."""
    slave, other = Slave(unzipped["named"]), Slave(unzipped["named"])
    slave.set("station", "SGF")
    other.set("station", "a longer"), other.set("station", "SGF")
    saved = slave.serialise(slave.save())
    assert saved == other.serialise(other.save())
    slave.set("station", "MKC")
    status, state = slave.deserialise(saved)
    assert (status, slave.call("SetFMUstate", state), slave.get("station")) == (OK, OK, "SGF")
    slave.call("FreeFMUstate", ctypes.byref(state))
    for instance in (slave, other):
        instance.free()
    floats, again = Interpreter(Named), Interpreter(Named)
    floats.set("station", "SGF")
    again.set_state(floats.get_state())
    assert again.get("station") == "SGF"
    assert list(again.get("others")) == ["", "a b", "Zürich"]


def test_reading_values_while_initialising_does_not_take_texts_back(unzipped):
    """Outputs are shown from a copy of the state, which the next change undoes."""
    slave = Slave(unzipped["named"])
    slave.call("EnterInitializationMode")
    slave.set("station", "SGF")
    assert slave.get("begun") == 2.0
    slave.set("gain", 2.0)
    assert (slave.get("begun"), slave.get("station")) == (4.0, "SGF")
    slave.free()


def test_the_page_shows_texts_and_bounds():
    html = page(lower(Named))
    assert "TUL" in html and "at most 8 bytes" in html and "Zürich" in html


def _component(task=None, **members):
    members = {"sample_period": Parameter("s", start=0.1), "y": Output("1"), **members}
    return type("Made", (Component,), {"__doc__": "Made.", "step": every("sample_period")(task or _quiet), **members})


def _quiet(self):
    self.y = 1.0 * self.y


WRONG = {
    "an input": (lambda: Input(kind="string"), "a string is a fixed Parameter"),
    "an output": (lambda: Output(kind="string"), "a string is a fixed Parameter"),
    "a state": (lambda: State(kind="string"), "a string is a fixed Parameter"),
    "tunable": (lambda: Parameter(kind="string", tunable=True), "a string is a fixed Parameter"),
    "a unit": (lambda: Parameter("m", kind="string"), "a string has no unit"),
    "a range": (lambda: Parameter(kind="string", max=4), "a string has no unit, no min"),
    "a number": (lambda: Parameter(kind="string", start=5), "start is 5, expected a text"),
    "too long": (
        lambda: Parameter(kind="string", start="Zürich", longest=6),
        "start is 'Zürich', which has 7 bytes in UTF-8; expected at most 6",
    ),
    "a line": (lambda: Parameter(kind="string", start="a\x01"), "expected no control characters"),
    "no bytes": (lambda: Parameter(kind="string", longest=0), "longest is 0, expected a number of bytes from 1"),
    "of a number": (lambda: Parameter("m", longest=5), 'longest is for strings, kind="string"'),
    "shape": (
        lambda: Parameter(2, kind="string", start=("a", "b", "c")),
        "start has shape (3,), expected a text or (2,)",
    ),
    "in a sentence": (
        lambda: _component(name_=Parameter(kind="string"), c=require("{name_} is wrong")(lambda self: True)),
        "the sentence names 'name_', which is a string; it shows numbers",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_declarations_are_refused_with_a_sentence(name):
    make, sentence = WRONG[name]
    with pytest.raises(NavfmuError) as refused:
        make()
    assert "test_strings.py, line " in str(refused.value) and sentence in str(refused.value)


def test_a_task_does_not_see_them():
    """Not with floats, either: there a comparison would work, and natively it would not."""

    def task(self):
        self.y = np.where(self.called == "TUL", 1.0, 0.0)

    made = _component(task, called=Parameter(kind="string", start="TUL"))
    sentence = "'called' is a string, which names something for hosts and tables; a task calculates with numbers"
    with pytest.raises(NavfmuError, match=sentence):
        lower(made)
    run = Interpreter(made)
    run.setup()
    with pytest.raises(NavfmuError, match=sentence):
        run.do_step(0.0, 0.1)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"station": "SGF", "lock": "b", "others": ["x", "y"]}, "others = [x, y]"),
        ({"station": 5}, "its example sets 'station' to 5, expected a text"),
        ({"lock": "bb"}, "its example sets 'lock' to 'bb', expected one of a, b; did you mean 'b'?"),
        ({"gain": "high"}, "its example sets 'gain' to 'high', expected a number"),
        ({"station": "Tulsa DME"}, "expected at most 8 bytes of UTF-8"),
    ],
)
def test_an_example_gives_texts_and_items_by_name(values, told, tmp_path):
    class Shown(Component):
        """Shown."""

        example = Example(values=values)
        station = Parameter(kind="string", start="TUL", longest=8, description="station")
        others = Parameter(2, kind="string", description="others")
        lock = Parameter(kind="enumeration", items=("a", "b"), description="lock")
        gain = Parameter("1", description="gain")
        sample_period = Parameter("s", start=0.1, description="sampling period")
        y = Output("1", description="output")

        @every("sample_period")
        def step(self):
            self.y = 1.0 * self.lock

    if "others" not in values:
        with pytest.raises(NavfmuError, match=re.escape(told)):
            build([Shown], tmp_path)
        return
    (path,) = build([Shown], tmp_path)
    html = Unzipped(path, tmp_path / "shown").folder.joinpath("documentation", "index.html").read_text()
    for part in ("station = SGF", "lock = b", told):
        assert f"<code>{part}</code>" in html


# --- in a system ---


@pytest.fixture(scope="module")
def named(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("named")
    build([Named], folder, pictures=False)
    source = SystemSource("stations", fmus=folder, stop_time=1.0, step=0.1).component("a", "named.fmu")
    source.parameters("a", {"station": "SGF", "others[3]": 'Köln & "Bonn"'})
    return source.pack(folder / "stations.ssp")


@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_a_parameter_set_and_python_set_them(named, engine):
    """That they arrive is seen by the FMU's own refusal."""
    system = System.load(named)
    assert system.values["a"] == {"station": "SGF", "others[3]": 'Köln & "Bonn"'}
    system.run(parameters={"a.station": "Tulsa"}, engine=engine)
    with pytest.raises(NavfmuError, match="'station' is set to a text of 9 bytes; expected at most 8 bytes of UTF-8"):
        system.run(parameters={"a.station": "Tulsa DME"}, engine=engine)
    with pytest.raises(NavfmuError, match=r"'station' = 5: expected a text"):
        system.run(parameters={"a.station": 5}, engine=engine)


@pytest.mark.parametrize(("text", "shown"), [("x\0y", r"\x00"), ("\udcff", r"\udcff")])
def test_a_text_that_does_not_arrive_as_it_is_is_refused(named, text, shown):
    """Catches one that C ends at its 0, and a traceback about bytes of the command line that are no UTF-8."""
    with pytest.raises(NavfmuError, match=f"the text has the character {re.escape(shown)}"):
        System.load(named).run(parameters={"a.station": text})


def test_the_command_line_sets_them(named, tmp_path):

    def run(value):
        arguments = ["run", str(named), "--set", f"a.station={value}", "--out", str(tmp_path / "run.csv")]
        return CliRunner().invoke(main, arguments)

    assert run("Tulsa").exit_code == 0
    refused = run("Tulsa DME")
    assert refused.exit_code == 2 and "at most 8 bytes of UTF-8" in " ".join(refused.output.split())
