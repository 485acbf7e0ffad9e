"""The folder of a test: legible, and different for different tests."""

import pytest

from navfmu.testing.logbook import path_of


@pytest.mark.parametrize(
    ("test", "path"),
    [
        ("test_gps.py::test_lost", "test_gps.py/test_lost"),
        ("tests/deep/test_gps.py::test_lost[seed7]", "tests/deep/test_gps.py/test_lost-seed7"),
        ("test_gps.py::TestLost::test_soon[a]", "test_gps.py/TestLost/test_soon-a"),
        ("test_gps.py::test_lost[seed7-jacobi-0.01]", "test_gps.py/test_lost-seed7-jacobi-0.01"),
    ],
)
def test_plain_names_are_as_they_are(test, path):
    assert path_of(test).as_posix() == path


def test_other_names_can_be_written_everywhere_and_do_not_meet():
    names = [
        "a b",
        "a-b",
        "a/b",
        "a:b",
        "a\\b",
        "a*b",
        "a?b",
        "ä",
        "a" * 300,
        "a" * 299,
        "..",
        "a[b",
        "a]b",
        "",
        "a::b",
    ]
    paths = [path_of(f"test_x.py::test_y[{name}]").as_posix() for name in names]
    assert len(set(paths)) == len(names)
    for path in paths:
        file, name = path.split("/")
        assert file == "test_x.py" and len(name) < 100 and not set(name) & set('<>:"|?*\\ ') and name.isascii()


def test_no_name_leads_out_of_the_folder():
    assert ".." not in path_of("../../test_x.py::test_y").parts
