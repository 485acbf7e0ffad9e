"""A sweep in terminals of several widths, and its report."""

from __future__ import annotations

import json
import re

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.export import Component, Output, Parameter, every
from navfmu.export.build import build
from navfmu.sweep import report
from navfmu.sweep.report import caption, page, picture, table, write_report
from navfmu.sweep.result import Row
from navfmu.sweep.show import show
from navfmu.sweep.sweep import sweep
from tests.components import systems
from tests.sweep.made import CLEAN, counted, made


@pytest.fixture(scope="module")
def result():
    tracker = System.load(systems.tracker())
    steps = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
    return sweep(tracker.experiment(record=["lag", "estimator", "sensor.reading"], seed=2, stop=10.0), steps)


@pytest.mark.parametrize("width", [40, 60, 80, 160])
def test_every_number_is_whole_at_every_width(result, width, monkeypatch, capsys):
    """Columns once were cut with an ellipsis: "gauss_sei…"."""
    monkeypatch.setenv("COLUMNS", str(width))
    show(result, None)
    out = capsys.readouterr().out
    words = out.split()
    for row in result.rows:
        assert row.step == result.steps[0] or f"{row.rms:.3g}" in words
    for counts in result.lost.values():
        assert all(str(count) in words for count in counts.values())
    for signal in result.signals:
        assert f"{result.apart[signal]:.3g}" in words
        for algorithm in ("gauss_seidel", "jacobi"):
            order = result.order(algorithm, signal)
            assert order is None or str(order) in out
    assert "gauss_seidel" in words and "…" not in out
    assert max(map(len, out.splitlines())) <= width


def test_the_report_names_what_cannot_be_compared(tmp_path):
    problem = "is not finite at 2 of 3 points"
    result = made([0.0, 0.05, problem], idle=("gps.fix.latitude",), not_real=("navigator.mode",), notes=("a note",))
    told = write_report(result, tmp_path).read_text()
    assert f"a.y {problem} (gauss_seidel, 0.4 s)" in told and "gps.fix.latitude" in told and "a note" in told
    assert "because not Real: navigator.mode." in told
    assert told.count(problem) >= 3  # recommendation, list, table
    about = json.loads((tmp_path / "sweep.json").read_text(), parse_constant=pytest.fail)
    assert about["errors"][2]["rms_error"] is None and about["errors"][2]["problem"] == problem
    rows = pandas.read_csv(tmp_path / "sweep.csv")
    assert rows.problem.tolist().count(problem) == 1 and rows.rms_error.isna().sum() == 1


def test_the_report_tells_exact_orders_from_fitted_ones():
    rows = table(made())
    assert rows[0]["order_points"] == 2 and rows[0]["order_deviation"] is None
    assert "(exact)" in page(made(), b"").html()


def test_the_caption_counts_what_is_drawn():
    assert "all signals with an error are drawn" in caption(made())
    one = made()
    rows = [Row(r.algorithm, r.step, f"a.y[{i}]", r.unit, r.rms, r.largest, r.span) for i in range(9) for r in one.rows]
    many = one.__class__(**{**vars(one), "rows": tuple(rows)})
    assert "the 6 of 9 signals that err most are drawn" in caption(many)


def test_the_caption_says_which_panel_leaves_a_signal_out():
    assert "Gauss-Seidel has no error to draw in a.y." in caption(made([0.0] * 3, CLEAN))
    assert "no error to draw" not in caption(made())


def test_signals_with_the_same_errors_are_all_seen(monkeypatch):
    """The single points of two signals lay on each other; the legend named one that nobody could see."""
    one = made([0.0, 0.02], steps=(0.1, 0.2), jacobi=[0.0, 0.0])
    rows = [Row(r.algorithm, r.step, f"a.y[{i}]", r.unit, r.rms, r.largest, r.span) for i in range(6) for r in one.rows]
    seen = []
    monkeypatch.setattr(report, "png", lambda drawing: seen.extend(drawing.axes[0].get_lines()) or b"")
    picture(one.__class__(**{**vars(one), "rows": tuple(rows)}))
    points = [line for line in seen if line.get_marker() == "o"]
    assert len(points) == 6 and len({line.get_markersize() for line in points}) == 6
    assert sorted(points, key=lambda line: -line.get_markersize()) == points  # the smaller above the greater


def test_a_picture_without_errors_says_so():
    assert picture(made([0.0] * 3, [0.0] * 3)) != picture(made([0.0] * 3, CLEAN))


def test_lost_samples_of_the_smallest_step_are_in_table_and_text(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    show(made(lost=counted(90, 90, 200)), None)
    out = capsys.readouterr().out
    assert re.search(r"b\.fix\.lost +jacobi +90 +90 +200", out) and "no sample is lost" not in out


class Rooted(Component):
    """Is not a number after one second."""

    y = Output("m", description="square root of what remains")
    sample_period = Parameter("s", start=0.01, min=1e-3, description="period")

    @every("sample_period")
    def step(self):
        self.y = np.sqrt(1.0 - self.time)


def test_a_signal_that_ends_as_nan_is_not_recommended(tmp_path):
    (file,) = build([Rooted], tmp_path)
    run = CliRunner().invoke(main, ["sweep", str(file), "--steps", "0.1,0.2", "--stop", "2", "--out", str(tmp_path)])
    assert run.exit_code == 0, run.output
    assert "Use" not in run.output and "is not finite at 5 of 11 points" in run.output
    assert "is not finite at 5 of 11 points" in (tmp_path / "report.html").read_text()


@pytest.mark.parametrize(("seed", "words"), [(7, "seed: 7"), (None, "seed: 1, as none is given")])
def test_the_seed_is_told(seed, words, tmp_path):
    options = ["--out", str(tmp_path), *([] if seed is None else ["--seed", str(seed)])]
    out = CliRunner().invoke(main, ["sweep", str(systems.tracker()), "--stop", "2", "--steps", "0.1,0.2", *options])
    assert out.exit_code == 0 and f"2 s at 2 step sizes, gauss_seidel and jacobi, {words}\n" in out.output
    assert f"({words});" in (tmp_path / "report.html").read_text()
