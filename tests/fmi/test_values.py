"""Values for variables: types, units, ranges, one for each element."""

from dataclasses import replace

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.fmi import values
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import Unit

ABOUT = Description(
    "imu",
    "{1}",
    "imu",
    (
        Variable("range", 0, "Real", "parameter", "fixed", "exact", 1.0, unit="m", min=0.0, max=1e6),
        Variable("factor", 1, "Real", "parameter", "fixed", "exact", 1.0, unit="1"),
        Variable("bias[1]", 2, "Real", "parameter", "fixed", "exact", 0.0),
        Variable("bias[2]", 3, "Real", "parameter", "fixed", "exact", 0.0),
        Variable("mode", 4, "Integer", "parameter", "fixed", "exact", 1, min=0, max=3, enumeration=True),
        Variable("on", 5, "Boolean", "input", "discrete", None, False),
        Variable("label", 6, "String", "parameter", "fixed", "exact", ""),
        Variable("y", 7, "Real", "output"),
        Variable("state", 8, "Real", "local", "continuous", "exact", 0.0),
        Variable("g", 9, "Real", "parameter", "constant", "exact", 9.81),
    ),
    units={"m": Unit("m", (0, 1, 0, 0, 0, 0, 0, 0))},
)


def given(**start):
    return values.expand(ABOUT, start, "here")


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("range", 3, 3.0),
        ("range", "0.5 nmi", 926.0),
        ("range", np.float32(0.5), 0.5),
        ("mode", np.int64(2), 2),
        ("mode", 2.0, 2),
        ("on", "yes", True),
        ("on", np.bool_(True), True),
        ("on", 0, False),
        ("label", "a b", "a b"),
        ("label", "[a]", "[a]"),  # was "a"
        ("label", ["[a]"], "[a]"),
        ("label", "[1, 2]", "[1, 2]"),  # was refused as two values
        ("state", 2, 2.0),
    ],
)
def test_a_value_gets_the_type_and_unit_of_its_variable(name, value, expected):
    (found,) = given(**{name: value}).values()
    assert found == expected and type(found) is type(expected)


@pytest.mark.parametrize("value", [[1, 2], (1.0, 2.0), np.array([1, 2]), "[1, 2]"])
def test_an_array_gets_a_value_for_each_element(value):
    assert given(bias=value) == {"bias[1]": 1.0, "bias[2]": 2.0}
    assert given(bias=0.5) == {"bias[1]": 0.5, "bias[2]": 0.5}


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("range", -1, "here: 'range' = -1 m is out of range: expected 0 to 1000000 m"),
        ("range", "-1 nmi", "'range' = -1852 m is out of range"),
        ("range", float("inf"), "'range' = inf m is out of range: expected a finite number"),
        ("range", True, "'range' = True: expected a number, for example '1.5 m'"),
        ("factor", "x", "'factor' = x: expected a number$"),
        ("range", None, "'range' = None: expected a number"),
        ("mode", 4, "'mode' = 4 is out of range: expected 0 to 3"),
        ("mode", 1.5, "'mode' = 1.5: expected an integer from -2147483648 to 2147483647"),
        ("on", 2, "'on' = 2: expected true or false"),
        ("label", 3, "'label' = 3: expected a text"),
        ("bias", [1, 2, 3], "'bias': 3 values given, expected 2"),
        ("y", 1, "'y' cannot be set: it is output, continuous"),
        ("g", 1, "'g' cannot be set: it is parameter, constant"),
        ("bia", 1, r"imu has no parameter 'bia'; did you mean 'bias'\?"),
    ],
)
def test_what_does_not_fit_is_told_in_a_sentence(name, value, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        given(**{name: value})


def test_an_item_is_found_by_its_very_name():
    """Of items of others one may begin with a blank; the same without it is another one."""
    mode = Variable("mode", 0, "Integer", "parameter", "fixed", "exact", 1, min=1, max=3, enumeration="Mode")
    about = replace(ABOUT, variables=(mode,), enumerations={"Mode": {"on": 1, " on": 2, " off": 3}})
    for text, number in (("on", 1), (" on", 2), ("on ", 1), (" off", 3), ("3", 3)):
        assert values.expand(about, {"mode": text}, "here") == {"mode": number}
