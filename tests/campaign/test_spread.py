"""Pictures over all runs: which marks stand where, and what their titles say."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.campaign.spread import spread, sweeps
from navfmu.report import along, strips


@pytest.fixture
def drawing(monkeypatch):
    """What was drawn, before it became a PNG."""
    kept = []
    for module in (along, strips):
        monkeypatch.setattr(module, "png", lambda figure: kept.append(figure) or b"PNG")
    return kept


def tale() -> dict:
    """Two variants, three magnitudes of a fault, one seed: errors of 10 times the magnitude; 25 m are asked."""
    requirement = {
        "id": "R",
        "quantity": ["a.horizontal_error", " at its worst time", "worst horizontal error"],
        "unit": "m",
        "quantile": None,
        "bounds": [None, 25.0],
    }
    cases = [{"name": f"c{value:g}", "values": [value]} for value in (1.0, 2.0, 3.0)]
    groups, runs = [], []
    for variant, more in (("main", 0.0), ("other", 4.0)):
        for number, case in enumerate(cases):
            worst = 10.0 * case["values"][0] + more
            held = worst <= 25.0
            cell = {"rank": [float(held), float(held), 100.0 - worst]}
            groups.append({"variant": variant, "case": number, "runs": [len(runs)], "cells": [cell]})
            runs.append({"variant": variant, "values": case["values"], "findings": [{"worst": worst, "held": held}]})
    return {"requirements": [requirement], "axes": ["bias (m)"], "cases": cases, "groups": groups, "runs": runs}


def marks(axis, look: str) -> list[tuple[float, float]]:
    lines = [line for line in axis.lines if line.get_marker() == look]
    return [(float(x), float(y)) for line in lines for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)]


def test_each_run_is_a_mark_in_the_strip_of_its_combination_the_worst_on_top(drawing):
    (found,) = spread(tale())
    assert found.title == "R: a.horizontal_error of 6 runs at its worst time, 2 not as asked"
    (axis,) = drawing[0].axes
    labels = [text.get_text() for text in axis.get_yticklabels()]
    assert labels == ["other, c3", "main, c3", "other, c2", "main, c2", "other, c1", "main, c1"]
    assert sorted(marks(axis, "x")) == [(30.0, 1.0), (34.0, 0.0)]
    assert sorted(marks(axis, "o")) == [(10.0, 5.0), (14.0, 4.0), (20.0, 3.0), (24.0, 2.0)]
    assert [25.0, 25.0] in [list(line.get_xdata()) for line in axis.lines]


def test_along_an_axis_each_run_stands_at_its_value(drawing):
    (found,) = sweeps(tale())
    assert found.title == "R along bias (m): not as asked from 3 to 3, as asked from 1 to 2"
    (axis,) = drawing[0].axes
    assert sorted(marks(axis, "o")) == [(0.875, 10), (1.125, 14), (1.875, 20), (2.125, 24)]
    assert sorted(marks(axis, "x")) == [(2.875, 30.0), (3.125, 34.0)]
    colours = {line.get_color() for line in axis.lines if line.get_marker() == "x" and len(line.get_xdata())}
    assert len(colours) == 2


def test_groups_stand_side_by_side_and_nearer_to_their_value_than_to_another():
    places = np.array([1.0, 10.0, 1000.0])
    for logarithmic, to in ((False, np.asarray), (True, np.log)):
        for share in (-0.5, 0.0, 0.5):
            moved = to(along.beside(places, places, share, logarithmic)) - to(places)
            assert moved == pytest.approx(share * 0.5 * np.diff(to(places)).min())
    assert list(along.beside(places[:1], places[:1], 0.5, False)) == [1.0]


def test_strips_of_cases_that_axes_made_are_named_by_their_values(drawing):
    """Long names lose their middle, and with it what tells them apart."""
    story = tale()
    for case in story["cases"]:
        case["name"] = f"bias (onset of the bias=10 min, height={case['values'][0]:g} m)"
    list(spread(story))
    labels = [text.get_text() for text in drawing[0].axes[0].get_yticklabels()]
    assert labels[:2] == ["other, bias (10 min, 3 m)", "main, bias (10 min, 3 m)"]


def test_what_does_not_vary_or_is_no_number_has_no_picture(drawing):
    story = tale()
    for run in story["runs"]:
        run["values"] = ["text"]
    assert list(sweeps(story)) == []
    for run in story["runs"]:
        run["values"] = [2.0]
    assert list(sweeps(story)) == [] and not drawing


def test_runs_whose_worst_value_is_no_number_are_counted_though_they_have_no_mark(drawing):
    """They are the worst of all: a picture that leaves them out in silence looks better than it is."""
    story = tale()
    for run in story["runs"][:2]:
        run["findings"][0] |= {"worst": None, "held": False}
    (found,) = spread(story)
    assert found.title == "R: a.horizontal_error of 6 runs at its worst time, 4 not as asked"
    assert found.caption.endswith(" 2 of the 6 runs have no mark: their worst value is no number.")
    assert len(marks(drawing[0].axes[0], "o")) == 2
    (found,) = sweeps(story)
    assert found.title == "R along bias (m): not as asked from 1 to 3, as asked from 1 to 2"
    assert found.caption.startswith("6 runs, ") and "2 of the 6 runs have no mark" in found.caption
    for run in story["runs"]:
        run["findings"][0]["worst"] = None
    assert list(spread(story)) == [] and list(sweeps(story)) == []


def test_no_run_is_crossed_out_where_a_percentile_of_all_is_asked(drawing):
    """Half of the runs may be beyond the bound: none of them is wrong."""
    story = tale()
    story["requirements"][0]["quantile"] = 0.5
    for run in story["runs"]:
        run["findings"][0]["held"] = None
    (found,) = spread(story)
    assert found.title == "R: a.horizontal_error of 6 runs at its worst time, asked of a percentile of the runs"
    assert len(marks(drawing[0].axes[0], "o")) == 6 and not marks(drawing[0].axes[0], "x")
    assert "cross" not in found.caption
    (found,) = sweeps(story)
    assert found.title == "R along bias (m): asked of a percentile of the runs" and "cross" not in found.caption
    assert len(marks(drawing[1].axes[0], "o")) == 6


def test_false_and_true_are_not_spread(drawing):
    story = tale()
    story["requirements"][0] |= {"unit": "1", "bounds": [1.0, None]}
    for run in story["runs"]:
        run["findings"][0]["worst"] = float(run["findings"][0]["held"])
    assert list(spread(story)) == [] and list(sweeps(story)) == []


@pytest.mark.parametrize(
    ("values", "logarithmic"), [([1, 10], False), ([1, 1000], True), ([-1, 1000], False), ([], False)]
)
def test_only_numbers_that_are_far_apart_get_a_logarithmic_axis(values, logarithmic):
    assert strips.scaled(np.array(values, float)) == logarithmic
