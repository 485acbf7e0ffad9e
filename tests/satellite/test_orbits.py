"""Files of orbits: RINEX of all versions, YUMA and SEM against what was written, and the sentences of wrong ones."""

from datetime import date

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.files.numbers import packed, unpacked
from navfmu.satellite import calendar
from navfmu.satellite.file import read_orbits
from tests.satellite import made

NEAR = date(2006, 11, 15)


def read(folder, text, near=None, name="file"):
    return read_orbits(made.written(folder, name, text), near)


def glab(old, new):
    """The published message with something else in it."""
    return made.navigation_2(made.GLAB.replace(old, new))


def refusal(folder, text, near=None, name="file"):
    with pytest.raises(NavfmuError) as caught:
        read(folder, text, near, name)
    return str(caught.value)


@pytest.mark.parametrize(
    ("day", "week", "second"),
    [
        (date(1980, 1, 6), 0, 0.0),
        (date(1999, 8, 21), 1023, 518400.0),
        (date(1999, 8, 22), 1024, 0.0),  # the first rollover
        (date(2019, 4, 7), 2048, 0.0),  # the second one
        (date(2020, 6, 25), 2111, 345600.0),
    ],
)
def test_weeks_of_days(day, week, second):
    assert calendar.gps_time(day, 0.0) == (week, second)


@pytest.mark.parametrize(
    ("day", "leaps"),
    [
        (date(1980, 1, 6), 0),
        (date(1993, 6, 30), 8),
        (date(1993, 7, 1), 9),
        (date(2016, 12, 31), 17),
        (date(2017, 1, 1), 18),
    ],
)
def test_leap_seconds(day, leaps):
    assert calendar.leap_seconds(day) == leaps


def test_all_versions_and_both_exponents_have_the_same_rows(tmp_path):
    """D and e, a point first, plain and packed by gzip; other systems and kinds of messages are left out, and told."""
    old = read(tmp_path, made.navigation_2(made.REMONDI, made.GLAB))
    new = read(
        tmp_path,
        made.navigation_3(made.GLONASS, made.GLAB.replace("D", "e"), made.GLONASS, made.REMONDI),
        name="new.rnx.gz",
    )
    assert np.array_equal(old.rows, new.rows) and len(old.rows) == 2
    assert np.array_equal(old.ionosphere, new.ionosphere)
    np.testing.assert_allclose(old.ionosphere[1], [116700.0, -229400.0, -131100.0, 1049000.0])
    assert "2 message(s) of satellites R are left out" in new.sentences()
    assert old.remarks == ()
    glonass = f"> EPH R01 FDMA\n{made.GLONASS}"
    newest = read(tmp_path, made.navigation_4(made.CNAV, made.GLAB, glonass, made.CNAV, made.REMONDI))
    assert np.array_equal(old.rows, newest.rows) and np.array_equal(old.ionosphere, newest.ionosphere)
    told = newest.sentences()
    assert "2 message(s) of satellites EPH G CNAV are left out" in told
    assert "1 message(s) of satellites EPH R FDMA are left out" in told
    assert read(tmp_path, made.navigation_4(made.GLAB, ionosphere="> ION E   IFNV")).ionosphere is None


def test_numbers_of_a_message_are_where_the_format_has_them(tmp_path):
    """Each number of the message by hand: a column shifted by one is another number everywhere."""
    rows = read(tmp_path, made.navigation_2(made.REMONDI))
    told = {
        "prn": 20, "toe_week": 1124, "toe": 93600.0, "semi_major_axis": 5153.79589081**2,
        "eccentricity": 0.00223578442819, "inclination": 0.961685061380, "node": 1.64046615454,
        "perigee": 2.06374037770, "mean_anomaly": 1.05827953357, "node_rate": -8.56928551657e-9,
        "inclination_rate": 3.42514267094e-10, "mean_motion_difference": 4.65376527657e-9, "cuc": 4.57651913166e-6,
        "cus": 1.77137553692e-6, "crc": 344.96875, "crs": 88.6875, "cic": 6.51925802231e-8, "cis": -8.56816768646e-8,
        "toc_week": 1124, "toc": 93600.0, "clock_bias": -8.57324339449e-5, "clock_drift": -2.72848410532e-12,
        "clock_drift_rate": 0.0, "group_delay": -6.51925802231e-9, "accuracy": 2.0, "health": 0.0, "issue": 20.0,
        "sent_week": 1124, "sent": 86580.0, "limit": 7200.0,
    }  # fmt: skip
    for name, value in told.items():
        assert rows.column(name)[0] == pytest.approx(value, rel=1e-15), name
    assert rows.column("place")[0] == pytest.approx(200000.0 + 1124.0 + 93600.0 / 604800.0, abs=1e-9)


def test_rows_are_in_order_and_the_later_of_two_messages_stays(tmp_path):
    """Also of satellites whose lines come in any order: the places increase, as tables of FMUs want."""
    again = made.GLAB.replace("0.172770000000D+06", "0.172790000000D+06").replace("0.396233", "0.396234")
    other = made.GLAB.replace("20 16", " 3 16")
    for messages in ((made.GLAB, again, other), (again, other, made.GLAB)):
        found = read(tmp_path, made.navigation_2(*messages))
        assert found.column("prn").tolist() == [3, 20]
        assert np.all(np.diff(found.column("place")) > 0.0)
        assert found.column("clock_bias")[1] == pytest.approx(0.396234052015e-3)
        assert any("1 orbit(s)" in sentence for sentence in found.sentences())


def test_a_message_that_is_sent_again_was_known_before(tmp_path):
    """Taken from the last time on, a receiver would have had no orbit until then."""
    again = made.GLAB.replace("0.172770000000D+06", "0.172790000000D+06")
    for messages in ((made.GLAB, again), (again, made.GLAB, again)):
        found = read(tmp_path, made.navigation_2(*messages))
        assert found.column("sent").tolist() == [172770.0]
        assert f"{len(messages) - 1} orbit(s) are left out: they were sent before" in found.sentences()


def test_a_table_goes_through_a_file_of_numbers(tmp_path):
    found = read(tmp_path, made.navigation_2(made.REMONDI, made.GLAB))
    back = unpacked(packed(found.table()), "file", as_written=True)
    assert list(back) == list(found.table())
    assert np.array_equal(np.stack(list(back.values()), -1), found.rows)


def test_times_of_transmission_belong_to_the_week_of_the_orbit(tmp_path):
    """Sent on Saturday for Sunday: seconds before the week, of the week before, unknown, not there, of long ago."""
    sunday = made.GLAB.replace("16  3  1", "16  2 28").replace("0.172800000000D+06", "0.000000000000D+00")
    for sent, week, second in (
        ("-0.30000000000D+02", 1885, 604770.0),
        ("0.604770000000D+06", 1885, 604770.0),
        ("0.999900000000D+09", 1885, 597600.0),
        (" " * 18, 1885, 597600.0),
        ("0.300000000000D+06", 1885, 597600.0),
    ):
        found = read(tmp_path, made.navigation_2(sunday.replace("0.172770000000D+06", sent)))
        assert (found.column("sent_week")[0], found.column("sent")[0]) == (week, second), sent
        assert found.column("toe_week")[0] == 1886


def test_weeks_modulo_1024_are_told_by_the_date(tmp_path):
    found = read(tmp_path, glab("0.188600000000D+04", "0.862000000000D+03"))
    assert found.column("toe_week")[0] == 1886
    assert any("modulo 1024" in sentence for sentence in found.sentences())


def test_both_almanacs_of_one_sky_are_the_same(tmp_path):
    """Semicircles and radians, the inclination from 54 degrees, one week of 19 years: two formats agree."""
    of_yuma, of_sem = read(tmp_path, made.yuma(1, 2, 30), NEAR), read(tmp_path, made.sem(1, 2, 30), NEAR)
    np.testing.assert_allclose(of_yuma.rows, of_sem.rows, rtol=1e-12, atol=1e-14)
    assert of_yuma.column("toe_week").tolist() == [1401] * 3
    assert of_yuma.column("limit")[0] == 26 * 604800.0
    assert of_yuma.ionosphere is None
    assert any("not in the file: 3, 4, 5," in sentence for sentence in of_yuma.sentences())


@pytest.mark.parametrize("almanac", [made.yuma, made.sem])
def test_a_week_of_an_almanac_wants_a_date(tmp_path, almanac):
    """Without one there are three; the wrong rollover is never taken; a full week needs none."""
    told = refusal(tmp_path, almanac(1, 2))
    assert "377 (1987-03-29), 1401 (2006-11-12), 2425 (2026-06-28)" in told
    assert "line" in told
    assert "250 weeks from 2011-09-01" in refusal(tmp_path, almanac(1, 2), date(2011, 9, 1))
    assert read(tmp_path, almanac(1, 2), date(2026, 7, 1)).column("toe_week")[0] == 2425
    assert read(tmp_path, almanac(1, 2, week=1401)).column("toe_week")[0] == 1401
    assert "weeks from 2020-01-01" in refusal(tmp_path, almanac(1, 2, week=1401), date(2020, 1, 1))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (made.navigation_2(made.GLAB)[:-90], ["ends after 12 lines", "line 8 of the 8 of satellite 20"]),
        (made.navigation_2(made.GLAB, made.REMONDI)[:-200], ["line 19", "toe_week of satellite 20 is missing"]),
        (made.navigation_2(made.GLAB)[:300], ["END OF HEADER", "cut off"]),
        (made.navigation_2(), ["no satellite of GPS"]),
        (made.navigation_3(made.GLONASS), ["no satellite of GPS"]),
        (glab("0.483385741245D-02", "0.483385741245X-02"), ["line 8", "X-02'"]),
        (glab("0.483385741245D-02", "0.483385741245D+00"), ["0 to 0.1"]),
        (glab("0.515369705963D+04", "0.265605933824D+08"), ["sqrt_a", "5000"]),
        (glab("0.515369705963D+04", "               nan"), ["'nan'", "a number"]),
        (glab("0.515369705963D+04", "0.5153697059D+9999"), ["a computer has"]),
        (glab("0.172800000000D+06", "0.172800000000D+07"), ["line 9", "1728000"]),
        (glab("0.172800000000D+06", "0.432000000000D+06"), ["t_oe", "72.0 h"]),
        (glab("0.188600000000D+04", "0.188500000000D+04"), ["satellite 20 is 1885"]),
        (glab("16  3  1  0  0  0.0", "16  2 29 23 59 42.0"), ["16 s", "UTC"]),
        (glab("16  3  1", "16 13  1"), ["line 6", "2016-13-1 is no date"]),
        (glab("20 16  3  1", "20 1E99 3 1"), ["line 6", "the year is 1E99; expected a whole number"]),
        (glab("16  3  1  0  0", "16  3  1 25  0"), ["25:0:0 is no time"]),
        (glab("20 16", "99 16"), ["prn is 99"]),
        (made.navigation_3("#" + made.GLAB), ["line 5", "expected a satellite"]),
        (made.navigation_2(made.GLAB).replace("2.10", "5.00"), ["version 5", "2, 3 or 4"]),
        (made.navigation_4(made.GLAB).replace("> EPH G20 LNAV\n", ""),
         ["line 7: begins with 'G20", "'> EPH G05 LNAV'"]),
        (made.OBSERVED_3, ["type 'OBSERVATION DATA'"]),
        ("", ["begins like no file of orbits"]),
        ("a,b\n1,2\n", ["begins like no file of orbits", "YUMA"]),
        (made.yuma(1, 2)[:-100], ["line 17", "no 'af1'", "cut off"]),
        (made.yuma(1, 1), ["satellite 1 comes again"]),
        (made.yuma(1, week=12345), ["the week is 12345", "0 to 9999"]),
        (made.yuma(1, week=-3), ["the week is -3"]),
        (made.yuma(1).replace("Af0(s)", "Afo(s)"), ["line 12", "'Afo(s)", "expected one of"]),
        (made.yuma(1).replace("0.9600000000", "55.0000000"), ["inclination is 55"]),
        (made.yuma(1).replace("319488.0000", "719488.0000"), ["toe is 719488"]),
        (made.yuma(1).replace("ID:                         01", "ID:                         00"), ["prn is 0"]),
        (made.sem(1, 2)[:-4], ["15 lines for 2 satellites", "expected 16"]),
        (made.sem(1, 2).replace("2  CURRENT", "3  CURRENT"), ["16 lines for 3 satellites", "expected 24"]),
        (made.sem(1).replace(" 5.57749073643905E-0003", ""), ["has 2 number(s)", "inclination"]),
        (made.sem(1).replace("0.51536000000000E+0004", "0.51536000000000F+0004"), ["sqrt_a", "expected a number"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(tmp_path, text, words):
    """Never a plausible wrong number: file, line, what, and what was expected."""
    told = refusal(tmp_path, text, NEAR)
    for word in words:
        assert word in told, told
    assert str(tmp_path) in told


@pytest.mark.parametrize("almanac", [made.yuma, made.sem])
def test_marks_of_editors_and_letters_of_other_languages_change_nothing(tmp_path, almanac):
    """UTF-8 with its mark, ends of lines of other systems; the second byte of an A with a ring is an end of line for
    ``str.splitlines``, so that the line of an error would be another one."""
    texts = [made.navigation_2(made.GLAB).replace("made", "A. \u00c5s"), almanac(1, 2)]
    for text in texts:
        rows = read(tmp_path, text, NEAR).rows
        for other in (text.encode("utf-8-sig"), text.replace("\n", "\r\n").encode(), text.replace("\n", "\r").encode()):
            file = tmp_path / "other"
            file.write_bytes(other)
            np.testing.assert_array_equal(read_orbits(file, NEAR).rows, rows)
    file.write_bytes(texts[0].replace("16  3  1", "16 13  1").encode())
    with pytest.raises(NavfmuError, match="line 6: 2016-13-1 is no date"):
        read_orbits(file)


def test_files_that_are_packed_wrongly(tmp_path):
    whole = made.written(tmp_path, "whole.gz", made.navigation_2(made.GLAB)).read_bytes()
    cut = tmp_path / "cut.gz"
    cut.write_bytes(whole[:-20])
    with pytest.raises(NavfmuError, match="cannot be unpacked"):
        read_orbits(cut)
    old = tmp_path / "old.Z"
    old.write_bytes(b"\x1f\x9d\x90abc")
    with pytest.raises(NavfmuError, match=r"cannot be unpacked|packed by compress .*, that is not installed"):
        read_orbits(old)
    with pytest.raises(NavfmuError, match="no such file"):
        read_orbits(tmp_path / "nothing")
    with pytest.raises(NavfmuError, match="is a folder"):
        read_orbits(tmp_path)
