"""Mistakes in axes, designs and searches: a sentence with the line, whatever is written there."""

from __future__ import annotations

import random
import re

import pytest
from click.testing import CliRunner

from navfmu.campaign import load_campaign
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from tests.campaign.axes import HEAD, written

TEXT = """
[design]
kind = "latin_hypercube"
count = 4
seed = 3

[[case]]
name = "drift"
faults = "drift.toml"

[[case]]
name = "two"
faults = "noise.toml"
pairs = ["drift.toml", "bias.toml", "noise.toml", "other.toml"]

[[axis]]
name = "rate"
vary = "fault.D.rate"
low = "1 mm/s"
high = "100 mm/s"
scale = "log"
cases = ["two"]

[[axis]]
vary = ["parameter.lag.tau", "parameter.truth.time_constant"]
values = [1.0, 2.0, 4.0]

[[axis]]
vary = "fault.D.start"
low = 0.1
high = "1.5"
search = "R"
tolerance = 0.2
cases = ["drift"]

[[requirement]]
id = "R"
signal = "lag.y"
at_most = "8 m"
percent = 90
from = 1.0

[[requirement]]
id = "Q"
signal = "lag.y"
at_most = "8 m"
quantile = 0.5
cases = ["two"]
"""
OTHER = '[[fault]]\nid = "O"\ntarget = ["lag.y", "truth.y"]\ntype = "bias"\nvalue = [1.0, 2.0]\n'


def file(folder, text=TEXT):
    (folder / "other.toml").write_text(OTHER)
    return written(folder, text, HEAD)


def test_the_file_is_in_order_before_it_is_changed(tmp_path):
    campaign = load_campaign(file(tmp_path))
    assert (len(campaign.cases), len(campaign.searches)) == (4 + 4 + 3, 3)  # two of four draw the same value


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (('kind = "latin_hypercube"', 'kind = "latin"'),
         "line 6: unknown kind 'latin'; did you mean 'latin_hypercube'? (there"),
        (('kind = "latin_hypercube"', 'kind = "sobol"\ncout = 3'),
         "line 7: unknown entry 'cout'; did you mean 'count'?"),
        (('"latin_hypercube"\ncount = 4', '"sobol"\ncount = 6'), "line 7: 'count' is 6, expected a power of 2"),
        (("count = 4\n", ""), "line 6: latin_hypercube needs 'count', the number of points"),
        (("count = 4", "count = 0"), "line 7: 'count' is 0, expected at least 1"),
        (("count = 4", "count = 2.5"), "line 7: 'count' is 2.5, expected a whole number"),
        (('"latin_hypercube"\ncount = 4\nseed = 3', '"list"'),
         "line 20: list needs 'count', the number of values from"),
        (('"latin_hypercube"\ncount = 4\nseed = 3', '"factorial"\nseed = 3'),
         "line 7: 'seed' goes with points that are dra"),
        (("seed = 3", "seed = -1"), "line 8: 'seed' is -1, expected at least 0"),
        (("[[case]]\nname = \"two\"", "[[case]]\nname = \"drift\""), "line 15: there are two cases named 'drift'"),
        (('pairs = ["drift.toml", ', 'pairs = ["drfit.toml", '),
         "line 17: faults: there is no file 'drfit.toml' (the system has: stuck)"),
        (('pairs = ["drift.toml", "bias.toml", "noise.toml", "other.toml"]', 'pairs = "bias.toml"'),
         "line 17: 'pairs' has one fault only, and a pair takes two"),
        (('pairs = ["drift.toml", "bias.toml", "noise.toml", "other.toml"]', "pairs = []"),
         "line 17: 'pairs' is an empty"),
        (("pairs = [", 'each = "bias.toml"\npairs = ['), "line 18: 'each' and 'pairs' exclude each other"),
        (("[[axis]]\nname", "[axis]\nname"), "line 27, column 7: cannot overwrite a value"),
        (('vary = "fault.D.rate"\n', ""), "this axis has no 'vary'"),
        (('"fault.D.rate"', '"fault.E.rate"'),
         "line 21: 'vary' is 'fault.E.rate': no case of this axis has a fault 'E' (there are"),
        (('"fault.D.rate"', '"fault.D"'), "line 21: 'vary' is 'fault.D', expected 'fault.ID.ENTRY', 'parameter.COMPO"),
        (('"fault.D.rate"', '"lag.tau"'),
         "line 21: 'vary' is 'lag.tau', expected 'fault.ID.ENTRY', 'parameter.COMPONENT.NAME' "
         "or 'step'; did you mean 'parameter.lag.tau'?"),
        (('"fault.D.rate"', '"fault.D.rat"'), "line 19: axis 'rate' at 1"),
        (('"fault.D.rate"', '"fault.D.type"'),
         "line 21: 'vary' is 'fault.D.type': 'type' of a fault is no value that can vary"),
        (('"fault.D.rate"', '"fault.D.rate[2]"'), "fault 'D': 'rate' is no list: there is no element 2"),
        (('"fault.D.rate"', '"fault.O.value[3]"'), "fault 'O': 'value' has 2 elements: there is no element 3"),
        (('"fault.D.rate"', '"fault.D.start"'), "line 19: axis 'rate' at 1"),
        (('low = "1 mm/s"', "low = 1"),
         "line 23: 'low' and 'high' have different units, no unit and 'mm/s': write them in one"),
        (('low = "1 mm/s"', "low = 0"), "line 23: 'low' and 'high' have different units"),
        (('low = "1 mm/s"', 'low = "0 mm/s"'),
         "line 22: 'low' is '0 mm/s', expected more than 0 where 'scale' is 'log'"),
        (('low = "1 mm/s"', 'low = "200 mm/s"'), "line 23: 'high' is '100 mm/s', expected more than 'low', '200 mm/s'"),
        (('low = "1 mm/s"', "low = nan"),
         "line 22: 'low' is nan, expected a finite number, or a text such as '0.5 nmi'"),
        (('low = "1 mm/s"', 'low = "slow"'), "line 22: 'low' is 'slow', expected a finite number"),
        (('low = "1 mm/s"', "low = true"), "line 22: 'low' is true, expected a number or a text"),
        (('low = "1 mm/s"\n', ""), "line 22: this axis has 'high' and no 'low'"),
        (('low = "1 mm/s"\nhigh = "100 mm/s"\n', ""), "line 21: this axis has neither 'values', nor 'low' and 'high'"),
        (('low = "1 mm/s"\nhigh = "100 mm/s"', 'low = -1.5e308\nhigh = 1.5e308'),
         "line 22: 'low' is -1.5e+308, expected more"),
        (('"1 mm/s"\nhigh = "100 mm/s"', '"1 mm/h/s"\nhigh = "9 mm/h/s"'),
         "line 21: variant 'main', case 'two: D + B (rate="),
        (('scale = "log"', 'scale = "lgo"'),
         "line 24: 'scale' is 'lgo', expected 'linear' or 'log'; did you mean 'log'?"),
        (('scale = "log"', "count = 3"), "line 24: 'count' goes with a grid: latin_hypercube draws as many points as"),
        (('scale = "log"', "tolerance = 3"), "line 24: 'tolerance' goes with 'search'"),
        (('scale = "log"', "values = [1]"), "line 22: 'low' and 'values' exclude each other"),
        (('cases = ["two"]\n\n[[axis]]', 'cases = ["tow"]\n\n[[axis]]'),
         "line 25: 'cases': there is no 'tow' in this campaign; did"),
        (('name = "rate"', 'name = "case"'), "line 20: 'name' is 'case', which is a column of its own"),
        (('name = "rate"', 'name = "lag.tau"'), "line 28: there are two axes 'lag.tau'; give them names"),
        (('name = "rate"', 'name = "\\u0007"'), "line 20: 'name' is '\\x07', expected a text that can head a column"),
        (("values = [1.0, 2.0, 4.0]", "values = []"), "line 29: 'values' is an empty list"),
        (("values = [1.0, 2.0, 4.0]", "values = [1.0, 2.0, 1]"), "line 29: 'values' holds 1 twice"),
        (("values = [1.0, 2.0, 4.0]", "values = [1.0, inf]"), "line 29: 'values' holds inf, expected a finite number"),
        (("values = [1.0, 2.0, 4.0]", 'values = [1.0, "2 s"]'), "line 29: 'values' have different units, none and 's'"),
        (("values = [1.0, 2.0, 4.0]", 'values = ["1 s", "2 m"]'),
         "line 29: 'values' have different units, 's' and 'm'"),
        (("values = [1.0, 2.0, 4.0]", 'values = ["1 m", "2 m"]'), "line 28: variant 'main', case"),
        (("values = [1.0, 2.0, 4.0]", 'values = ["x", "y"]'), "line 28: variant 'main', case"),
        (("values = [1.0, 2.0, 4.0]", "values = [1.0, -2.0]"),
         "'tau' = -2 s is out of range: expected at least 0.01 s"),
        (("values = [1.0, 2.0, 4.0]", "values = [1.0, [2.0]]"), "line 29: 'values' holds [2.0], expected"),
        (("values = [1.0, 2.0, 4.0]", f"values = [1{'0' * 400}]"), "line 29: 'values' holds 1000"),
        (('"parameter.lag.tau", ', '"parameter.lag.tua", '),
         "parameter 'lag.tua': lag has no parameter 'tua'; did you mean 'tau'?"),
        (('vary = ["parameter', 'vary = "step"\nname = ["parameter'), "line 29: 'name' is ['parameter"),
        (('["parameter.lag.tau", "parameter.truth.time_constant"]', "[]"), "line 28: 'vary' is an empty list"),
        (('search = "R"', 'search = "r"'), "line 35: 'search': there is no requirement 'r' (there are: R, Q)"),
        (('search = "R"', 'search = "Q"'),
         "line 35: 'search': Q asks a quantile of the runs; a search asks one at a time"),
        (('search = "R"', 'search = "R"\ncount = 3'), "line 36: 'count' goes with a grid, not with 'search'"),
        (("tolerance = 0.2\n", ""), "line 35: 'search' needs a 'tolerance', the width of the bracket"),
        (("tolerance = 0.2", "tolerance = 0"), "line 36: 'tolerance' is 0, expected at least 1.4e-09"),
        (("tolerance = 0.2", "tolerance = -1"), "line 36: 'tolerance' is -1, expected at least 1.4e-09"),
        (("tolerance = 0.2", "tolerance = nan"), "line 36: 'tolerance' is nan, expected a finite number"),
        (("tolerance = 0.2", 'tolerance = "0.2 min"'),
         "line 36: 'tolerance' is '0.2 min', expected it in the unit of 'low' and"),
        (('high = "1.5"\nsearch', 'values = [1]\nsearch'), "line 33: 'low' and 'values' exclude each other"),
        (('low = 0.1\nhigh = "1.5"\nsearch', 'values = [1]\nsearch'),
         "line 33: 'search' goes from 'low' to 'high', not through"),
        (('low = 0.1\nhigh = "1.5"', 'low = 3\nhigh = "7"'), "line 1: fault 'D' starts at 7 s, the run ends"),
        (('vary = "fault.D.start"', 'vary = "step"'), "is not a multiple of the step"),
        (('at_most = "8 m"\npercent', 'at_most = "8 m"\ncases = ["two"]\npercent'),
         "line 37: 'search': R is not asked of the case"),
        (('id = "Q"', 'id = "R"'), "there are two requirements 'R'"),
        (("[[axis]]\nvary = \"fault.D.start\"", "[[axis]]\nname = \"again\"\nvary = \"parameter.lag.tau\""),
         "line 33: case 'drift': 'lag.tau' is varied by the axis 'lag.tau', too"),
    ],
)  # fmt: skip
def test_a_mistake_is_answered_with_its_line(tmp_path, change, sentence):
    assert change[0] in TEXT
    made = file(tmp_path, TEXT.replace(*change, 1))
    result = CliRunner().invoke(main, ["campaign", str(made), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2 and isinstance(result.exception, SystemExit), result.exception
    assert str(made) in result.stderr and not (tmp_path / "out").exists()
    assert sentence in result.stderr and result.stderr.count("\n") == 1
    assert re.search(r"campaign\.toml, line \d+", result.stderr)


def test_a_design_without_axes_is_refused(tmp_path):
    made = file(tmp_path, '[design]\nkind = "factorial"\n')
    with pytest.raises(NavfmuError, match=r"line 4: there is no \[\[axis\]\] whose points this design could take"):
        load_campaign(made)


WORDS = [
    *("nan", "inf", "-1", "0", "1e-320", "1e300", '""', '"x"', "true", "[]", "[[1]]", "{}", '"1 mm/s"', '"\\u0000"'),
    *("9" * 400, '"fault.D.rate"', '"step"', '"R"', '"drift"', "1979-05-27", '"1e999 m"', '"parameter.."'),
]


@pytest.mark.parametrize("seed", range(20))
def test_no_mutation_is_answered_with_anything_but_a_sentence(tmp_path, seed):
    """Lines left out, doubled and swapped, values that are none, texts cut off; each 15 times."""
    chance = random.Random(seed)
    for number in range(15):
        lines = TEXT.split("\n")
        for _ in range(chance.choice([1, 1, 2, 3])):
            at = chance.randrange(len(lines))
            kind = chance.randrange(5)
            if kind == 0:
                del lines[at]
            elif kind == 1:
                lines.insert(chance.randrange(len(lines)), lines[at])
            elif kind == 2:
                other = chance.randrange(len(lines))
                lines[at], lines[other] = lines[other], lines[at]
            elif kind == 3 and "=" in lines[at]:
                lines[at] = f"{lines[at].split('=')[0]}= {chance.choice(WORDS)}"
            else:
                lines[at] = lines[at][: chance.randrange(len(lines[at]) + 1)]
        made = file(tmp_path, "\n".join(lines))
        try:
            load_campaign(made, allow=lambda runs: None)
        except NavfmuError as error:
            text = str(error)
            assert "campaign.toml" in text or ".toml" in text, (number, text)
            assert "\n" not in text and len(text) < 1000
