"""Simulation tasks of SSP Traceability: valid by the standard's schemas, and true.

``pyssp_standard`` reads the resource meta data and brings the schema of everything that a task is made of, not that of
the task's own phases and steps: these stand here, as chapter 7 of the standard has them.
"""

from __future__ import annotations

import hashlib
import re
from datetime import UTC, datetime
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
from click.testing import CliRunner
from lxml import etree

from navfmu import System
from navfmu.cli.main import main
from navfmu.faults.file import parse_faults
from navfmu.ssp.traceability import NAMESPACES, Particle, Resource, Step, document
from tests.components import systems
from tests.conformance import hosts

STEP = '<xs:complexType><xs:sequence><xs:element name="{}" type="stc:StepType"/></xs:sequence></xs:complexType>'
SCHEMA = f"""<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:stc="{NAMESPACES["stc"]}"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
 targetNamespace="{NAMESPACES["stmd"]}" elementFormDefault="qualified">
<xs:import namespace="http://ssp-standard.org/SSP1/SystemStructureCommon" schemaLocation="SystemStructureCommon.xsd"/>
<xs:import namespace="{NAMESPACES["stc"]}" schemaLocation="STC11.xsd"/>
<xs:import namespace="{NAMESPACES["srmd"]}" schemaLocation="SRMD11.xsd"/>
<xs:element name="SimulationTaskMetaData"><xs:complexType><xs:sequence>
<xs:element name="ExecutionPhase" minOccurs="0">{STEP.format("ExecuteSimulation")}</xs:element>
<xs:element name="EvaluationPhase" minOccurs="0">{STEP.format("EvaluateSimulationResults")}</xs:element>
</xs:sequence><xs:attribute name="version" use="required" fixed="1.0.0"/><xs:attribute name="name" use="required"/>
<xs:attribute name="GUID" use="required"/><xs:attributeGroup ref="ssc:ABaseElement"/>
<xs:attributeGroup ref="ssc:ATopLevelMetaData"/></xs:complexType></xs:element></xs:schema>"""


@pytest.fixture(scope="module")
def standard():
    """``pyssp_standard``, and the schema of a task."""
    try:
        import pyssp_standard
        import xmlschema
    except ImportError:
        hosts.require(False, "pyssp_standard")
    resources = Path(pyssp_standard.__file__).parent / "resources"
    return pyssp_standard, xmlschema.XMLSchema11(SCHEMA, base_url=str(resources))


def navfmu(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def check(file: Path, standard, folder: Path) -> etree._Element:
    """Valid as a task; its resource meta data valid by themselves, with the checksums of the files they are about."""
    from pyssp_standard.srmd import SRMD

    _, schema = standard
    assert [error.reason for error in schema.iter_errors(str(file))] == []
    task = etree.parse(file).getroot()
    found = list(task.iter(f"{{{NAMESPACES['srmd']}}}SimulationResourceMetaData"))
    assert found
    for number, element in enumerate(found):
        alone = folder / f"{number}.srmd"
        alone.write_bytes(etree.tostring(element))
        with SRMD(alone) as data:
            data.__check_compliance__()
            assert data.checksum == hashlib.sha3_256(read(data.data, file)).hexdigest(), data.data
            assert data.data.endswith(data.name.replace(" ", "%20"))
    for resource in task.iter(f"{{{NAMESPACES['stc']}}}Resource"):
        assert (resource.get("source") is None) != (resource.find("stc:Content", NAMESPACES) is None)
    return task


def read(uri: str, file: Path) -> bytes:
    parts = urlparse(uri)
    path = Path(unquote(parts.path))
    return (path if parts.scheme == "file" else file.parent / path).read_bytes()


def entries(task, name: str, of: str = "") -> dict[str, str]:
    """Keyword and value of a classification."""
    (found,) = task.iterfind(f".//stc:Classification[@type='navfmu.{name}']", NAMESPACES)
    return {entry.get("keyword"): entry.text for entry in found}


def resources(task, particle: str) -> list[tuple[str, str]]:
    found = task.iterfind(f".//stc:{particle}/stc:Resource", NAMESPACES)
    return [(one.get("kind"), one.get("source") or one.find("stc:Content", NAMESPACES).text) for one in found]


def test_a_run_says_what_was_run_and_what_came_of_it(standard, tmp_path):
    """What it says is enough to fly it again, and to see that its files are those that were flown."""
    folder, out = tmp_path / "a folder", tmp_path / "x.csv"
    file = folder / "run.stmd"
    options = ["--faults", "stuck", "--set", "lag.tau=2 s", "--seed", 4, "--step", 0.05, "--stop", 10]
    done = navfmu("run", systems.tracker(), *options, "--out", out, "--report", folder, "--stmd", file)
    assert done.exit_code == 0 and f"traceability: {file}" in done.output, done.output
    task = check(file, standard, tmp_path)
    system = System.load(systems.tracker())
    assert entries(task, "fmus.sha256") == system.hashes()
    assert entries(task, "system")["digest"] == system.digest
    assert entries(task, "parameters") == {"lag.tau": "2 s"}
    said = entries(task, "experiment")
    wanted = {"stop (s)": "10", "step (s)": "0.05", "algorithm": "gauss_seidel", "seed": "4", "engine": "compiled"}
    assert said | wanted == said
    (kind, source), (testcase, faults) = resources(task, "Input")
    assert (kind, testcase) == ("system", "testcase") and source == system.place.as_uri()
    assert [fault.id for fault in parse_faults(faults)] == ["F1"]
    (how,) = resources(task, "Procedure")
    assert how[0] == "configuration" and how[1].startswith("navfmu run ") and "--seed 4 --step 0.05" in how[1]
    outputs = [("result", out.as_uri()), ("result", "recording.parquet"), ("report", "report.html")]
    assert resources(task, "Output") == outputs
    made = datetime.strptime(task.get("generationDateAndTime"), "%Y-%m-%dT%H:%M:%SZ").replace(tzinfo=UTC)
    assert abs((datetime.now(UTC) - made).total_seconds()) < 3600.0


CAMPAIGN = """system = "{}"
stop = 10.0
step = 0.1
seeds = "1-2"
[[requirement]]
id = "R1"
signal = "lag.y"
at_most = 1000.0
[[requirement]]
id = "R2"
signal = "lag.y"
at_most = 1.0
"""


def test_a_campaign_says_how_it_was_judged(standard, tmp_path):
    (tmp_path / "c.toml").write_text(CAMPAIGN.format(systems.tracker()))
    out = tmp_path / "out"
    file = out / "task.stmd"
    done = navfmu("campaign", tmp_path / "c.toml", "--out", out, "--stmd", file)
    assert done.exit_code == 0 and f"traceability: {file}" in done.output, done.output
    task = check(file, standard, tmp_path)
    assert set(entries(task, "verdicts").items()) == {("R1, main, nominal", "holds"), ("R2, main, nominal", "violated")}
    kinds = [kind for kind, _ in resources(task, "Input")]
    assert kinds == ["system", "testcase", "requirement"]
    written = {source for _, source in resources(task, "Output")}
    assert written == {"runs.csv", "runs.parquet", "campaign.json", "verdicts.csv", "report.html"}
    said = entries(task, "experiment")
    assert said["runs"] == "2" and said["seeds"] == "1-2" and re.match(r"\d{4}-\d\d-\d\d", said["flown"])


def test_two_tasks_have_two_numbers_and_one_has_one(tmp_path):
    """The number must change with the content, and with nothing else."""
    step = Step(Particle(), Particle((Resource("configuration", text="navfmu run x"),)), Particle())
    other = Step(Particle(), Particle((Resource("configuration", text="navfmu run y"),)), Particle())

    def numbered(step):
        text = document("x", "", {"ExecuteSimulation": step}, tmp_path)
        return etree.fromstring(text).get("generationDateAndTime"), etree.fromstring(text).get("GUID")

    pairs = [numbered(one) for one in (step, step, other)]
    assert pairs[0][1] != pairs[2][1]
    assert (pairs[0][1] == pairs[1][1]) == (pairs[0][0] == pairs[1][0])


def test_what_no_xml_can_hold_is_written_as_python_has_it(standard, tmp_path):
    about = {"notes": {"a\x00b": "c\x01d"}}
    step = Step(Particle(), Particle((), about), Particle())
    file = tmp_path / "x.stmd"
    file.write_bytes(document("n\x02", "", {"ExecuteSimulation": step}, tmp_path))
    assert [error.reason for error in standard[1].iter_errors(str(file))] == []
    assert entries(etree.parse(file), "notes") == {"a\\x00b": "c\\x01d"}


@pytest.mark.parametrize("command", ["run", "campaign"])
def test_a_file_that_cannot_be_written_is_refused_before_anything_is_flown(tmp_path, command):
    (tmp_path / "c.toml").write_text(CAMPAIGN.format(systems.tracker()))
    subject = {"run": systems.tracker(), "campaign": tmp_path / "c.toml"}[command]
    out = ["--out", tmp_path / {"run": "x.csv", "campaign": "out"}[command]]
    for name, sentence in (("x.xml", "expected .stmd at its end"), ("c.toml/x.stmd", "is not a folder")):
        done = navfmu(command, subject, *out, "--stmd", tmp_path / name)
        assert done.exit_code == 2 and sentence in " ".join(done.stderr.split()), done.output
    assert [path.name for path in tmp_path.iterdir()] == ["c.toml"]
