"""A fault file says what fails when; a mistake in it is told with its line."""

import math
import re
from pathlib import Path

import pytest

import navfmu
from navfmu.engine.making import RECIPES
from navfmu.errors import NavfmuError
from navfmu.faults import TYPES, Fault, load_faults
from navfmu.faults.file import parse_faults

GOOD = """
description = "what may happen"

[[fault]]
id = "gps_lost"
fmea = "F12"
target = "gps.jammed"
type = "input"
start = 300
duration = 1800.0

[[fault]]
id = "gyro_noise"
target = "imu.reading.rate"
type = "noise"
sigma = [1e-3, 0.0, 0.0]
period = 0.01
stream = 7
"""


def test_a_file_is_read(tmp_path):
    path = tmp_path / "faults.toml"
    path.write_text(GOOD, encoding="utf-8")
    jammed, noisy = load_faults(path)
    assert (jammed.id, jammed.fmea, jammed.target, jammed.type) == ("gps_lost", "F12", "gps.jammed", "input")
    assert (jammed.start, jammed.duration, jammed.parameters) == (300, 1800.0, {})
    assert jammed.where == f"{path}, line 4"
    assert noisy.parameters == {"sigma": [1e-3, 0.0, 0.0], "period": 0.01, "stream": 7}
    assert (noisy.start, noisy.duration) == (0.0, math.inf)


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(NavfmuError, match=r"nothing\.toml: no such file; expected a fault file"):
        load_faults(tmp_path / "nothing.toml")


def test_a_file_that_is_no_text_is_told(tmp_path):
    (tmp_path / "faults.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(NavfmuError, match=r"faults\.toml: the fault file cannot be read"):
        load_faults(tmp_path / "faults.toml")


def fault(**changes):
    entries = {"id": '"x"', "target": '"a.y"', "type": '"bias"', "value": "1.0"} | changes
    return "[[fault]]\n" + "\n".join(f"{key} = {value}" for key, value in entries.items() if value is not None)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[[fault]]\nid = \n", r"f\.toml, line 2, column 6: invalid value"),
        ("\n[[faults]]\nid = 'x'\n", r"f\.toml, line 2: unknown entry 'faults'; did you mean 'fault'\?"),
        ("[fault]\nid = 'x'\n", r"f\.toml, line 1: 'fault' is written as tables: \[\[fault\]\]"),
        (fault(id=None), r"f\.toml, line 1: this fault has no 'id'"),
        (fault(target=None), r"f\.toml, line 1: fault 'x' has no 'target'"),
        (fault(type='"biass"'), r"f\.toml, line 4: fault 'x': unknown type 'biass'; did you mean 'bias'\?"),
        (fault(target='"y"'), r"f\.toml, line 3: fault 'x': 'target' must be written component\.signal, not 'y'"),
        (fault(start="-1"), r"f\.toml, line 6: fault 'x': 'start' must be a time in s, 0 or later, not -1"),
        (fault(start='"now"'), "line 6: fault 'x': 'start' is 'now', expected a time: a number of seconds"),
        (fault(duration="0"), r"f\.toml, line 6: fault 'x': 'duration' must be a positive time in s, not 0"),
        (fault(duraton="1"), r"line 6: fault 'x': unknown entry 'duraton'; did you mean 'duration'\?"),
        (fault(rate="1"), r"line 6: fault 'x': type 'bias' has no parameter 'rate' \(it takes value\)"),
        (fault(value=None), r"line 4: .*type 'bias' needs the parameter 'value'"),
        (fault(type='"noise"', value=None, sigma="1.0", period="0.0"), "'period' must be a positive time in s"),
        (fault(type='"noise"', value=None, sigma="1", period="1", stream="-1"), "'stream' must be a whole number"),
        (fault() + "\n\n" + fault(), r"f\.toml, line 8: the id 'x' is already taken"),
    ],
)
def test_a_mistake_is_told_with_its_line(text, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        parse_faults(text, "f.toml")


def test_the_table_of_types_says_what_each_acts_on_and_takes():
    assert set(TYPES) == {*RECIPES, "lost_step"}
    for name, kind in TYPES.items():
        assert kind.name == name
        assert kind.target and kind.effect


def test_the_documented_table_is_that_of_the_types():
    text = (Path(__file__).parents[2] / "docs" / "faults.md").read_text(encoding="utf-8")
    for kind in TYPES.values():
        given = ", ".join(f"`{p.name}`" + ("" if p.required else " (optional)") for p in kind.parameters)
        assert f"| `{kind.name}` | {kind.target} | {given} | {kind.effect} |" in text


def test_the_documented_examples_are_fault_files():
    text = (Path(__file__).parents[2] / "docs" / "faults.md").read_text(encoding="utf-8")
    faults = parse_faults(re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1], "docs/faults.md")
    assert [(fault.id, fault.start) for fault in faults] == [("gps_lost", 300), ("gyro_bias", 600), ("icing", 900)]
    blocks = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert [f.id for block in blocks[1:] for f in parse_faults(block, "docs/faults.md")] == [
        "loose_contact",
        "gps_outage",
        "engine_out",
        "ice",
    ]
    made: dict = {}
    exec(re.search(r"```python\n(.*?)```", text, re.DOTALL)[1].partition("flight =")[0], made)
    assert made["Fault"] is navfmu.Fault is Fault
    assert made["icing"].describe() == faults[2].describe()
