"""Systems written from Python: valid, flat, deterministic, and wrong calls answered by sentences."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from lxml import etree

from navfmu.errors import NavfmuError
from navfmu.ssp.document import NAMESPACES, schema
from navfmu.ssp.writer import SystemSource

from . import fmus


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def source(tmp_path: Path) -> SystemSource:
    fmus.sensor(tmp_path)
    fmus.filter_(tmp_path)
    system = SystemSource("loop", fmus=tmp_path, description="two & a <loop>", stop_time=10, step=0.01)
    system.component("sensor", "sensor.fmu").component("filter", "filter.fmu")
    system.connect("sensor.reading", "filter.imu").connect("filter.rate", "sensor.rate")
    system.parameters("sensor", {"bias": (0.1, 0.2, 0.3), "period": 0.02}, name="sensor_good")
    system.variant("poor", parameters={"sensor": {"bias": "30 deg/s", "seed": 7, "aligned": True}})
    return system


def find(text: bytes, path: str) -> list[etree._Element]:
    return etree.fromstring(text).findall(path, NAMESPACES)


def test_documents_are_valid_against_the_schemas_of_ssp_1_0(source):
    kinds = {".ssd": "SystemStructureDescription", ".ssv": "SystemStructureParameterValues"}
    files = source.files()
    sets = ["resources/sensor_good.ssv", "resources/sensor_poor.ssv"]
    assert sorted(files) == ["SystemStructure.ssd", "poor.ssd", *sets]
    for name, text in files.items():
        rules = etree.XMLSchema(file=str(schema(kinds[Path(name).suffix])))
        assert rules.validate(etree.fromstring(text)), (name, rules.error_log)


def test_a_bundle_connects_the_members_that_the_input_has(source):
    pairs = {
        (c.get("startElement") + "." + c.get("startConnector"), c.get("endElement") + "." + c.get("endConnector"))
        for c in find(source.files()["SystemStructure.ssd"], ".//ssd:Connection")
    }
    members = ("rate[1]", "rate[2]", "rate[3]", "valid", "sequence", "time_of_validity")
    expected = {(f"sensor.reading.{m}", f"filter.imu.{m}") for m in members}
    expected |= {(f"filter.rate[{i}]", f"sensor.rate[{i}]") for i in (1, 2, 3)}
    assert pairs == expected


def test_the_step_is_said_as_libcosim_and_as_omsimulator_read_it(source):
    text = source.files()["SystemStructure.ssd"]
    (master,) = find(text, "ssd:System/ssd:Annotations/ssc:Annotation[@type='org.openmodelica']//oms:FixedStepMaster")
    assert dict(master.attrib) == {"description": "oms-ma", "stepSize": "0.01", "relativeTolerance": "1e-06"}
    (algorithm,) = find(text, "ssd:DefaultExperiment//osp:FixedStepAlgorithm")
    assert algorithm.get("baseStepSize") == "0.01"


def test_there_are_no_connectors_at_the_root_and_none_that_nothing_feeds(source):
    text = source.files()["SystemStructure.ssd"]
    assert find(text, "ssd:System/ssd:Connectors") == []
    connected = {(c.get("endElement"), c.get("endConnector")) for c in find(text, ".//ssd:Connection")}
    for component in find(text, ".//ssd:Component"):
        for connector in component.findall(".//ssd:Connector[@kind='input']", NAMESPACES):
            assert (component.get("name"), connector.get("name")) in connected


def test_both_ends_of_a_connection_name_the_same_unit(source):
    text = source.files()["SystemStructure.ssd"]
    unit = {
        (component.get("name"), connector.get("name")): connector[0].get("unit")
        for component in find(text, ".//ssd:Component")
        for connector in component.iterfind(".//ssd:Connector", NAMESPACES)
    }
    for c in find(text, ".//ssd:Connection"):
        assert unit[c.get("startElement"), c.get("startConnector")] == unit[c.get("endElement"), c.get("endConnector")]


def test_a_variant_lays_its_parameters_over_those_of_the_base(source):
    text = source.files()["resources/sensor_poor.ssv"]
    values = {p.get("name"): p[0].get("value") for p in find(text, ".//ssv:Parameter")}
    assert values["period"] == "0.02" and values["seed"] == "7" and values["aligned"] == "true"
    assert float(values["bias[2]"]) == pytest.approx(0.5235987755982988, rel=1e-15)


def test_a_variant_lays_its_connections_over_those_of_the_base(source, tmp_path):
    """A second sensor comes in and feeds the filter; what the base connects otherwise stays, also what it connects
    later on, and the base knows nothing of it."""
    source.variant(
        "second",
        components={"other": "sensor.fmu"},
        connections={"filter.imu": "other.reading", "other.rate": "filter.rate"},
        parameters={"other": {"seed": 3}},
    )
    source.connect("sensor.reading.temperature", "sensor.heater")
    files = source.files()

    def pairs(name):
        return {
            (f"{c.get('endElement')}.{c.get('endConnector')}", f"{c.get('startElement')}.{c.get('startConnector')}")
            for c in find(files[name], ".//ssd:Connection")
        }

    members = ("rate[1]", "rate[2]", "rate[3]", "valid", "sequence", "time_of_validity")
    expected = {(f"filter.imu.{m}", f"other.reading.{m}") for m in members}
    expected |= {(f"{to}.rate[{i}]", f"filter.rate[{i}]") for i in (1, 2, 3) for to in ("sensor", "other")}
    assert pairs("second.ssd") == expected | {("sensor.heater", "sensor.reading.temperature")}
    assert not any("other" in end for pair in pairs("SystemStructure.ssd") for end in pair)
    assert len(find(files["second.ssd"], ".//ssd:Component")) == 3
    assert "resources/other_second.ssv" in files
    (input_,) = (c for c in find(files["second.ssd"], ".//ssd:Component[@name='other']"))
    kinds = [c.get("name") for c in input_.findall(".//ssd:Connector[@kind='input']", NAMESPACES)]
    assert kinds == ["rate[1]", "rate[2]", "rate[3]"]
    archive = zipfile.ZipFile(source.pack(tmp_path / "second.ssp", variant="second"))
    assert len(find(archive.read("SystemStructure.ssd"), ".//ssd:Component")) == 3


def test_the_same_calls_pack_to_the_same_bytes(source, tmp_path):
    first = source.pack(tmp_path / "a.ssp").read_bytes()
    assert source.pack(tmp_path / "b.ssp").read_bytes() == first
    names = zipfile.ZipFile(tmp_path / "a.ssp").namelist()
    assert names[0] == "SystemStructure.ssd" and "resources/sensor.fmu" in names and "poor.ssd" in names


def test_a_variant_can_be_packed_as_the_main_system(source, tmp_path):
    archive = zipfile.ZipFile(source.pack(tmp_path / "poor.ssp", variant="poor"))
    assert "poor.ssd" not in archive.namelist()
    assert b"resources/sensor_poor.ssv" in archive.read("SystemStructure.ssd")


def test_writing_again_leaves_the_files_untouched(source, tmp_path):
    paths = source.write(tmp_path / "out")
    before = [path.stat().st_mtime_ns for path in paths]
    assert [path.stat().st_mtime_ns for path in source.write(tmp_path / "out")] == before


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda s: s.component("a", "none.fmu"), "none.fmu: no such file"),
        (lambda s: s.component("sensor", "sensor.fmu"), "two components named 'sensor'"),
        (lambda s: s.connect("senser.rate", "filter.imu"), "no component 'senser'; did you mean 'sensor'"),
        (lambda s: s.connect("sensor.readin", "filter.imu"), "did you mean 'reading'"),
        (lambda s: s.connect("sensor.reading.temperature", "sensor.heatr"), "did you mean 'heater'"),
        (lambda s: s.connect("sensor.reading.temperature", "filter.rate"), "is output, expected input"),
        (lambda s: s.connect("filter.rate[1]", "sensor.heater"), "is in rad/s, 'heater' in K"),
        (lambda s: s.connect("sensor.reading.sequence", "sensor.heater"), "is Integer, 'heater' is Real"),
        (lambda s: s.connect("filter.rate", "sensor.rate"), "is connected already"),
        (lambda s: s.connect("filter.rate", "filter.imu"), "'; it has: rate"),  # and not [1], [2], [3], or 430 of them
        (lambda s: s.parameters("sensor", {"perod": 1}), "no parameter 'perod'; did you mean 'period'"),
        (lambda s: s.parameters("sensor", {"bias": [1, 2]}), "2 values given, expected 3"),
        (lambda s: s.parameters("sensor", {"bias": -1}), "'bias[1]' = -1 rad/s is out of range: expected 0 to 1 rad/s"),
        (lambda s: s.parameters("sensor", {"bias": "1 m"}), "'m' cannot be converted to 'rad/s'"),
        (lambda s: s.parameters("sensor", {"bias": "1 furlong"}), "unit 'furlong' is not known here"),
        (lambda s: s.parameters("sensor", {"seed": 1.5}), "expected an integer"),
        (lambda s: s.parameters("sensor", {"aligned": "maybe"}), "expected true or false"),
        (lambda s: s.parameters("sensor", {"reading": 1}), "is a bundle"),
        (lambda s: s.parameters("filter", {"imu.lost": 1}), "cannot be set: it is output"),
        (lambda s: s.variant("poor"), "two variants named 'poor'"),
        (lambda s: SystemSource("a\x02"), "SystemSource: name: the text 'a\\x02' has the character \\x02, which XML"),
        (lambda s: SystemSource("a", description="\ud800"), "a: description: the text '\\ud800' has the character"),
        (lambda s: s.component("a\x00", "sensor.fmu"), "component: the text 'a\\x00' has the character \\x00"),
        (lambda s: s.component("a", "sen\x7fsor\x1f.fmu"), "file name of an FMU: the text"),
        (lambda s: s.parameters("sensor", {}, name="a\x01"), "sensor: name of the parameter set: the text"),
        (lambda s: s.variant("a\x01"), "variant: the text"),
        (lambda s: s.variant("a", description="\x0b"), "variant 'a': description: the text"),
        (lambda s: s.variant("a", components={"senser": "sensor.fmu"}), "no component 'senser'; did you mean 'sensor'"),
        (lambda s: s.variant("a", connections={"filter.imu": "other.reading"}), "no component 'other'"),
        (
            lambda s: s.variant("a", connections={"filter.im": "sensor.reading"}),
            "connection 'sensor.reading' -> 'filter",
        ),
        (lambda s: s.variant("a", connections={"filter": "sensor.reading"}), "not of the form component.variable"),
        (lambda s: s.pack("x.ssp", variant="pour"), "no variant 'pour'; did you mean 'poor'"),
    ],
)
def test_a_wrong_call_is_answered_by_a_sentence(source, call, sentence):
    with pytest.raises(NavfmuError) as error:
        call(source)
    assert sentence in str(error.value)


def test_a_display_unit_with_an_offset_converts(source):
    source.parameters("sensor", {"ambient": "15 degC"})
    assert b'value="288.15"' in source.files()["resources/sensor_good.ssv"]


def test_strings_come_back_as_they_are_or_are_refused(tmp_path):
    described = fmus.describe("plant", [fmus.variable("label", "parameter", "String", start="")])
    fmus.write(tmp_path / "plant.fmu", described)
    text = "a\nb\tc\rd  e<&\"'\x85 \U0001f6e9"
    system = SystemSource("one", fmus=tmp_path).component("plant", "plant.fmu").parameters("plant", {"label": text})
    (value,) = find(system.files()["resources/plant.ssv"], ".//ssv:String")
    assert value.get("value") == text
    for wrong in ("a\x01b", "\ud800", "\uffff"):
        with pytest.raises(NavfmuError, match=r"one: plant: 'label' = .*: the text has the character .*; expected"):
            system.parameters("plant", {"label": wrong})
