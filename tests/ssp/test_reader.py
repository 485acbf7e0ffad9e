"""Systems read from SSP: what takes effect, what is an error, and what is listed as ignored."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from navfmu import System
from navfmu.engine.link import Link
from navfmu.errors import NavfmuError
from navfmu.ssp import reader
from navfmu.ssp.writer import SystemSource

from . import fmus


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))


HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="test"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping">
"""
UNITS = """<ssd:Units>
  <ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>
  <ssc:Unit name="ft"><ssc:BaseUnit m="1" factor="0.3048"/></ssc:Unit>
  <ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
  <ssc:Unit name="s"><ssc:BaseUnit s="1"/></ssc:Unit>
</ssd:Units>"""
CONNECTORS = """<ssd:Connectors>
  <ssd:Connector name="height" kind="output"><ssc:Real/></ssd:Connector>
  <ssd:Connector name="flag" kind="output"><ssc:Boolean/></ssd:Connector>
  <ssd:Connector name="altitude" kind="input"><ssc:Real/></ssd:Connector>
  <ssd:Connector name="temperature" kind="input"><ssc:Real unit="degC"/></ssd:Connector>
</ssd:Connectors>"""


def plant(folder: Path) -> Path:
    """Outputs in feet, inputs in metres."""
    names = [
        fmus.variable("height", "output", reference=1, unit="ft"),
        fmus.variable("flag", "output", "Boolean", 2),
        fmus.variable("altitude", "input", reference=3, unit="m"),
        fmus.variable("temperature", "input", reference=4, unit="K"),
        fmus.variable("gain", "parameter", reference=5, unit="m", min="0"),
        fmus.variable("count", "parameter", "Integer", 6),
        fmus.variable("on", "parameter", "Boolean", 7),
    ]
    return fmus.write(folder / "plant.fmu", fmus.describe("plant", names))


def bindings(text: str) -> str:
    return f"<ssd:ParameterBindings>{text}</ssd:ParameterBindings>"


def inline(parameters: str, prefix: str = "") -> str:
    return (
        f"<ssd:ParameterBinding{f' prefix={chr(34)}{prefix}{chr(34)}' if prefix else ''}><ssd:ParameterValues>"
        f'<ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>{parameters}</ssv:Parameters></ssv:ParameterSet>'
        "</ssd:ParameterValues>MAPPING</ssd:ParameterBinding>"
    )


def real(name: str, value: float, unit: str = "") -> str:
    attribute = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}"{attribute}/></ssv:Parameter>'


def ssd(
    connections: str = "",
    a: str = "",
    system: str = "",
    elements: str = "",
    connectors: str = CONNECTORS,
    enumerations: str = "",
    tail: str = "",
) -> str:
    wires = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    return (
        f'{HEAD}<ssd:System name="s">{system}<ssd:Elements>'
        f'<ssd:Component name="a" source="resources/plant.fmu">{connectors}{a}</ssd:Component>'
        f'<ssd:Component name="b" source="resources/plant.fmu">{connectors}</ssd:Component>{elements}'
        f"</ssd:Elements>{wires}</ssd:System>{enumerations}{UNITS}{tail}</ssd:SystemStructureDescription>"
    ).replace("MAPPING", "")


def wire(start: str, end: str, inner: str = "", **attributes: str) -> str:
    a, b = start.split("."), end.split(".")
    text = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return (
        f'<ssd:Connection startElement="{a[0]}" startConnector="{a[1]}" endElement="{b[0]}" endConnector="{b[1]}"'
        f"{text}>{inner}</ssd:Connection>"
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "system" / "resources").mkdir(parents=True)
    plant(tmp_path / "system" / "resources")
    return tmp_path / "system"


def load(folder: Path, text: str, variant: str | None = None) -> System:
    (folder / "SystemStructure.ssd").write_text(text, encoding="utf-8")
    return System.load(folder, variant)


def test_what_the_writer_writes_is_read_back(tmp_path):
    fmus.sensor(tmp_path)
    fmus.filter_(tmp_path)
    source = SystemSource("loop", fmus=tmp_path, stop_time=10, step=0.01)
    source.component("sensor", "sensor.fmu").component("filter", "filter.fmu")
    source.connect("sensor.reading", "filter.imu").connect("filter.rate", "sensor.rate")
    source.parameters("sensor", {"bias": (0.1, 0.2, 0.3)}).variant("poor", parameters={"sensor": {"seed": 7}})
    file = source.pack(tmp_path / "loop.ssp")
    main, poor = System.load(file), System.load(file, variant="poor")
    assert list(main.fmus) == ["sensor", "filter"]
    assert main.structure.stop_time == 10.0 and main.structure.step == 0.01
    assert main.values == {"sensor": {"bias[1]": 0.1, "bias[2]": 0.2, "bias[3]": 0.3}, "filter": {}}
    assert poor.values["sensor"] == {"bias[1]": 0.1, "bias[2]": 0.2, "bias[3]": 0.3, "seed": 7}
    assert len(main.links) == 9 and not any(link.scaled for link in main.links)
    assert main.structure.ignored == []
    assert reader.variants(file) == ["poor"]
    assert main.digest != poor.digest


def test_units_convert_on_a_connection(folder):
    system = load(folder, ssd(wire("a.height", "b.altitude")))
    assert system.links == (Link("a.height", "b.altitude", 0.3048, 0.0),)


def test_a_linear_transformation_acts_after_the_conversion(folder):
    inner = '<ssc:LinearTransformation factor="2" offset="5"/>'
    system = load(folder, ssd(wire("a.height", "b.altitude", inner)))
    assert system.links == (Link("a.height", "b.altitude", 0.6096, 5.0),)


def test_conversion_can_be_suppressed(folder):
    inner = '<ssc:LinearTransformation factor="2"/>'
    system = load(folder, ssd(wire("a.height", "b.altitude", inner, suppressUnitConversion="true")))
    assert system.links == (Link("a.height", "b.altitude", 2.0, 0.0),)


def test_a_connector_in_another_unit_than_its_variable_converts(folder):
    connectors = CONNECTORS.replace(
        '"altitude" kind="input"><ssc:Real/>', '"altitude" kind="input"><ssc:Real unit="ft"/>'
    )
    system = load(folder, ssd(wire("a.height", "b.altitude"), connectors=connectors))
    (link,) = system.links
    assert (link.factor, link.offset) == pytest.approx((0.3048, 0.0))


def test_a_connection_written_from_input_to_output_is_turned_round(folder):
    (link,) = load(folder, ssd(wire("b.altitude", "a.height"))).links
    assert (link.source, link.target) == ("a.height", "b.altitude")


def test_parameters_convert_and_later_bindings_win(folder):
    text = bindings(inline(real("gain", 10, "ft") + real("temperature", 15, "degC")) + inline(real("gain", 20, "ft")))
    values = load(folder, ssd(a=text)).values["a"]
    assert values == {"gain": 20 * 0.3048, "temperature": 288.15}


def test_bindings_of_the_system_win_over_those_of_a_component(folder):
    system = bindings(inline(real("b.gain", 3)) + inline(real("gain", 4), prefix="a."))
    values = load(folder, ssd(a=bindings(inline(real("gain", 1))), system=system)).values
    assert values["a"]["gain"] == 4.0 and values["b"]["gain"] == 3.0


def test_a_mapping_renames_and_transforms_after_the_conversion(folder):
    mapping = (
        '<ssd:ParameterMapping><ssm:ParameterMapping version="1.0"><ssm:MappingEntry source="k" target="gain">'
        '<ssc:LinearTransformation factor="2" offset="1"/></ssm:MappingEntry>'
        '<ssm:MappingEntry source="switch" target="on"><ssc:BooleanMappingTransformation>'
        '<ssc:MapEntry source="true" target="false"/><ssc:MapEntry source="false" target="true"/>'
        "</ssc:BooleanMappingTransformation></ssm:MappingEntry></ssm:ParameterMapping></ssd:ParameterMapping>"
    )
    switch = '<ssv:Parameter name="switch"><ssv:Boolean value="false"/></ssv:Parameter>'
    text = bindings(inline(real("k", 10, "ft") + switch + real("other", 1)).replace("MAPPING", mapping))
    system = load(folder, ssd(a=text))
    assert system.values["a"] == {"gain": 2 * 3.048 + 1, "on": True}
    assert any("'other' is not in the mapping" in line for line in system.structure.ignored)


def test_external_parameter_sets_and_mappings_are_read(folder):
    (folder / "p.ssv").write_text(
        '<ssv:ParameterSet version="1.0" name="p" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">'
        f"<ssv:Parameters>{real('k', 2)}</ssv:Parameters></ssv:ParameterSet>"
    )
    (folder / "m.ssm").write_text(
        '<ssm:ParameterMapping version="1.0" xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping">'
        '<ssm:MappingEntry source="k" target="gain"/></ssm:ParameterMapping>'
    )
    text = '<ssd:ParameterBinding source="p.ssv"><ssd:ParameterMapping source="m.ssm"/></ssd:ParameterBinding>'
    assert load(folder, ssd(a=bindings(text))).values["a"] == {"gain": 2.0}


def test_a_mapping_of_the_system_transforms_like_one_of_a_component(folder):
    mapping = (
        '<ssd:ParameterMapping><ssm:ParameterMapping version="1.0"><ssm:MappingEntry source="k" target="a.gain">'
        '<ssc:LinearTransformation factor="2" offset="1"/></ssm:MappingEntry></ssm:ParameterMapping>'
        "</ssd:ParameterMapping>"
    )
    system = load(folder, ssd(system=bindings(inline(real("k", 10, "ft")).replace("MAPPING", mapping))))
    assert system.values["a"] == {"gain": 2 * 3.048 + 1}


def test_an_output_that_starts_at_a_value_of_ones_choice_can_be_given_one(folder):
    assert load(folder, ssd(a=bindings(inline(real("height", 100, "m"))))).values["a"]["height"] == pytest.approx(
        328.084
    )


def test_a_value_for_a_connected_input_is_listed_as_without_effect(folder):
    system = load(folder, ssd(wire("b.height", "a.altitude"), a=bindings(inline(real("altitude", 3)))))
    assert system.values["a"] == {}
    assert any("'a.altitude' is connected to 'b.height'" in note for note in system.notes)


def moded(folder: Path, items: str = "") -> None:
    """The plant with an enumeration ``mode`` from ``command`` and Strings."""
    items = items or '<Item name="off" value="0"/><Item name="on" value="3"/>'
    kind = f'<SimpleType name="Mode"><Enumeration>{items}</Enumeration></SimpleType>'
    types = f"<TypeDefinitions>{kind}</TypeDefinitions>"
    names = [
        fmus.variable("mode", "output", "Enumeration", 1, declaredType="Mode"),
        fmus.variable("command", "input", "Enumeration", 2, declaredType="Mode"),
        fmus.variable("text", "output", "String", 3),
        fmus.variable("said", "input", "String", 4),
    ]
    text = fmus.describe("plant", names).replace("<ModelVariables>", f"{types}<ModelVariables>")
    fmus.write(folder / "resources" / "plant.fmu", text)


MODES = """<ssd:Connectors>
  <ssd:Connector name="mode" kind="output"><ssc:Enumeration name="Mode"/></ssd:Connector>
  <ssd:Connector name="command" kind="input"><ssc:Enumeration name="Mode"/></ssd:Connector>
  <ssd:Connector name="text" kind="output"><ssc:String/></ssd:Connector>
  <ssd:Connector name="said" kind="input"><ssc:String/></ssd:Connector>
</ssd:Connectors>"""
ENUMERATIONS = """<ssd:Enumerations><ssc:Enumeration name="Mode">
  <ssc:Item name="aus" value="0"/><ssc:Item name="an" value="3"/>
</ssc:Enumeration></ssd:Enumerations>"""


def test_enumerations_connect_and_their_values_are_named(folder):
    moded(folder)

    def commanded(value):
        text = bindings(inline(f'<ssv:Parameter name="command"><ssv:Enumeration value="{value}/></ssv:Parameter>'))
        return load(folder, ssd(wire("a.mode", "b.command"), a=text, connectors=MODES, enumerations=ENUMERATIONS))

    system = commanded('an" name="Mode"')
    assert system.links == (Link("a.mode", "b.command"),) and system.values["a"] == {"command": 3}
    assert not system.notes
    assert commanded('on"').values["a"] == {"command": 3}
    with pytest.raises(NavfmuError, match="parameter 'command' is 'ann', expected one of aus, an; did you mean 'an'"):
        commanded('ann" name="Mode"')
    with pytest.raises(NavfmuError, match="'command' = onn: expected one of off, on; did you mean 'on'"):
        commanded('onn"')


def test_an_enumeration_that_the_document_does_not_define_is_left_to_the_fmu_with_a_note(folder):
    moded(folder)
    system = load(folder, ssd(wire("a.mode", "b.command"), connectors=MODES))
    assert system.links and all("the enumeration 'Mode' is not defined" in line for line in system.lenient)


def test_enumerations_of_different_values_and_texts_are_refused_when_loading(folder):
    moded(folder)
    (folder / "resources" / "other.fmu").write_bytes((folder / "resources" / "plant.fmu").read_bytes())
    moded(folder, '<Item name="off" value="0"/><Item name="on" value="1"/>')
    text = ssd(wire("a.mode", "b.command"), connectors=MODES.replace('<ssc:Enumeration name="Mode"/>', ""))
    text = text.replace("plant.fmu", "other.fmu", 1)
    with pytest.raises(NavfmuError, match=r"one enumeration \(off = 0, on = 3\) to another \(off = 0, on = 1\)"):
        load(folder, text)
    with pytest.raises(NavfmuError, match="a String cannot be connected to a String"):
        load(folder, ssd(wire("a.text", "b.said"), connectors=MODES, enumerations=ENUMERATIONS))
    with pytest.raises(NavfmuError, match="a Integer cannot be connected to a String"):
        load(folder, ssd(wire("a.mode", "b.said"), connectors=MODES, enumerations=ENUMERATIONS))


def test_the_step_is_found_where_omsimulator_keeps_it(folder):
    annotation = (
        '<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations xmlns:oms="https://raw.githubuser'
        'content.com/OpenModelica/OMSimulator/master/schema/oms.xsd"><oms:SimulationInformation><oms:FixedStepMaster '
        'stepSize="0.25"/></oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations></ssd:System>'
    )
    structure = load(folder, ssd(tail="<ssd:DefaultExperiment/>").replace("</ssd:System>", annotation)).structure
    assert structure.step == 0.25 and structure.ignored == []


def test_root_connectors_are_tolerated_and_listed(folder):
    system = '<ssd:Connectors><ssd:Connector name="y0" kind="output"/></ssd:Connectors>'
    text = ssd('<ssd:Connection startElement="a" startConnector="height" endConnector="y0"/>', system=system)
    ignored = load(folder, text).structure.ignored
    assert len(ignored) == 2 and "root connector 'y0'" in ignored[0] and "root connector" in ignored[1]


def test_annotations_and_unknown_parameter_names_are_listed(folder):
    tail = '<ssd:Annotations><ssc:Annotation type="x"/></ssd:Annotations>'
    ignored = load(folder, ssd(a=bindings(inline(real("gian", 1))), tail=tail)).structure.ignored
    assert any("annotation 'x' of the document" in line for line in ignored)
    assert any("no variable 'gian'; did you mean 'gain'" in line for line in ignored)


def test_an_archive_loads_like_its_folder(folder, tmp_path):
    load(folder, ssd(wire("a.height", "b.altitude")))
    with zipfile.ZipFile(tmp_path / "s.ssp", "w") as archive:
        archive.write(folder / "SystemStructure.ssd", "SystemStructure.ssd")
        archive.write(folder / "resources" / "plant.fmu", "resources/plant.fmu")
    assert System.load(tmp_path / "s.ssp").links == System.load(folder).links
    assert System.load(folder / "SystemStructure.ssd").links == System.load(folder).links


NESTED = '<ssd:System name="inner"/>'
REFERENCE = '<ssd:SignalDictionaryReference name="d" dictionary="x"/>'
PACKAGE = '<ssd:Component name="c" source="x.ssp" type="application/x-ssp-package"/>'


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<ssd", "is not well-formed XML"),
        ("<a/>", "expected <ssd:SystemStructureDescription> of SSP 1.0"),
        (HEAD + "<ssd:Nonsense/></ssd:SystemStructureDescription>", "Nonsense"),
        (ssd(elements=NESTED), "System 'inner': nested systems are not supported"),
        (ssd(elements=REFERENCE), "signal dictionaries are not supported"),
        (ssd(elements=PACKAGE), "type 'application/x-ssp-package' is not supported"),
        (ssd(elements='<ssd:Component name="a" source="resources/plant.fmu"/>'), "the name is taken"),
        (ssd(elements='<ssd:Component name="c" source="resources/none.fmu"/>'), "'resources/none.fmu' is missing"),
        (ssd(elements='<ssd:Component name="c" source="http://x.org/c.fmu"/>'), "expected a relative path"),
        (ssd(wire("a.height", "c.altitude")), "there is no component 'c'"),
        (ssd(wire("a.heigth", "b.altitude")), "no variable 'heigth'; did you mean 'height'"),
        (ssd(wire("a.height", "b.temperature")), "the first is m, the second K"),
        (ssd(wire("a.height", "b.altitude") + wire("b.height", "b.altitude")), "'b.altitude' has two sources"),
        (ssd(wire("a.height", "b.flag")), "goes from output to output"),
        (ssd(a=bindings(inline(real("gain", 10, "s")))), "'s' cannot be converted to 'm'"),
        (ssd(a=bindings(inline(real("gain", -1)))), "'gain' = -1 m is out of range: expected at least 0 m"),
        (ssd(a=bindings('<ssd:ParameterBinding source="no.ssv"/>')), "its parameter set 'no.ssv' is missing"),
        (ssd(a=bindings("<ssd:ParameterBinding/>")), "neither a source nor inline values"),
        (ssd(connectors=CONNECTORS.replace("height", "hight")), "no variable 'hight'; did you mean 'height'"),
        (
            ssd(connectors=CONNECTORS.replace("<ssc:Boolean/>", "<ssc:Real/>")),
            "is Real, but the FMU's variable is Boolean",
        ),
        (ssd(connectors=CONNECTORS.replace('"degC"', '"ft"')), "'K' cannot be converted to 'ft'"),
    ],
)
def test_a_wrong_document_is_answered_by_a_sentence_that_names_it(folder, text, sentence):
    with pytest.raises(NavfmuError) as error:
        load(folder, text)
    assert sentence in str(error.value) and "SystemStructure.ssd" in str(error.value)


def test_entities_are_not_expanded(folder):
    text = ssd().replace("<ssd:SystemStr", '<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]><ssd:SystemStr', 1)
    with pytest.raises(NavfmuError, match="document type declaration"):
        load(folder, text)


def test_an_unknown_variant_is_answered_with_the_nearest(folder):
    (folder / "scanning.ssd").write_text(ssd())
    with pytest.raises(NavfmuError, match="no variant 'scaning'; did you mean 'scanning'"):
        load(folder, ssd(), variant="scaning")


def test_an_unconnected_input_without_a_start_value_is_an_error(folder):
    description = fmus.describe("plant", [fmus.variable("u", "input", reference=1).replace(' start="0"', "")])
    fmus.write(folder / "resources" / "plant.fmu", description)
    with pytest.raises(NavfmuError, match=r"input 'a\.u' is not connected and has no start value"):
        load(folder, ssd(connectors=""))


def test_a_source_outside_the_package_is_refused(folder, tmp_path):
    load(folder, ssd())
    plant(tmp_path)
    with zipfile.ZipFile(tmp_path / "s.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", ssd().replace("resources/plant.fmu", "../../../plant.fmu"))
    with pytest.raises(NavfmuError, match="lies outside the package"):
        System.load(tmp_path / "s.ssp")


def test_a_value_outside_an_enumeration_is_answered_with_those_that_are_allowed(folder):
    text = ssd(wire("sensor.reading", "filter.reading")).replace('kind="output"', 'kind="outptu"', 1)
    assert "outptu" in text
    with pytest.raises(NavfmuError, match=r"line \d+: .*'outptu' is not an element of the set \{'input', 'output'"):
        load(folder, text)
