"""Tables in resources: found whatever the host calls the folder, refused with file and line when they are wrong."""

import ctypes
import locale
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.export import Table
from navfmu.export.interpreter import Interpreter

from .components import Rows
from .slave import ERROR, OK, Slave, Unzipped

TABLE = "time (s),x (m)\n0.0,0.0\n1.0,2.0\n3.0,0.0\n"


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


def test_the_table_has_a_header_with_units_and_numbers_that_read_back(unzipped):
    assert (unzipped["source"].folder / "resources" / "track.csv").read_text() == TABLE


@pytest.mark.parametrize("form", ["file://{}", "file:{}", "file://localhost{}", "FILE://{}", "file://{}/"])
def test_the_resource_location_may_be_written_in_several_ways(source, form):
    path = (source.folder / "resources").as_uri().removeprefix("file://")
    assert "%20" in path and "%25" in path
    assert x_at_one(source, form.format(path)) == 2.5


def test_a_plain_path_is_taken_as_it_is(source):
    assert x_at_one(source, str(source.folder / "resources")) == 2.5


def test_a_missing_location_or_file_is_told(source):
    assert x_at_one(source, "file:///nowhere/%41") == "The table /nowhere/A/track.csv cannot be read."
    none = "No fmuResourceLocation was given, but this FMU reads the table resources/track.csv."
    assert x_at_one(source, "") == none
    (source.folder / "resources" / "track.csv").unlink()
    assert x_at_one(source).endswith("/resources/track.csv cannot be read.")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("time (s),y (m)\n0,0\n1,1\n", "does not start with the line 'time (s),x (m)'."),
        ("", "does not start with the line 'time (s),x (m)'."),
        ("time (s),x (m)\n0,0\n", "has 1 rows; expected at least 2."),
        ("time (s),x (m)\n0,0\n1\n", "Line 3 of the table"),
        ("time (s),x (m)\n0,0\n1,x\n", "is not 2 numbers separated by commas."),
        ("time (s),x (m)\n0,0\n1,\n2,3\n", "Line 3 of the table"),
        ("time (s),x (m)\n0,0\n1,2,3\n", "has more than 2 numbers."),
        ("time (s),x (m)\n0,0\n1,nan\n", "is not 2 numbers separated by commas."),
        ("time (s),x (m)\n0,0\n1,1\n1,2\n", "its first number, 1, is not greater than the one before."),
    ],
)
def test_a_wrong_table_is_refused_with_file_and_line(source, text, sentence):
    (source.folder / "resources" / "track.csv").write_text(text)
    said = x_at_one(source)
    assert sentence in said
    assert "track.csv" in said
    assert "100%%25" not in said and "100%%" in said  # a percent sign is doubled for hosts that print like printf


def test_other_line_ends_empty_lines_and_notations_are_read(source):
    text = "time (s),x (m)\r\n0,0\r\n\r\n1E0, +2.0\r\n3,0"
    (source.folder / "resources" / "track.csv").write_bytes(text.encode())
    assert x_at_one(source) == 2.5


#: A mark of one byte, which is the one between the numbers, too, and a mark of two bytes.
LANGUAGES = ("de_DE", "ps_AF")


@pytest.fixture(scope="module")
def languages(tmp_path_factory):
    """A folder of locales, made where their sources are."""
    folder = tmp_path_factory.mktemp("locales")
    for name in LANGUAGES:
        if shutil.which("localedef") and Path(f"/usr/share/i18n/locales/{name}").is_file():
            command = ["localedef", "-i", name, "-f", "UTF-8", str(folder / f"{name}.UTF-8")]
            subprocess.run(command, check=False, capture_output=True)
    return folder


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("rows", ["0.0,0.0\n1.0,2.0\n3.0,0.0\n", "0,0.5\n1,2\n3,1\n", "-1,0\n0,0\n2,4\n"])
def test_numbers_are_read_whatever_the_hosts_locale_is(source, languages, monkeypatch, language, rows):
    before = locale.setlocale(locale.LC_NUMERIC)
    (source.folder / "resources" / "track.csv").write_text(f"time (s),x (m)\n{rows}")
    if any(languages.iterdir()):
        monkeypatch.setenv("LOCPATH", str(languages))
    try:
        locale.setlocale(locale.LC_NUMERIC, f"{language}.UTF-8")
    except locale.Error:
        pytest.skip(f"the locale {language} is not installed and cannot be made")
    try:
        assert locale.localeconv()["decimal_point"] != "."
        assert x_at_one(source) == 2.5
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)


def test_a_long_table_is_read_and_searched_in_both_directions(source):
    rows = [f"{k * 0.001!r},{k * 0.5!r}" for k in range(50000)]
    (source.folder / "resources" / "track.csv").write_text("time (s),x (m)\n" + "\n".join(rows) + "\n")
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
    table = source.folder / "resources" / "track.csv"
    table.unlink()
    table.mkdir()  # can be opened, but gives an error when read
    assert x_at_one(source).endswith("/resources/track.csv cannot be read.")


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


ROWS = ["0.0,1.0", "1.0,2.0", "2.5,4.0", "3.0,8.0"]
OTHERS = {
    "one value": ["0.0,1.0", "1.0,2.0000000000000004", "2.5,4.0", "3.0,8.0"],
    "two signs": ["0.0,1.0", "1.0,-2.0", "2.5,-4.0", "3.0,8.0"],
    "a row more": [*ROWS, "4.0,8.0"],
    "a row less": ROWS[:-1],
}


@pytest.mark.parametrize("other", OTHERS)
def test_a_state_that_was_saved_with_another_table_is_refused(other, unzipped, tmp_path):
    """Also when it is the same binary, and the host holds the state of another instance in memory."""
    fmu = copy_of(unzipped["rows"], tmp_path / "other")
    (fmu.folder / "resources" / "track.csv").write_text("\n".join(["time (s),x (m)", *OTHERS[other], ""]))
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
    (fmu.folder / "resources" / "track.csv").write_text("time (s),x (m)\r\n0,1\r\n1e0,2\r\n2.50,4\r\n3,8\r\n")
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
