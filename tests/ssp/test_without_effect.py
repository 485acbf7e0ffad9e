"""What stands in the documents of a system and has no effect is listed; what stands there twice is not guessed at."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.ssp.document import NAMESPACES

from . import fmus
from .test_reader import CONNECTORS, bindings, folder, inline, load, private_cache, real, ssd, wire

assert private_cache and folder  # fixtures


def mapping(entries: str, **attributes: str) -> str:
    text = "".join(f' {key}="{value}"' for key, value in attributes.items())
    inner = f'<ssm:ParameterMapping version="1.0">{entries}</ssm:ParameterMapping>' if entries else ""
    return f"<ssd:ParameterMapping{text}>{inner}</ssd:ParameterMapping>"


def mapped(parameters: str, entries: str) -> str:
    return bindings(inline(parameters).replace("MAPPING", mapping(entries)))


def test_every_value_that_another_overrides_is_listed(folder):
    text = bindings(inline(real("gain", 1)) + inline("\n" + real("gain", 2)))
    system = load(folder, ssd(a=text, system=bindings(inline("\n\n" + real("a.gain", 3)))))
    assert system.values["a"] == {"gain": 3.0} and not system.lenient
    first, second = system.structure.ignored
    assert "the value of 'a.gain' is overridden in" in first and "the value of 'a.gain' is overridden in" in second
    assert first.split(", line ")[2].split()[0] == second.split(", line ")[1].partition(":")[0]  # 1 by 2, 2 by 3


@pytest.mark.parametrize("entries", ["", '<ssm:MappingEntry source="gain" target="gain"/>'])
def test_a_name_that_stands_in_a_set_twice_is_not_as_ssp_has_it(folder, entries):
    parameters = real("gain", 1) + "\n" + real("gain", 2)
    system = load(folder, ssd(a=mapped(parameters, entries) if entries else bindings(inline(parameters))))
    assert system.values["a"] == {"gain": 2.0} and not system.structure.ignored
    (line,) = system.lenient
    assert "parameter 'gain' has no effect: it stands in the set once more, in line" in line
    with pytest.raises(NavfmuError, match=r"which --strict refuses: .* parameter 'gain' has no effect"):
        System.load(folder, strict=True)


def test_two_entries_of_a_mapping_with_one_target_are_seen(folder):
    entries = '<ssm:MappingEntry source="x" target="gain"/>\n<ssm:MappingEntry source="z" target="gain"/>'
    system = load(folder, ssd(a=mapped(real("x", 1) + real("z", 2), entries)))
    assert system.values["a"] == {"gain": 2.0}
    assert ["the value of 'a.gain' is overridden" in line for line in system.structure.ignored] == [True]


NOTE = '<ssd:Annotations><ssc:Annotation type="org.note"><x>1</x></ssc:Annotation></ssd:Annotations>'
SSV_NOTE, SSM_NOTE = NOTE.replace("ssd:", "ssv:"), NOTE.replace("ssd:", "ssm:")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (ssd().replace("</ssd:System>", f"{NOTE}</ssd:System>"), "the system"),
        (ssd(tail=NOTE), "the document"),
        (ssd(tail=f"<ssd:DefaultExperiment>{NOTE}</ssd:DefaultExperiment>"), "the default experiment"),
        (ssd(a=NOTE), "the component 'a'"),
        (ssd(wire("a.height", "b.altitude", NOTE)), "the connection"),
        (
            ssd(connectors=CONNECTORS.replace("<ssc:Boolean/>", f"<ssc:Boolean/>{NOTE}")),
            "the connector 'flag'",
        ),
        (ssd(a=bindings(inline(real("gain", 1)).replace("MAPPING", NOTE))), "the parameter binding"),
        (
            ssd(a=bindings(inline(real("gain", 1)).replace("</ssv:Parameters>", f"</ssv:Parameters>{SSV_NOTE}"))),
            "the parameter set 'p'",
        ),
        (
            ssd(a=mapped(real("gain", 1), f'<ssm:MappingEntry source="gain" target="gain"/>{SSM_NOTE}')),
            "the parameter mapping",
        ),
        (
            ssd().replace('<ssc:BaseUnit s="1"/>', '<ssc:BaseUnit s="1"/>' + NOTE.replace("ssd:", "ssc:")),
            "the unit 's'",
        ),
    ],
)
def test_annotations_are_listed_wherever_they_stand(folder, text, place):
    found = load(folder, text).structure.ignored
    assert found and all(f"annotation 'org.note' of {place}" in line for line in found)


def test_annotations_of_a_parameter_set_in_a_file_are_listed_once(folder):
    (folder / "p.ssv").write_text(
        '<ssv:ParameterSet version="1.0" name="p" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
        ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">'
        f"<ssv:Parameters>{real('gain', 2)}</ssv:Parameters>{SSV_NOTE}</ssv:ParameterSet>"
    )
    sets = "".join(f'<ssd:ParameterBinding source="p.ssv" prefix="{name}."/>' for name in "ab")
    (line,) = load(folder, ssd(system=bindings(sets))).structure.ignored
    assert "p.ssv, line 1: annotation 'org.note' of the document" in line


def test_of_a_source_and_what_stands_beside_it_the_source_is_read_and_the_other_listed(folder):
    """SSP leaves open which of the two counts."""
    named = f'version="1.0" name="p" xmlns:ssv="{NAMESPACES["ssv"]}" xmlns:ssm="{NAMESPACES["ssm"]}"'
    entry = '<ssm:MappingEntry source="x" target="{}"/>'
    values = f"<ssv:ParameterSet {named}><ssv:Parameters>{real('x', 4)}</ssv:Parameters></ssv:ParameterSet>"
    (folder / "p.ssv").write_text(values)
    (folder / "m.ssm").write_text(f"<ssm:ParameterMapping {named}>{entry.format('gain')}</ssm:ParameterMapping>")
    text = inline("\n" + real("x", 3)).replace("MAPPING", "\n" + mapping(entry.format("altitude"), source="m.ssm"))
    system = load(
        folder, ssd(a=bindings(text.replace("<ssd:ParameterBinding>", '<ssd:ParameterBinding source="p.ssv">')))
    )
    assert system.values["a"] == {"gain": 4.0}
    values, entries = sorted(system.structure.ignored)
    assert values.endswith(", line 12: the ParameterSet inside an element that has the source 'p.ssv'")
    assert entries.endswith(", line 14: the ParameterMapping inside an element that has the source 'm.ssm'")


def test_a_source_with_a_query_is_not_read_without_it(folder):
    (folder / "p.ssv").write_text("")
    with pytest.raises(NavfmuError, match=r"source 'p\.ssv\?version=2' is not supported, expected a relative path"):
        load(folder, ssd(a=bindings('<ssd:ParameterBinding source="p.ssv?version=2"/>')))


def test_a_string_for_what_is_none_is_read_with_a_note(folder):
    text = '<ssv:Parameter name="gain"><ssv:String value="3 ft"/></ssv:Parameter>'
    system = load(folder, ssd(a=bindings(inline(text))))
    assert system.values["a"] == {"gain": pytest.approx(0.9144)}
    (line,) = system.lenient
    assert line.endswith("'a.gain' is Real and is given as a String")


@pytest.mark.parametrize(
    ("unit", "notes"),
    [
        ('<ssc:BaseUnit m="1" factor="1000"/>', 1),
        ('<ssc:BaseUnit s="1"/>', 1),
        ('<ssc:BaseUnit m="1" offset="1"/>', 1),
        ('<ssc:BaseUnit m="1" factor="1.0000001"/>', 0),
    ],
)
def test_a_unit_that_fmu_and_document_define_differently_is_taken_by_its_name_with_a_note(folder, unit, notes):
    text = ssd(a=bindings(inline(real("gain", 3, "m")))).replace(METRE, f'<ssc:Unit name="m">{unit}</ssc:Unit>')
    system = load(folder, text)
    assert system.values["a"] == {"gain": 3.0}
    end = "'a.gain': the unit 'm' has two different definitions, and is taken by its name"
    assert [line.endswith(end) for line in system.lenient] == [True] * notes


@pytest.mark.parametrize(
    ("attributes", "sentence"),
    [
        ({"sourceBase": "component", "source": "m.ssm"}, "sourceBase 'component' is not supported, expected 'SSD'"),
        ({"type": "application/x-other"}, "expected application/x-ssp-parameter-mapping"),
        ({"source": "no.ssm"}, "its parameter mapping: 'no.ssm' is missing"),
    ],
)
def test_a_mapping_that_is_not_read_is_refused(folder, attributes, sentence):
    (folder / "m.ssm").write_text(
        '<ssm:ParameterMapping version="1.0" xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping">'
        '<ssm:MappingEntry source="gain" target="gain"/></ssm:ParameterMapping>'
    )
    entries = "" if "source" in attributes else '<ssm:MappingEntry source="gain" target="gain"/>'
    text = bindings(inline(real("gain", 1)).replace("MAPPING", mapping(entries, **attributes)))
    with pytest.raises(NavfmuError) as error:
        load(folder, ssd(a=text))
    assert sentence in str(error.value) and "SystemStructure.ssd, line" in str(error.value)


FLAG = '<ssd:Connector name="flag" kind="output"><ssc:Boolean/></ssd:Connector>'
METRE = '<ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>'
MODE = '<ssc:Enumeration name="E"><ssc:Item name="on" value="1"/></ssc:Enumeration>'


@pytest.mark.parametrize(
    ("text", "twice", "other"),
    [
        (ssd(), FLAG, FLAG.replace("Boolean", "Real")),
        (ssd(), METRE, METRE.replace('m="1"', 's="1"')),
        (ssd(enumerations=f"<ssd:Enumerations>{MODE}</ssd:Enumerations>"), MODE, MODE.replace('"1"', '"2"')),
        (
            ssd(enumerations=f"<ssd:Enumerations>{MODE}</ssd:Enumerations>"),
            '<ssc:Item name="on" value="1"/>',
            '<ssc:Item name="on" value="2"/>',
        ),
    ],
)
def test_a_definition_that_stands_there_twice_and_differs_is_refused(folder, text, twice, other):
    system = load(folder, text.replace(twice, twice + twice))
    assert system.lenient and all("stands here twice" in line for line in system.lenient)
    with pytest.raises(NavfmuError, match=r"line \d+: \w+ '\w+'.*: stands here twice, and differs"):
        load(folder, text.replace(twice, twice + other))


def integer(name: str, value: str, unit: str) -> str:
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}" unit="{unit}"/></ssv:Parameter>'


def bare(folder: Path) -> None:
    names = [fmus.variable("factor", "parameter"), fmus.variable("count", "parameter", "Integer", 1)]
    fmus.write(folder / "resources" / "plant.fmu", fmus.describe("plant", names))


def test_a_unit_for_what_has_none_is_listed(folder):
    bare(folder)
    text = bindings(inline(integer("factor", "4", "ft") + integer("count", "4", "furlong")))
    system = load(folder, ssd(a=text, connectors=""))
    assert system.values["a"] == {"factor": 4.0, "count": 4}
    first, second = system.structure.ignored
    assert "the unit 'ft' of 'a.factor', which has none" in first
    assert "the unit 'furlong' of 'a.count', which has none" in second
    system = load(folder, ssd(a=bindings(inline(integer("factor", "4", "1"))), connectors=""))
    assert not system.structure.ignored


def test_a_connector_gives_a_unit_to_what_has_none(folder):
    bare(folder)
    connectors = '<ssd:Connectors><ssd:Connector name="factor" kind="parameter"><ssc:Real unit="m"/></ssd:Connector>'
    text = ssd(a=bindings(inline(integer("factor", "10", "ft"))), connectors=f"{connectors}</ssd:Connectors>")
    assert load(folder, text).values["a"] == {"factor": pytest.approx(3.048)}


@pytest.mark.parametrize("packed", [False, True])
def test_a_source_with_backslashes_is_read_with_a_note(folder, packed):
    text = ssd().replace("resources/plant.fmu", "resources\\plant.fmu")
    system = load(folder, text)
    if packed:
        with zipfile.ZipFile(folder / "s.ssp", "w") as archive:
            archive.writestr("SystemStructure.ssd", text)
            archive.write(folder / "resources" / "plant.fmu", "resources/plant.fmu")
        system = System.load(folder / "s.ssp")
    assert len(system.lenient) == 2 and "source 'resources\\plant.fmu' is written with \\ for /" in system.lenient[0]
    if packed:
        with zipfile.ZipFile(folder / "s.ssp", "w") as archive:
            archive.writestr("SystemStructure.ssd", text.replace("resources", "..\\..\\..\\.."))
        with pytest.raises(NavfmuError, match="lies outside the package"):
            System.load(folder / "s.ssp")


def test_a_component_with_a_dot_in_its_name_is_refused_with_its_line(folder):
    component = '<ssd:Component name="c.d" source="resources/plant.fmu"/>'
    with pytest.raises(NavfmuError, match=r"line \d+: Component 'c.d': expected a name without a dot"):
        load(folder, ssd(elements=component))


def test_a_single_fmu_whose_identifier_has_a_dot_is_a_component_without_one(tmp_path):
    text = fmus.describe("a.b", [fmus.variable("gain", "parameter"), fmus.variable("y", "output", reference=1)])
    system = System.load(fmus.write(tmp_path / "a.fmu", text))
    assert list(system.fmus) == ["a_b"] and system.variable("a_b.y").causality == "output"
