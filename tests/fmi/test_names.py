"""What a name stands for."""

import pytest

from navfmu.errors import NavfmuError
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable


def variables(*rows: str) -> tuple[Variable, ...]:
    return tuple(Variable(name, i, kind, causality) for i, (causality, kind, name) in enumerate(map(str.split, rows)))


IMU = Description(
    "imu",
    "{1}",
    "imu",
    variables(
        "input Real rate[1]",
        "input Real rate[2]",
        "parameter Real sigma",
        "parameter Real sigma_x",
        "output Real reading.rate[1]",
        "output Real reading.rate[2]",
        "output Boolean reading.valid",
        "output Integer reading.sequence",
        "output String reading.text",
        "output Real temperature",
        "output String name",
        "output Boolean lamp.valid",
    ),
)
SYSTEM = {"imu": IMU, "spare": IMU}


def meant(name: str) -> list[str]:
    return [str(signal) for signal in names.signals(SYSTEM, name, f"signal '{name}'")]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("imu.temperature", ["imu.temperature"]),
        ("imu.rate", ["imu.rate[1]", "imu.rate[2]"]),  # an input may be recorded too
        ("imu.reading.rate", ["imu.reading.rate[1]", "imu.reading.rate[2]"]),
        ("imu.reading.rate[2]", ["imu.reading.rate[2]"]),
        ("imu.reading", [f"imu.reading.{n}" for n in ("rate[1]", "rate[2]", "valid", "sequence")]),  # no text
        ("*.temperature", ["imu.temperature", "spare.temperature"]),
        ("imu.*rate[1]", ["imu.reading.rate[1]"]),  # outputs only; brackets mean themselves
        ("imu.sigma", ["imu.sigma"]),  # and not sigma_x
    ],
)
def test_what_a_name_stands_for_in_a_system(name, expected):
    assert meant(name) == expected


def test_a_component_stands_for_its_outputs():
    assert meant("imu") == meant("imu.*")
    assert len(meant("imu")) == 6


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("im.rate", r"signal 'im\.rate': there is no component 'im'; did you mean 'imu'\?"),
        ("gps", "there is no component 'gps'"),
        ("imu.", "component 'imu' has no variable ''"),
        ("imu.reading.rat", "has no variable 'reading.rat'; did you mean"),
        ("imu.read", "has no variable 'read'"),
        ("imu.name", "a String cannot be recorded"),
        ("gps.*", "no output matches the pattern"),
        ("imu.sigma*", "no output matches the pattern"),
    ],
)
def test_names_of_nothing(name, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        meant(name)


def test_elements_are_not_members():
    assert [v.name for v in names.elements(IMU, "rate")] == ["rate[1]", "rate[2]"]
    assert names.elements(IMU, "reading") == []
    assert [v.name for v in names.elements(IMU, "sigma")] == ["sigma"]


def test_members_by_suffix():
    assert list(names.members(IMU, "reading", {"output"}, "x"))[:2] == [".rate[1]", ".rate[2]"]
    assert list(names.members(IMU, "rate", {"input"}, "x")) == ["[1]", "[2]"]
    with pytest.raises(NavfmuError, match="x: 'rate' of imu is input, expected output"):
        names.members(IMU, "rate", {"output"}, "x")
    with pytest.raises(NavfmuError, match=r"x: imu has no variable 'readin'; did you mean 'reading'\?"):
        names.members(IMU, "readin", {"output"}, "x")


def test_a_bundle_has_valid_and_sequence():
    assert names.bundles(IMU) == ["reading"]


def test_parts_of_names():
    assert names.split("imu.reading.rate[1]") == ("imu", "reading.rate[1]")
    assert names.array("reading.rate[1]") == "reading.rate"
    assert (names.bundle("reading.rate[1]"), names.bundle("rate[1]")) == ("reading", "")
    assert names.short(["reading.rate[1]"]) == ["reading.rate[1]", "reading.rate", "reading"]
    assert names.short(["a.b.c"]) == ["a.b.c", "a.b", "a"]


def test_arrays_of_bundles_are_no_arrays_of_numbers():
    """Whoever takes everything from the first bracket on for indices would make one array of all their members."""
    assert [names.array(n) for n in ("s[2].range", "s[2].bias[1,3]", "'a[1]'")] == ["s[2].range", "s[2].bias", "'a[1]'"]
    assert [names.subscript(n) for n in ("s[2].range", "s[2].bias[1, 3]")] == [(), (1, 3)]
    assert [names.is_element(suffix) for suffix in ("", "[1]", "[1,2,3]", "[1].valid", ".valid")] == [1, 1, 1, 0, 0]


def test_names_are_folded_for_people():
    found = [f"{name}[{i}]{rest}" for i in (1, 2, 3) for name, rest in (("s", ".valid"), ("s", ".bias[1]"), ("x", ""))]
    assert names.folded(found) == ["s[1…3].valid", "s[1…3].bias", "x"]
    matrix = [f"m[{i},{j}].a" for i in (1, 2) for j in (1, 2, 3)]
    assert names.folded([*matrix, "s[2].b", "y"]) == ["m[1,1…2,3].a", "s[2].b", "y"]


def test_names_between_which_some_are_not_there_are_not_folded_to_one():
    """Whatever their order. Catches 1…4 for a system that connects 1, 2 and 4, and 2…1."""
    assert names.folded([f"s[{i}].valid" for i in (4, 2, 1)]) == ["s[1…2].valid", "s[4].valid"]
    assert names.folded(["s[2].a", "s[1].a"]) == ["s[1…2].a"]
    assert names.folded([f"m[{i},{j}].a" for i, j in ((1, 1), (2, 1), (2, 2))]) == ["m[1,1].a", "m[2,1…2,2].a"]
    assert names.folded(["s[1].a", "s[1,2].a"]) == ["s[1].a", "s[1,2].a"]


def test_indices_that_there_are_not_get_a_range_and_other_names_the_nearest():
    known = [f"s[{i}].range" for i in range(1, 13)] + ["m[1,1]", "m[2,3]", "tau"]
    assert names.hint("s[0].range", known) == "; indices go from 's[1].range' to 's[12].range'"
    assert names.hint("m[3]", known) == "; indices go from 'm[1,1]' to 'm[2,3]'"
    assert names.hint("tau[1]", known) == "; did you mean 'tau'?"
    assert names.hint("tua", known) == "; did you mean 'tau'?"


def test_a_member_of_all_bundles_of_an_array_is_an_array():
    known = [f"s[{i}].{member}" for i in (1, 2) for member in ("range", "bias[1]", "bias[2]", "valid")]
    assert names.group(known, "s.range") == {"[1]": "s[1].range", "[2]": "s[2].range"}
    assert list(names.group(known, "s.bias")) == ["[1][1]", "[1][2]", "[2][1]", "[2][2]"]
    assert names.group(known, "s[2].bias") == {"[1]": "s[2].bias[1]", "[2]": "s[2].bias[2]"}
    assert names.group(known, "s.rang") == names.group(known, "s.bia") == names.group(known, "t.range") == {}
    assert names.group([*known, "s.range"], "s.range") == {"": "s.range"}
    assert names.group(["g[1,2].c[3].x[4]"], "g.c.x") == {"[1,2][3][4]": "g[1,2].c[3].x[4]"}
    assert [names.stands_for("c.s.range", signal) for signal in ("c.s[1].range", "c.s[1].ranges", "d.s[1].range")] == [
        1,
        0,
        0,
    ]
