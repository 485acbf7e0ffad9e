"""A saboteur is an FMU like the others: valid, the same in every host, its states saved, safe whatever a host calls."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from navfmu import Fault, System
from navfmu.engine.link import TYPES
from navfmu.export.build import build, prepare
from navfmu.export.description import describe
from navfmu.export.toolchain import TARGETS
from navfmu.fmi.description import Variable
from navfmu.fmi.units import Unit
from navfmu.sabotage.saboteur import _variables, saboteurs
from navfmu.ssp.writer import SystemSource
from tests import sanitizers
from tests.components import systems
from tests.conformance import hosts
from tests.export.slave import ERROR, OK, Slave, Unzipped
from tests.sabotage.sabotaged import STEPS, H

FAULTS = (  # everything that remembers, and a bundle with a Boolean and an Integer
    Fault("noise", "sensor.reading.length", "noise", 0.5, sigma=1.0, period=0.3),
    Fault("late", "sensor.reading.length", "delay", delay=0.4, jitter=0.5, period=0.25),
    Fault("slow", "sensor.reading.length", "slow", 1.0, period=0.7, on=2.0, off=1.0),
    Fault("stuck", "sensor.reading", "stuck", 3.0, 1.0),
    Fault("spike", "lag.u", "spike", 1.0, value=5.0, every=0.6),
    Fault("failed", "lag.bias", "input", 2.0, value=1.0),
)
DIRECT = pytest.mark.parametrize("direct", [False, True], ids=["", "direct"])


def made(direct=False):
    experiment = System.load(systems.tracker()).experiment(stop=STEPS * H, step=H, faults=FAULTS)
    return saboteurs(experiment.plan(), experiment.system.links, 5, direct)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Model name, direct -> its FMU."""
    found = {}
    for direct in (False, True):
        folder = tmp_path_factory.mktemp("saboteurs")
        for path in build([one.model for one in made(direct)], folder, pictures=False):
            found[path.stem, direct] = path
    return found


@pytest.fixture(scope="module")
def unzipped(fmus, tmp_path_factory):
    return {key: Unzipped(path, tmp_path_factory.mktemp("unzipped")) for key, path in fmus.items()}


def test_they_are_valid_and_say_what_depends_on_what(fmus, unzipped):
    for (name, direct), path in fmus.items():
        assert validate_fmu(str(path)) == []
        xml = unzipped[name, direct].xml
        assert (xml.find("CoSimulation").get("canHandleVariableCommunicationStepSize")) == "false"
        for part, depends in (("Outputs", direct), ("InitialUnknowns", True)):
            for unknown in xml.find("ModelStructure").find(part):
                assert bool(unknown.get("dependencies")) == (depends and name != "saboteur")
    sensor = unzipped["sensor_saboteur", False].variables
    assert set(sensor) == {
        *(f"true.reading.{name}" for name in ("length", "valid", "sequence", "time_of_validity")),
        *(f"reading.{name}" for name in ("length", "valid", "sequence", "time_of_validity")),
        "seed",
    }
    assert sensor["reading.length"].find("Real").get("unit") == "m"


def test_names_of_components_that_no_model_has(tmp_path):
    """Names that differ in such characters only give models with names of their own; none begins with a digit."""
    source = SystemSource("names", fmus=systems.fmus(), stop_time=STEPS * H, step=H)
    names = ("a-b", "a b", "1st")
    for name in names:
        source.component(name, "source.fmu")
    faults = [Fault(f"F{i}", f"{name}.y", "bias", value=1.0) for i, name in enumerate(names)]
    experiment = System.load(source.pack(tmp_path / "it.ssp")).experiment(stop=STEPS * H, step=H, faults=faults)
    found = saboteurs(experiment.plan(), experiment.system.links, 5, False)
    assert [one.model.name for one in found] == ["a_b_saboteur", "a_b_saboteur_", "_1st_saboteur"]


def test_names_of_other_makers_are_not_said_to_be_structured(tmp_path):
    """An identifier has no sign but _ and no letter of other alphabets; what validates says so for one name each."""
    source = SystemSource("names", fmus=systems.fmus(), stop_time=STEPS * H, step=H)
    source.component("truth", "source.fmu").component("l ä", "lag.fmu").connect("truth.y", "l ä.u")
    given = {"stop": STEPS * H, "step": H, "faults": [Fault("it", "l ä.u", "bias", value=1.0)]}
    experiment = System.load(source.pack(tmp_path / "it.ssp")).experiment(**given)
    (one,) = saboteurs(experiment.plan(), experiment.system.links, 5, False)
    (path,) = build([one.model], tmp_path, pictures=False)
    assert validate_fmu(str(path)) == []
    assert [v.name for v in one.model.variables] == ["true.y", "to.l ä.u"]
    assert 'variableNamingConvention="structured"' in describe(made()[1].model, "{x}")


def test_whole_arrays_are_arrays_and_parts_of_them_are_not():
    """An array whose elements do not all pass must not name others than those that do."""

    def passed(*names):
        likes = {name: Variable(name, 7, "Real", "output", start=float(i)) for i, name in enumerate(names)}
        return [(v.name, v.index, v.shape, v.start) for v in _variables(3, "output", likes)]

    assert passed("x[1]", "x[2]", "y") == [("x", 3, (2,), (0.0, 1.0)), ("y", 5, (), (2.0,))]
    assert passed("m[1,1]", "m[1,2]", "m[2,1]", "m[2,2]") == [("m", 3, (2, 2), (0.0, 1.0, 2.0, 3.0))]
    for part in (("x[2]", "x[3]"), ("x[2]", "x[1]"), ("m[1, 1]", "m[1, 2]"), ("m[1,1]", "m[2,2]")):
        assert [(name, shape) for name, _, shape, _ in passed(*part)] == [(name, ()) for name in part]


def test_units_of_other_makers_are_taken_over_as_they_are():
    """One that is no SI unit with its factor; of one that nobody defines the name, and not that it has no dimension."""
    feet = Unit("ft", (0, 1, 0, 0, 0, 0, 0, 0), 0.3048)
    model = made()[1].model
    like = dataclasses.replace(model.variables[0], shape=(), start=(0.0,))
    variables = [dataclasses.replace(like, name=unit, unit=unit, index=i) for i, unit in enumerate(("ft", "smoot"))]
    foreign = dataclasses.replace(model, variables=tuple(variables), units={"ft": feet, "smoot": Unit("smoot")})
    xml = ElementTree.fromstring(describe(foreign, "{x}"))
    defined = {unit.get("name"): [dict(base.attrib) for base in unit] for unit in xml.iter("Unit")}
    assert defined == {"ft": [{"m": "1", "factor": "0.3048"}], "smoot": []}


@DIRECT
def test_hosts_give_the_numbers_of_this_one(fmus, direct):
    """Alone, with inputs that stay."""
    fmu = fmus["sensor_saboteur", direct]
    start = {"true.reading.length": 2.5, "true.reading.valid": True, "true.reading.sequence": 3}
    (name,) = (system := System.load(fmu)).fmus
    flight = system.run(
        stop=STEPS * H, step=H, algorithm="jacobi", parameters={f"{name}.{key}": v for key, v in start.items()}
    )
    assert len(set(flight[f"{name}.reading.length"])) > 10
    expected = {key.removeprefix(f"{name}."): float(flight[key].iloc[-1]) for key in flight}
    assert hosts.fmpy_single(fmu, H, STEPS, start) == expected
    assert hosts.libcosim_single(fmu, H, STEPS, start) == expected
    assert hosts.ecos_library_single(fmu, H, STEPS, start) == expected


def advance(slave, first, count, seed):
    random, rows = np.random.default_rng(seed), []
    for k in range(first, first + count):
        slave.set("true.reading.length", random.normal())
        slave.set("true.reading.sequence", k)
        assert slave.step(k * H, H) == OK, slave.said
        rows.append(slave.everything())
    return rows


@DIRECT
def test_a_state_that_is_restored_repeats_to_the_last_bit(unzipped, direct):
    """Also what delays and noise remember; in another instance, too, and after a reset from the beginning."""
    one, two = (Slave(unzipped["sensor_saboteur", direct]) for _ in range(2))
    one.initialise()
    beginning = advance(one, 0, 20, 1)
    state = one.save()
    data = one.serialise(state)
    expected = advance(one, 20, 30, 2)
    assert one.call("SetFMUstate", state) == OK
    assert advance(one, 20, 30, 2) == expected
    two.initialise()
    status, copy = two.deserialise(data)
    assert status == OK and two.call("SetFMUstate", copy) == OK
    assert advance(two, 20, 30, 2) == expected
    assert one.call("FreeFMUstate", ctypes.byref(state)) == two.call("FreeFMUstate", ctypes.byref(copy)) == OK
    assert one.call("Reset") == OK
    one.initialise()
    assert advance(one, 0, 20, 1) == beginning
    one.free(), two.free()


def test_another_step_is_refused_and_changes_nothing(unzipped):
    """It would count its points wrongly, and faults would come at other times without a word."""
    slave = Slave(unzipped["sensor_saboteur", False])
    slave.initialise()
    advance(slave, 0, 8, 1)
    before = slave.everything()
    assert slave.step(8 * H, 2 * H) == ERROR
    assert slave.said == (
        "The communication step size is 0.25 s at 1 s; this instance counts communication points of 0.125 s."
    )
    assert slave.everything() == before and slave.step(8 * H, H) == OK
    slave.free()


def test_direct_outputs_follow_inputs_between_steps_and_the_last_counts(unzipped):
    """What is read on the way to the last input leaves nothing behind: a stuck value would keep it."""
    read_often, read_once = (Slave(unzipped["sensor_saboteur", True]) for _ in range(2))
    for slave in (read_often, read_once):
        slave.initialise()
    for k in range(30):
        for value in (100.0 + k, float(k)):
            read_often.set("true.reading.length", value)
            seen = read_often.get("reading.length")
        read_once.set("true.reading.length", float(k))
        assert seen == read_once.get("reading.length")
        assert read_often.step(k * H, H) == read_once.step(k * H, H) == OK
    read_often.free(), read_once.free()


@sanitizers.needs_gcc
@pytest.mark.parametrize("one", [0, 1, 2], ids=["truth", "sensor", "driven"])
@DIRECT
def test_sanitizers_find_nothing_whatever_a_host_calls(one, direct, tmp_path):
    model = made(direct)[one].model
    sources = prepare(model)
    for name, text in sources.files.items():
        (tmp_path / name).write_text(text)
    drive = Path(__file__).parents[1] / "export" / "drive.c"
    program = sanitizers.compile([drive, tmp_path / sources.units[1]], tmp_path / "drive", [tmp_path])
    environment = {k: v for k, v in os.environ.items() if k != "LD_PRELOAD"}
    done = subprocess.run(
        [str(program), tmp_path.as_uri()], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout == "clean 1\n"


@pytest.mark.slow
def test_they_are_built_for_the_platforms_of_the_others(tmp_path):
    (file,) = build([made()[1].model], tmp_path, platforms="all", pictures=False)
    folders = {name.split("/")[1] for name in zipfile.ZipFile(file).namelist() if name.startswith("binaries/")}
    assert len(TARGETS) == 5 and {"linux64", "win64", "darwin64"} <= folders and len(folders) >= len(TARGETS)


def test_types_of_values_are_all_tried():
    assert {v.type for one in made() for v in one.model.variables} == set(TYPES)
