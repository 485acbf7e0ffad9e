"""The Python twin: valid, same numbers as the native FMU, honest state, several in one process."""

import ctypes
import hashlib
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output
from navfmu.export.build import build
from navfmu.export.twin import build_twin, sources
from tests import built

from .components import Listener, Searcher, Sensor, Source, TwoRates, Wide
from .slave import DISCARD, OK, Slave, Unzipped

ROOT = Path(__file__).parents[2]
FATAL = 4
SMALL = {"sensor": Sensor, "listener": Listener, "searcher": Searcher, "source": Source, "two_rates": TwoRates}
SMALL["wide"] = Wide
EVERY = {**SMALL, **built.components()}


class Instance:
    """An FMU in FMPy, with its description."""

    def __init__(self, path, folder, name="instance", **values):
        self.path = path
        self.description = fmpy.read_model_description(str(path))
        identifier = self.description.coSimulation.modelIdentifier
        self.slave = FMU2Slave(
            guid=self.description.guid, unzipDirectory=str(folder), modelIdentifier=identifier, instanceName=name
        )
        self.instantiate(loggingOn=True)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.write(values)
        self.setupExperiment(startTime=0.0)
        self.enterInitializationMode()
        self.exitInitializationMode()

    def __getattr__(self, name):
        return getattr(self.slave, name)

    def write(self, values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self, f"set{variable.type}")([variable.valueReference], [value])

    def outputs_of(self, kind):
        return [v for v in self.variables.values() if v.type == kind and v.causality == "output"]

    def read(self, kind):
        chosen = [v.valueReference for v in self.outputs_of(kind)]
        return getattr(self, f"get{kind}")(chosen) if chosen else []

    def outputs(self):
        return [*self.read("Real"), *self.read("Integer"), *self.read("Boolean")]


@pytest.fixture(scope="module")
def twins(tmp_path_factory):
    """Build twins once; return a function that gives path and unzipped folder by name."""
    folder, done = tmp_path_factory.mktemp("twins"), {}

    def twin(name):
        if name not in done:
            path = build_twin(EVERY[name], folder)
            done[name] = (path, fmpy.extract(str(path), str(folder / name)))
        return done[name]

    return twin


@pytest.mark.parametrize("name", EVERY)
def test_twin_is_valid_and_needs_a_tool(name, twins):
    path, _ = twins(name)
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    assert description.coSimulation.needsExecutionTool
    assert not description.coSimulation.canInterpolateInputs
    assert description.coSimulation.canGetAndSetFMUstate


def scale(variable):
    """A plausible size for random values of an input."""
    sizes = {"rad": 0.3, "rad/s": 0.1, "m": 300.0, "m/s": 10.0, "m/s2": 3.0, "T": 2e-5, "Pa": 100.0, "K": 5.0, "s": 1.0}
    return sizes.get(variable.unit, 1.0)


def random_inputs(description, steps, period, rng):
    """Random values for each input and step; bundles announce new data in half of the steps."""
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    sequences: dict[str, int] = {}
    wander: dict[str, float] = {}
    for k in range(steps):
        values = {}
        new = {}
        for v in inputs:
            bundle, _, member = v.name.rpartition(".")
            if member == "sequence":
                new[bundle] = rng.random() < 0.5
                sequences[bundle] = sequences.get(bundle, 0) + int(new[bundle])
        for v in inputs:
            bundle, _, member = v.name.rpartition(".")
            if bundle and not new[bundle]:
                continue
            if member == "sequence":
                values[v.name] = sequences[bundle]
            elif member == "time_of_validity":
                values[v.name] = k * period
            elif v.type == "Boolean":
                values[v.name] = bool(rng.random() < (0.8 if bundle else 0.05))
            elif v.type == "Integer":
                values[v.name] = int(rng.integers(int(v.min or 0), int(v.max or 3) + 1))
            else:
                wander[v.name] = 0.99 * wander.get(v.name, 0.0) + 0.14 * scale(v) * rng.normal()
                values[v.name] = float(v.start) + wander[v.name]
        yield values


@pytest.mark.parametrize("name", EVERY)
def test_twin_and_native_give_the_same_numbers_over_1000_random_steps(name, twins, tmp_path):
    native_path = build([EVERY[name]], tmp_path)[0]
    twin = Instance(*twins(name))
    native = Instance(native_path, fmpy.extract(str(native_path), str(tmp_path / "native")))
    assert twin.description.guid != native.description.guid
    period = native.description.defaultExperiment.stepSize
    period = float(period) if period else 0.01
    rng = np.random.default_rng(11)
    recorded = []
    for k, values in enumerate(random_inputs(native.description, 1000, period, rng)):
        for one in (twin, native):
            one.write(values)
            one.doStep(currentCommunicationPoint=k * period, communicationStepSize=period)
        recorded.append((twin.outputs(), native.outputs()))
    ours, theirs = np.array([r[0] for r in recorded], float), np.array([r[1] for r in recorded], float)
    assert np.all(np.isfinite(theirs))
    names = [v.name for kind in ("Real", "Integer", "Boolean") for v in native.outputs_of(kind)]
    signals = [
        name.partition("[")[0] for name in names
    ]  # a signal is the whole array: cancellation leaves small elements
    largest = {s: np.max(np.abs(theirs[:, [t == s for t in signals]])) for s in signals}
    difference = dict(zip(names, np.max(np.abs(ours - theirs), axis=0), strict=True))
    bound = 1e-11  # the navigator's odds are exp() of a sum of some hundred terms, each rounded: 5e-12 of it
    wrong = {
        n: (d, largest[s]) for (n, d), s in zip(difference.items(), signals, strict=True) if d > bound * largest[s]
    }
    assert not wrong
    assert np.any(np.ptp(theirs, axis=0) > 0)


def step_all(one, start, count, period=0.1):
    seen = []
    for k in range(count):
        if "u[1]" in one.variables:
            one.write({"u[1]": float(np.sin(k))})
        one.doStep(currentCommunicationPoint=start + k * period, communicationStepSize=period)
        seen.append(one.outputs())
    return seen


@pytest.mark.parametrize("name", ["sensor", "two_rates", "imu", "navigator"])
def test_restored_state_of_the_twin_repeats_to_the_last_bit(name, twins):
    one = Instance(*twins(name))
    step_all(one, 0.0, 7)
    state = one.getFMUstate()
    data = one.serializeFMUstate(state)
    first = step_all(one, 0.7, 10)
    one.setFMUstate(state)
    assert step_all(one, 0.7, 10) == first
    other = Instance(*twins(name), name="other")
    other.setFMUstate(other.deSerializeFMUstate(data))
    assert step_all(other, 0.7, 10) == first


def test_hidden_state_of_the_twin_is_restored(twins):
    """Which sample was seen last is no variable, and yet must be restored."""
    one = Instance(*twins("listener"))
    one.write({"reading.sequence": 1})
    one.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.1)
    state = one.getFMUstate()
    one.setFMUstate(state)
    one.doStep(currentCommunicationPoint=0.1, communicationStepSize=0.1)
    assert one.getInteger([one.variables["updates"].valueReference]) == [1]


def test_reset_twin_starts_again(twins):
    one = Instance(*twins("sensor"))
    first = step_all(one, 0.0, 5)
    one.reset()
    one.setupExperiment(startTime=0.0)
    one.enterInitializationMode()
    one.exitInitializationMode()
    assert step_all(one, 0.0, 5) == first


@pytest.mark.parametrize("logging", [True, False])
def test_rejected_parameter_of_the_twin_says_why(logging, twins, capfd):
    _, folder = twins("sensor")
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        fmpy.simulate_fmu(str(folder), stop_time=1.0, start_values={"sigma": -1.0}, debug_logging=logging)
    output = capfd.readouterr()
    assert "Parameter 'sigma' is -1 m; expected a value from 0 to 10 m." in output.out + output.err


@pytest.mark.parametrize("categories", [None, [], [b"logEvents"]])
def test_a_refused_step_of_the_twin_says_why(categories, twins, tmp_path, capfd):
    """Whatever is asked for: no log, all of it, another category."""
    one = Slave(Unzipped(twins("listener")[0], tmp_path / "one"), logging=int(categories is not None))
    if categories:
        names = (ctypes.c_char_p * len(categories))(*categories)
        assert one.call("SetDebugLogging", 1, ctypes.c_size_t(len(categories)), names) == OK
    one.initialise()
    assert one.step(1.0, 0.1) == DISCARD
    sentence = "A step from 1 s was asked for, but this instance is at 0 s; to go back, restore a saved state."
    assert sentence in capfd.readouterr().err
    assert [told for _, _, told in one.messages] == ([sentence] if categories == [] else [])
    one.free()


def test_a_saved_state_of_another_build_of_the_twin_is_refused(tmp_path, capfd):
    """The same variables, tasks and tables, and another equation."""
    text = "from navfmu.export import Component, Input, Output, Parameter, every\n\n\nclass {0}(Component):\n"
    text += "    name = 'same'\n    u, y, pace = Input('m'), Output('m'), Parameter('s', start=0.1)\n\n"
    text += "    @every('pace')\n    def step(self):\n        self.y = {1} * self.u\n"
    slaves = []
    for factor in (1.0, 2.0):
        module = ModuleType(f"same_{factor:.0f}")
        module.__file__ = str(tmp_path / f"{module.__name__}.py")
        Path(module.__file__).write_text(text.format("Same", factor))
        sys.modules[module.__name__] = module
        exec(compile(text.format("Same", factor), module.__file__, "exec"), vars(module))
        fmu = build_twin(module.Same, tmp_path / module.__name__, pictures=False)
        slaves.append(Slave(Unzipped(fmu, tmp_path / module.__name__ / "unzipped")))
    one, two = slaves
    data = one.serialise(one.save())
    status, state = two.deserialise(data)
    assert status != OK or two.call("SetFMUstate", state) == FATAL
    assert "This is not a saved state of this build of 'same', tables included." in capfd.readouterr().err
    assert one.call("SetFMUstate", one.deserialise(data)[1]) == OK


def test_many_twins_in_one_process_do_not_disturb_each_other(twins, tmp_path):
    """Two versions of one component, and many instances, in a process of their own that must end well."""
    changed = tmp_path / "other" / "gadget.py"
    plain = tmp_path / "gadget" / "gadget.py"
    for file, factor in ((plain, 1.0), (changed, 2.0)):
        file.parent.mkdir()
        (file.parent / "common.py").write_text(f"def twice(x):\n    return {factor} * x\n")
        file.write_text(
            "import common\nfrom navfmu.export import Component, Output, Parameter, every\n\n\n"
            'class Gadget(Component):\n    """Gadget."""\n\n    T = Parameter("s", start=0.1)\n'
            '    y = Output("1")\n\n    @every("T")\n    def step(self):\n        self.y = common.twice(self.time)\n'
        )
        code = "import gadget; from navfmu.export.twin import build_twin; build_twin(gadget.Gadget, '.')"
        environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"}
        subprocess.run([sys.executable, "-c", code], cwd=file.parent, env=environment, check=True)
    code = f"""
import fmpy
from tests.export.test_twin import Instance
paths = [{str(plain.with_suffix(".fmu"))!r}, {str(changed.with_suffix(".fmu"))!r}, {str(twins("sensor")[0])!r}]
places = [fmpy.extract(p, {str(tmp_path / "unpacked")!r} + str(n)) for n, p in enumerate(paths)]
ones = [Instance(p, place, f"i{{i}}") for p, place in zip(paths, places) for i in range(70)]
for one in ones:
    one.doStep(currentCommunicationPoint=0.0, communicationStepSize=1.0)
values = [one.read("Real")[0] for one in ones]
assert values[:70] == [1.0] * 70 and values[70:140] == [2.0] * 70, values[:140:35]
assert len(set(values[140:])) == 1 and values[140] != 0
for one in ones:
    one.terminate()
    one.freeInstance()
print("done")
"""
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert (run.stdout.strip().splitlines()[-1:], run.returncode) == (["done"], 0), run.stderr


def test_twin_carries_one_module_with_a_name_of_its_own(twins):
    path, _ = twins("imu")
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        module = archive.read("resources/slavemodule.txt").decode()
        text = archive.read(f"resources/{module}.py").decode()
    own = [n for n in names if n.startswith("resources/") and not n.startswith("resources/pythonfmu/")]
    assert sorted(own) == [f"resources/{module}.py", "resources/slavemodule.txt"]
    assert module.startswith("imu_") and len(module) == len("imu_") + 16
    assert "class ImuSlave(Fmi2Slave):" in text
    assert {"models.inertial.inertial", "fmus.inertial.imu", "navfmu.export.interpreter"} <= set(sources(EVERY["imu"]))
    assert "import ziglang" not in text


STATIONS = """
from pathlib import Path

import numpy as np

from hills import slope
from navfmu.export import Component, Output, Parameter, Table, start


class Stations(Component):
    \"""Stations.\"""

    table = Table(columns=(("x", "m"), ("y", "m")), rows=np.load(Path(__file__).with_name("stations.npy")))
    x = Parameter("m", start=2.5, description="x")
    y = Output("m", description="y")

    @start
    def find(self):
        self.y = slope.STEEPNESS * self.table.around(x=self.x).linear()[1]
"""


def test_a_twin_carries_the_files_that_its_modules_read(tmp_path):
    """Of a module, and of one in a package; they are gone when the twin runs. What nobody names stays where it is."""
    for folder in ("made", "made/hills", "built"):
        (tmp_path / folder).mkdir()
    made = tmp_path / "made"
    (made / "stations.py").write_text(STATIONS)
    (made / "unused.csv").write_text("1,2\n")
    (made / "hills" / "__init__.py").write_text("")
    read = "from pathlib import Path\n\nSTEEPNESS = float(Path(__file__).with_name('slope.txt').read_text())\n"
    (made / "hills" / "slope.py").write_text(read)
    (made / "hills" / "slope.txt").write_text("3.0")
    np.save(made / "stations.npy", np.arange(200_000.0).reshape(-1, 2))
    code = "import stations; from navfmu.export.twin import build_twin; build_twin(stations.Stations, '../built')"
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"}
    subprocess.run([sys.executable, "-c", code], cwd=made, env=environment, check=True)
    made.rename(tmp_path / "elsewhere")
    path = tmp_path / "built" / "stations.fmu"
    with zipfile.ZipFile(path) as archive:
        module = archive.read("resources/slavemodule.txt").decode()
        carried = [name for name in archive.namelist() if name.startswith(f"resources/{module}/")]
    assert sorted(carried) == [f"resources/{module}/hills/slope.txt", f"resources/{module}/stations.npy"]
    code = f"""
import fmpy
from tests.export.test_twin import Instance
one = Instance({str(path)!r}, fmpy.extract({str(path)!r}, {str(tmp_path / "unpacked")!r}))
print(one.read("Real"))
one.terminate()
one.freeInstance()
"""
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env={"PYTHONPATH": str(ROOT)}, capture_output=True)
    assert run.stdout.decode().strip() == "[10.5]", run.stderr.decode()  # 3 (1 + 2.5)


def test_twin_is_built_byte_for_byte_the_same(tmp_path):
    digests = {
        hashlib.sha256(build_twin(Sensor, tmp_path / folder).read_bytes()).hexdigest() for folder in ("one", "two")
    }
    assert len(digests) == 1


def test_a_class_inside_a_function_has_no_twin(tmp_path):
    class Local(Component):
        """Local."""

        y = Output("m")

    with pytest.raises(NavfmuError, match="top of a module"):
        build_twin(Local, tmp_path)


def test_a_model_that_needs_another_package_has_no_twin(tmp_path):
    (tmp_path / "heavy.py").write_text(
        "import scipy.special\nfrom navfmu.export import Component, Output\n\n\n"
        'class Heavy(Component):\n    """Heavy."""\n\n    y = Output("m")\n'
    )
    sys.path.insert(0, str(tmp_path))
    try:
        import heavy

        with pytest.raises(NavfmuError, match=r"plain NumPy only, and one imports 'scipy"):
            build_twin(heavy.Heavy, tmp_path)
    finally:
        sys.path.remove(str(tmp_path))
