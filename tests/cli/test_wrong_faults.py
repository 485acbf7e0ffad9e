"""Fault files that are wrong, through the command line: where, what, and what was expected, and nothing is written."""

from __future__ import annotations

import pytest

from tests.cli.test_bad_input import navfmu, refused
from tests.components import systems


def fault(**changes):
    """A fault that can be, but for the changes; None: the entry is left out."""
    entries = {
        "id": '"F"',
        "target": '"lag.y"',
        "type": '"bias"',
        "value": '"1 m"',
        "start": "5.0",
        "duration": '"2 s"',
    }
    given = {key: value for key, value in (entries | changes).items() if value is not None}
    return "[[fault]]\n" + "".join(f"{key} = {value}\n" for key, value in given.items())


def of(kind, **changes):
    return fault(type=f'"{kind}"', value=None, **changes)


#: By name: the file, and what is said behind its name.
WRONG = {
    # encodings and syntax
    "UTF-16": (fault().encode("utf-16"), ": the fault file cannot be read: it is not text in UTF-8"),
    "Latin-1": (
        fault(description='"Böe"').encode("latin-1"),
        ": the fault file cannot be read: it is not text in UTF-8",
    ),
    "a NUL": (fault().encode() + b"\0", "line 8, column 1: invalid statement"),
    "empty": (b"", ": holds no fault; expected at least one table [[fault]]"),
    "blank": (b" \n\n", ": holds no fault; expected at least one table [[fault]]"),
    "a comment only": (b"# nothing\n", ": holds no fault; expected at least one table [[fault]]"),
    "a byte order mark and nothing": (b"\xef\xbb\xbf", ": holds no fault; expected at least one table [[fault]]"),
    "JSON": (b'{"fault": [{"id": "F"}]}', "line 1, column 1: invalid statement"),
    "no closing quote": (fault(id='"F'), "line 2, column 8: illegal character '\\n'"),
    "no value": (fault(start=""), "line 6, column 9: invalid value"),
    "twice the same key": (fault() + "start = 1.0\n", "line 8, column 12: cannot overwrite a value"),
    "a bare word": (fault(type="bias"), "line 4, column 8: invalid value"),
    "a comma as decimal point": (
        fault(start="5,0"),
        "line 6, column 10: expected newline or end of document after a statement",
    ),
    "one bracket missing": (
        fault().replace("[[fault]]", "[[fault]"),
        "line 1, column 8: expected ']]' at the end of an array declaration",
    ),
    "tabs of a spreadsheet": (
        "id\ttarget\ttype\nF\tlag.y\tbias\n",
        "line 1, column 4: expected '=' after a key in a key/value pair",
    ),
    # structure
    "one table": (fault().replace("[[fault]]", "[fault]"), "line 1: 'fault' is written as tables: [[fault]]"),
    "another name of the table": (
        fault().replace("[[fault]]", "[[faults]]"),
        "line 1: unknown entry 'faults'; did you mean 'fault'?",
    ),
    "a nested table": (
        fault() + "[fault.when]\nphase = 'x'\n",
        "line 8: fault 'F': 'when' is {'phase': 'x'}, expected a text",
    ),
    "a table as value": (
        fault(value="{ m = 1 }"),
        "line 5: fault 'F': 'value' is {'m': 1}, expected a number or true or false or a text or a list",
    ),
    "a list of lists": (
        fault(value="[[1.0]]"),
        "line 5: fault 'F': 'value' holds [1.0], expected a number or true or false or a text",
    ),
    "an empty list of targets": (fault(target="[]"), "line 3: fault 'F': 'target' is an empty list"),
    "a target twice": (fault(target='["lag.y", "lag.y"]'), "line 3: fault 'F': 'target' has 'lag.y' twice"),
    "a fault as text": ('fault = "gps"\n', "line 1: 'fault' is written as tables: [[fault]]"),
    "an empty list of faults": ("fault = []\n", ": holds no fault; expected at least one table [[fault]]"),
    "a list of numbers": ("fault = [1, 2]\n", "line 1: 'fault' holds 1, expected a table"),
    "the entries without a table": (
        fault().replace("[[fault]]\n", ""),
        "line 1: unknown entry 'id'; expected description or fault",
    ),
    # keys
    "a misspelt id": (fault(id=None, idd='"F"'), "line 7: unknown entry 'idd'; did you mean 'id'?"),
    "a misspelt target": (
        fault(target=None, taget='"lag.y"'),
        "line 7: fault 'F': unknown entry 'taget'; did you mean 'target'?",
    ),
    "a misspelt type": (
        fault(type=None, tpye='"bias"'),
        "line 7: fault 'F': unknown entry 'tpye'; did you mean 'type'?",
    ),
    "a misspelt value": (
        fault(value=None, vlaue='"1 m"'),
        "line 7: fault 'F': unknown entry 'vlaue'; did you mean 'value'?",
    ),
    "a misspelt start": (
        fault(start=None, strat="5.0"),
        "line 7: fault 'F': unknown entry 'strat'; did you mean 'start'?",
    ),
    "a misspelt duration": (
        fault(duration=None, durration='"2 s"'),
        "line 7: fault 'F': unknown entry 'durration'; did you mean 'duration'?",
    ),
    "a key in capitals": (
        fault(start=None, Start="5.0"),
        "line 7: fault 'F': unknown entry 'Start'; did you mean 'start'?",
    ),
    "a misspelt description": (
        fault(descripton='"x"'),
        "line 8: fault 'F': unknown entry 'descripton'; did you mean 'description'?",
    ),
    "a misspelt fmea": (fault(fmae='"F1"'), "line 8: fault 'F': unknown entry 'fmae'; did you mean 'fmea'?"),
    # types of entries
    "an id that is a number": (fault(id="1"), "line 2: 'id' is 1, expected a text"),
    "an empty id": (fault(id='""'), "line 2: a fault: 'id' must be a text that is not empty"),
    "an id that is a list": (fault(id='["a"]'), "line 2: 'id' is ['a'], expected a text"),
    "a target that is a number": (fault(target="7"), "line 3: fault 'F': 'target' is 7, expected a text or a list"),
    "an empty target": (fault(target='""'), "line 3: fault 'F': 'target' must be written component.signal, not ''"),
    "a target without a component": (
        fault(target='"y"'),
        "line 3: fault 'F': 'target' must be written component.signal, not 'y'",
    ),
    "a type that is a number": (fault(type="3"), "line 4: fault 'F': 'type' is 3, expected a text"),
    "an empty type": (fault(type='""'), "line 4: fault 'F': unknown type ''"),
    "a type in capitals": (fault(type='"Bias"'), "line 4: fault 'F': unknown type 'Bias'; did you mean 'bias'?"),
    "a start that is true": (fault(start="true"), "line 6: fault 'F': 'start' is true, expected a number or a text"),
    "a start that is a list": (
        fault(start="[1.0]"),
        "line 6: fault 'F': 'start' is [1.0], expected a number or a text",
    ),
    "a start that is NaN": (
        fault(start="nan"),
        "line 6: fault 'F': 'start' is nan, expected a time: a number of seconds, or a text such as '5 min'",
    ),
    "an infinite start": (fault(start="inf"), "line 6: fault 'F': 'start' must be a time in s, 0 or later, not inf"),
    "a negative start": (fault(start="-5.0"), "line 6: fault 'F': 'start' must be a time in s, 0 or later, not -5.0"),
    "a start in metres": (
        fault(start='"5 m"'),
        "line 6: fault 'F': 'start' is '5 m': 'm' is no unit of time; did you mean 'ms'? (s, ms, min, h)",
    ),
    "a start in words": (
        fault(start='"soon"'),
        "line 6: fault 'F': 'start' is 'soon', expected a time: a number of seconds, or a text such as '5 min'",
    ),
    "a date as start": (
        fault(start="2026-01-01"),
        "line 6: fault 'F': 'start' is 2026-01-01, expected a number or a text",
    ),
    "a negative duration": (
        fault(duration="-2.0"),
        "line 7: fault 'F': 'duration' must be a positive time in s, not -2.0",
    ),
    "a duration of zero": (fault(duration="0"), "line 7: fault 'F': 'duration' must be a positive time in s, not 0"),
    "a duration that is NaN": (
        fault(duration="nan"),
        "line 7: fault 'F': 'duration' is nan, expected a time: a number of seconds, or a text such as '5 min'",
    ),
    "a duration in an unknown unit": (
        fault(duration='"2 fortnights"'),
        "line 7: fault 'F': 'duration' is '2 fortnights': 'fortnights' is no unit of time (s, ms, min, h)",
    ),
    "an fmea that is a number": (fault(fmea="12"), "line 8: fault 'F': 'fmea' is 12, expected a text"),
    # ids
    "the same id twice": (fault() + fault(), "line 9: the id 'F' is already taken"),
    # units and values
    "a value in a unit of another kind": (
        fault(value='"1 kg"'),
        "line 5: fault 'F': 'value' = 1 kg for 'lag.y': unit 'kg' is not known here; expected m, mm, km, ft or",
    ),
    "a value in an unknown unit": (
        fault(value='"1 mm2"'),
        "line 5: fault 'F': 'value' = 1 mm2 for 'lag.y': unit 'mm2' is not known here; expected m, mm, km, ft or",
    ),
    "a value that is NaN": (
        fault(value="nan"),
        "line 5: fault 'F': 'value' = nan for 'lag.y': expected a finite number",
    ),
    "an infinite value": (fault(value="inf"), "line 5: fault 'F': 'value' = inf for 'lag.y': expected a finite number"),
    "a value that is true": (
        fault(value="true"),
        "line 5: fault 'F': 'value' = true for 'lag.y': expected a number, for example '1.5 m'",
    ),
    "a value in words": (
        fault(value='"much"'),
        "line 5: fault 'F': 'value' = much for 'lag.y': expected a number, for example '1.5 m'",
    ),
    "too many values": (fault(value="[1.0, 2.0]"), "line 5: fault 'F': 'value': 2 values given, expected 1"),
    "an empty list of values": (fault(value="[]"), "line 5: fault 'F': 'value': 0 values given, expected 1"),
    "a value that is a date": (
        fault(value="2026-01-01"),
        "line 5: fault 'F': 'value' is 2026-01-01, expected a number or true or false or a text or a list",
    ),
    "an unknown type": (fault(type='"bais"'), "line 4: fault 'F': unknown type 'bais'; did you mean 'bias'?"),
    "an unknown component": (
        fault(target='"lga.y"'),
        "line 3: fault 'F': target 'lga.y': there is no component 'lga'; did you mean 'lag'?",
    ),
    "an unknown variable": (
        fault(target='"lag.yy"'),
        "line 3: fault 'F': target 'lag.yy': component 'lag' has no variable 'yy'; did you mean 'y'?",
    ),
    "an unknown bundle": (
        of("dropout", target='"sensor.raeding"'),
        "line 3: fault 'F': target 'sensor.raeding' is not a bundle of outputs or connected inputs (values with",
    ),
    "a parameter of another type": (
        fault(rate='"1 m/s"'),
        "line 8: fault 'F': type 'bias' has no parameter 'rate' (it takes value)",
    ),
    "a rate without time": (
        of("drift", rate='"1 m"'),
        "line 7: fault 'F': 'rate' = 1 m for 'lag.y': 'm' cannot be converted to 'm/s': the first is m, the second",
    ),
    "no rate": (of("drift"), "line 4: fault 'F': type 'drift' needs the parameter 'rate'"),
    "a negative sigma": (
        of("noise", sigma='"-1 m"', period="1.0"),
        "line 7: fault 'F': 'sigma' = -1 m for 'lag.y': expected a number that is not negative",
    ),
    "a period of zero": (
        of("noise", sigma='"1 m"', period="0"),
        "line 8: fault 'F': 'period' must be a positive time in s, not 0",
    ),
    "a stream that is broken": (
        of("noise", sigma='"1 m"', period="1", stream="1.5"),
        "line 9: fault 'F': 'stream' is 1.5, expected a whole number",
    ),
    "a negative stream": (
        of("noise", sigma='"1 m"', period="1", stream="-1"),
        "line 9: fault 'F': 'stream' must be a whole number from 0 to 2147483647, not -1",
    ),
    "neither low nor high": (of("saturate"), "line 4: fault 'F': type 'saturate' needs the parameter 'low' or 'high'"),
    "low above high": (
        of("saturate", low='"3 m"', high='"1 m"'),
        "line 7: fault 'F': 'low' is 3 and 'high' 1 for 'lag.y'",
    ),
    "a resolution of zero": (
        of("quantise", step="0"),
        "line 7: fault 'F': 'step' = 0 for 'lag.y': expected a positive number",
    ),
    "a unit of another kind": (
        of("unit", unit='"kg"'),
        "line 7: fault 'F': 'unit' = kg for 'lag.y': unit 'kg' is not known here; expected m or mm or km or ft or",
    ),
    "a unit that is misspelt": (
        of("unit", unit='"fet"'),
        "line 7: fault 'F': 'unit' = fet for 'lag.y': unit 'fet' is not known here; expected m or mm or km or ft",
    ),
    "a negative delay": (
        of("delay", delay="-1"),
        "line 7: fault 'F': 'delay' must be a time in s, 0 or longer, not -1",
    ),
    "an order with a place twice": (
        of("swap", order="[1, 1]"),
        "line 7: fault 'F': 'order' must have each of the places 1, 2, ... once, such as [2, 1, 3], not [1, 1]",
    ),
    "an order of texts": (of("swap", order='["a"]'), "line 7: fault 'F': 'order' holds 'a', expected a whole number"),
    "a misspelt nan": (
        fault(type='"nan"', value='"nane"'),
        "line 5: fault 'F': 'value' must be 'nan', 'inf' or '-inf', not 'nane'; did you mean 'nan'?",
    ),
    "a flip with a value": (
        fault(type='"flip"'),
        "line 5: fault 'F': type 'flip' has no parameter 'value' (it takes no parameters)",
    ),
    "an input that is connected": (
        fault(type='"input"', target='"lag.u"'),
        "line 3: fault 'F': type 'input' acts on unconnected inputs, but 'lag.u' is a connected input",
    ),
    "a parameter that is fixed": (
        fault(type='"parameter"', target='"lag.tau"'),
        "line 3: fault 'F': type 'parameter' acts on tunable parameters, but 'lag.tau' is a fixed parameter (no",
    ),
    "a lost step of a variable": (
        of("lost_step"),
        "line 3: fault 'F': 'target' must be the name of a component, not 'lag.y'",
    ),
    # times
    "on without off": (fault(on="1.0"), "line 8: fault 'F': 'on' needs 'off' beside it"),
    "off without on": (fault(off="1.0"), "line 8: fault 'F': 'off' needs 'on' beside it"),
    "mttr without mttf": (fault(mttr="1.0"), "line 8: fault 'F': 'mttr' needs 'mttf' beside it"),
    "shape without mttf": (fault(shape="2.0"), "line 8: fault 'F': 'shape' needs 'mttf' beside it"),
    "cause without mttf": (fault(cause='"bus"'), "line 8: fault 'F': 'cause' needs 'mttf' beside it"),
    "a negative mttf": (fault(mttf="-1"), "line 8: fault 'F': 'mttf' must be a positive time in s, not -1"),
    "a shape of zero": (fault(mttf="10", shape="0"), "line 9: fault 'F': 'shape' must be a positive number, not 0"),
    "an empty cause": (
        fault(mttf="10", cause='""'),
        "line 9: fault 'F': 'cause' must be a text that is not empty, not ''",
    ),
    "on shorter than a step": (
        fault(on="0.01", off="1.0"),
        "line 8: fault 'F': 'on' 0.01 s is shorter than the step 0.1 s; some of its times would hold no",
    ),
    "when and during": (
        fault(when='"lag.y > 1 m"', during='"lag.y > 1 m"'),
        "line 9: fault 'F': 'when' and 'during' exclude each other",
    ),
    "when and mttf": (
        fault(when='"lag.y > 1 m"', mttf="10"),
        "line 9: fault 'F': 'when' and 'mttf' exclude each other",
    ),
    "when and on": (
        fault(when='"lag.y > 1 m"', on="1", off="1"),
        "line 9: fault 'F': 'when' and 'on' exclude each other",
    ),
    "hold without a condition": (fault(hold="1"), "line 8: fault 'F': 'hold' needs 'when' or 'during' beside it"),
    "an empty condition": (fault(when='""'), "line 8: fault 'F': 'when' must be a text that is not empty, not ''"),
    "a condition that is a number": (
        fault(when='"lag.y"'),
        "line 8: fault 'F': 'when': in 'lag.y', character 1: expected a truth value, such as 'x < 1', but this is",
    ),
    "a condition with an unknown signal": (
        fault(when='"lag.z > 1 m"'),
        "line 8: fault 'F': 'when': in 'lag.z > 1 m', character 1: component 'lag' has no variable 'z'",
    ),
    "a condition in another unit": (
        fault(when='"lag.y > 1 s"'),
        "line 8: fault 'F': 'when': in 'lag.y > 1 s', character 7: '>' joins m and s, expected one dimension",
    ),
    "a condition that does not end": (
        fault(when='"lag.y > "'),
        "line 8: fault 'F': 'when': in 'lag.y > ', character 8: it ends, expected a value",
    ),
    "a condition that asks for a fault that is not": (
        fault(when='"active(G)"'),
        "line 8: fault 'F': 'when': in 'active(G)', character 8: there is no fault 'G' (faults: F)",
    ),
    "a window between two points": (
        fault(start="5.01", duration="0.02"),
        "line 7: fault 'F': no communication point lies between its start 5.01 s and its end 5.03 s at the step",
    ),
    "two of one cause with other times": (
        fault(mttf="10", cause='"bus"') + fault(id='"G"', target='"truth.y"', mttf="20", cause='"bus"'),
        "line 17: fault 'G': it has the cause 'bus' of fault 'F', but another 'mttf'; the random times of one",
    ),
}


def test_the_file_of_which_the_others_are_changes_is_a_good_one(tmp_path):
    (tmp_path / "faults.toml").write_text(fault(), encoding="utf-8")
    done = navfmu("run", systems.tracker(), "--faults", tmp_path / "faults.toml", "--out", tmp_path / "out.parquet")
    assert done.exit_code == 0 and (tmp_path / "out.parquet").exists()


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_fault_file_is_answered_with_a_sentence(name, tmp_path):
    content, sentence = WRONG[name]
    file, out = tmp_path / "faults.toml", tmp_path / "out.parquet"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    result = navfmu("run", systems.tracker(), "--faults", file, "--out", out)
    refused(result)
    said = " ".join(result.stderr.split())
    assert said.count("navfmu: ") == 1
    comma = ", " if sentence.startswith("line") else ""
    assert said.startswith(f"navfmu: {file}{comma}{sentence}")
    assert list(tmp_path.iterdir()) == [file]


def test_they_are_many_and_of_every_kind():
    texts = {content if isinstance(content, bytes) else content.encode() for content, _ in WRONG.values()}
    assert len(texts) == len(WRONG) > 100
