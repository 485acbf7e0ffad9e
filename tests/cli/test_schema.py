"""The schemas that editors get agree with what the readers accept."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner

from navfmu.cli.main import main
from navfmu.cli.schema import KINDS, schema
from navfmu.faults.file import parse_faults

ROOT = Path(__file__).parents[2]
FILES = {
    "campaign": [*ROOT.glob("system_ssp/*/campaigns/*.toml"), ROOT / "examples" / "campaign.toml"],
    "faults": list(ROOT.glob("system_ssp/*/faults/*.toml")),
    "report": list(ROOT.glob("system_ssp/*/report.toml")),
}


@pytest.mark.parametrize(("kind", "file"), [(kind, file) for kind, files in FILES.items() for file in files])
def test_shipped_files_fit_the_printed_schema(kind, file):
    printed = CliRunner().invoke(main, ["schema", kind])
    assert printed.exit_code == 0
    rules = json.loads(printed.output)
    jsonschema.Draft202012Validator.check_schema(rules)
    jsonschema.validate(tomllib.loads(file.read_text(encoding="utf-8")), rules)


FAULT = '[[fault]]\nid = "F"\ntarget = "a.y"\ntype = "bias"\n'


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("campaign", "stop = 10.0"),
        ("campaign", 'system = "s"\nvariants = []'),
        ("campaign", 'system = "s"\nvariants = ["main", "main"]'),
        ("campaign", 'system = "s"\nalgorithm = "seidel"'),
        ("campaign", 'system = "s"\n[[requirement]]\nid = "R"\nsignal = "a.y"\npercent = 101'),
        ("campaign", 'system = "s"\n[[requirement]]\nid = "R"\nsignal = "a.y"\nbegin = 1.0'),
        ("campaign", 'system = "s"\n[[axis]]\nvalues = [1]'),
        ("campaign", 'system = "s"\n[[axis]]\nvary = "step"\nlow = 1\nhigh = 2\ncount = 1'),
        ("campaign", 'system = "s"\n[[axis]]\nvary = "step"\nlow = 1\nhigh = 2\nscale = "lgo"'),
        ("campaign", 'system = "s"\n[design]\nkind = "sobel"'),
        ("report", '[[picture]]\nkind = "mpa"'),
        ("faults", FAULT),
        ("faults", FAULT + "value = 1\nrate = 1"),
        ("faults", FAULT + "value = 1\nduraton = 1"),
        ("faults", FAULT.replace("bias", "biass") + "value = 1"),
        ("faults", FAULT + "value = 1\nhold = 1"),
        ("faults", FAULT + 'value = 1\nwhen = "a.y > 1"\nduring = "a.y > 1"'),
        ("faults", FAULT + 'value = 1\nwhen = "a.y > 1"\nmttf = 3'),
        ("faults", FAULT + "value = 1\non = 1"),
        ("faults", FAULT + "value = 1\nshape = 2"),
        ("faults", FAULT + 'value = 1\ncause = "x"'),
        ("faults", FAULT + 'value = 1\nwhen = ""'),
        ("faults", FAULT + "value = 1\non = -1\noff = 1"),
        ("faults", FAULT + "value = 1\nmttf = 0"),
        ("faults", FAULT + "value = 1\nmttf = 1\nshape = 0"),
        ("faults", FAULT + "value = 1\nduration = 0"),
        ("faults", FAULT + "value = 1\nduration = -1"),
        ("faults", FAULT + "value = 1\nstart = -1"),
        ("faults", FAULT + 'value = 1\nwhen = "a.y > 1"\nhold = -1'),
    ],
)
def test_what_the_reader_refuses_the_schema_refuses(kind, text):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(text), json.loads(schema(kind)))


def test_every_entry_of_a_schema_says_what_it_means():
    for kind in KINDS:
        rules = json.loads(schema(kind))
        for table in (rules, *rules["$defs"].values()):
            silent = [n for n, e in table["properties"].items() if not e.get("description") and "const" not in e]
            assert not silent, (kind, table.get("description"), silent)


def test_an_unknown_kind_is_answered_with_the_nearest():
    result = CliRunner().invoke(main, ["schema", "campain"])
    assert result.exit_code == 2 and "did you mean 'campaign'? (there are: campaign, faults" in result.stderr


@pytest.mark.parametrize(
    "times",
    [
        "start = 0",
        'when = "a.y > 1"\nhold = 0\nduration = "3 s"',
        'during = "cruise"\non = 1\noff = 2\nstart = 3',
        'during = "cruise"\nmttf = "1 min"\nmttr = 3\nshape = 2\ncause = "bus"',
    ],
)
def test_times_that_the_reader_takes_the_schema_takes(times):
    text = FAULT + "value = 1\n" + times
    assert parse_faults(text)
    jsonschema.validate(tomllib.loads(text), json.loads(schema("faults")))
