"""The page of figures in docs: what is written of a row."""

from __future__ import annotations

import re

from navfmu.figures import Comparison, Difference, collection
from navfmu.figures.answer import Answer
from tools import figures_page


def test_a_row_has_its_figures_one_reason_for_those_that_share_it_and_why_one_differs():
    known = Difference(5.0, 7.0, "the area is another")
    found = (
        Comparison("a number", "3", 3.0, 2.0, 4.0, "no more digits"),
        Comparison("another", "2", 6.0, 1.0, 3.0, "no more digits", "deg", known),
    )
    row = Answer("M1", "it is so", "page 7", "key", found, ("a misprint",), "a picture").describe()
    text = figures_page.table([row])
    assert "| another | 2 | 6 deg | 1 to 3 deg | differs, explained |" in text
    assert text.count("no more digits") == 1 and "- **another differs**: the area is another" in text
    assert "- a misprint" in text and "![a picture](figures/M1.png)" in text


def test_the_page_has_all_rows_and_their_pictures():
    """Wrong: a row that was added and not found for the page."""
    page = figures_page.PAGE.read_text(encoding="utf-8")
    rows = [row.name for row in collection.collection("thesis").rows]
    assert re.findall(r"^### (\w+): ", page, re.MULTILINE) == rows
    assert all((figures_page.PICTURES / f"{name}.png").is_file() for name in rows)
    assert figures_page.WRITTEN.search(page)
