"""What a campaign says of itself: seeds that change nothing, time that nothing judges, shares that are none."""

from __future__ import annotations

from pathlib import Path

import pandas
import pytest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.finding import enough
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.requirement import wilson
from navfmu.errors import NavfmuError
from tests.components import systems

REQUIREMENT = '\n[[requirement]]\nid = "R"\nsignal = "{signal}"\nat_most = 100.0\n'
SEEDS = "the seed changes nothing: no component takes it and no fault is random; all seeds are one run"
NOISE = 'type = "noise"\nsigma = 0.1\nperiod = 0.1\n'
FAULT = '[[fault]]\nid = "n"\ntarget = "m0.y"\n'


def flown(folder: Path, system: Path, head: str = "", more: str = "", signal: str = "m0.y") -> Outcome:
    text = f'system = "{system}"\nstop = 1.0\nstep = 0.1\n{head}{REQUIREMENT.format(signal=signal)}{more}'
    (folder / "c.toml").write_text(text)
    return run_campaign(load_campaign(folder / "c.toml"), folder / "out", workers="thread")


def test_seeds_that_change_nothing_are_said(tmp_path):
    """Twenty times the same run once held "20/20" without a word."""
    (tmp_path / "n.toml").write_text(FAULT + NOISE)
    cases = '\n[[case]]\nname = "quiet"\n\n[[case]]\nname = "noisy"\nfaults = "n.toml"\n'
    outcome = flown(tmp_path, systems.ring(), 'seeds = "1-3"\n', cases)
    assert outcome.passed and outcome.remarks == {SEEDS: 3}
    assert f"{SEEDS} (in 3 of 6 runs)" in outcome.report.read_text()
    table = pandas.read_csv(tmp_path / "out" / "runs.csv", keep_default_na=False)
    assert [SEEDS in notes for notes in table["notes"]] == (table["case"] == "quiet").tolist()
    quiet, noisy = outcome.cells
    assert (quiet.held, quiet.total, quiet.interval) == (3, 3, wilson(1, 1))
    assert noisy.interval == wilson(3, 3)
    assert "held in 3 of 3 runs" in quiet.sentence and "all are one run, and the interval" in quiet.sentence
    assert "one run" not in noisy.sentence


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (NOISE, 0),
        ('type = "garbage"\nlow = 0.0\nhigh = 1.0\nperiod = 0.1\n', 0),
        ('type = "delay"\ndelay = 0.1\njitter = 0.3\n', 0),
        ('type = "bias"\nvalue = 1.0\nmttf = 0.1\n', 0),
        ('type = "delay"\ndelay = 0.1\nperiod = 0.3\n', 2),
        ('type = "bias"\nvalue = 1.0\non = 0.1\noff = 0.1\n', 2),
    ],
)
def test_seeds_of_random_faults_are_not_talked_down_and_no_others_are_talked_up(tmp_path, fault, said):
    """What is said is what the recordings show."""
    (tmp_path / "n.toml").write_text(FAULT + fault)
    head = 'seeds = "1-2"\n[parameters]\nm0.y0 = 0.0\n'
    outcome = flown(tmp_path, systems.ring(), head, '\n[[case]]\nname = "c"\nfaults = "n.toml"\n')
    assert outcome.remarks.get(SEEDS, 0) == said
    first, second = (pandas.read_parquet(judged.run.recording(tmp_path / "out")) for judged in outcome.runs)
    assert first.equals(second) == bool(said)


@pytest.mark.parametrize(("seeds", "own", "said"), [("1-2", "", 0), ("1", "", 0), ("1-2", '"sensor.seed" = 3\n', 2)])
def test_seeds_that_a_component_takes_are_not_talked_down(tmp_path, seeds, own, said):
    head = f'seeds = "{seeds}"\n[parameters]\n{own}'
    outcome = flown(tmp_path, systems.tracker(), head, signal="estimator.solution.length")
    assert outcome.notes.get(SEEDS, 0) == said


@pytest.mark.parametrize(
    ("period", "more", "said"),
    [
        (0.3, "", "R: judged up to t = 0.9 s only, the last recorded point before the end at 1 s"),
        (0.3, "to = 0.9\n", ""),
        (0.5, "", ""),
    ],
)
def test_time_after_the_last_recorded_point_is_not_judged_in_silence(tmp_path, period, more, said):
    """A quantile is asked of the recordings; all else at every communication point."""
    assert not flown(tmp_path, systems.ring(), f"record_period = {period}\n", more).remarks
    outcome = flown(tmp_path, systems.ring(), f"record_period = {period}\n", f"quantile = 0.5\n{more}")
    assert outcome.remarks == ({f"{said} (the recording period is 0.3 s)": 1} if said else {})
    assert (said in (tmp_path / "out" / "runs.csv").read_text()) and bool(outcome.runs[0].remarks) == bool(said)


def test_runs_beside_a_quantile_are_refused(tmp_path):
    with pytest.raises(NavfmuError, match=r"line 10: 'runs' goes with 'percent', not with 'quantile'"):
        flown(tmp_path, systems.ring(), more="quantile = 0.5\nruns = 50\n")


def test_no_run_is_never_enough(tmp_path):
    """The rounding that was allowed was as large as the share."""
    outcome = flown(tmp_path, systems.ring(), more='expect = "violated"\nruns = 1e-9\n')
    assert not outcome.passed and outcome.cells[0].held == 0
    outcome = flown(tmp_path, systems.ring(), more="percent = 1e-9\nat_least = 50.0\n")
    assert not outcome.passed and outcome.runs[0].findings["R"].percent == 0.0
    for total in range(1, 200):
        for held in range(1, total + 1):
            assert enough(100.0 * held / total, 100 * (held / total))
            assert not enough(100.0 * (held - 1) / total, 100 * (held / total))
