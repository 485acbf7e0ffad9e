"""Expressions that are wrong, in a campaign, through the command line: where, what, and what was expected."""

from __future__ import annotations

import pytest

from tests.cli.test_bad_input import navfmu, refused
from tests.components import systems

HEAD = """system = "{system}"
[[case]]
name = "stuck"
faults = "stuck"
[[requirement]]
id = "R"
"""


def asks(text, *more):
    """A requirement of an expression."""
    return "\n".join([f"signal = '''{text}'''", *more])


def bound(text, *more):
    """One that needs a bound."""
    return asks(text, 'at_most = "8 m"', *more)


#: By name: what the requirement asks, and what is said behind the name of the file.
WRONG = {
    "empty": (bound(""), "line 7: 'signal' is '', expected a text that is not empty"),
    "blank": (bound("  "), "line 7: variant 'main': in ' ', character 1: it ends, expected a value"),
    "an unknown component": (
        bound("lga.y - 1 m"),
        "line 7: variant 'main': in 'lga.y - 1 m', character 1: there is no component 'lga'; did you mean 'lag.y'?",
    ),
    "an unknown variable": (
        bound("lag.yy - 1 m"),
        "line 7: variant 'main': in 'lag.yy - 1 m', character 1: component 'lag' has no variable 'yy'; did you",
    ),
    "a bare name": (
        bound("lag - 1 m"),
        "line 7: variant 'main': in 'lag - 1 m', character 1: 'lag' is a component, expected one of its signals,",
    ),
    "a name alone": (bound("y"), "line 7: variant 'main': in 'y', character 1: there is no signal 'y'"),
    "a bundle": (
        bound("sensor.reading - 1 m"),
        "line 7: variant 'main': in 'sensor.reading - 1 m', character 1: 'sensor.reading' is a bundle, expected",
    ),
    "an unknown ending": (
        bound("lag.y@ture - 1 m"),
        "line 7: variant 'main': in 'lag.y@ture - 1 m', character 6: '@' has no meaning",
    ),
    "a sign too much": (
        bound("lag.y + * 2"),
        "line 7: variant 'main': in 'lag.y + * 2', character 9: there is '*', expected a value",
    ),
    "a sign at the end": (
        bound("lag.y -"),
        "line 7: variant 'main': in 'lag.y -', character 8: it ends, expected a value",
    ),
    "a sign of another language": (
        bound("lag.y && truth.y"),
        "line 7: variant 'main': in 'lag.y && truth.y', character 7: '&' has no meaning",
    ),
    "an assignment": (bound("lag.y = 3"), "line 7: variant 'main': in 'lag.y = 3', character 7: '=' has no meaning"),
    "a power": (
        bound("lag.y ** 2"),
        "line 7: variant 'main': in 'lag.y ** 2', character 8: there is '*', expected a value",
    ),
    "a remainder": (bound("lag.y % 2"), "line 7: variant 'main': in 'lag.y % 2', character 7: '%' has no meaning"),
    "an open bracket": (
        bound("(lag.y - 1 m"),
        "line 7: variant 'main': in '(lag.y - 1 m', character 13: it ends, expected ')'",
    ),
    "a closed bracket": (
        bound("lag.y - 1 m)"),
        "line 7: variant 'main': in 'lag.y - 1 m)', character 12: there is ')', expected the end",
    ),
    "an open quote": (bound('"lag.y'), "line 7: variant 'main': in '\"lag.y', character 1: '\"' has no meaning"),
    "a comma": (
        bound("lag.y, truth.y"),
        "line 7: variant 'main': in 'lag.y, truth.y', character 6: there is ',', expected the end",
    ),
    "two values": (
        bound("lag.y truth.y"),
        "line 7: variant 'main': in 'lag.y truth.y', character 7: there is 'truth.y', expected a comparison, '+'",
    ),
    "two numbers": (
        bound("1 2"),
        "line 7: variant 'main': in '1 2', character 3: there is '2', expected a comparison, '+' or '-', '*' or",
    ),
    "an unknown function": (
        bound("abss(lag.y)"),
        "line 7: variant 'main': in 'abss(lag.y)', character 1: there is no function 'abss'; did you mean 'abs'?",
    ),
    "a function in capitals": (
        bound("ABS(lag.y)"),
        "line 7: variant 'main': in 'ABS(lag.y)', character 1: there is no function 'ABS' (functions: abs, active,",
    ),
    "a function of another language": (
        bound("sin(lag.y)"),
        "line 7: variant 'main': in 'sin(lag.y)', character 1: there is no function 'sin'; did you mean 'min'?",
    ),
    "a function without a value": (
        bound("abs()"),
        "line 7: variant 'main': in 'abs()', character 1: abs() takes one value, not 0",
    ),
    "a function of two": (
        bound("abs(lag.y, truth.y)"),
        "line 7: variant 'main': in 'abs(lag.y, truth.y)', character 1: abs() takes one value, not 2",
    ),
    "a root of two": (
        bound("sqrt(lag.y, truth.y)"),
        "line 7: variant 'main': in 'sqrt(lag.y, truth.y)', character 1: sqrt() takes one value, not 2",
    ),
    "a name that is called": (
        bound("lag.y(1)"),
        "line 7: variant 'main': in 'lag.y(1)', character 1: there is no function 'lag.y' (functions: abs, active,",
    ),
    "a minimum of nothing": (
        bound("min()"),
        "line 7: variant 'main': in 'min()', character 1: min() takes at least one value",
    ),
    "an unknown unit": (
        bound("lag.y - 1 mm2"),
        "line 7: variant 'main': in 'lag.y - 1 mm2', character 9: the unit 'mm2' is not known; did you mean 'mm'?",
    ),
    "a unit of another kind": (
        bound("lag.y - 1 s"),
        "line 7: variant 'main': in 'lag.y - 1 s', character 7: '-' joins m and s, expected one dimension",
    ),
    "a unit that is none": (
        bound("lag.y - 1 furlong"),
        "line 7: variant 'main': in 'lag.y - 1 furlong', character 9: the unit 'furlong' is not known",
    ),
    "a comparison of metres and seconds": (
        asks("lag.y > time"),
        "line 7: variant 'main': in 'lag.y > time', character 7: '>' joins m and s, expected one dimension",
    ),
    "a sum of metres and a truth value": (
        bound("lag.y + (truth.y > 1)"),
        "line 7: variant 'main': in 'lag.y + (truth.y > 1)', character 18: this is a truth value, expected a number",
    ),
    "a minimum of metres and seconds": (
        bound("min(lag.y, time)"),
        "line 7: variant 'main': in 'min(lag.y, time)', character 1: min() joins m and s, expected one dimension",
    ),
    "a norm of metres and seconds": (
        bound("norm(lag.y, time)"),
        "line 7: variant 'main': in 'norm(lag.y, time)', character 1: norm() joins m and s, expected one dimension",
    ),
    "a truth value where a number is": (
        bound("lag.y > 1 m"),
        "line 8: 'at_most' = 8 m: 'lag.y > 1 m' is a truth value",
    ),
    "a number where a truth value is": (asks("lag.y"), "line 6: this requirement has neither 'at_most' nor 'at_least'"),
    "not of a number": (
        asks("not lag.y"),
        "line 7: variant 'main': in 'not lag.y', character 5: this is a number, expected a truth value: compare",
    ),
    "and of numbers": (
        asks("lag.y and truth.y"),
        "line 7: variant 'main': in 'lag.y and truth.y', character 1: this is a number, expected a truth value:",
    ),
    "or of a number": (
        asks("lag.y > 1 m or truth.y"),
        "line 7: variant 'main': in 'lag.y > 1 m or truth.y', character 16: this is a number, expected a truth",
    ),
    "minus of a truth value": (
        bound("-(lag.y > 1 m)"),
        "line 7: variant 'main': in '-(lag.y > 1 m)', character 9: this is a truth value, expected a number",
    ),
    "abs of a truth value": (
        bound("abs(lag.y > 1 m)"),
        "line 7: variant 'main': in 'abs(lag.y > 1 m)', character 11: this is a truth value, expected a number",
    ),
    "a comparison of truth values with a number": (
        asks("(lag.y > 1 m) > 0"),
        "line 7: variant 'main': in '(lag.y > 1 m) > 0', character 8: this is a truth value, expected a number",
    ),
    "a bound in another unit": (
        asks("lag.y - truth.y", 'at_most = "8 s"'),
        "line 8: 'at_most' = 8 s: 'lag.y - truth.y' is in m",
    ),
    "a bound in words": (
        asks("lag.y - truth.y", 'at_most = "much"'),
        "line 8: in 'much', character 1: there is no signal 'much'",
    ),
    "a bound on an area": (
        asks("lag.y * truth.y", 'at_most = "8 m"'),
        "line 8: 'at_most' = 8 m: 'lag.y * truth.y' is in m2",
    ),
    "an unknown fault": (
        asks("active(G)"),
        "line 7: variant 'main': in 'active(G)', character 8: there is no fault 'G' (faults: F1)",
    ),
    "a misspelt fault": (
        asks("active(f1)"),
        "line 7: variant 'main': in 'active(f1)', character 8: there is no fault 'f1'; did you mean 'F1'? (faults:",
    ),
    "active of two": (
        asks("active(F1, F1)"),
        "line 7: variant 'main': in 'active(F1, F1)', character 1: active() takes the id of one fault, or nothing",
    ),
    "active of a number": (
        asks("active(1)"),
        "line 7: variant 'main': in 'active(1)', character 1: active() takes the id of one fault, or nothing",
    ),
    "a number with two points": (
        bound("lag.y - 1.2.3"),
        "line 7: variant 'main': in 'lag.y - 1.2.3', character 12: there is '.3', expected a comparison, '+' or",
    ),
    "a number that is too great": (
        bound("lag.y - 1e999 m"),
        "line 7: variant 'main': in 'lag.y - 1e999 m', character 9: this number is too large",
    ),
    "a number in words": (
        bound("lag.y - two"),
        "line 7: variant 'main': in 'lag.y - two', character 9: there is no signal 'two'",
    ),
    "NaN": (bound("lag.y - nan"), "line 7: variant 'main': in 'lag.y - nan', character 9: there is no signal 'nan'"),
    "a text": (bound("lag.y - 'x'"), "line 7: variant 'main': in 'lag.y - 'x'', character 9: there is no signal 'x'"),
    "a letter that is none": (
        bound("lag.y - 1 m;"),
        "line 7: variant 'main': in 'lag.y - 1 m;', character 12: ';' has no meaning",
    ),
    "another minus": (
        bound("lag.y \u2212 1 m"),
        "line 7: variant 'main': in 'lag.y − 1 m', character 7: '−' has no meaning",
    ),
    "a when that is a number": (
        bound("lag.y - 1 m", 'when = "lag.y"'),
        "line 9: variant 'main': in 'lag.y', character 1: expected a truth value, such as 'x < 1', but this is a",
    ),
    "a when of an unknown signal": (
        bound("lag.y - 1 m", 'when = "lag.z > 1 m"'),
        "line 9: variant 'main': in 'lag.z > 1 m', character 1: component 'lag' has no variable 'z' (it has: u,",
    ),
    "a when that does not end": (
        bound("lag.y - 1 m", 'when = "lag.y >"'),
        "line 9: variant 'main': in 'lag.y >', character 8: it ends, expected a value",
    ),
    "a when that is a list": (
        bound("lag.y - 1 m", 'when = ["lag.y > 1 m"]'),
        "line 9: 'when' is ['lag.y > 1 m'], expected a text",
    ),
    "events of a number": (
        'events = "lag.y"\nat_most = 1',
        "line 7: variant 'main': in 'lag.y', character 1: expected a truth value, such as 'x < 1', but this is a",
    ),
    "a broken number of events": (
        'events = "lag.y > 1 m"\nat_most = 1.5',
        "line 8: 'at_most' is 1.5, expected a number of events: 0, 1, 2 ...",
    ),
    "detects a number": (
        'detects = "lag.y"\nwithin = 1',
        "line 7: variant 'main': in 'lag.y', character 1: expected a truth value, such as 'x < 1', but this is a",
    ),
    "detects without a time": (
        'detects = "lag.y > 1 m"',
        "line 7: 'detects' needs 'within' beside it: how long it may take",
    ),
    "detects in metres": (
        'detects = "lag.y > 1 m"\nwithin = "1 m"',
        "line 8: 'within' is '1 m': 'm' is no unit of time; did you mean 'ms'? (s, ms, min, h)",
    ),
    "recovers of an unknown fault": (
        'recovers = "lag.y > 1 m"\nwithin = 1\nfault = "G"',
        "line 9: there is no fault 'G' (faults: F1)",
    ),
    "signal and events": (
        'signal = "lag.y > 1 m"\nevents = "lag.y > 1 m"\nat_most = 1',
        "line 8: expected one of 'signal', 'events', 'detects', 'recovers', and no more",
    ),
    "neither": ("at_most = 1", "line 6: expected one of 'signal', 'events', 'detects', 'recovers'"),
    "a tolerance in metres": (
        asks("lag.y > 1 m", 'tolerance = "1 m"'),
        "line 8: 'tolerance' is '1 m': 'm' is no unit of time; did you mean 'ms'? (s, ms, min, h)",
    ),
    "a negative tolerance": (
        asks("lag.y > 1 m", "tolerance = -1"),
        "line 8: 'tolerance' is -1.0, expected a time in s, 0 or more",
    ),
    "an expression that is a number": ("signal = 3\nat_most = 1", "line 7: 'signal' is 3, expected a text"),
    "an expression that is a list": (
        'signal = ["lag.y"]\nat_most = 1',
        "line 7: 'signal' is ['lag.y'], expected a text",
    ),
    "no bound on a number": (asks("lag.y - truth.y"), "line 6: this requirement has neither 'at_most' nor 'at_least'"),
    "too many brackets": (
        bound("(" * 3000 + "lag.y" + ")" * 3000),
        "character 2001: expected at most 2000 characters, not 6005",
    ),
}


def campaign(folder, entries):
    file = folder / "campaign.toml"
    file.write_text(HEAD.format(system=systems.tracker()) + entries + "\n", encoding="utf-8")
    return file


def test_the_requirement_of_which_the_others_are_changes_is_a_good_one(tmp_path):
    file = campaign(tmp_path, bound("abs(lag.y - 1 m) + max(lag.y, 2 ft) * 2", 'when = "not active(F1)"'))
    assert navfmu("campaign", file, "--out", tmp_path / "out", "--workers", "thread").exit_code in (0, 1)
    assert (tmp_path / "out" / "report.html").exists()


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_expression_is_answered_with_a_sentence(name, tmp_path):
    entries, sentence = WRONG[name]
    file = campaign(tmp_path, entries)
    result = navfmu("campaign", file, "--out", tmp_path / "out", "--workers", "thread")
    refused(result)
    said = " ".join(result.stderr.split())
    assert said.startswith(f"navfmu: {file}, line ") and said.count("navfmu: ") == 1
    assert sentence in said
    assert list(tmp_path.iterdir()) == [file]


def test_they_are_many_and_of_every_kind():
    assert len({entries for entries, _ in WRONG.values()}) == len(WRONG) > 70
