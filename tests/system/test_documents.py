"""The documents of the shipped system: valid, flat, complete, and those in the repository are the ones written."""

import re
from pathlib import Path

import fmpy.ssp
import pytest
from lxml import etree

from navfmu.errors import NavfmuError
from system_ssp.backup_navigator.system import ATTITUDES, NAVIGATORS, RECEIVERS, source

FOLDER = Path(__file__).parents[2] / "system_ssp" / "backup_navigator"
SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"
SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
CONNECTED = {
    "three_antennas": {("ahrs", "gps"): ("gps", "attitude")},
    "gps_signals": {
        ("gps", "specific_force"): ("aircraft", "specific_force"),
        ("gps_solver", "signals"): ("gps", "signals"),
        ("navigator", "fix"): ("gps_solver", "fix"),
        ("navigator", "fix_error_sigma"): ("gps_solver", "horizontal_sigma"),
        ("navigator", "augmented_protection"): ("gps_solver", "augmented_horizontal_protection"),
    },
}
"""Inputs that a variant connects otherwise, and the outputs that feed them, as arrays and bundles."""
REPLACED = {**dict.fromkeys(ATTITUDES, "ahrs"), **dict.fromkeys(NAVIGATORS, "navigator")}
"""Components in whose place a variant has another FMU."""


def joined(document):
    """Outputs by inputs, without the members of arrays and bundles."""

    def end(connection, side):
        return connection.get(f"{side}Element"), re.split(r"[.\[]", connection.get(f"{side}Connector"))[0]

    return {end(c, "end"): end(c, "start") for c in etree.fromstring(document).iter(f"{SSD}Connection")}


@pytest.fixture(scope="module")
def files(fmus):
    return source(fmus).files()


def test_the_documents_in_the_repository_are_those_that_the_source_writes(files):
    kept = {
        str(path.relative_to(FOLDER)): path.read_bytes()
        for pattern in ("*.ssd", "resources/*.ssv")
        for path in FOLDER.glob(pattern)
    }
    assert sorted(kept) == sorted(files), "run: python build_fmus.py && python -m system_ssp"
    for name in files:
        assert kept[name] == files[name], f"{name} differs: run python build_fmus.py && python -m system_ssp"


def test_every_document_is_valid_against_the_ssp_schema(files):
    schemas = {
        ".ssd": etree.XMLSchema(etree.parse(SCHEMAS / "SystemStructureDescription.xsd")),
        ".ssv": etree.XMLSchema(etree.parse(SCHEMAS / "SystemStructureParameterValues.xsd")),
    }
    for name, text in files.items():
        schemas[Path(name).suffix].assertValid(etree.fromstring(text))


def test_every_system_is_flat_without_root_connectors_and_with_equal_units(files):
    for name, text in files.items():
        if not name.endswith(".ssd"):
            continue
        system = etree.fromstring(text).find(f"{SSD}System")
        assert system.find(f"{SSD}Connectors") is None, name
        units = {}
        for component in system.iter(f"{SSD}Component"):
            for connector in component.iter(f"{SSD}Connector"):
                units[component.get("name"), connector.get("name")] = connector[0].get("unit")
        connections = list(system.iter(f"{SSD}Connection"))
        assert len(connections) > 90
        for c in connections:
            start = units[c.get("startElement"), c.get("startConnector")]
            assert start == units[c.get("endElement"), c.get("endConnector")], c.attrib


def test_every_variant_loads_alone_and_differs_from_the_base_where_it_says(load, fmus, files):
    base = load()
    for variant in source(fmus).variants:
        system = load(variant)
        changed = {
            f"{name}.{key}"
            for name, values in system.values.items()
            for key, value in values.items()
            if base.values.get(name, {}).get(key) != value
        }
        if variant in CONNECTED:
            assert (
                not changed
                and joined(files[f"{variant}.ssd"])
                == {
                    end: CONNECTED[variant].get(end, start)
                    for end, start in joined(files["SystemStructure.ssd"]).items()
                }
                | CONNECTED[variant]
            )
            continue
        if variant in REPLACED:
            place = REPLACED[variant]
            others = {name for name, it in system.descriptions.items() if it.guid != base.descriptions[name].guid}
            assert others == {place} and system.descriptions[place].model_identifier == variant
            more = {
                tuple(end.split(".")): tuple(start.split(".")) for end, start in NAVIGATORS.get(variant, {}).items()
            }
            assert joined(files[f"{variant}.ssd"]) == joined(files["SystemStructure.ssd"]) | more
            continue
        if variant == "shared_bias":
            assert changed == {"dme.receiver_share"}
            continue
        component = {"open": "navigator.", "r_as": "navigator.", "imu_": ("imu.", "ahrs.")}.get(variant[:4])
        stations = "bay_area" in variant
        assert changed, variant
        assert all(name.startswith(component) if component else stations or name == "dme.mode" for name in changed), (
            variant,
            changed,
        )
        if variant in RECEIVERS:
            assert changed == {"dme.mode"}


def test_a_track_fmu_can_take_the_place_of_the_aircraft(fmus):
    with pytest.raises(NavfmuError, match=r"nothing\.fmu"):
        source(fmus, aircraft="nothing.fmu")
