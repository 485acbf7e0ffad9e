"""What is not as FMI and SSP have it, but clear, is read with a note and runs all the same; ``--strict`` refuses it."""

from __future__ import annotations

import warnings
import zipfile

import pytest

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.fmi import fmu
from tests.ssp import fmus

from . import stepper
from .habits import lag, replaced


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(fmu, "_memory", {})


def run(file, **parameters):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return System.load(file).run(stop=1, step=0.125, parameters=parameters)


VENDOR = "<VendorAnnotations><Tool name='x'><x:y/></Tool></VendorAnnotations>"
FMUS = {
    "names with ./": ({"entry": "./{}".format}, "names in the archive begin with './'"),
    "names with a backslash": ({"entry": lambda name: name.replace("/", "\\")}, "'\\' between folders"),
    "an identifier with a dash": (
        {"description": replaced(('modelIdentifier="probe"', 'modelIdentifier="a-lag"')), "binary": "a-lag"},
        "modelIdentifier 'a-lag' is not an identifier of the C language",
    ),
    "units that are not defined": (
        {"description": replaced(('unit="s"', 'unit="second"'), ('unit="m"', 'unit="metre"'))},
        "modelDescription.xml: not defined: units 'metre', 'second'",
    ),
    "a display unit of an undefined unit": (
        {"description": replaced(('<Real unit="m"', '<Real unit="metre" displayUnit="nmi"'))},
        'the display unit "nmi" of variable "u" is not defined (1 more like it)',
    ),
    "a start of a calculated variable": (
        {"description": replaced(('initial="calculated"><Real ', 'initial="calculated"><Real start="7" '))},
        'the variable "y" has initial="calculated" but provides a start value',
    ),
    "a continuous Integer": (
        {"description": replaced(('variability="discrete"', 'variability="continuous"'))},
        'the variable "number" is of type Integer and must have variability != "continuous"',
    ),
    "a parameter that does not say when it changes": (
        {"description": replaced(('variability="fixed" initial="exact"', ""))},
        'the combination causality="parameter" and variability="continuous" in variable "tau" is not allowed',
    ),
    "a constant parameter": (
        {"description": replaced(('variability="fixed" initial="exact"', 'variability="constant"'))},
        'the combination causality="parameter" and variability="constant" in variable "tau" is not allowed',
    ),
    "a fixed output": (
        {"description": replaced(('variability="continuous" initial="calculated"', 'variability="fixed"'))},
        'the combination causality="output" and variability="fixed" in variable "y" is not allowed',
    ),
    "an unknown attribute": (
        {"description": replaced(("<ScalarVariable ", '<ScalarVariable previous="1" '))},
        ": <ScalarVariable> has the unknown attribute 'previous' (4 more like it)",
    ),
    "an undeclared prefix": (
        {"description": replaced(("<ModelVariables>", VENDOR + "<ModelVariables>"))},
        "the prefix 'x' is not declared",
    ),
    "a date that is none": (
        {"description": replaced(("<fmiModelDescription ", '<fmiModelDescription generationDateAndTime="noon" '))},
        "'generationDateAndTime': 'noon' is not a valid value",
    ),
    "no start value of a parameter": (
        {"description": replaced(('<String start="probe"/>', "<String/>"))},
        'variable "label" has no start value',
    ),
    "a unit without a factor": (
        {"description": replaced(('<BaseUnit m="1"/>', '<BaseUnit m="1" factor="0"/>'))},
        "modelDescription.xml: unit 'm' has the factor 0 and the offset 0: nothing can be converted",
    ),
    "a display unit without end": (
        {"description": replaced(('factor="0.0005399568034557236"', 'factor="INF" offset="1"'))},
        "modelDescription.xml: display unit 'nmi' has the factor inf and the offset 1: nothing can be converted",
    ),
    "a tolerance of 0": (
        {"description": replaced(("<ModelVariables>", '<DefaultExperiment tolerance="0"/><ModelVariables>'))},
        "modelDescription.xml: the tolerance of its default experiment, 0, is none and is left out",
    ),
    "variables counted from 0": (
        {"description": replaced(('<Unknown index="2"/>', '<Unknown index="1" dependencies="0"/>'))},
        "ModelStructure names the variable 0 of 5, counted from 1: what it says is left out",
    ),
    "a structure with more variables": (
        {"description": replaced(('<Unknown index="2"/>', '<Unknown index="2"/><Unknown index="6"/>'))},
        "ModelStructure names the variable 6 of 5, counted from 1: what it says is left out",
    ),
}  # fmt: skip


@pytest.mark.parametrize("habit", FMUS)
def test_an_fmu_with_a_habit_runs_with_a_note_and_strict_refuses_it(tmp_path, capsys, habit):
    made, sentence = FMUS[habit]
    (tmp_path / "clean").mkdir()
    clean = run(lag(tmp_path / "clean"))
    assert clean.attrs["notes"] == []
    file = lag(tmp_path, **made)
    flight = run(file)
    (column,) = (name for name in flight if name.endswith(".y"))
    assert flight[column].tolist() == clean["probe.y"].tolist()
    assert any(note.startswith("read leniently: lag.fmu: ") and sentence in note for note in flight.attrs["notes"])
    with pytest.raises(NavfmuError, match=r"lag\.fmu: is read leniently, which --strict refuses: "):
        System.load(file, strict=True)
    for words in (["info"], ["run", "--stop", "1", "--step", "0.125"], ["sweep", "--stop", "1", "--steps", "0.1,0.5"]):
        with pytest.raises(SystemExit) as ended:
            main([words[0], str(file), "--strict", *words[1:]])
        assert ended.value.code == 2 and "which --strict refuses" in capsys.readouterr().err


def test_a_start_of_a_calculated_variable_is_not_taken_for_its_value(tmp_path):
    made, _ = FMUS["a start of a calculated variable"]
    assert System.load(lag(tmp_path, **made)).value("probe.y") is None


@pytest.mark.parametrize("structure", ["<ModelStructure/>", "<ModelStructure><Outputs/></ModelStructure>"])
def test_an_fmu_without_outputs_runs(tmp_path, structure):
    def without(text):
        begin, end = text.index("<ModelStructure>"), text.index("</ModelStructure>")
        text = text[:begin] + structure + text[end + len("</ModelStructure>") :]
        return text.replace('causality="output"', 'causality="local"')

    flight = run(lag(tmp_path, without))
    assert list(flight.columns) == [] and len(flight) == 9


def test_a_binary_under_another_name_is_named(tmp_path):
    with pytest.raises(NavfmuError, match=r"has no binary probe\.\w+ for this machine .* binaries/\w+/other\."):
        System.load(lag(tmp_path, binary="other"))


def test_a_library_without_the_functions_of_what_the_fmu_cannot_do_runs_with_a_note(tmp_path):
    """Hosts that look up all of FMI's functions cannot load it; libcosim, for one, can."""
    file = stepper.write(tmp_path / "bare.fmu", binary=stepper.bare())
    flight = run(file, **{"stepper.u": 2.0})
    assert flight["stepper.x"].iloc[-1] == 2.0
    assert System.load(stepper.write(tmp_path / "whole.fmu")).lenient == ()
    library = f"binaries/{fmu.platforms()[0]}/stepper{fmu.library_suffix()}"
    missing = "fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate, fmi2SetRealInputDerivatives"
    assert f"read leniently: bare.fmu: {library} has no {missing}" in flight.attrs["notes"]
    with pytest.raises(NavfmuError, match=r"which --strict refuses: bare\.fmu: binaries/.* has no fmi2GetFMUstate, "):
        System.load(file, strict=True)
    with pytest.raises(NavfmuError, match=r"component 'stepper': FMPy cannot load its binary: .*undefined symbol"):
        System.load(file).run(stop=1, step=0.125, engine="reference")


@pytest.mark.parametrize(
    ("ability", "function"),
    [("canGetAndSetFMUstate", "fmi2GetFMUstate"), ("canInterpolateInputs", "fmi2SetRealInputDerivatives")],
)
def test_a_library_without_the_functions_of_what_the_fmu_claims_is_refused(tmp_path, ability, function):
    file = stepper.write(tmp_path / "bare.fmu", binary=stepper.bare(), **{ability: "true"})
    with pytest.raises(NavfmuError, match=f"component 'stepper': the binary .* has no function {function}"):
        run(file)


def test_truth_values_may_have_spaces_around_them(tmp_path):
    """XML schemas take them away; who does not, reads true as false."""
    change = replaced(
        ("<CoSimulation ", '<CoSimulation canBeInstantiatedOnlyOncePerProcess=" 1 " canInterpolateInputs="\ntrue" '),
        ('<Real unit="m" start="2"', '<Real unit="m" start="2" relativeQuantity="true "'),
        ("</ModelVariables>", fmus.variable("on", "input", "Boolean", 0, start=" true ") + "</ModelVariables>"),
    )
    about = System.load(lag(tmp_path, change)).descriptions["probe"]
    assert about.only_one_instance and about.can_interpolate_inputs and about.by_name["u"].relative
    assert about.by_name["on"].start is True


@pytest.mark.parametrize("version", ["1.0", "3.0"])
def test_other_versions_of_fmi_are_told(tmp_path, version):
    file = lag(tmp_path, replaced(('fmiVersion="2.0"', f'fmiVersion="{version}"')))
    with pytest.raises(NavfmuError, match=f"is for FMI {version}, expected FMI 2.0: FMUs of FMI 1 and FMI 3 cannot be"):
        System.load(file)


def test_two_variables_of_one_name_are_refused(tmp_path):
    with pytest.raises(NavfmuError, match="two variables are named 'y'"):
        System.load(lag(tmp_path, replaced(('name="u"', 'name="y"'))))


# -- systems -----------------------------------------------------------------------------------------------------------

SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="test"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
  <ssd:System name="s">
    <ssd:Elements>
      <ssd:Component name="a" source="lag.fmu">
        <ssd:Connectors><ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
        <ssd:ParameterBindings><ssd:ParameterBinding source="a.ssv"/></ssd:ParameterBindings>
      </ssd:Component>
      <ssd:Component name="b" source="lag.fmu">
        <ssd:Connectors><ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector></ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startElement="a" startConnector="y" endElement="b" endConnector="u"/>
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment stopTime="1">
    <ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
      <osp:Algorithm xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations">
        <osp:FixedStepAlgorithm baseStepSize="0.125"/>
      </osp:Algorithm>
    </ssc:Annotation></ssd:Annotations>
  </ssd:DefaultExperiment>
</ssd:SystemStructureDescription>
"""
SSV = """<ssv:ParameterSet version="1.0" name="p" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssv:Parameters><ssv:Parameter name="u"><ssv:Real value="3"/></ssv:Parameter></ssv:Parameters>
</ssv:ParameterSet>
"""
OUTPUT = '<ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>'
OSP = ' xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations"'
ORPHAN = '<ssd:Connector name="mass" kind="parameter"><ssc:Real/></ssd:Connector></ssd:Connectors>'
UNITS = "<ssd:Units><ssc:Unit name='u'><ssc:BaseUnit {}/></ssc:Unit></ssd:Units>"
SYSTEMS = {
    "an undeclared prefix": (replaced((OSP, "")), "the prefix 'osp' is not declared"),
    "an unknown attribute": (
        replaced(("<ssd:Component ", '<ssd:Component colour="red" ')),
        "line 7: <Component> has the unknown attribute 'colour' (1 more like it)",
    ),
    "a parameter that the FMU lacks": (
        replaced(("</ssd:Connectors>", ORPHAN)),
        "line 7: Component 'a', connector 'mass': is a parameter that lag.fmu does not have",
    ),
    "a parameter of another type": (
        replaced(("</ssd:Connectors>", ORPHAN.replace("mass", "tau").replace("Real", "Binary"))),
        "line 7: Component 'a', connector 'tau': is Binary, but the FMU's variable is Real",
    ),
    "a connection of what is no connector": (
        replaced(
            ('<ssd:Connectors><ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>', "")
        ),
        "component 'a' does not list a connector 'y'",
    ),
    "a unit without a factor": (
        replaced(("  <ssd:DefaultExperiment", UNITS.format('s="1" factor="0"') + "<ssd:DefaultExperiment")),
        "unit 'u': has the factor 0 and the offset 0: nothing can be converted",
    ),
    "a unit that the FMU defines otherwise": (
        replaced(
            (
                "  <ssd:DefaultExperiment",
                UNITS.replace("'u'", "'m'").format('m="1" factor="1000"') + "<ssd:DefaultExperiment",
            ),
            ("<ssc:Real/>", '<ssc:Real unit="m"/>'),
        ),
        "connector 'y': the unit 'm' has two different definitions, and is taken by its name",
    ),
}


def packed(folder, ssd=SSD, ssv=SSV, prefix=""):
    with zipfile.ZipFile(folder / "s.ssp", "w") as archive:
        archive.writestr(f"{prefix}SystemStructure.ssd", ssd)
        archive.writestr(f"{prefix}a.ssv", ssv)
        archive.write(lag(folder), f"{prefix}lag.fmu")
    return folder / "s.ssp"


@pytest.mark.parametrize("habit", SYSTEMS)
def test_a_system_with_a_habit_runs_with_a_note_and_strict_refuses_it(tmp_path, habit):
    change, sentence = SYSTEMS[habit]
    clean = run(packed(tmp_path))
    assert clean.attrs["notes"] == [] and clean["a.y"].iloc[-1] > 1.5
    flight = run(packed(tmp_path, change(SSD)))
    assert flight["b.y"].tolist() == clean["b.y"].tolist()
    assert any(note.startswith("read leniently: ") and sentence in note for note in flight.attrs["notes"])
    with pytest.raises(NavfmuError, match=r"s\.ssp: is read leniently, which --strict refuses: "):
        System.load(tmp_path / "s.ssp", strict=True)


def test_a_package_whose_names_begin_with_a_dot_and_a_parameter_set_without_its_prefix_are_read(tmp_path):
    namespace = ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
    file = packed(tmp_path, ssv=SSV.replace(namespace, ""), prefix="./")
    system = System.load(file)
    assert system.values["a"] == {"u": 3.0}
    assert [note.partition(": ")[2] for note in system.lenient] == [
        "names in the archive begin with './'",
        "a.ssv, line 1: the prefix 'ssv' is not declared",
    ]


def test_a_parameter_set_in_a_namespace_that_ssp_does_not_have_is_read(tmp_path):
    file = packed(tmp_path, ssv=SSV.replace("SSP1/SystemStructureParameterValues", "SSP1/ParameterValues"))
    system = System.load(file)
    assert system.values["a"] == {"u": 3.0}
    space = "http://ssp-standard.org/SSP1/"
    said = f"{file}: a.ssv: its namespace is '{space}ParameterValues', expected '{space}SystemStructureParameterValues'"
    assert list(system.lenient) == [said]
    for wrong in ("SSP1/SystemStructureCommon", "SSP3/ParameterValues"):
        file = packed(tmp_path, ssv=SSV.replace("SSP1/SystemStructureParameterValues", wrong))
        with pytest.raises(NavfmuError, match=rf"a\.ssv: expected <ssv:ParameterSet> of SSP 1\.0, found <.*{wrong}"):
            System.load(file)


def test_a_campaign_that_is_strict_refuses_a_system_with_a_habit(tmp_path, capsys):
    packed(tmp_path, SYSTEMS["an unknown attribute"][0](SSD))
    requirement = '[[requirement]]\nid = "R"\nsignal = "b.y"\nat_most = 9.0\n'
    text = f'system = "s.ssp"\nstop = 1.0\nstep = 0.125\n{requirement}'
    (tmp_path / "c.toml").write_text(text)
    with pytest.raises(SystemExit) as ended:
        main(["campaign", str(tmp_path / "c.toml"), "--strict", "--out", str(tmp_path / "out")])
    assert ended.value.code == 2 and "which --strict refuses" in capsys.readouterr().err


@pytest.mark.parametrize("document", ["ssd", "ssv"])
def test_ssp_2_is_told(tmp_path, document):
    text = {"ssd": SSD, "ssv": SSV}[document].replace('version="1.0" name', 'version="2.0" name')
    with pytest.raises(NavfmuError, match=r"is for SSP 2\.0, expected SSP 1\.0: documents of SSP 2\.0 cannot be"):
        System.load(packed(tmp_path, **{document: text}))
