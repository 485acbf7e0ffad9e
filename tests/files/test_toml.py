"""TOML files: every entry has its line, and nothing that is no text of a sensible size is read."""

from __future__ import annotations

import os

import pytest

from navfmu.errors import NavfmuError
from navfmu.files import toml
from navfmu.files.toml import Document

TEXT = '''a = 1.5  # [no] table
"b.c".x = [1, # one
 "t] wo", {p = 3, q.r = [
 7]}]
text = """
[[case]] \\""" not = 1
"""
[table.sub]
day = 1979-05-27 07:32:00
[[case]]
name = '[x]'
[case.parameters]
"lag.tau" = 3
lag.k = 2

[[ case ]]
[[case.inner]]
k = 1
[[case.inner]]
"k" = 2
'''

PLACES = {
    ("a",): 1,
    ("b.c", "x"): 2,
    ("b.c", "x", 0): 2,
    ("b.c", "x", 1): 3,
    ("b.c", "x", 2, "p"): 3,
    ("b.c", "x", 2, "q", "r", 0): 4,
    ("text",): 5,
    ("table", "sub"): 8,
    ("table", "sub", "day"): 9,
    ("case",): 10,
    ("case", 0): 10,
    ("case", 0, "name"): 11,
    ("case", 0, "parameters", "lag.tau"): 13,
    ("case", 0, "parameters", "lag", "k"): 14,
    ("case", 1): 16,
    ("case", 1, "inner", 0, "k"): 18,
    ("case", 1, "inner", 1, "k"): 20,
    ("case", 1, "name"): 16,  # not there: its table
    ("none",): 1,
}


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_every_entry_has_its_line(newline):
    document = Document(TEXT.replace("\n", newline), "f.toml")
    assert {place: document.line(*place) for place in PLACES} == PLACES
    assert str(document.error("is wrong", "case", 1, "inner", 1, "k")) == "f.toml, line 20: is wrong"
    assert str(document.error("is empty")) == "f.toml: is empty"


def test_every_value_of_the_parser_has_a_line_of_its_own():
    """Each scalar of the document stands, as text, on the line that is given for it."""
    lines = TEXT.splitlines()

    def check(value, *place):
        if isinstance(value, dict):
            for key, inner in value.items():
                check(inner, *place, key)
        elif isinstance(value, list):
            for number, inner in enumerate(value):
                check(inner, *place, number)
        elif place != ("text",):
            assert str(value).partition(" ")[0] in lines[document.line(*place) - 1]

    document = Document(TEXT, "f.toml")
    check(document.content)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a = 1\nb = x", "f.toml, line 2, column 5: invalid value"),
        ("a = ", "f.toml, end of document: invalid value"),
        ("[[a.b]]\n[a.b]", "f.toml, line 2, column 5: cannot declare 'a.b' twice"),
        ("a = " + "[" * 5000, "f.toml: is nested too deeply"),
        ("a = " + "1" * 5000, "f.toml: "),  # more digits than Python reads
    ],
)
def test_what_is_not_toml_is_a_sentence(text, sentence):
    with pytest.raises(NavfmuError) as caught:
        Document(text, "f.toml")
    assert str(caught.value).startswith(sentence)


def test_a_mark_at_the_beginning_is_no_content(tmp_path):
    (tmp_path / "f.toml").write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert Document.read(tmp_path / "f.toml").content == {"a": 1}


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="a device of Unix")
@pytest.mark.parametrize("name", ["/dev/zero", "/dev/null", "/"])
def test_what_is_not_a_file_is_refused_at_once(name):
    with pytest.raises(NavfmuError, match=r": is a (device|folder), expected a fault file"):
        Document.read(name, "fault file")


def test_a_file_without_end_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(toml, "MAX_BYTES", 1_000_000)
    (tmp_path / "f.toml").write_text("#" * 1_000_001)
    with pytest.raises(NavfmuError, match=r"f\.toml: is larger than 1 MB, expected a campaign file"):
        Document.read(tmp_path / "f.toml", "campaign file")
