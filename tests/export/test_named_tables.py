"""Tables whose files are named by string parameters: read when initialisation ends, kept apart in saved states."""

import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, Table, every
from navfmu.export.description import initial_unknowns
from navfmu.export.interpreter import Interpreter
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin

from .components import Planned
from .slave import ERROR, OK, Slave
from .test_tables import copy_of, saved

OTHER = saved([[0.0, 5.0], [2.0, 6.0], [4.0, 5.0]])
HIGH = saved([[0.0, 2000.0], [4.0, 0.0]])


@pytest.fixture
def planned(unzipped, tmp_path):
    """A copy of the FMU with more files in its resources."""
    fmu = copy_of(unzipped["planned"], tmp_path / "planned")
    (fmu.folder / "resources" / "other.npy").write_bytes(OTHER)
    (fmu.folder / "resources" / "high.npy").write_bytes(HIGH)
    (fmu.folder / "resources" / "bad.npy").write_bytes(saved([[0.0, 5.0], [0.0, 6.0]]))
    field = np.zeros((), [("x (m)", "<f8", (2,)), ("y (m)", "<f8", (3,)), ("z (m)", "<f8", (2, 3))])
    field["x (m)"], field["y (m)"], field["z (m)"] = [0.0, 10.0], [0.0, 1.0, 2.0], [[1, 1, 1], [2, 2, 2]]
    np.save(fmu.folder / "resources" / "plane.npy", field)
    return fmu


def flown(slave, start=0.0):
    """x, z and first at the start and after two seconds."""
    found = [[slave.get(name) for name in ("x", "z", "first")]]
    assert slave.step(start, 2.0) == OK
    return [*found, [slave.get(name) for name in ("x", "z", "first")]]


def test_an_empty_name_is_the_table_itself(planned):
    slave = Slave(planned)
    assert slave.initialise() == OK
    assert flown(slave) == [[1.0, 1.5, 1.0], [5.0, 5.5, 1.0]]
    slave.free()


@pytest.mark.parametrize("name", ["other.npy", "plans/ö 1.npy"])
def test_a_file_that_is_named_is_read_instead_with_a_grid_of_another_size(planned, name):
    """Constants that were found in the old file and kept would show in `first`."""
    file = planned.folder / "resources" / name
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(OTHER)
    slave = Slave(planned)
    assert slave.set("plan_file", name) == OK
    assert slave.set("field_file", "plane.npy") == OK
    assert slave.initialise() == OK
    assert flown(slave) == [[5.0, 1.5, 5.0], [6.0, 1.6, 5.0]]
    slave.call("Reset")
    assert slave.initialise() == OK
    assert flown(slave) == [[1.0, 1.5, 1.0], [5.0, 5.5, 1.0]]
    slave.free()


def test_the_interpreter_does_the_same(planned):
    run = Interpreter(Planned, resources=planned.folder / "resources")
    run.set("plan_file", "other.npy")
    run.set("field_file", "plane.npy")
    run.setup()
    assert [run.get(name) for name in ("x", "z", "first")] == [5.0, 1.5, 5.0]
    run.do_step(0.0, 2.0)
    assert [run.get(name) for name in ("x", "z", "first")] == [6.0, 1.6, 5.0]


def test_what_is_named_can_be_seen_and_changed_during_initialisation(planned):
    slave = Slave(planned)
    slave.call("SetupExperiment", 0, fmi_real(0), fmi_real(0), 0, fmi_real(0))
    slave.call("EnterInitializationMode")
    seen = []
    for name in ("", "other.npy", "high.npy", ""):
        assert slave.set("plan_file", name) == OK
        seen.append(slave.get("x"))
    assert seen == [1.0, 5.0, 2000.0, 1.0]
    assert slave.call("ExitInitializationMode") == OK
    slave.free()


def fmi_real(value):
    import ctypes

    return ctypes.c_double(value)


def test_a_requirement_sees_the_table_that_is_named(planned):
    slave = Slave(planned)
    slave.set("plan_file", "high.npy")
    assert slave.initialise() == ERROR
    assert slave.said == "the plan begins above 1000"
    slave.free()
    run = Interpreter(Planned, resources=planned.folder / "resources")
    run.set("plan_file", "high.npy")
    with pytest.raises(NavfmuError, match="the plan begins above 1000"):
        run.setup()


OUTSIDE = "' is not in the resources; expected the name of a file there."
WRONG = {
    "none.npy": ("none.npy cannot be read.", "none.npy: no such file; expected a table"),
    "bad.npy": ("number 2 of 2 in 'time (s)', 0, is not greater", "bad.npy: Table is searched by 'time'"),
    "plane.npy": ("has the header", "'z (m)' (a surface); expected 'time (s)' (a list), 'x (m)' (a list)"),
    "whole.npy": ("has the header", "'x (m)' is of type <i4; expected <f8, which is what FMUs read"),
    "swapped.npy": ("has the header", "'time (s)' is of type >f8; expected <f8, which is what FMUs read"),
    "row.npy": ("has the header", "has the columns 'time (s)' (a number), 'x (m)' (a number); expected"),
    "plans": ("plans cannot be read.", "is a folder, expected a table"),
    "../resources/other.npy": (OUTSIDE, OUTSIDE),
    "a/../other.npy": (OUTSIDE, OUTSIDE),
    "/tmp/other.npy": (OUTSIDE, OUTSIDE),
    "C:other.npy": (OUTSIDE, OUTSIDE),
    "\\\\server\\other.npy": (OUTSIDE, OUTSIDE),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_told_and_another_can_be_named(planned, name):
    """A file elsewhere is no part of the FMU: what it holds is not in the key under which results are kept."""
    (planned.folder / "resources" / "plans").mkdir()
    np.save(planned.folder / "resources" / "row.npy", np.zeros((), [("time (s)", "<f8"), ("x (m)", "<f8")]))
    for file, kinds in (("whole", ("<f8", "<i4")), ("swapped", (">f8", ">f8"))):
        rows = np.array([(0, 1), (4, 2)], [("time (s)", kinds[0]), ("x (m)", kinds[1])])
        np.save(planned.folder / "resources" / f"{file}.npy", rows)
    native, floats = WRONG[name]
    slave = Slave(planned)
    slave.set("plan_file", name)
    assert slave.initialise() == ERROR
    assert native in slave.said
    assert slave.set("plan_file", "other.npy") == OK
    assert slave.call("ExitInitializationMode") == OK
    assert slave.get("x") == 5.0
    slave.free()
    run = Interpreter(Planned, resources=planned.folder / "resources")
    run.set("plan_file", name)
    with pytest.raises(NavfmuError) as caught:
        run.setup()
    assert floats in str(caught.value)


def test_a_state_brings_its_tables_along_and_is_refused_where_they_hold_something_else(planned, unzipped, tmp_path):
    """A state that was set beside the tables of another run would go on with that run's plan, without a word."""
    one, two = Slave(planned), Slave(planned)
    one.set("plan_file", "other.npy")
    for slave in (one, two):
        assert slave.initialise() == OK
        assert slave.step(0.0, 1.0) == OK
    kept, own = one.serialise(one.save()), two.serialise(two.save())
    status, state = two.deserialise(kept)
    assert status == OK and two.call("SetFMUstate", state) == OK
    assert flown(two, 1.0) == [[5.5, 6.0, 5.0], [5.5, 6.0, 5.0]]
    status, state = two.deserialise(own)
    assert two.call("SetFMUstate", state) == OK
    assert flown(two, 1.0) == [[3.0, 3.5, 1.0], [7.0, 7.5, 1.0]]

    changed = copy_of(planned, tmp_path / "changed")
    (changed.folder / "resources" / "other.npy").write_bytes(saved([[0.0, 5.0], [2.0, 6.0], [4.0, 5.5]]))
    missing = copy_of(planned, tmp_path / "missing")
    (missing.folder / "resources" / "other.npy").unlink()
    for fmu, said in ((changed, "This is not a saved state of this build"), (missing, "other.npy cannot be read.")):
        other = Slave(fmu)
        assert other.initialise() == OK
        assert other.step(0.0, 1.0) == OK
        before = other.everything()
        status, state = other.deserialise(kept)
        assert status == OK and other.call("SetFMUstate", state) == ERROR
        assert said in other.said
        assert other.everything() == before
        assert flown(other, 1.0) == [[3.0, 3.5, 1.0], [7.0, 7.5, 1.0]]
        other.free()
    one.free()
    two.free()


def test_states_of_the_interpreter_do_so_too(planned):
    folder = planned.folder / "resources"
    one, two = Interpreter(Planned, resources=folder), Interpreter(Planned, resources=folder)
    one.set("plan_file", "other.npy")
    for run in (one, two):
        run.setup()
        run.do_step(0.0, 1.0)
    kept, own = one.get_state(), two.get_state()
    two.set_state(kept)
    two.do_step(1.0, 2.0)
    assert two.get("x") == 5.5
    two.set_state(own)
    (folder / "other.npy").write_bytes(HIGH)
    with pytest.raises(NavfmuError, match="not a saved state of this build of 'planned', tables included"):
        Interpreter(Planned, resources=folder).set_state(kept)
    two.do_step(1.0, 2.0)
    assert two.get("x") == 7.0


def test_the_twin_reads_what_is_named(planned, tmp_path):
    path = build_twin(Planned, tmp_path, pictures=False)
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("resources/other.npy", OTHER)
    result = fmpy.simulate_fmu(str(path), stop_time=2.0, output_interval=1.0, start_values={"plan_file": "other.npy"})
    assert result["x"].tolist() == [5.0, 5.5, 6.0]


def test_a_file_is_named_by_a_string_of_the_component():
    def declared(**more):
        class Wrong(Component):
            """Wrong."""

            plan_file = Parameter(kind="string", description="file")
            files = Parameter(2, kind="string", description="files")
            sample_period = Parameter("s", start=1.0, description="period")
            plan = Table(columns=(("time", "s"),), rows=[[0.0], [1.0]], **more)
            x = Output("m", description="x")

            @every("sample_period")
            def step(self):
                self.x = self.x + 1.0

    declared(file="plan_file")
    for file, hint in (("plan_fiel", "; did you mean 'plan_file'?"), ("sample_period", ""), ("files", "")):
        with pytest.raises(NavfmuError) as caught:
            declared(file=file)
        assert f"the file of 'plan' is named by '{file}', which is no string Parameter{hint}" in str(caught.value)


def test_what_is_found_at_the_start_depends_on_the_name_of_the_file():
    """Each value on the names of its own tables: catches none, and all of them for every value."""
    model = lower(Planned)
    found = {model.elements[i].name: {model.elements[j].name for j in of} for i, of in initial_unknowns(model)}
    assert found == {"x": {"plan_file"}, "z": {"plan_file", "field_file"}, "first": {"plan_file"}}
