"""Report files that are wrong, through the command line: where, what, and what was expected, and nothing is written."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from tests.cli.test_bad_input import navfmu, refused
from tests.second_system.system import REPORT, pack

TEXT = REPORT.read_text(encoding="utf-8")
NOTICE = '\n[[notice]]\nlabel = "late"\nsignal = "judge.distance"\n'
PHASE = '\n[[phase]]\nid = "away"\nwhen = "judge.distance > 10 m"\n'


def but(old, new, text=TEXT):
    """The good file with a change."""
    assert old in text
    return text.replace(old, new, 1)


def more(text):
    return TEXT + text


def ellipses(entries):
    behind = "\n\n[[picture.marks]]"
    return but(behind, f"\nellipses = {{ {entries} }}{behind}")


ONE_AXIS = TEXT.rpartition('    { name = "east"')[0] + "]\n"
NAMED = but('kind = "radial"', 'kind = "radial"\nname = "a"')
#: By name: the file, and what is said behind its name.
WRONG = {
    "UTF-16": (TEXT.encode("utf-16"), ": the report file cannot be read: it is not text in UTF-8"),
    "Latin-1": (more("# Böe\n").encode("latin-1"), ": the report file cannot be read: it is not text in UTF-8"),
    "no closing bracket": (
        but('["judge", "finder.place"]', '["judge", "finder.place"'),
        "line 4, column 1: unclosed array",
    ),
    "no closing quote": (but('"percentiles"', '"percentiles'), "line 5, column 20: illegal character '\\n'"),
    "no value": (but("factor = 2", "factor ="), "line 10, column 9: invalid value"),
    "twice the same key": (but("factor = 2", "factor = 2\nfactor = 3"), "line 11, column 11: cannot overwrite a value"),
    "twice record": (but("[[picture]]", "record = []\n[[picture]]"), "line 4, column 12: cannot overwrite a value"),
    "JSON": (b'{"record": ["judge"]}', "line 1, column 1: invalid statement"),
    "record as a text": (but('["judge", "finder.place"]', '"judge"'), "line 2: 'record' is 'judge', expected a list"),
    "record as a table": (
        but('record = ["judge", "finder.place"]', "[record]\njudge = true"),
        "line 2: 'record' is {'judge': True}, expected a list",
    ),
    "record with a number": (but('"finder.place"]', "7]"), "line 2: 'record' holds 7, expected a text"),
    "a misspelt record": (but("record =", "recrod ="), "line 2: unknown entry 'recrod'; did you mean 'record'?"),
    "a misspelt table": (
        but("[[picture]]", "[[pictures]]"),
        "line 4: unknown entry 'pictures'; did you mean 'picture'?",
    ),
    "a table that is none": (
        but("[[statistic]]", "[[stat]]"),
        "line 33: unknown entry 'stat'; did you mean 'statistic'?",
    ),
    "one picture": (
        '[picture]\nkind = "lines"\nsignals = ["judge.distance"]\n',
        "line 1: 'picture' is written as tables: [[picture]]",
    ),
    "a picture as text": ('picture = "map"\n', "line 1: 'picture' is written as tables: [[picture]]"),
    "a list of numbers": ("picture = [1]\n", "line 1: 'picture' holds 1, expected a table"),
    "a picture without a kind": (
        but('kind = "percentiles"\n', ""),
        "line 4: this picture has no 'kind' (there are: lines, map, percentiles, sigma)",
    ),
    "a kind that is a number": (
        but('kind = "percentiles"', "kind = 1"),
        "line 5: there is no picture of the kind 1 (there are: lines, map, percentiles, sigma)",
    ),
    "an empty kind": (
        but('kind = "percentiles"', 'kind = ""'),
        "line 5: there is no picture of the kind '' (there are: lines, map, percentiles, sigma)",
    ),
    "a kind in capitals": (
        but('kind = "map"', 'kind = "Map"'),
        "line 18: there is no picture of the kind 'Map'; did you mean 'map'? (there are: lines, map, percentiles,",
    ),
    "a misspelt kind": (
        but('kind = "lines"', 'kind = "line"'),
        "line 30: there is no picture of the kind 'line'; did you mean 'lines'? (there are: lines, map,",
    ),
    "an unknown statistic": (
        but('kind = "radial"', 'kind = "radical"'),
        "line 34: there is no statistic of the kind 'radical'; did you mean 'radial'? (there are: radial)",
    ),
    "a statistic without a kind": (
        but('kind = "radial"\n', ""),
        "line 33: this statistic has no 'kind' (there are: radial)",
    ),
    "no signal": (but('signal = "judge.distance"\n', ""), "line 4: this picture has no 'signal'"),
    "a signal that is a list": (
        but('signal = "judge.distance"', 'signal = ["judge.distance"]'),
        "line 6: 'signal' is ['judge.distance'], expected a text",
    ),
    "a signal that is a number": (
        but('signal = "judge.distance"', "signal = 1"),
        "line 6: 'signal' is 1, expected a text",
    ),
    "an empty signal": (
        but('signal = "judge.distance"', 'signal = ""'),
        "line 6: picture 'percentiles': '': there is no component ''",
    ),
    "a signal without a component": (
        but('signal = "judge.distance"', 'signal = "distance"'),
        "line 6: picture 'percentiles': 'distance': there is no component 'distance'",
    ),
    "an unknown signal": (
        but('signal = "judge.distance"', 'signal = "judge.distanse"'),
        "line 6: picture 'percentiles': 'judge.distanse': component 'judge' has no variable 'distanse'; did you",
    ),
    "an unknown component": (
        but('signal = "judge.distance"', 'signal = "jugde.distance"'),
        "line 6: picture 'percentiles': 'jugde.distance': there is no component 'jugde'; did you mean 'judge'?",
    ),
    "a bundle as signal": (
        but('signal = "judge.distance"', 'signal = "finder.place"'),
        "line 6: picture 'percentiles': 'finder.place' stands for 5 signals; name one, for example",
    ),
    "signals of lines as a text": (
        but('["finder.place.sequence", "judge.north_error"]', '"judge.north_error"'),
        "line 31: 'signals' is 'judge.north_error', expected a list",
    ),
    "no signals": (
        but('["finder.place.sequence", "judge.north_error"]', "[]"),
        "line 31: 'signals' is an empty list, expected at least one",
    ),
    "an unknown entry of lines": (
        but('kind = "lines"', 'kind = "lines"\nsignal = "judge.distance"'),
        "line 31: unknown entry 'signal'; did you mean 'signals'?",
    ),
    "a factor that is true": (but("factor = 2", "factor = true"), "line 10: 'factor' is true, expected a number"),
    "a factor that is a text": (but("factor = 2", 'factor = "2"'), "line 10: 'factor' is '2', expected a number"),
    "a factor of zero": (but("factor = 2", "factor = 0"), "line 10: 'factor' is 0, expected more than 0"),
    "a negative factor": (but("factor = 2", "factor = -2"), "line 10: 'factor' is -2, expected more than 0"),
    "a factor that is NaN": (but("factor = 2", "factor = nan"), "line 10: 'factor' is nan, expected more than 0"),
    "an infinite factor": (but("factor = 2", "factor = inf"), "line 10: 'factor' is inf, expected a finite number"),
    "a misspelt factor": (but("factor = 2", "fcator = 2"), "line 10: unknown entry 'fcator'; did you mean 'factor'?"),
    "a misspelt valid": (but("valid =", "vaild ="), "line 11: unknown entry 'vaild'; did you mean 'valid'?"),
    "an axis without a sigma": (but(', sigma = "finder.north_sigma"', ""), "line 8: this picture has no 'sigma'"),
    "an axis with a misspelt error": (
        but('error = "judge.north_error"', 'eror = "judge.north_error"'),
        "line 13: unknown entry 'eror'; did you mean 'error'?",
    ),
    "an axis that is a text": (
        but('{ name = "east", error = "judge.east_error", sigma = "finder.east_sigma" }', '"east"'),
        "line 14: 'axes' holds 'east', expected a table",
    ),
    "an error in another unit": (
        but('error = "judge.north_error"', 'error = "rover.latitude"'),
        "line 8: picture 'sigma': 'rover.latitude' is in rad, 'finder.north_sigma' in m; they are compared and",
    ),
    "one place only": (
        but('truth = ["rover.latitude", "rover.longitude"]', 'truth = ["rover.latitude"]'),
        "line 19: 'truth' holds 1, expected two",
    ),
    "three places": (
        but('truth = ["rover.latitude", ', 'truth = ["rover.latitude", "rover.latitude", '),
        "line 19: 'truth' holds 3, expected two",
    ),
    "a place that is a length": (
        but('truth = ["rover.latitude"', 'truth = ["judge.distance"'),
        "line 17: picture 'map': 'judge.distance' is in m, expected an angle in rad or deg",
    ),
    "an estimate as a text": (
        but('estimate = ["finder.place.latitude", "finder.place.longitude"]', 'estimate = "finder"'),
        "line 20: 'estimate' is 'finder', expected a list",
    ),
    "an unknown parameter": (
        but('"finder.beacon_latitude"', '"finder.beacon_lattitude"'),
        "line 26: picture 'map': 'finder.beacon_lattitude': component 'finder' has no variable 'beacon_lattitude';",
    ),
    "marks without a label": (but('label = "beacon"\n', ""), "line 23: this marks has no 'label'"),
    "marks as one table": (
        but("[[picture.marks]]", "[picture.marks]"),
        "line 23: 'marks' is written as tables: [[picture.marks]]",
    ),
    "a count that is a number": (
        but('count = "finder.beacon_count"', "count = 3"),
        "line 25: 'count' is 3, expected a text",
    ),
    "ellipses without an east": (ellipses('north = "finder.north_sigma"'), "line 22: this ellipses has no 'east'"),
    "no ellipse": (
        ellipses('north = "finder.north_sigma", east = "finder.east_sigma", count = 0'),
        "line 22: 'count' is 0, expected more than 0",
    ),
    "a broken number of ellipses": (
        ellipses('north = "finder.north_sigma", east = "finder.east_sigma", count = 1.5'),
        "line 22: 'count' is 1.5, expected a whole number",
    ),
    "a statistic with one axis": (ONE_AXIS, "line 36: 'axes' holds 1, expected two"),
    "two statistics without a name": (
        TEXT + TEXT[TEXT.index("[[statistic]]") :],
        "line 33: of several statistics each needs a 'name'; their files are named after it",
    ),
    "two statistics of one name": (
        NAMED + NAMED[TEXT.index("[[statistic]]") :],
        "line 33: two statistics are named 'a'; their files are named after it",
    ),
    "an empty name": (
        but('kind = "radial"', 'kind = "radial"\nname = ""'),
        "line 35: 'name' is '', expected a text that is not empty",
    ),
    "a notice without a label": (more(but('label = "late"\n', "", NOTICE)), "line 41: this notice has no 'label'"),
    "an empty label": (more(but('"late"', '""', NOTICE)), "line 42: 'label' is '', expected a text that is not empty"),
    "a notice of an unknown signal": (
        more(but("judge.distance", "judge.distnce", NOTICE)),
        "line 43: notice 'late': 'judge.distnce': component 'judge' has no variable 'distnce'; did you mean",
    ),
    "a notice that equals a text": (more(NOTICE + 'equals = "2"\n'), "line 44: 'equals' is '2', expected a number"),
    "a misspelt equals": (more(NOTICE + "equal = 2\n"), "line 44: unknown entry 'equal'; did you mean 'equals'?"),
    "a phase without an id": (more(but('id = "away"\n', "", PHASE)), "line 41: this phase has no 'id'"),
    "a phase with a wrong id": (
        more(but('"away"', '"far away"', PHASE)),
        "line 42: 'id' is 'far away', expected letters, digits and '_', and no word that expressions have",
    ),
    "a phase that is called like a word": (
        more(but('"away"', '"and"', PHASE)),
        "line 42: 'id' is 'and', expected letters, digits and '_', and no word that expressions have",
    ),
    "two phases of one id": (more(PHASE + PHASE), "line 46: there are two phases 'away'"),
    "a phase without a condition": (
        more(but('when = "judge.distance > 10 m"\n', "", PHASE)),
        "line 41: this phase has no 'when'",
    ),
    "a phase that is a number": (
        more(but("judge.distance > 10 m", "judge.distance", PHASE)),
        "line 43: phase 'away': in 'judge.distance', character 1: expected a truth value, such as 'x < 1', but",
    ),
    "a phase in another unit": (
        more(but("10 m", "10 s", PHASE)),
        "line 43: phase 'away': in 'judge.distance > 10 s', character 16: '>' joins m and s, expected one dimension",
    ),
    "a phase of an unknown signal": (
        more(but("judge.distance", "judge.distnce", PHASE)),
        "line 43: phase 'away': in 'judge.distnce > 10 m', character 1: component 'judge' has no variable",
    ),
    "a phase that does not end": (
        more(but("10 m", "", PHASE)),
        "line 43: phase 'away': in 'judge.distance > ', character 17: it ends, expected a value",
    ),
    "a phase that is a list": (
        more(but('"judge.distance > 10 m"', '["judge.distance > 10 m"]', PHASE)),
        "line 43: 'when' is ['judge.distance > 10 m'], expected a text",
    ),
}


@pytest.fixture(scope="module")
def rover(tmp_path_factory) -> Path:
    return pack(tmp_path_factory.mktemp("rover"))


def packed(rover: Path, content: bytes, to: Path) -> Path:
    """The system with another report file."""
    with zipfile.ZipFile(rover) as old, zipfile.ZipFile(to, "w") as new:
        for one in old.infolist():
            new.writestr(one, content if one.filename == "extra/report.toml" else old.read(one))
    return to


def test_the_file_of_which_the_others_are_changes_is_a_good_one(rover, tmp_path):
    system = packed(rover, more(NOTICE + PHASE).encode(), tmp_path / "s.ssp")
    assert navfmu("run", system, "--stop", 2, "--report", tmp_path / "out").exit_code == 0
    assert (tmp_path / "out" / "report.html").exists()


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_report_file_is_answered_with_a_sentence(name, rover, tmp_path):
    content, sentence = WRONG[name]
    system = packed(rover, content if isinstance(content, bytes) else content.encode(), tmp_path / "s.ssp")
    result = navfmu("run", system, "--stop", 2, "--report", tmp_path / "out")
    refused(result)
    said = " ".join(result.stderr.split())
    comma = ", " if sentence.startswith("line") else ""
    assert said.count("navfmu: ") == 1
    assert said.startswith(f"navfmu: {system}: extra/report.toml{comma}{sentence}")
    assert list(tmp_path.iterdir()) == [system]


def test_they_are_many_and_of_every_kind():
    assert len({str(content) for content, _ in WRONG.values()}) == len(WRONG) > 70
