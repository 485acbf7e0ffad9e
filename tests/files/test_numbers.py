"""Files of columns of numbers: what NumPy reads and writes itself, and the same as text."""

import io

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.files import numbers, numbers_as_text

TABLE = {"time (s)": np.array([0.0, 1.0, 2.5]), "x (m)": np.array([0.1, -0.0, 1e-320])}
GRID = {
    "north (m)": np.array([0.0, 10.0, 25.0]),
    "east (m)": np.array([-1.0, 1.0]),
    "height (m)": np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
    "slope (1)": np.arange(6.0).reshape(3, 2) / 3,
}
GREEK = {"α (rad)": np.array([0.0, 1.0]), "C_L (1)": np.array([0.1, 0.2])}
WESTERN = {"höhe (m)": np.array([0.0, 1.0])}
ALL = {"table": TABLE, "grid": GRID, "Greek": GREEK, "Western": WESTERN}


def same(one, other):
    assert list(one) == list(other)
    for name in one:
        assert one[name].shape == other[name].shape
        assert one[name].tobytes() == other[name].tobytes()


@pytest.mark.parametrize("which", ALL)
def test_numpy_reads_every_column(which):
    """A header that NumPy did not take, or columns in another order than that of the header, would show here."""
    records = np.load(io.BytesIO(numbers.packed(ALL[which])))
    same({name: np.ascontiguousarray(records[name]) for name in records.dtype.names}, ALL[which])
    same(numbers.unpacked(numbers.packed(ALL[which]), "x"), ALL[which])


@pytest.mark.filterwarnings("ignore:Stored array in format 3.0")
@pytest.mark.parametrize("which", ALL)
def test_the_header_that_fmus_expect_is_the_one_that_numpy_saves(which):
    columns, file = ALL[which], io.BytesIO()
    grid = which == "grid"
    form = [(name, "<f8", column.shape if grid else ()) for name, column in columns.items()]
    records = np.zeros(() if grid else len(next(iter(columns.values()))), form)
    np.save(file, records)
    version = file.getvalue()[6]
    begins = 10 if version == 1 else 12
    first, second = next(iter(columns.values())).size, list(columns.values())[-1].shape[-1]
    header = numbers.header(list(columns), grid)
    header = header.replace(b"\1", str(first).encode()).replace(b"\2", str(second).encode())
    assert file.getvalue()[begins:].startswith(header)
    assert file.getvalue()[begins:].partition(b"\n")[0].rstrip() == header
    assert version == (3 if which == "Greek" else 1)


@pytest.mark.parametrize("which", ALL)
def test_text_reads_back_to_the_last_bit(which):
    text = numbers_as_text.text(ALL[which])
    same(numbers_as_text.columns(text, ALL[which], "x.csv"), ALL[which])
    with_marks = "\ufeff" + text.replace("\n", "\r\n") + "\r\n"
    same(numbers_as_text.columns(with_marks, ALL[which], "x.csv"), ALL[which])


def test_a_grid_is_a_line_for_each_point_and_the_second_axis_goes_first():
    lines = numbers_as_text.text({name: GRID[name] for name in list(GRID)[:3]}).splitlines()
    assert lines == [
        "north (m),east (m),height (m)", "0.0,-1.0,1.0", "0.0,1.0,2.0", "10.0,-1.0,3.0", "10.0,1.0,4.0",
        "25.0,-1.0,5.0", "25.0,1.0,6.0",
    ]  # fmt: skip


HEAD, POINTS = "time (s),x (m)\n", "north (m),east (m),height (m),slope (1)\n"
WRONG_TEXTS = {
    "": (TABLE, "x.csv, line 1: the columns are ''; expected 'time (s),x (m)'"),
    "time (s),x (ft)\n": (TABLE, "x.csv, line 1: the columns are 'time (s),x (ft)'; expected 'time (s),x (m)'"),
    HEAD + "0,1\n\n1,\n": (TABLE, "x.csv, line 4: expected 2 numbers separated by commas"),
    HEAD + "0,1,2\n": (TABLE, "x.csv, line 2: expected 2 numbers separated by commas"),
    HEAD + "0,1_0\n": (TABLE, "x.csv, line 2: expected 2 numbers separated by commas"),  # Python would read 10
    HEAD + "0,nan\n": (TABLE, "x.csv, line 2: expected 2 numbers separated by commas"),
    POINTS + "0,0,1,1\n0,1,1,1\n1,0,1,1\n": (GRID, "x.csv: has 3 points; expected each of 2 numbers of the first axis"),
    POINTS + "0,0,1,1\n1,0,1,1\n0,1,1,1\n1,1,1,1\n": (GRID, "x.csv: has 4 points; expected each of 2 numbers"),
}


@pytest.mark.parametrize("text", WRONG_TEXTS)
def test_a_wrong_text_is_told_with_its_line(text):
    like, sentence = WRONG_TEXTS[text]
    with pytest.raises(NavfmuError) as caught:
        numbers_as_text.columns(text, like, "x.csv")
    assert str(caught.value).startswith(sentence)


def test_a_file_that_is_none_or_has_no_names_is_told():
    plain, pickled = io.BytesIO(), io.BytesIO()
    np.save(plain, np.zeros((2, 2)))
    np.save(pickled, np.array([{}], object))
    for data, said in (
        (b"", "expected a file of NumPy's format"),
        (b"time (s)\n", "expected a file of NumPy's format"),
        (numbers.packed(TABLE)[:-1], "expected a file of NumPy's format"),
        (pickled.getvalue(), "expected a file of NumPy's format"),  # which would run code of its own
        (plain.getvalue(), "holds numbers without names; expected an array of records"),
    ):
        with pytest.raises(NavfmuError, match=said):
            numbers.unpacked(data, "x.npy")


def _header(text):
    return b"\x93NUMPY\x01\x00\x76\x00" + text.encode().ljust(117) + b"\n"


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("<c16", "complex128"),
        ("<U4", "<U4"),
        ("<M8[s]", "datetime64"),
        ("V8", "V8"),
        ("?", "bool"),
        ([("a", "<f8")], "a"),
    ],
)
def test_columns_of_what_is_no_real_number_are_told(kind, told):
    """Catches an imaginary part that is dropped, days that are read as seconds, and a traceback of NumPy's."""
    file = io.BytesIO()
    np.save(file, np.zeros(2, [("time (s)", "<f8"), ("x (m)", kind)]))
    with pytest.raises(NavfmuError, match=rf"x.npy: 'x \(m\)' is of type .*{told}.*; expected real numbers"):
        numbers.unpacked(file.getvalue(), "x.npy")


@pytest.mark.parametrize("header", ["(" * 100, "{'descr': '<f8', 'fortran_order': False, 'shape': (9999999999999,), }"])
def test_a_header_that_is_none_is_told(header):
    """NumPy has other errors than ValueError for these."""
    with pytest.raises(NavfmuError, match=r"^x.npy: .*; expected a file of NumPy's format$"):
        numbers.unpacked(_header(header), "x.npy")
