"""Verdicts: what agrees, what differs for a reason, and what nobody explains."""

from __future__ import annotations

import json
import math

import pytest

from navfmu.errors import NavfmuError
from navfmu.figures import Comparison, Difference
from navfmu.figures.comparison import AGREES, DIFFERS, EXPLAINED, worst

KNOWN = Difference(5.0, 7.0, "the area is another")


def compared(found, **more):
    return Comparison("a number", "3", found, **{"low": 2.0, "high": 4.0, "why": "no more digits"} | more)


@pytest.mark.parametrize(
    ("found", "known", "verdict"),
    [
        (2.0, None, AGREES),
        (4.0, KNOWN, AGREES),
        (4.01, None, DIFFERS),
        (4.01, KNOWN, DIFFERS),
        (5.0, KNOWN, EXPLAINED),
        (7.01, KNOWN, DIFFERS),
        (math.nan, KNOWN, DIFFERS),
        (math.inf, None, DIFFERS),
    ],
)
def test_a_difference_is_explained_within_bounds_of_its_own(found, known, verdict):
    """Wrong: a reason that explains whatever comes; NaN that lies in no place and so agrees."""
    one = compared(found, difference=known)
    assert one.verdict == verdict
    assert bool(one.explanation) == (verdict == EXPLAINED)


def test_bounds_are_told_in_words():
    assert compared(3.0, unit="deg").bounds == "2 to 4 deg"
    assert compared(3.0, low=-math.inf).bounds == "at most 4"
    assert compared(3.0, high=math.inf).bounds == "at least 2"
    assert compared(3.0, low=-1.23456, high=12345.6).bounds == "-1.235 to 12346"
    assert compared(6.0, difference=KNOWN).explanation == "the area is another (explained: 5 to 7)"


def test_the_worst_of_several_counts():
    assert worst([AGREES, EXPLAINED, AGREES]) == EXPLAINED
    assert worst([EXPLAINED, DIFFERS, AGREES]) == DIFFERS


@pytest.mark.parametrize("found", [3.0, math.nan, math.inf])
def test_what_is_kept_is_what_was_found(found):
    """Through JSON, which has neither NaN nor infinity. Wrong: a bound that is then none, a NaN that becomes null."""
    one = compared(found, high=math.inf, difference=Difference(-math.inf, 0.0, "so it is"))
    again = Comparison.restored(json.loads(json.dumps(one.describe(), allow_nan=False)))
    assert again.verdict == one.verdict and again.bounds == one.bounds and again.difference == one.difference
    assert again.found == found or (math.isnan(found) and math.isnan(again.found))


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"low": 5.0}, "expected the smaller one first"),
        ({"low": math.nan}, "expected the smaller one first"),
        ({"why": " "}, "not why"),
        ({"difference": Difference(7.0, 5.0, "so")}, "from 7 to 5; expected the smaller one first"),
    ],
)
def test_a_tolerance_without_reason_or_sense_is_refused(more, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        compared(3.0, **more)
