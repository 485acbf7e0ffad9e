"""Files of observations: both versions against what was written, and the sentences of wrong ones."""

import sys

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.satellite.observations import read_observations
from tests.satellite import made


def read(folder, text, name="file"):
    return read_observations(made.written(folder, name, text))


def refusal(folder, text):
    with pytest.raises(NavfmuError) as caught:
        read(folder, text)
    return str(caught.value)


def test_versions_3_and_4(tmp_path):
    """Empty and 0 are not measured, an event is passed over, GLONASS is left out and told; plain and packed by gzip."""
    for name, version in (("o.rnx", "3.05"), ("o.rnx.gz", "4.01")):
        found = read(tmp_path, made.OBSERVED_3.replace("3.05", version), name)
        assert found.marker == "MADE" and len(found) == 2
        assert found.week.tolist() == [2111, 2111] and found.second.tolist() == [345600.0, 345660.0]
        np.testing.assert_array_equal(found.position_e, [3582105.2910, 532589.7313, 5232754.8054])
        assert list(found.values) == ["C1C", "D1C", "L1C", "S1C"]
        assert all(value.shape == (2, 32) for value in found.values.values())
        code, doppler = found.named("C1C"), found.named("D1C")
        assert code[0, 1] == 25847357.745 and code[0, 4] == 20947300.931 and code[1, 4] == 20959368.361
        assert np.count_nonzero(np.isfinite(code)) == 3
        assert doppler[0, 1] == -3123.088 and np.isnan(doppler[0, 4]) and doppler[1, 4] == -1077.284
        assert np.isnan(found.named("L1C")[0, 1]) and found.named("S1C")[0, 4] == 50.5
        assert any("systems R are left out" in sentence for sentence in found.sentences())


def test_version_2(tmp_path):
    """Thirteen satellites in two lines, six observations in two, a system that is not said, an event, names of
    version 3, a short line at the end."""
    found = read(tmp_path, made.OBSERVED_2)
    assert list(found.values) == ["C1C", "D1C", "L1C", "S1C", "S2W"]
    assert found.week.tolist() == [1315, 1315] and found.second.tolist() == [393036.0, 393066.0]
    seen = np.flatnonzero(np.isfinite(found.named("C1C")[0])) + 1
    assert seen.tolist() == [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12]
    for prn in seen:
        assert found.named("C1C")[0, prn - 1] == 20000000.0 + prn
        assert found.named("L1C")[0, prn - 1] == 1e8 + prn
        assert found.named("D1C")[0, prn - 1] == -100.0 - prn
        assert found.named("S1C")[0, prn - 1] == pytest.approx(40.0 + prn / 10)
        assert found.named("S2W")[0, prn - 1] == 30.0
    assert found.named("C1C")[1, 11] == 20000112.0 and found.named("S2W")[1, 11] == 31.0
    assert np.count_nonzero(np.isfinite(found.named("C1C")[1])) == 1


def test_cycle_slips_of_version_2_are_no_observations(tmp_path):
    slips = made.OBSERVED_2.replace(" 05  3 24 13 11  6.0000000  0  1 12", " 05  3 24 13 11  6.0000000  6  1 12")
    assert len(read(tmp_path, slips)) == 1


def test_a_name_that_is_not_there(tmp_path):
    with pytest.raises(NavfmuError, match="has no 'C1W'; there are C1C, D1C, L1C, S1C; did you mean 'C1C'"):
        read(tmp_path, made.OBSERVED_3).named("C1W")


def test_epochs_of_utc_are_told(tmp_path):
    """Every 30 s at 12 s and 42 s, 18 s too early: as if in UTC; 18 s too late: leap seconds added to GPS time; at full
    half minutes nothing is told."""

    def sentences(*seconds):
        head, _, _ = made.OBSERVED_3.partition("> ")
        rows = "G02  25847357.745\n"
        epochs = [f"> 2020 06 25 00 {s // 60:02d} {s % 60:02d}.0000000  0  1\n{rows}" for s in seconds]
        return " ".join(read(tmp_path, head + "".join(epochs)).sentences())

    assert "as if they were counted in UTC, which is 18 s behind" in sentences(12, 42, 72, 102)
    assert "epochs are 18 s beyond multiples of 30 s, as if they were 18 s ahead of GPS time" in sentences(18, 48, 78)
    assert "as if" not in sentences(0, 30, 60, 90)
    assert "as if" not in sentences(5, 35, 65, 95)
    told = sentences(0, 30, 120, 150)
    assert "1 gap(s); the longest lasts 90 s from 2020-06-25 00:00:30 GPS" in told and "every 30 s" in told


def changed(old, new, text=made.OBSERVED_3):
    assert old in text
    return text.replace(old, new)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (made.OBSERVED_3[:-20], ["line 15", "D1C is '-1077.' in 14 columns", "three digits"]),
        (made.OBSERVED_3[: made.OBSERVED_3.rindex("G05")], ["after 14 lines", "of the epoch of line 14"]),
        (changed("  0  3\n", "  0  4\n"), ["line 12", "'> 20'", "of the epoch of line 8"]),
        (changed("  0  3\n", "  0  2\n"), ["line 11", "begins with 'R07 '", "an epoch"]),
        (changed("     GPS  ", "     UTC  "), ["line 6", "system UTC", "18 s behind"]),
        (changed("     GPS  ", "     GLO  "), ["system GLO", "expected GPS"]),
        (changed("     0     0    0.0000000     GPS  ", "                              GLO  "), ["hour is missing"]),
        (changed("    0.0000000     GPS  ", "                  GLO  "), ["the second is missing"]),
        (changed("00 01 00.0", "00 00 00.0"), ["line 14", "not after that of line 8"]),
        (changed("00 01 00.0", "00 61 00.0"), ["line 14", "0:61:0 is no time"]),
        (changed("2020 06 25 00 01", "2020 06 31 00 01"), ["2020-6-31 is no date"]),
        (changed("2020 06 25 00 01 00.0000000", "                           "), ["line 14", "year, month, day"]),
        (changed("G05  20959368.361", "G05  2095936x.361"), ["line 15", "C1C is '2095936x.361'"]),
        (changed("G05  20959368.361", "G05   20959368.36"), ["line 15", "14 columns"]),
        (changed("G05  20959368.361", "G05  20959368,361"), ["line 15", "14 columns"]),
        (changed("G05  20947300.931", "G02  20947300.931"), ["satellite 2 comes twice"]),
        (changed("G05  20947300.931", "G45  20947300.931"), ["no satellite 45"]),
        (changed("G    4 C1C", "G    5 C1C"), ["line 4", "5 types", "there are 4"]),
        (changed("G    4 C1C", "E    4 C1C"), ["no types of observations of GPS"]),
        (changed("  0  1\n", "  9  1\n"), ["flag 9"]),
        (changed("  0  1\n", "  0  x\n"), ["line 14", "number of satellites is 'x'"]),
        (changed("3.05", "5.01"), ["version 5.01"]),
        (changed("END OF HEADER", "END OF HEADED"), ["no line 'END OF HEADER'"]),
        (changed("SOMETHING HAPPENED  ", "G    3 C1C L1C D1C  ").replace(
            f"{'':40}COMMENT", f"{'':40}SYS / # / OBS TYPES"), ["line 13", "change within the file"]),
        (changed(made.line("MADE", "MARKER NAME"), made.line("G  100  1 C1C", "SYS / SCALE FACTOR")), ["scaled"]),
        (made.navigation_3(made.GLAB), ["type 'N: GNSS NAV DATA'"]),
        ("time,range\n0,1\n", ["line 1", "RINEX VERSION / TYPE"]),
        ("", ["ends after 0 lines"]),
        (changed("G12G09G06R21", "G12G09G06R2", made.OBSERVED_2), ["line 6", "one is '22G'"]),
        (made.OBSERVED_2[:-30], ["ends after", "satellites of the epoch"]),
        (changed("     6    C1", "     7    C1", made.OBSERVED_2), ["7 types", "there are 6"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(tmp_path, text, words):
    told = refusal(tmp_path, text)
    for word in words:
        assert word in told, told
    assert str(tmp_path) in told


def test_what_is_packed_by_hatanakas_method_is_the_same(tmp_path):
    """By Hatanaka's own program, of both of its formats, and packed once more."""
    hatanaka = pytest.importorskip("hatanaka")
    for text, name in ((made.OBSERVED_2, "o.05d"), (made.OBSERVED_3, "o.crx"), (made.OBSERVED_3, "o.crx.gz")):
        plain = read(tmp_path, text, "plain")
        packed = read(tmp_path, hatanaka.rnx2crx(text), name)
        assert packed.remarks == plain.remarks and list(packed.values) == list(plain.values)
        for values, others in zip(packed.values.values(), plain.values.values(), strict=True):
            np.testing.assert_array_equal(values, others)
        np.testing.assert_array_equal(packed.second, plain.second)
    cut = hatanaka.rnx2crx(made.OBSERVED_3)[:-60]
    with pytest.raises(NavfmuError, match=r"cut\.crx: cannot be unpacked: .*; expected a RINEX observation"):
        read(tmp_path, cut, "cut.crx")


def test_without_the_package_that_unpacks_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "hatanaka", None)
    text = made.line("1.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE") + made.OBSERVED_3
    told = refusal(tmp_path, text)
    assert "Hatanaka's method" in told and "pip install 'navfmu[rinex]'" in told
