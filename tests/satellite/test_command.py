"""navfmu orbits: what is told and written, in a table that an FMU takes."""

import numpy as np
from click.testing import CliRunner

from navfmu.cli.main import main
from navfmu.files.numbers import unpacked
from navfmu.files.numbers_as_text import columns
from navfmu.satellite.orbits import COLUMNS
from tests.satellite import made


def run(*arguments):
    return CliRunner().invoke(main, ["orbits", *map(str, arguments)])


def test_two_days_go_into_one_table(tmp_path):
    """A file of each format has the same numbers; a message of both files is there once."""
    one = made.written(tmp_path, "one.01n", made.navigation_2(made.REMONDI, made.GLAB))
    two = made.written(tmp_path, "two.rnx.gz", made.navigation_3(made.GLAB.replace("20 16", " 7 16"), made.GLAB))
    binary = run(one, two, "--out", tmp_path / "orbits.npy")
    assert binary.exit_code == 0, binary.output
    assert "3 orbit(s) of 2 satellite(s)" in binary.output and "1 orbit(s) are left out" in binary.output
    assert "ionosphere, alpha: 1.1180e-08" in binary.output
    table = unpacked((tmp_path / "orbits.npy").read_bytes(), "orbits.npy", as_written=True)
    assert list(table) == [f"{name} ({unit})" for name, unit in COLUMNS]
    assert table["prn (1)"].tolist() == [7.0, 20.0, 20.0]
    assert run(one, two, "--out", tmp_path / "orbits.csv").exit_code == 0
    read = columns((tmp_path / "orbits.csv").read_text(), table, "orbits.csv")
    assert all(np.array_equal(read[name], table[name]) for name in table)


def test_what_is_wrong_is_a_sentence(tmp_path):
    almanac = made.written(tmp_path, "yuma.txt", made.yuma(1, 2))
    messages = made.written(tmp_path, "brdc.01n", made.navigation_2(made.GLAB))
    out = tmp_path / "orbits.csv"
    for arguments, words in (
        ((almanac, "--out", out), "expected a date near it"),
        ((almanac, "--near", "yesterday", "--out", out), "--near is 'yesterday'; expected a date as in 2006-11-15"),
        ((almanac, "--near", "2006-11-15", "--out", tmp_path / "orbits.txt"), "expected .csv or .npy"),
        ((tmp_path / "nothing", "--out", out), "no such file"),
        ((messages, "--near", "2016-03-01", "--out", out), "--near 2016-03-01 is for almanacs"),
    ):
        told = run(*arguments)
        assert told.exit_code == 2 and words in " ".join(told.output.split()), told.output
        assert not out.exists()
    assert run(almanac, "--near", "2006-11-15").exit_code == 0
