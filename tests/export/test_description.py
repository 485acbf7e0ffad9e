"""modelDescription.xml: valid, complete, with units that are right."""

import dataclasses
from xml.etree import ElementTree

import fmpy
import pytest
from fmpy.validation import validate_fmu

from navfmu import NavfmuError
from navfmu.export import Component, Input, Output, Parameter, State, every, start
from navfmu.export.build import build
from navfmu.export.description import DISPLAY_UNITS, base_units, check_units, describe, initial_unknowns
from navfmu.export.tracing.lower import lower
from tests import built

from .arrays import Beacons, Cube, Receiver
from .components import Planned, Sensor, Source
from .slave import OK, Slave, Unzipped


@pytest.mark.parametrize("name", sorted(built.components()))
def test_every_fmu_of_the_project_is_valid(name, tmp_path_factory):
    path = built.fmu(name, tmp_path_factory)
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert not description.coSimulation.needsExecutionTool
    for variable in description.modelVariables:
        assert variable.description, variable.name
        assert variable.type != "Real" or variable.unit, variable.name
        if variable.causality in ("input", "parameter"):
            assert variable.start is not None, variable.name


@pytest.mark.parametrize("component", [Beacons, Receiver, Cube])
def test_names_stand_in_the_order_of_the_structured_convention(component):
    """Depth first, FMI 2.0.4, section 2.2.9. Catches all ranges of an array of bundles before all parts of it, and the
    number of the last sample far behind the others of its bundle; indices that are references."""
    model = lower(component)
    xml = ElementTree.fromstring(describe(model, "{0}"))
    variables = list(xml.iter("ScalarVariable"))
    names = [variable.get("name") for variable in variables]
    for prefix in {name[:end] for name in names for end, c in enumerate(name) if c in ".["}:
        places = [place for place, name in enumerate(names) if name.startswith((f"{prefix}.", f"{prefix}["))]
        assert places == list(range(places[0], places[-1] + 1)), prefix
    assert {int(variable.get("valueReference")): name for variable, name in zip(variables, names, strict=True)} == {
        element.index: element.name for element in model.elements
    }
    outputs = {names[int(unknown.get("index")) - 1] for unknown in xml.find("ModelStructure/Outputs")}
    assert outputs == {v.get("name") for v in variables if v.get("causality") == "output"}


def test_small_fmus_are_valid(unzipped):
    for fmu in unzipped.values():
        assert validate_fmu(str(fmu.folder)) == []
        assert fmu.xml.get("variableNamingConvention") == "structured"


@pytest.mark.parametrize(
    ("unit", "exponents"),
    [
        ("1", {}),
        ("m/s2", {"m": 1, "s": -2}),
        ("1/s", {"s": -1}),
        ("kg/m3", {"kg": 1, "m": -3}),
        ("N.m", {"kg": 1, "m": 2, "s": -2}),
        ("m2/s3", {"m": 2, "s": -3}),
        ("rad/s", {"rad": 1, "s": -1}),
        ("m.s-1", {"m": 1, "s": -1}),
        ("T", {"kg": 1, "s": -2, "A": -1}),
        ("Pa/m", {"kg": 1, "m": -2, "s": -2}),
        ("Hz/s", {"s": -2}),
    ],
)
def test_units_are_read_as_si_symbols_with_powers(unit, exponents):
    assert base_units(unit) == exponents


@pytest.mark.parametrize("unit", ["", "deg", "ft", "m//s", "m/", "m s", "m^2", "12", "m.1", "/s", "M"])
def test_other_units_are_refused(unit):
    with pytest.raises(NavfmuError, match="expected SI symbols"):
        base_units(unit)


def test_unknown_display_units_are_refused_with_the_nearest_name():
    model = lower(Sensor)
    wrong = dataclasses.replace(model.variables[0], unit="rad", display_unit="degs")
    with pytest.raises(NavfmuError, match=r"variable 'u': unit 'rad' cannot be displayed as 'degs'.*mean 'deg'"):
        check_units(dataclasses.replace(model, variables=(wrong, *model.variables[1:])))


def test_units_of_columns_are_refused_like_those_of_variables():
    """Seconds as "sec" went into the file of a table, where no host could tell what they are."""
    model = lower(Planned)
    wrong = dataclasses.replace(model.tables[0], units=("sec", "m"))
    with pytest.raises(NavfmuError, match=r"table 'plan', column 'time': unknown unit 'sec'; expected SI symbols"):
        check_units(dataclasses.replace(model, tables=(wrong, *model.tables[1:])))
    check_units(model)


def test_display_units_are_right():
    """One of each against its definition."""
    expected = {
        ("m/s", "kn"): 1852 / 3600,
        ("m", "nmi"): 1852,
        ("m", "ft"): 0.3048,
        ("m/s", "ft/min"): 0.3048 / 60,
        ("rad", "deg"): 0.017453292519943295,
        ("rad/s", "deg/h"): 0.017453292519943295 / 3600,
        ("m/s2", "mg"): 9.80665e-3,
        ("T", "mG"): 1e-7,
        ("Pa", "hPa"): 100,
        ("Pa", "inHg"): 3386.389,
    }
    for (unit, name), one in expected.items():
        assert DISPLAY_UNITS[unit][name][0] * one == pytest.approx(1.0, rel=1e-12)
    factor, offset = DISPLAY_UNITS["K"]["degC"]
    assert factor * 288.15 + offset == pytest.approx(15.0)


def test_outputs_depend_on_the_state_alone_and_calculated_ones_are_initial_unknowns(unzipped):
    xml = unzipped["source"].xml
    names = list(unzipped["source"].variables)
    outputs = xml.findall("ModelStructure/Outputs/Unknown")
    assert [(names[int(o.get("index")) - 1], o.get("dependencies")) for o in outputs] == [("x", "")]
    unknowns = xml.findall("ModelStructure/InitialUnknowns/Unknown")
    assert [(names[int(u.get("index")) - 1], u.get("dependencies")) for u in unknowns] == [
        ("x", str(names.index("offset") + 1))
    ]
    assert unzipped["sensor"].xml.find("ModelStructure/InitialUnknowns") is None


def test_initial_unknowns_depend_on_all_that_can_be_set_then():
    class Warm(Component):
        """Starts from a state that can be set, from a parameter, and from chance."""

        u = Input("m", description="input")
        sigma = Parameter("m", start=0.1, description="sigma")
        unused = Parameter("m", description="not read")
        covariance = State(2, "m2", start=1.0, description="state with a start value")
        given = Output("m", description="output with a start value")
        kept = State("m", description="calculated state")
        chance = Output("m", description="drawn")
        known = Output("m2", description="not drawn")
        later = Output("m", description="calculated from what is calculated")

        @start
        def begin(self, noise):
            self.chance = self.sigma * noise(1)[0]
            self.known = self.covariance[1] + 1.0
            self.kept = self.given + self.u

        @start
        def go_on(self):
            self.later = self.kept + self.known

    model = lower(Warm)
    name = [e.name for e in model.elements]
    assert {name[i]: {name[j] for j in of} for i, of in initial_unknowns(model)} == {
        "chance": {"sigma", "seed", "stream"},
        "known": {"covariance[2]"},
        "later": {"given", "u", "covariance[2]"},
    }


def test_faults_bundles_and_ranges_are_described(unzipped):
    sensor = unzipped["sensor"]
    marked = [n for n, v in sensor.variables.items() if v.find("Annotations/Tool[@name='navfmu']/fault") is not None]
    assert marked == ["broken"]
    bundles = sensor.xml.findall("VendorAnnotations/Tool[@name='navfmu']/bundles/bundle")
    assert [b.get("name") for b in bundles] == ["reading"]
    sigma = sensor.variables["sigma"].find("Real")
    assert (sigma.get("unit"), sigma.get("min"), sigma.get("max"), sigma.get("start")) == ("m", "0.0", "10.0", "0.1")
    assert sensor.variables["gain"].get("variability") == "tunable"
    assert sensor.variables["reading.sequence"].find("Integer").get("start") == "0"
    assert sensor.variables["reading.valid"].find("Boolean").get("start") == "false"


def test_awkward_text_is_escaped():
    class Odd(Component):
        """Less < more & "quotes" 'single' — long."""

        x = Input("m", description='a < b & "c"\nnext line')
        every_s = Parameter("s", start=0.1, min=0.01, description="period")
        y = Output("m", description="100 %")

        @every("every_s")
        def copy(self):
            self.y = self.x

    text = describe(lower(Odd), "{guid}")
    assert "Less &lt; more &amp; " in text
    assert '"a &lt; b &amp; &quot;c&quot; next line"' in text or "'a &lt; b &amp; \"c\" next line'" in text


def test_the_least_integer_is_described_and_comes_back(tmp_path):
    class Deep(Component):
        """An integer of all its bits."""

        every_s = Parameter("s", start=0.1, min=0.01, description="period")
        least = Parameter(kind="integer", start=-(2**31), min=-(2**31), description="least")
        y = Output(kind="integer", description="the same")

        @every("every_s")
        def copy(self):
            self.y = self.least

    (path,) = build(Deep, tmp_path)
    fmu = Unzipped(path, tmp_path / "unzipped")
    number = fmu.variables["least"].find("Integer")
    assert (number.get("min"), number.get("start")) == ("-2147483648", "-2147483648")
    slave = Slave(fmu)
    assert slave.get("least") == -(2**31)
    slave.initialise()
    assert slave.step(0.0, 0.1) == OK and slave.get("y") == -(2**31)
    slave.free()


def test_description_of_a_twin_needs_a_tool_and_has_no_sources():
    text = describe(lower(Source), "{guid}", needs_execution_tool=True, can_interpolate_inputs=False)
    assert 'needsExecutionTool="true"' in text
    assert "SourceFiles" not in text
