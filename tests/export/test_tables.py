"""Tables in resources: found whatever the host calls the folder, refused with a sentence when they are wrong.

Their files are written here by ``np.save``, and changed byte by byte.
"""

import ctypes
import io
import shutil

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, Table, every
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter

from .components import Rows
from .slave import ERROR, OK, Slave, Unzipped

NAMES = ("time (s)", "x (m)")
ROWS = [[0.0, 0.0], [1.0, 2.0], [3.0, 0.0]]


def saved(rows, names=NAMES, form="<f8", version=None) -> bytes:
    """A table as NumPy saves it."""
    file = io.BytesIO()
    records = np.array([tuple(row) for row in rows], [(name, form) for name in names])
    np.lib.format.write_array(file, records, version)
    return file.getvalue()


def hold(fmu, data: bytes, name="track"):
    """Put a file in the place of an FMU's table."""
    (fmu.folder / "resources" / f"{name}.npy").write_bytes(data)


@pytest.fixture
def source(unzipped, tmp_path):
    """A copy of the FMU in a folder whose name needs care in a URI."""
    return copy_of(unzipped["source"], tmp_path / "with space é 100%")


def copy_of(fmu, folder):
    shutil.copytree(fmu.folder, folder)
    copy = Unzipped.__new__(Unzipped)
    copy.__dict__.update(fmu.__dict__, folder=folder)
    return copy


def x_at_one(fmu, resources=None):
    slave = Slave(fmu, resources=resources)
    if not slave.component:
        return slave.said
    slave.initialise()
    slave.step(0.0, 1.0)
    value = slave.get("x")
    slave.free()
    return value


def test_the_file_is_the_one_that_numpy_saves(unzipped):
    assert (unzipped["source"].folder / "resources" / "track.npy").read_bytes() == saved(ROWS)


@pytest.mark.parametrize("form", ["file://{}", "file:{}", "file://localhost{}", "FILE://{}", "file://{}/"])
def test_the_resource_location_may_be_written_in_several_ways(source, form):
    path = (source.folder / "resources").as_uri().removeprefix("file://")
    assert "%20" in path and "%25" in path
    assert x_at_one(source, form.format(path)) == 2.5


def test_a_plain_path_is_taken_as_it_is(source):
    assert x_at_one(source, str(source.folder / "resources")) == 2.5


def test_a_missing_location_or_file_is_told(source):
    assert x_at_one(source, "file:///nowhere/%41") == "The table /nowhere/A/track.npy cannot be read."
    none = "No fmuResourceLocation was given, but this FMU reads the table resources/track.npy."
    assert x_at_one(source, "") == none
    (source.folder / "resources" / "track.npy").unlink()
    assert x_at_one(source).endswith("/resources/track.npy cannot be read.")


HEADER = "{'descr': [('time (s)', '<f8'), ('x (m)', '<f8')], 'fortran_order': False, 'shape': (%s,), }"
EXPECTED = f"; expected {HEADER % '...'}."
GOOD = saved(ROWS)
WRONG = {
    "another unit": (
        saved(ROWS, ("time (s)", "x (ft)")),
        f"has the header {HEADER % 3}{EXPECTED}".replace("m)", "ft)", 1),
    ),
    "columns the other way round": (saved(ROWS, NAMES[::-1]), EXPECTED),
    "a column more": (saved(np.ones((3, 3)), (*NAMES, "y (m)")), "('y (m)', '<f8')]"),
    "most significant byte first": (saved(ROWS, form=">f8"), "('x (m)', '>f8')]"),
    "single precision": (saved(ROWS, form="<f4"), "('x (m)', '<f4')]"),
    "numbers without names": (
        saved([[0.0], [1.0]], NAMES[:1]).replace(b"('time (s)', '<f8')", b"'f0'               "),
        "'f0'",
    ),
    "a size that is none": (GOOD.replace(b"(3,)", b"(x,)"), "'shape': (x,)"),
    "a size that is too large for anything": (
        GOOD.replace(b"(3,), }      ", b"(3333333333,)"),
        "'shape': (3333333333,)",
    ),
    "a size that is too large": (
        GOOD.replace(b"(3,), }        ", b"(333333333,), }"),
        "has less than the 666666666 numbers",
    ),
    "a CSV file": (b"time (s),x (m)\n0,0\n1,1\n", "is no file of NumPy's format."),
    "nothing": (b"", "is no file of NumPy's format."),
    "the end in the header": (GOOD[:40], "is no file of NumPy's format."),
    "a header without an end": (GOOD[:8] + b"\xff\xff" + GOOD[10:], "is no file of NumPy's format."),
    "a number less": (GOOD[:-8], "has less than the 6 numbers of its header."),
    "a byte less": (GOOD[:-1], "has less than the 6 numbers of its header."),
    "a byte more": (GOOD + b"\n", "has more than the 6 numbers of its header."),
    "a row": (saved(ROWS[:1]), "has 1 numbers in 'time (s)'; expected at least 2."),
    "no row": (saved([]), "has 0 numbers in 'time (s)'; expected at least 2."),
    "no number": (saved([[0, 0], [1, np.nan]]), "number 2 of 2 in 'x (m)' is nan; expected a finite one."),
    "a negative one": (saved([[0, 0], [1, -np.nan]]), "number 2 of 2 in 'x (m)' is nan; expected a finite one."),
    "no time": (saved([[0, 0], [1, 1], [np.inf, 1]]), "number 3 of 3 in 'time (s)' is inf; expected a finite one."),
    "a time twice": (
        saved([[0, 0], [1, 1], [1, 2]]),
        "number 3 of 3 in 'time (s)', 1, is not greater than the one before, 1.",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_table_is_refused_and_what_is_wrong_told(source, wrong):
    """A reader that trusted the header would read past the end, and one that skipped it would take feet for metres."""
    data, sentence = WRONG[wrong]
    hold(source, data)
    said = x_at_one(source)
    assert sentence in said
    assert "track.npy" in said
    assert "100%%25" not in said and "100%%" in said  # a percent sign is doubled for hosts that print like printf


@pytest.mark.filterwarnings("ignore:Stored array in format 3.0")
@pytest.mark.parametrize("letters", ["höhe", "α_L"])
def test_columns_may_have_names_in_any_letters(letters, tmp_path):
    """NumPy writes the first in Latin-1, the second in UTF-8; the bytes of both are negative where char has a sign."""

    class Lettered(Component):
        """Lettered."""

        sample_period = Parameter("s", start=1.0, description="period")
        table = Table(columns=(("time", "s"), (letters, "m")), rows=[[0.0, 1.0], [1.0, 2.0]])
        x = Output("m", description="x")

        @every("sample_period")
        def step(self):
            self.x = self.table.next_row[1]

    (file,) = build([Lettered], tmp_path, pictures=False)
    fmu = Unzipped(file, tmp_path / "unzipped")
    slave = Slave(fmu)
    slave.initialise()
    assert slave.step(0.0, 1.0) == OK and slave.get("x") == 2.0
    slave.free()
    hold(fmu, saved([[0, 1], [1, np.nan]], ("time (s)", f"{letters} (m)"), version=None), "table")
    assert f"number 2 of 2 in '{letters} (m)' is nan" in Slave(fmu).said
    hold(fmu, saved([[0, 1], [1, 1]], ("time (s)", f"{letters[::-1]} (m)")), "table")
    assert "has the header" in Slave(fmu).said


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_all_versions_of_the_format_are_read(source, version):
    hold(source, saved([[0.0, 1.0], [1.0, 3.0], [3.0, 0.0]], version=version))
    assert x_at_one(source) == 3.5


def test_a_long_table_is_read_and_searched_in_both_directions(source):
    hold(source, saved([[k * 0.001, k * 0.5] for k in range(50000)]))
    slave = Slave(source)
    slave.initialise()
    state = slave.save()
    assert slave.step(0.0, 40.0) == OK
    assert slave.get("x") == pytest.approx(20000.5)
    slave.call("SetFMUstate", state)
    assert slave.step(0.0, 1.0) == OK
    assert slave.get("x") == pytest.approx(500.5)
    slave.free()


def test_a_table_that_cannot_be_read_to_its_end_is_told(source):
    table = source.folder / "resources" / "track.npy"
    table.unlink()
    table.mkdir()  # can be opened, but gives an error when read
    assert x_at_one(source).endswith("/resources/track.npy cannot be read.")


@pytest.mark.parametrize("start", [-2.0, 0.0, 10.0])
def test_native_fmu_and_interpreter_find_the_same_rows_before_within_and_behind_a_table(unzipped, start):
    native, floats = Slave(unzipped["rows"]), Interpreter(Rows)
    native.initialise(start)
    floats.setup(start)
    saved, kept = native.save(), floats.get_state()
    found = set()
    for _ in range(2):  # the second time from a place far behind
        for k in range(12):
            rows = native.get("row"), native.get("next_row")
            np.testing.assert_array_equal(rows, (floats.get("row"), floats.get("next_row")))
            found.add((rows[0][0], rows[1][0]))
            native.step(start + 0.5 * k, 0.5)
            floats.do_step(start + 0.5 * k, 0.5)
        native.call("SetFMUstate", saved)
        floats.set_state(kept)
    native.free()
    everything = {(0.0, 1.0), (1.0, 2.5), (2.5, 3.0)}
    assert found == {-2.0: everything, 0.0: everything, 10.0: {(2.5, 3.0)}}[start]


HELD = [[0.0, 1.0], [1.0, 2.0], [2.5, 4.0], [3.0, 8.0]]
OTHERS = {
    "one value": [[0.0, 1.0], [1.0, 2.0000000000000004], [2.5, 4.0], [3.0, 8.0]],
    "two signs": [[0.0, 1.0], [1.0, -2.0], [2.5, -4.0], [3.0, 8.0]],
    "a row more": [*HELD, [4.0, 8.0]],
    "a row less": HELD[:-1],
}


@pytest.mark.parametrize("other", OTHERS)
def test_a_state_that_was_saved_with_another_table_is_refused(other, unzipped, tmp_path):
    """Also when it is the same binary, and the host holds the state of another instance in memory."""
    fmu = copy_of(unzipped["rows"], tmp_path / "other")
    hold(fmu, saved(OTHERS[other]))
    slaves = here, there = Slave(unzipped["rows"]), Slave(fmu)
    for slave in slaves:
        slave.initialise()
        assert slave.step(0.0, 1.5) == OK
    state, before = there.save(), here.everything()
    sentence = "This is not a saved state of this build of 'rows', tables included."
    assert (here.deserialise(there.serialise(state))[0], here.said) == (ERROR, sentence)
    assert (here.call("SetFMUstate", state), here.said) == (ERROR, sentence)
    assert (here.call("GetFMUstate", ctypes.byref(state)), here.said) == (ERROR, sentence)
    assert here.everything() == before
    assert there.call("SetFMUstate", state) == OK
    for slave in slaves:
        slave.free()


def test_a_state_fits_where_the_same_numbers_are_written_otherwise(unzipped, tmp_path):
    fmu = copy_of(unzipped["rows"], tmp_path / "other")
    hold(fmu, saved(HELD, version=(2, 0)))
    here, there = Slave(unzipped["rows"]), Slave(fmu)
    assert here.deserialise(there.serialise(there.save()))[0] == OK
    here.free()
    there.free()


def test_the_interpreter_refuses_the_state_of_another_table_and_of_another_build():
    class Other(Rows):
        name = "rows"
        track = Table(columns=(("time", "s"), ("x", "m")), rows=[[0.0, 1.0], [1.0, 2.0], [2.5, 4.5], [3.0, 8.0]])

    assert [v.name for v in Interpreter(Other).variables] == [v.name for v in Interpreter(Rows).variables]
    sentence = "This is not a saved state of this build of 'rows', tables included."
    for other in (Interpreter(Other), Interpreter(Rows, "another")):
        with pytest.raises(NavfmuError, match=sentence):
            other.set_state(Interpreter(Rows).get_state())
    Interpreter(Rows, "another").set_state(Interpreter(Rows, "another").get_state())


@pytest.mark.parametrize("resources", ["/" + "ü" * 1000, "/x" + "ü" * 1000, "file:///caf%E9"])
def test_what_is_said_is_utf_8_where_a_path_is_too_long_to_be_shown_or_is_none(unzipped, resources):
    """Catches half of a character at the end, which hosts that decode what they are told fail on."""
    slave = Slave(unzipped["source"], resources=resources)
    assert slave.component.value is None
    assert slave.said.startswith("The table /"), "a message that is not UTF-8 is lost in the logger"
    assert "üüü" in slave.said or slave.said == "The table /caf?/track.npy cannot be read."
