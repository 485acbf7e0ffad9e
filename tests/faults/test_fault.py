"""A fault made in Python: times with units, several targets, and its parameters by keyword."""

import json
import math

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.faults import Fault, parse_fault
from navfmu.fmi.seconds import seconds


def test_parameters_may_be_keywords():
    by_keyword = Fault("x", "a.y", "noise", start=1.0, sigma=2.0, period=0.1, stream=5)
    assert by_keyword == Fault("x", "a.y", "noise", 1.0, parameters={"sigma": 2.0, "period": 0.1, "stream": 5})
    assert Fault("x", "a.y", "bias", 0.0, 2.0, {"value": 1}) == Fault("x", "a.y", "bias", duration=2.0, value=1)


def test_parameters_that_were_given_are_not_changed():
    given = {"sigma": 1.0, "period": "100 ms"}
    assert Fault("x", "a.y", "noise", parameters=given).parameters["period"] == 0.1
    assert given == {"sigma": 1.0, "period": "100 ms"}


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"valeu": 1}, r"fault 'x': type 'bias' has no parameter 'valeu'; did you mean 'value'\? \(it takes value\)"),
        ({"value": 1, "strat": 3}, r"has no parameter 'strat'; did you mean 'start'\?"),
        ({"value": 1, "parameters": {"value": 2}}, "'value' is given twice"),
        ({"value": 1, "start": "5 mni"}, r"'start' is '5 mni': 'mni' is no unit of time; did you mean 'min'\?"),
        ({"value": 1, "start": "5 m"}, "'m' is no unit of time"),
        ({"value": 1, "start": "-5 min"}, "'start' must be a time in s, 0 or later, not '-5 min'"),
        ({"value": 1, "start": True}, "'start' is True, expected a time"),
        ({"value": 1, "start": math.inf}, "'start' must be a time in s, 0 or later, not inf"),
        ({"value": 1, "duration": "0 h"}, "'duration' must be a positive time in s, not '0 h'"),
        ({"value": 1, "target": []}, "'target' is an empty list"),
        ({"value": 1, "target": ["a.y", "b"]}, r"'target' must be written component\.signal, not 'b'"),
        ({"value": 1, "target": ["a.y", "b.y", "a.y"]}, r"'target' has 'a\.y' twice"),
        ({"value": 1, "target": 3}, r"'target' must be written component\.signal, not 3"),
    ],
)
def test_what_cannot_be_is_a_sentence(given, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        Fault(**{"id": "x", "target": "a.y", "type": "bias"} | given)


def test_times_may_be_texts_and_are_kept_in_seconds():
    fault = Fault("x", "a.y", "bias", "5 min", "0.5 h", value=1)
    assert (fault.start, fault.duration) == (300.0, 1800.0)
    assert Fault("x", "a.y", "noise", sigma=1, period="250 ms").parameters["period"] == 0.25


@pytest.mark.parametrize(
    ("text", "value"),
    [("1.15 min", 69.0), ("0.7min", 42.0), (" 1e2 ms ", 0.1), ("300", 300.0), (3, 3), (np.int64(3), 3)],
)
def test_a_decimal_time_is_the_double_nearest_to_it(text, value):
    assert seconds(text, "t") == value


def test_one_target_in_a_list_is_that_target():
    assert Fault("x", ["a.y"], "bias", value=1) == Fault("x", "a.y", "bias", value=1)
    assert Fault("x", "a.y", "bias", value=1).targets == ("a.y",)
    assert Fault("x", ["a.y", "b.y"], "bias", value=1).targets == ("a.y", "b.y")


def test_a_fault_survives_being_written_down():
    fault = Fault("x", ["a.y", "b.y"], "bias", "5 min", 3.0, value=["1 km", 2.0], fmea="F1")
    assert Fault.of(json.loads(json.dumps(fault.describe()))) == fault
    assert parse_fault(fault.inline()).describe() == fault.describe()
