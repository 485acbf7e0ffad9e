"""A component that needs a Python package: a PythonFMU that says what it needs, keeps objects, and saves no state."""

import sys
import textwrap
import zlib

import fmpy
import pytest
from fmpy.validation import validate_fmu

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, every
from navfmu.export.build import build, build_all
from navfmu.export.discovery import components
from navfmu.export.interpreter import Interpreter
from navfmu.export.twin import build_twin

from .slave import Slave, Unzipped

HELPER = '''
class Counter:
    """An object whose state no FMU can copy."""

    def __init__(self):
        self.count = 0

    def next(self):
        self.count += 1
        return self.count
'''
MODULE = '''
from navfmu.export import Component, Output, Parameter, every, start


class Counting(Component):
    """Counts with a package of others."""

    name = "counting_{name}"
    needs = ("{name}",)
    step = Parameter("1", start=2.0, description="of the count")
    period_s = Parameter("s", start=0.1, min=1e-3, description="period")
    count = Output("1", description="count")

    @start
    def begin(self):
        import {name}

        self.kept["counter"] = {name}.Counter()
        self.count = 0.0 * self.step

    @every("period_s")
    def tick(self):
        if self.kept["counter"].count < 100:
            self.count = self.step * self.kept["counter"].next()
'''


@pytest.fixture
def counting(tmp_path, monkeypatch, request):
    """A component in a folder of its own, and the package that it needs beside it."""
    name = f"helper_{zlib.crc32(request.node.name.encode())}"
    for folder, file, text in (("packages", f"{name}.py", HELPER), (f"of_{name}", "counting.py", MODULE)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / file).write_text(textwrap.dedent(text).format(name=name))
    (tmp_path / f"of_{name}" / "__init__.py").touch()
    monkeypatch.syspath_prepend(tmp_path / "packages")
    (component,) = components(tmp_path / f"of_{name}").values()
    yield component
    sys.modules.pop(name, None)


def test_the_fmu_says_that_it_needs_a_tool_and_saves_no_state(counting, tmp_path):
    """A state that is restored without the package's half would go on from another flight."""
    path = build_twin(counting, tmp_path / "out")
    assert validate_fmu(str(path)) == []
    about = fmpy.read_model_description(str(path))
    assert about.coSimulation.needsExecutionTool
    assert not about.coSimulation.canGetAndSetFMUstate
    assert not about.coSimulation.canSerializeFMUstate
    assert float(about.defaultExperiment.stepSize) == 0.1
    (unknown,) = about.initialUnknowns
    assert unknown.variable.name == "count"
    xml = (Unzipped(path, tmp_path / "unzipped").folder / "modelDescription.xml").read_text()
    assert xml.partition("<InitialUnknowns>")[2].count("dependencies") == 0  # on all that is known


def test_each_instance_keeps_its_own(counting):
    one, other = Interpreter(counting), Interpreter(counting)
    for each in (one, other):
        each.setup()
    for k in range(3):
        one.do_step(0.1 * k, 0.1)
    other.do_step(0.0, 0.1)
    assert (one.get("count"), other.get("count")) == (6.0, 2.0)
    one.reset()
    one.setup()
    one.do_step(0.0, 0.1)
    assert one.get("count") == 2.0


def test_it_runs_in_a_host_and_without_its_package_says_what_is_missing(counting, tmp_path, monkeypatch, capfd):
    (name,) = counting.needs
    unzipped = Unzipped(build_twin(counting, tmp_path / "out"), tmp_path / "unzipped")
    slave = Slave(unzipped)
    assert slave.component
    monkeypatch.undo()  # the folder of packages is on the path no more
    sys.modules.pop(name)
    capfd.readouterr()
    assert not Slave(unzipped).component
    told = capfd.readouterr().err
    assert f"tested: 'counting_{name}' needs the Python package {name}, which the Python of this process (" in told
    assert f"install it there: pip install {name}" in told


def test_it_has_no_native_fmu(counting, tmp_path):
    with pytest.raises(NavfmuError, match="and has no native FMU; expected a folder for Python twins"):
        build([counting], tmp_path / "out")
    (built,) = build_all([counting], tmp_path / "out", twins=tmp_path / "out" / "python")
    assert built.path.parent.name == "python"
    assert not list((tmp_path / "out").glob("*.fmu"))


class Forgetful(Component):
    """Keeps what no state holds, and names no package."""

    x = Output("1", description="x")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="period")

    @every("sample_period")
    def tick(self):
        self.kept["y"] = self.x


def test_what_needs_no_package_keeps_states_only(tmp_path):
    """Else a saved state of a native FMU, or of its twin, would lack what is kept."""
    told = "'kept' is for what comes from a Python package; name that in 'needs', or declare a State"
    with pytest.raises(NavfmuError, match=told):
        build([Forgetful], tmp_path)
    run = Interpreter(Forgetful)
    run.setup()
    with pytest.raises(NavfmuError, match=told):
        run.do_step(0.0, 0.1)
