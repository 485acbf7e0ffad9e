"""Rows of figures as claims: one that differs, or failed, is missed."""

from __future__ import annotations

from pathlib import Path

import pytest

from evidence import figures
from navfmu.figures import Comparison
from navfmu.figures.answer import Answer
from navfmu.figures.collection import Collection
from navfmu.figures.running import Outcome
from navfmu.report.page import Page


def answer(*found, error=""):
    compared = tuple(Comparison("a number", "3", one, 2.0, 4.0, "no more digits") for one in found)
    return Answer("M1", "it is so", "page 7", "key", compared, error=error)


@pytest.mark.parametrize(
    ("one", "holds"),
    [
        (answer(3.0, 4.0), True),
        (answer(3.0, 5.0), False),
        (answer(error="no such orbit"), False),
    ],
)
def test_a_row_that_differs_or_failed_is_missed(one, holds):
    """Wrong: a failed row without comparisons, of which none differs."""
    outcome = Outcome(Collection("made", "A book that is made.", (), Path()), 1, (one,), 0)
    found = figures.section([outcome])
    assert [claim.holds for claim in found.claims] == [holds] == [outcome.passed]
    assert ("is not found again" in found.claims[0].sentence) != holds
    page = Page("")
    found.write(page)
    assert "figures/made has the report" in page.html()
