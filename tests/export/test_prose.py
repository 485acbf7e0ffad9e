"""Docstrings become paragraphs, lists and blocks; what is meant as text stays text."""

import pytest

from navfmu.export.page.prose import blocks, pieces


def kinds(text):
    return [block.kind for block in blocks(text)]


def test_a_docstring_falls_into_its_parts():
    equations, items = "    y = a x      (1)\n    z = b", "- one\n- two\n  lines"
    text = f"First\nparagraph.\n\n{equations}\n\n{items}\n\na    gain\nb c  offset\n    of the sensor"
    assert kinds(text) == ["paragraph", "verbatim", "list", "terms"]
    paragraph, verbatim, items, terms = (block.content for block in blocks(text))
    assert paragraph == [("", "First paragraph.")]
    assert verbatim == "y = a x      (1)\nz = b"
    assert items == [[("", "one")], [("", "two lines")]]
    assert terms == [("a", [("", "gain")]), ("b c", [("", "offset of the sensor")])]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("`x` and ``y[1]``", [("code", "x"), ("", " and "), ("code", "y[1]")]),
        ("this is *not* z", [("", "this is "), ("em", "not"), ("", " z")]),
        ("a * b * c", [("", "a * b * c")]),
        ("2*a*b", [("", "2*a*b")]),
        ("x < y & <b>", [("", "x < y & <b>")]),
        ("`2*a*b`", [("code", "2*a*b")]),
        ("", []),
    ],
)
def test_names_and_stressed_words_are_found_and_products_are_not(text, expected):
    assert pieces(text) == expected
