"""Differences (``relativeQuantity``): 10 degC of one are 10 K, wherever they are given, connected or shown."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.engine.link import Link
from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import SystemSource
from navfmu.system.display import Display

from . import fmus
from .test_reader import bindings, inline, load, private_cache, real, ssd, wire

assert private_cache  # each test its own

CELSIUS = '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>'
SPREAD = '<TypeDefinitions><SimpleType name="Spread"><Real unit="K" displayUnit="degC" relativeQuantity="true"/>'


def heater(folder: Path) -> Path:
    """Each of its variables is there as a temperature and as a difference of temperatures."""
    shown = {"unit": "K", "displayUnit": "degC"}
    names = [
        fmus.variable("T", "parameter", reference=1, **shown),
        fmus.variable("dT", "parameter", reference=2, start="1", relativeQuantity="true", **shown),
        fmus.variable("typed", "parameter", reference=3, declaredType="Spread", start="1"),
        fmus.variable("untyped", "parameter", reference=4, declaredType="Spread", start="1", relativeQuantity="false"),
        fmus.variable("kelvin", "output", reference=5, unit="K"),
        fmus.variable("kelvins", "output", reference=6, unit="K", relativeQuantity="true"),
        fmus.variable("celsius", "input", reference=7, unit="degC"),
        fmus.variable("celsiuses", "input", reference=8, unit="degC", relativeQuantity="true"),
        fmus.variable("warmer", "input", reference=9, unit="K", relativeQuantity="true"),
    ]
    text = fmus.describe("plant", names).replace("</UnitDefinitions>", CELSIUS)
    types = f"{SPREAD}</SimpleType></TypeDefinitions><ModelVariables>"
    return fmus.write(folder / "plant.fmu", text.replace("<ModelVariables>", types))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "system" / "resources").mkdir(parents=True)
    heater(tmp_path / "system" / "resources")
    return tmp_path / "system"


def test_a_value_with_a_unit_has_no_origin(tmp_path):
    about = describe(heater(tmp_path))
    given = expand(about, dict.fromkeys(("T", "dT", "typed", "untyped"), "10 degC"), "here")
    assert given == {"T": 283.15, "dT": 10.0, "typed": 10.0, "untyped": 283.15}


def test_nor_has_one_of_a_parameter_set(folder):
    text = bindings(inline(real("T", 10, "degC") + real("dT", 10, "degC")))
    assert load(folder, ssd(a=text, connectors="")).values["a"] == {"T": 283.15, "dT": 10.0}


def test_nor_has_one_that_python_writes(folder):
    source = SystemSource("s", fmus=folder / "resources").component("a", "plant.fmu")
    source.parameters("a", {"dT": "10 degC"}).write(folder)
    assert System.load(folder).values["a"] == {"dT": 10.0}


def test_nor_has_what_is_shown(tmp_path):
    about = describe(heater(tmp_path))
    shown = {name: Display.of(about.by_name[name], about).text(10.0) for name in ("T", "dT", "typed")}
    assert shown == {"T": "-263.15", "dT": "10", "typed": "10"}
    info = CliRunner().invoke(main, ["info", str(tmp_path / "plant.fmu")])
    assert "1 = 1 degC" in info.output


def test_connected_differences_differ_in_scale_only(folder):
    system = load(folder, ssd(wire("a.kelvins", "b.celsiuses") + wire("a.kelvin", "b.celsius"), connectors=""))
    assert system.links == (Link("a.kelvins", "b.celsiuses"), Link("a.kelvin", "b.celsius", 1.0, -273.15))


def test_a_connector_in_another_unit_than_its_difference_scales_only(folder):
    connectors = "".join(
        f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real unit="degC"/></ssd:Connector>'
        for name, kind in (("kelvins", "output"), ("warmer", "input"))
    )
    text = ssd(wire("a.kelvins", "b.warmer"), connectors=f"<ssd:Connectors>{connectors}</ssd:Connectors>")
    assert load(folder, text).links == (Link("a.kelvins", "b.warmer"),)


@pytest.mark.parametrize("pair", ["a.kelvin b.celsiuses", "a.kelvins b.celsius"])
def test_a_difference_and_a_temperature_in_units_with_an_origin_do_not_connect(folder, pair):
    with pytest.raises(NavfmuError, match="'degC' has an origin of its own, so what this means is not clear"):
        load(folder, ssd(wire(*pair.split()), connectors=""))
    system = load(folder, ssd(wire(*pair.split(), suppressUnitConversion="true"), connectors=""))
    assert not system.links[0].scaled


def test_in_units_without_one_they_do_with_a_note_that_strict_refuses(folder):
    system = load(folder, ssd(wire("a.kelvin", "b.warmer"), connectors=""))
    assert system.links == (Link("a.kelvin", "b.warmer"),)
    said = "connects a quantity that is none to a difference (relativeQuantity)"
    assert any(said in line for line in system.lenient)
    connectors = '<ssd:Connectors><ssd:Connector name="warmer" kind="input"/></ssd:Connectors>'
    listed = connectors.replace("</", '<ssd:Connector name="kelvin" kind="output"/></')
    load(folder, ssd(wire("a.kelvin", "b.warmer"), connectors=listed))
    with pytest.raises(NavfmuError, match=r"which --strict refuses: .* connects a quantity that is none to a diff"):
        System.load(folder, strict=True)


def test_python_connects_two_of_a_kind_only(folder):
    source = SystemSource("s", fmus=folder / "resources").component("a", "plant.fmu").component("b", "plant.fmu")
    with pytest.raises(NavfmuError, match=r"'kelvin' is none, 'warmer' is a difference \(relativeQuantity\)"):
        source.connect("a.kelvin", "b.warmer")
    source.connect("a.kelvins", "b.warmer")
