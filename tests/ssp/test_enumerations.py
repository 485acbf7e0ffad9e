"""Values of enumerations: those of its items and no others, by their names or their numbers."""

from __future__ import annotations

from pathlib import Path

import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import SystemSource

from . import fmus
from .test_reader import bindings, inline, load, private_cache, ssd

assert private_cache  # each test its own

ITEMS = {"off": 1, "on": 2, "auto": 7, "3": 4}
ALLOWED = "is no value of its enumeration: expected one of off = 1, on = 2, auto = 7, 3 = 4"


def switch(folder: Path, start: int = 1) -> Path:
    items = "".join(f'<Item name="{name}" value="{value}"/>' for name, value in ITEMS.items())
    kind = f'<SimpleType name="Mode"><Enumeration>{items}</Enumeration></SimpleType>'
    names = [
        fmus.variable("mode", "parameter", "Enumeration", 1, declaredType="Mode", start=str(start)),
        fmus.variable("command", "input", "Enumeration", 2, declaredType="Mode", start="1"),
    ]
    types = f"<TypeDefinitions>{kind}</TypeDefinitions><ModelVariables>"
    return fmus.write(folder / "plant.fmu", fmus.describe("plant", names).replace("<ModelVariables>", types))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "system" / "resources").mkdir(parents=True)
    switch(tmp_path / "system" / "resources")
    return tmp_path / "system"


@pytest.mark.parametrize(("given", "value"), [("auto", 7), (" on ", 2), (7, 7), (2.0, 2), ("2", 2), ("3", 4)])
def test_an_item_is_given_by_its_name_or_its_number(tmp_path, given, value):
    assert expand(describe(switch(tmp_path)), {"mode": given}, "here") == {"mode": value}


@pytest.mark.parametrize("given", [5, "5", 0, 5.0])
def test_another_number_is_refused_wherever_it_is_given(folder, given):
    system = load(folder, ssd(connectors=""))
    with pytest.raises(NavfmuError, match=ALLOWED):
        system.run(stop=1, step=0.5, parameters={"a.mode": given})
    with pytest.raises(NavfmuError, match=ALLOWED):
        SystemSource("s", fmus=folder / "resources").component("a", "plant.fmu").parameters("a", {"mode": given})
    with pytest.raises(NavfmuError, match=ALLOWED):
        fault = Fault("f", "a.command", "input", value=given, start=0.5)
        system.run(stop=1, step=0.5, faults=fault)


@pytest.mark.parametrize("value", ['Integer value="5"', 'Real value="5"', 'Enumeration value="5"'])
def test_it_is_refused_in_a_parameter_set_with_its_line(folder, value):
    text = bindings(inline(f'<ssv:Parameter name="mode"><ssv:{value}/></ssv:Parameter>'))
    with pytest.raises(NavfmuError, match=rf"line \d+: a: 'mode' = 5 {ALLOWED}"):
        load(folder, ssd(a=text, connectors=""))


def test_a_number_where_ssp_wants_a_name_is_read_with_a_note(folder):
    def read(value: str) -> System:
        text = inline(f'<ssv:Parameter name="mode"><ssv:Enumeration value="{value}"/></ssv:Parameter>')
        system = load(folder, ssd(a=bindings(text), connectors=""))
        assert system.values["a"] == {"mode": {"7": 7, "3": 4, "auto": 7}[value]}
        return system

    (line,) = read("7").lenient
    assert "'a.mode' is the number 7 and no item's name" in line
    assert not read("3").lenient and not read("auto").lenient


def test_a_start_value_of_the_fmu_that_no_item_has_is_told(tmp_path):
    assert not describe(switch(tmp_path)).lenient
    (line,) = describe(switch(tmp_path, 5)).lenient
    assert 'the start value 5 of the variable "mode" is no item of its enumeration' in line


def test_python_writes_the_number_as_other_hosts_read_it(folder):
    source = SystemSource("s", fmus=folder / "resources").component("a", "plant.fmu").parameters("a", {"mode": "auto"})
    assert b'<ssv:Integer value="7"/>' in source.files()["resources/a.ssv"]
    source.write(folder)
    assert System.load(folder, strict=True).values["a"] == {"mode": 7}
