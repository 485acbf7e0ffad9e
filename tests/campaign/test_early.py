"""Runs that an FMU ends early: what was not reached is not certified, and nothing falls over runs of unequal length."""

from __future__ import annotations

import html
from pathlib import Path

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.outcome import Outcome, judge_quantile
from navfmu.campaign.show import show
from navfmu.cli.main import main
from navfmu.ssp.writer import SystemSource
from tests.campaign.test_campaign import judge, requirement
from tests.foreign.stepper import write

HEAD = """
system = "{system}"
seeds = "{seeds}"
stop = 10.0
step = 0.1

[parameters]
stepper.u = 1.0
"""
REQUIREMENT = '\n[[requirement]]\nid = "R"\nsignal = "stepper.x"\nat_most = 5.0\n'
STATISTIC = """[[statistic]]
kind = "radial"
error = "stepper.x"
axes = [
    { error = "stepper.x", sigma = "stepper.fixed", name = "a" },
    { error = "stepper.direct", sigma = "stepper.fixed", name = "b" },
]

[[picture]]
kind = "sigma"
axes = [{ error = "stepper.x", sigma = "stepper.fixed", name = "a" }]

[[picture]]
kind = "lines"
signals = ["stepper.x"]
"""
TIME = np.arange(11.0)


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))


def flown(
    folder: Path, *more: str, ends_at: float = 1e9, spread: float = 0.0, seeds: str = "1-2", faults: str = ""
) -> Outcome:
    """A campaign of one FMU that ends the runs at ``ends_at`` + ``spread`` * seed (s)."""
    (folder / "f.toml").write_text(faults)
    more = (*more, '\n[[case]]\nname = "faults"\nfaults = "f.toml"\n' if faults else "")
    source = SystemSource("early", fmus=folder, stop_time=10.0, step=0.1)
    write(folder / "stepper.fmu")
    (folder / "report.toml").write_text(STATISTIC)
    source.component("stepper", "stepper.fmu").attach("report.toml", folder / "report.toml")
    text = HEAD.format(system=source.pack(folder / "early.ssp").name, seeds=seeds)
    text += f"stepper.ends_at = {ends_at}\nstepper.spread = {spread}\n" + "".join(more)
    (folder / "c.toml").write_text(text)
    return run_campaign(load_campaign(folder / "c.toml"), folder / "out", workers="thread")


def test_a_requirement_whose_time_was_not_reached_is_not_held(tmp_path):
    outcome = flown(tmp_path, REQUIREMENT, ends_at=2.0)
    (cell,) = outcome.cells
    assert not cell.passed and not outcome.passed and cell.held == 0
    assert cell.sentence == (
        "held in 0 of 2 runs; worst: seed 1, 2 at t = 2 s, inside for 20.7 % of the time; "
        "2 ended before all points were reached"
    )
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv")
    assert rows.missing.tolist() == [80, 80] and rows.worst.max() == pytest.approx(2.0)


def test_a_requirement_whose_time_was_over_holds(tmp_path):
    outcome = flown(tmp_path, REQUIREMENT, "to = 2.0\n", ends_at=2.0)
    assert outcome.passed and outcome.cells[0].held == 2


@pytest.mark.parametrize("how", ["percent = 90", 'expect = "violated"', "quantile = 0.5"])
def test_a_time_of_which_no_point_was_reached_is_answered(tmp_path, how):
    outcome = flown(tmp_path, REQUIREMENT, "from = 4.0\n", how, ends_at=2.0)
    (cell,) = outcome.cells
    assert not cell.passed and cell.held == 0 and "2 ended before all points were reached" in cell.sentence
    assert "nan" not in cell.sentence


def test_what_is_missing_speaks_against_the_requirement_either_way():
    held = judge(requirement(most=20.0, percent=60.0), TIME, np.zeros(7))
    assert held.held and held.percent == pytest.approx(700 / 11) and held.missing == 4
    assert not judge(requirement(most=20.0, percent=65.0), TIME, np.zeros(7)).held
    assert judge(requirement(most=20.0, expect_violated=True), TIME, np.zeros(7)).held  # it was not violated
    broken = judge(requirement(most=5.0, expect_violated=True), TIME, np.array([0.0, 6.0]))
    assert not broken.held and broken.first_violation == 1.0


@pytest.mark.parametrize("kind", ["detects", "recovers"])
@pytest.mark.parametrize("expect", ["held", "violated"])
def test_what_is_missing_after_a_fault_speaks_against_the_requirement_either_way(tmp_path, kind, expect):
    """The run ends at 5 s, 2 or 3 s after what it counts from. Wrong: that nobody noticed by then, although there was
    more time for it, is the violation that is expected."""
    fault = '[[fault]]\nid = "x"\ntarget = "stepper.x"\ntype = "bias"\nvalue = 1.0\nstart = 2.0\nduration = 1.0\n'
    entry = f'\n[[requirement]]\nid = "R-{{0}}"\n{kind} = "time > 8"\nwithin = {{0}}\nexpect = "{expect}"\n'
    outcome = flown(tmp_path, entry.format(4.0), entry.format(1.0), seeds="1", ends_at=5.0, faults=fault)
    open_, broken = outcome.cells
    assert not open_.passed and broken.passed is (expect == "violated")
    after = "noticed" if kind == "detects" else "recovered"
    assert f"not {after} before the early end" in open_.sentence and "nan" not in open_.sentence


def test_a_run_without_a_number_is_outside_of_a_quantile_and_the_others_are_not():
    values = np.array([[0.0], [0.0], [np.nan]])
    for bound in ({"most": 1.0}, {"least": -1.0}):
        assert judge_quantile(requirement(**bound, quantile=0.5, percent=None), TIME[:1], values).passed
        found = judge_quantile(requirement(**bound, quantile=0.9, percent=None), TIME[:1], values)
        assert not found.passed and "of 3 runs is no number at t = 0 s, where 2 of 3 runs are inside" in found.sentence


def test_runs_of_unequal_length_are_judged_counted_and_drawn(tmp_path):
    """Seeds 1, 2, 3 end at 5, 6 and 7 s."""
    outcome = flown(tmp_path, REQUIREMENT, "quantile = 0.3\nto = 6.5\n", ends_at=4.0, spread=1.0, seeds="1-3")
    (cell,) = outcome.cells
    assert "2 ended before all points were reached" in cell.sentence
    report = (tmp_path / "out" / "report.html").read_text()
    assert "3 of 3 runs ended early, the first at t = 5 s: it counts up to there" in report
    assert "2 of 3 runs ended early: what is missing counts as beyond the limit and outside" in report
    assert report.partition('<h2 id="all-runs">')[0].count("data:image/png;base64") == 3


def test_runs_that_end_at_once_are_answered_with_a_report(tmp_path):
    outcome = flown(tmp_path, REQUIREMENT, ends_at=0.05)
    assert not outcome.passed and outcome.report.is_file()


LATE = '[[fault]]\nid = "late"\ntarget = "stepper.x"\ntype = "bias"\nvalue = 1000.0\nstart = 5.0\n'


def test_a_fault_that_an_early_end_has_left_out_is_a_finding(tmp_path, capsys):
    """Its requirement was held by all runs, none of which it was injected into."""
    outcome = flown(tmp_path, REQUIREMENT, "to = 2.0\n", ends_at=2.0, faults=LATE)
    assert not outcome.passed and not outcome.cells[0].passed and outcome.cells[0].held == 0
    assert "; in 2 a fault changed nothing, which counts as not held" in outcome.cells[0].sentence
    why = "starts at 5 s, but the run ended at 2 s"
    assert outcome.idle == {("main", "faults", "late", why): [1, 2]}
    assert outcome.notes == {"component 'stepper' ended the run at t = 2 s, before the stop time 10 s": 2}
    show(outcome)
    out = " ".join(capsys.readouterr().out.split())
    assert f"did not happen main, faults, seed 1-2: fault 'late' {why}" in out
    assert f"<td>{why}</td>" in outcome.report.read_text()
    assert set(pandas.read_csv(tmp_path / "out" / "runs.csv").idle) == {f"late {why}"}


def test_only_the_runs_in_which_a_fault_acted_count(tmp_path):
    """Seeds 1 to 4 end at 5, 6, 7 and 8 s."""
    hidden = LATE.replace("5.0", "5.5")
    outcome = flown(tmp_path, REQUIREMENT, "to = 2.0\nruns = 75\n", ends_at=4.0, spread=1.0, seeds="1-4", faults=hidden)
    assert outcome.cells[0].passed and outcome.cells[0].held == 3 and not outcome.passed


@pytest.mark.parametrize("how", ["", "quantile = 0.5\n", 'expect = "violated"\n'])
def test_a_fault_that_others_hide_certifies_nothing(tmp_path, how):
    faults = LATE + "duration = 2.0\n\n" + LATE.replace("late", "stuck").replace('"bias"\nvalue = 1000.0', '"stuck"')
    outcome = flown(tmp_path, REQUIREMENT, how, faults=faults)
    assert not outcome.passed and not outcome.cells[0].passed
    ((_, _, fault, why),) = outcome.idle
    assert fault == "late" and why.startswith("changed nothing: without it every value that was recorded")


def test_a_single_run_notes_the_fault_that_it_did_not_come_to(tmp_path):
    write(tmp_path / "stepper.fmu")
    (tmp_path / "f.toml").write_text(LATE)
    words = [
        *("run", str(tmp_path / "stepper.fmu"), "--stop", "20", "--step", "0.1", "--set", "stepper.ends_at=2"),
        *("--faults", str(tmp_path / "f.toml"), "--report", str(tmp_path / "r")),
    ]
    for engine in ("compiled", "reference"):
        result = CliRunner().invoke(main, [*words, "--engine", engine])
        note = "fault 'late' starts at 5 s, but the run ended at 2 s"
        assert result.exit_code == 0 and note in " ".join(result.stderr.split())
        assert note in html.unescape((tmp_path / "r" / "report.html").read_text())
