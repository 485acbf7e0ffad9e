"""Files of stations: what is read of them, and what is refused, each in a sentence with its line."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.navaids.file import read
from tests.navaids.made import NEW, OLD, TABLE


def given(tmp_path, text, name="nav.dat"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_a_file_of_version_810(tmp_path):
    """Wrong: kHz or MHz for hundredths of MHz, feet for m, ranges in km, rows of VORs taken, names cut."""
    found = read(given(tmp_path, OLD))
    assert [one.ident for one in found.stations] == ["SEA", "IAAA", "AAL"]
    assert (found.biased, found.repeated) == (1, 1)
    sea = found.stations[0]
    assert (sea.name, sea.line, sea.bias) == ("SEATTLE VORTAC DME", 7, 0.0)
    np.testing.assert_allclose(np.degrees([sea.latitude, sea.longitude]), [47.43538889, -122.30963889], rtol=1e-14)
    np.testing.assert_allclose([sea.elevation, sea.frequency, sea.range], [107.8992, 116.8, 240760.0], rtol=1e-12)


@pytest.mark.parametrize("version", ["1100", "1150", "1200"])
def test_a_later_file_has_terminal_and_region_between_ident_and_name(tmp_path, version):
    found = read(given(tmp_path, NEW.replace("1100", version, 1)))
    assert [(one.ident, one.name) for one in found.stations] == [
        ("SEA", "SEATTLE VORTAC DME"),
        ("IAAA", "34R DME-ILS"),
        ("AAL", "AALBORG TACAN"),
    ]


def test_a_file_of_version_740_has_the_same_rows(tmp_path):
    old, before = given(tmp_path, OLD), given(tmp_path, OLD.replace("810", "740", 1), "before.dat")
    assert read(before).stations == read(old).stations


@pytest.mark.parametrize("head", ["", "\n", " \n", "A\n"])
def test_a_file_is_known_by_its_version_when_its_first_line_is_empty_or_missing(tmp_path, head):
    """Such files are in circulation. Lines are counted as they stand."""
    text = head + OLD.removeprefix("I\n")
    assert [one.ident for one in read(given(tmp_path, text)).stations] == ["SEA", "IAAA", "AAL"]
    row = 6 + head.count("\n")
    with pytest.raises(NavfmuError, match=f"line {row}: the latitude of 'SEA' is 95"):
        read(given(tmp_path, text.replace("12  47.43538889", "12  95.0"), "other.dat"))


@pytest.mark.parametrize("form", [lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t + "no row\n"])
def test_ends_of_lines_marks_and_what_stands_behind_the_end_do_not_matter(tmp_path, form):
    assert read(given(tmp_path, form(OLD))).stations == read(given(tmp_path, OLD, "other.dat")).stations


def test_names_in_the_letters_of_old_files(tmp_path):
    found = read(given(tmp_path, OLD.replace("AALBORG", "\u00c5LBORG").encode("latin-1")))
    assert found.stations[-1].name == "\u00c5LBORG TACAN"


@pytest.mark.parametrize("mark", [b"\x85", b"\x0c", b"\x1c", "\u2028".encode()])
def test_a_mark_in_a_name_does_not_end_its_line(tmp_path, mark):
    """Three dots of old Windows, a new page. Catches ``str.splitlines``."""
    found = read(given(tmp_path, OLD.encode().replace(b"AALBORG", b"AAL" + mark + b"BORG")))
    assert [one.ident for one in found.stations] == ["SEA", "IAAA", "AAL"]
    found = read(given(tmp_path, TABLE.encode().replace(b"WEST", b"WE" + mark + b"ST"), "stations.csv"))
    assert [one.line for one in found.stations] == [2, 3, 4]


def test_remarks_are_passed_over(tmp_path):
    remarked = OLD.replace("\n12 ", "\n# 12 as they were\n12 ", 1)
    assert [one.line for one in read(given(tmp_path, remarked)).stations] == [8, 10, 12]


ROW = "12  47.43538889 -122.30963889    354 11680 130    0.0 SEA  SEATTLE VORTAC DME"
WRONG_ROWS = {
    "a frequency in MHz": (ROW.replace("11680", "116.80"), "line 7: the frequency of 'SEA' is 1.168 MHz"),
    "no channel": (ROW.replace("11680", "11683"), "is 116.83 MHz; expected 108.00 to 117.95 MHz or"),
    "a channel of the voice": (ROW.replace("11680", "12180"), "line 7: the frequency of 'SEA' is 121.8 MHz"),
    "degrees and minutes": (ROW.replace("47.43538889", "4726.1"), "line 7: the latitude of 'SEA' is 4726.1 degrees"),
    "a longitude to 360": (ROW.replace("-122.30963889", "237.7"), "the longitude of 'SEA' is 237.7 degrees"),
    "no range": (ROW.replace(" 130 ", " 0 "), "line 7: the range of 'SEA' is 0 nmi; expected 1 to 1000"),
    "a decimal comma": (ROW.replace("47.43538889", "47,435"), "line 7: the latitude is '47,435'; expected a number"),
    "an exponent of Fortran": (ROW.replace("354", "3.54D+02"), "line 7: the elevation is '3.54D+02'"),
    "no number": (ROW.replace("47.43538889", "nan"), "line 7: the latitude is 'nan'; expected a number"),
    "an underscore": (ROW.replace("354", "3_54"), "line 7: the elevation is '3_54'"),
    "a cut row": (ROW[:40], "line 7: the row has 5 words; expected at least 8: 12 or 13, latitude"),
    "no code": ("SEA " + ROW, "line 7: begins with 'SEA'; expected the code of a row, such as 12"),
}


@pytest.mark.parametrize("name", WRONG_ROWS)
def test_a_row_with(name, tmp_path):
    row, sentence = WRONG_ROWS[name]
    path = given(tmp_path, OLD.replace(ROW, row))
    with pytest.raises(NavfmuError) as error:
        read(path)
    assert sentence in str(error.value) and str(path) in str(error.value)


WRONG_FILES = {
    "a version of before": (OLD.replace("810", "715", 1), "line 2: the version of the file is '715'; expected 740 or"),
    "a raised digit": (OLD.replace("810 V", "\u00b2 V", 1), "line 2: the version of the file is '\u00b2'; expected"),
    "a version without an end": (OLD.replace("810", "8" * 5000, 1), "line 2: the version of the file is '888"),
    "a quote that does not end": (TABLE.replace('OF IT"', "OF IT"), "line 4: unexpected end of data; expected values"),
    "a word without an end": (TABLE.replace("WEST", "W" * 200_000), "line 2: field larger than field limit"),
    "no version": ("I\n", "line 2: the version of the file is missing; expected 740 or 810 or 1100 or 1150"),
    "its end missing": (OLD.removesuffix("99\n"), "ends at line 11 without the row 99: something of it is missing"),
    "an old row in a later file": (NEW.replace("ENRT K1 SEATTLE VORTAC DME", ""), "has 8 words; expected at least 10"),
    "no transponder": ("I\n810 Version\n99\n", "holds no station; expected rows 12 or 13"),
    "biased ones only": ("I\n810 V\n" + ROW.replace("0.0 ", "0.5 ") + "\n99\n", "holds no station but 1 with a bias"),
    "bytes": (b"I\n810\n\0\0", "is no text; expected a file of stations"),
    "nothing": ("", "there is no column 'ident'"),
    "a column misspelt": (TABLE.replace("range_nmi", "range_nm"), "no column 'range_nmi'; did you mean 'range_nm'?"),
    "a column twice": (TABLE.replace("name", "ident"), "there are two columns 'ident'"),
    "a word in a table": (TABLE.replace("37.0,-122.0", "37.0,west"), "line 2: 'longitude_deg' is 'west'; expected"),
    "a value too many": (TABLE.replace("WEST", "WEST,1"), "line 2: has 8 values; expected 7"),
    "a number out of range": (TABLE.replace("38.0", "98.0"), "line 4: the latitude of 'C' is 98 degrees"),
    "no ident": (TABLE.replace("\nA,", "\n,"), "line 2: 'ident' is empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG_FILES)
def test_a_file_with(name, tmp_path):
    text, sentence = WRONG_FILES[name]
    with pytest.raises(NavfmuError) as error:
        read(given(tmp_path, text))
    assert sentence in str(error.value)


def test_a_table(tmp_path):
    """Wrong: a name cut at its comma, a bias that is not known taken for one, lines counted from the wrong one."""
    found = read(given(tmp_path, TABLE, "stations.csv"))
    assert [(one.ident, one.name, one.line) for one in found.stations] == [
        ("A", "WEST", 2),
        ("B", "EAST, OF IT", 3),
        ("C", "NORTH", 4),
    ]
    biased = (
        TABLE.replace("name", "bias_nmi").replace("WEST", "0.2").replace('"EAST, OF IT"', "0").replace("NORTH", "0")
    )
    assert [one.ident for one in read(given(tmp_path, biased, "b.csv")).stations] == ["B", "C"]


def test_of_one_channel_and_place_there_is_one_and_of_two_channels_two(tmp_path):
    """Wrong: by ident (those of the world repeat), by place alone (a TACAN beside an ILS), or by channel alone."""
    rows = TABLE.splitlines()
    beside = [*rows, "D,37.0005,-122.0,0,110.0,100,", "E,37.0,-122.0,0,113.0,100,", "A,40.0,-122.0,0,110.0,100,"]
    found = read(given(tmp_path, "\n".join(beside), "stations.csv"))
    assert [one.ident for one in found.stations] == ["A", "B", "C", "E", "A"] and found.repeated == 1


@pytest.mark.parametrize("first", [0, 1])
def test_a_transponder_of_which_one_row_tells_a_bias_is_not_used(tmp_path, first):
    """Two ILS of one runway: its delay is that of the one that is on. Wrong: the other row taken, in either order."""
    biased = TABLE.replace("name", "bias_nmi").replace("WEST", "0").replace('"EAST, OF IT"', "0").replace("NORTH", "0")
    rows, other = biased.splitlines(), "D,37.0002,-122.0,0,110.0,100,2.0"
    rows.insert(1 + first, other)
    found = read(given(tmp_path, "\n".join(rows), "stations.csv"))
    assert [one.ident for one in found.stations] == ["B", "C"] and (found.biased, found.repeated) == (2, 0)


def test_the_nearest_come_first(tmp_path):
    found = read(given(tmp_path, TABLE, "stations.csv"))
    near = found.within(np.radians(37.1), np.radians(-121.2), 150e3)
    assert [one.ident for one in near] == ["B", "A", "C"]
    assert [one.ident for one in found.within(np.radians(37.0), np.radians(-121.0), 50e3)] == ["B"]
