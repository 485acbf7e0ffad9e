"""Requirements on when a fault is noticed, and when it is recovered from, against closed forms.

The six lags of the ring stand at 1 m; a fault adds 1 m to one of their outputs.
"""

from __future__ import annotations

import json
import math
import re

import pandas
import pytest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.requirement import wilson
from navfmu.campaign.show import show
from navfmu.errors import NavfmuError
from tests.components import systems

HEAD = 'system = "{system}"\nstop = {stop}\nstep = 0.1\nrecord_period = 0.1\nseeds = "{seeds}"\n'
FAULT = '[[fault]]\nid = "{id}"\ntarget = "m0.y"\ntype = "bias"\nvalue = 1.0\n{more}\n'


def flown(folder, faults, *entries, stop=10.0, seeds="1"):
    (folder / "f.toml").write_text("\n".join(FAULT.format(id=id, more=more) for id, more in faults.items()))
    text = HEAD.format(system=systems.ring(), stop=stop, seeds=seeds)
    text += '[[case]]\nname = "nominal"\n[[case]]\nname = "failed"\nfaults = "f.toml"\n'
    for number, entry in enumerate(entries):
        text += f'\n[[requirement]]\nid = "R-{number}"\n{entry}\n'
    (folder / "c.toml").write_text(text)
    return run_campaign(load_campaign(folder / "c.toml"), folder / "out", workers="thread")


def cells(outcome):
    return {cell.requirement.id: cell for cell in outcome.cells if cell.case == "failed"}


def finding(outcome, name):
    (judged,) = outcome.of("main", "failed")
    return judged.findings.get(name)


def test_a_fault_is_noticed_in_time_or_not(tmp_path):
    """From 2 s on m0.y is 1 m too great, which is seen at once."""
    outcome = flown(
        tmp_path,
        {"x": "start = 2.0\nduration = 3.0"},
        'detects = "m0.y > 1.5 m"\nwithin = 0.0',
        'detects = "time >= 3.25 s"\nwithin = "1.3 s"',
        'detects = "time >= 3.25 s"\nwithin = "1.2 s"',
        'detects = "m0.y > 3 m"\nwithin = "1 s"\nfault = "x"',
        'detects = "m0.y > 3 m"\nwithin = "1 s"\nexpect = "violated"',
    )
    assert {cell.case for cell in outcome.cells} == {"failed"}  # where nothing fails, nothing can be noticed
    found = [finding(outcome, f"R-{number}") for number in range(5)]
    assert [f.held for f in found] == [True, True, False, False, False]
    assert [f.worst for f in found[:3]] == pytest.approx([0.0, 1.3, 1.3]) and math.isnan(found[3].worst)
    assert [f.worst_time for f in found[:3]] == pytest.approx([2.0, 3.3, 3.3])
    assert found[2].first_violation == pytest.approx(3.2)
    told = {name: cell.sentence for name, cell in cells(outcome).items()}
    assert told["R-1"] == "held in 1 of 1 runs; worst: seed 1, after 1.3 s"
    assert told["R-2"] == "held in 0 of 1 runs; worst: seed 1, after 1.3 s, first violated at t = 3.2 s"
    assert told["R-3"] == "held in 0 of 1 runs; worst: seed 1, never noticed, first violated at t = 3 s"
    assert [cell.passed for cell in cells(outcome).values()] == [True, True, False, False, True]
    assert cells(outcome)["R-1"].requirement.sentence == "the first fault noticed within 1.3 s: time >= 3.25 s"
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv").query("case == 'failed'")
    assert rows.first_onset.tolist() == [2.0] * 5
    assert rows.latency.tolist()[2:] == pytest.approx([1.2, 1.0, 1.0]) and rows.latency[:3].isna().any()


def test_what_is_allowed_violates_nothing(tmp_path):
    """Wrong: a mark "first violated", and a latency, of a requirement that the run is told to hold."""
    outcome = flown(
        tmp_path,
        {"x": "start = 2.0\nduration = 0.5"},
        'events = "m0.y > 1.5 m"\nat_most = 1',
        'signal = "m0.y"\nat_most = "1.5 m"\npercent = 90',
        'signal = "m0.y"\nat_most = "1.5 m"\npercent = 99',
    )
    assert [finding(outcome, f"R-{number}").held for number in range(3)] == [True, True, False]
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv").query("case == 'failed'")
    assert rows.latency.isna().tolist() == [True, True, False] and rows.first_violation.tolist() == [2.0] * 3
    story = re.search(r'<script[^>]*id="story"[^>]*>(.*?)</script>', outcome.report.read_text(), re.DOTALL)[1]
    (run,) = [run for run in json.loads(story)["runs"] if run["case"] == "failed"]
    assert [found["first"] for found in run["findings"]] == [None, None, 2.0]
    assert [event[1:] for event in run["events"] if event[0] == "violation"] == [["R-2", 2.0]]


def test_it_is_recovered_from_in_time_or_not(tmp_path):
    """It is over at 5 s. The ring feeds back what has happened: how long m1.y is beyond a bound, the recording says."""
    faults, asked = {"x": "start = 2.0\nduration = 3.0"}, 'signal = "m1.y"\nat_most = 100'
    outcome = flown(tmp_path, faults, asked)
    series = outcome.series(outcome.of("main", "failed")[0], ["m1.y"])
    bound = (series["m1.y"][50] + series["m1.y"][-1]) / 2
    k = round(10 * series["time"][series["m1.y"] > bound][-1]) + 1 - 50
    assert 2 < k < 45
    outcome = flown(
        tmp_path,
        faults,
        f'recovers = "m1.y <= {bound} m"\nwithin = {k / 10}',
        f'recovers = "m1.y <= {bound} m"\nwithin = {(k - 1) / 10}\nfault = "x"',
        'recovers = "m1.y <= 0.5 m"\nwithin = 2.0',
        'recovers = "true"\nwithin = 0.0',
        'recovers = "time < 9.75 s"\nwithin = 2.0',
    )
    found = [finding(outcome, f"R-{number}") for number in range(5)]
    assert [f.held for f in found] == [True, False, False, True, False]
    assert found[0].worst == found[1].worst == k / 10 and found[3].worst == 0.0
    assert math.isnan(found[2].worst) and math.isnan(found[4].worst)
    told = {name: cell.sentence for name, cell in cells(outcome).items()}
    assert told["R-2"] == "held in 0 of 1 runs; worst: seed 1, never recovered, violated at t = 7 s"
    sentence = cells(outcome)["R-2"].requirement.sentence
    assert sentence == "m1.y <= 0.5 m within 2 s of the end of all faults, and from then on"


def test_what_a_run_was_too_short_to_show_is_not_asked(tmp_path, capsys):
    """The run has its end 1 s after the onset: what is not noticed then may be so within 2 s."""
    outcome = flown(
        tmp_path,
        {"x": "start = 9.0"},
        'detects = "m0.y > 3 m"\nwithin = 2.0',
        'detects = "m0.y > 1.5 m"\nwithin = 2.0',
        'recovers = "m0.y > 1.5 m"\nwithin = 2.0',
        seeds="1-2",
    )
    found = cells(outcome)
    assert (found["R-0"].total, found["R-0"].passed) == (0, False)
    assert found["R-0"].sentence.startswith("held in 0 of 0 runs; in 2 it could not be asked")
    assert [found[f"R-{number}"].verdict for number in range(3)] == ["no answer", "holds", "no answer"]  # not: violated
    words = "0 of 3 requirements, each asked of a variant in a case, are violated; 2 could be asked in no run; 1 hold"
    assert words in outcome.report.read_text() and "(1 variant x 2 cases x 2 seeds)" in outcome.report.read_text()
    assert pandas.read_csv(tmp_path / "out" / "verdicts.csv").verdict.tolist() == ["no answer", "holds", "no answer"]
    show(outcome)
    printed = capsys.readouterr().out
    assert "NO ANSWER 0/0" in printed and "no answer R-0, main, failed" in printed and "VIOLATED" not in printed
    assert (found["R-1"].total, found["R-1"].held) == (2, 2)
    assert found["R-2"].total == 0 and not outcome.passed  # it does not end


def test_runs_in_which_a_fault_does_not_come_are_not_counted(tmp_path):
    """At random it comes in some of the runs only."""
    outcome = flown(tmp_path, {"x": 'mttf = "20 s"'}, 'detects = "m0.y > 1.5 m"\nwithin = 0.0', seeds="1-12", stop=10.0)
    came = sum(bool(judged.answer.acted["x"]) for judged in outcome.of("main", "failed"))
    cell = cells(outcome)["R-0"]
    assert 0 < came < 12 and (cell.held, cell.total) == (came, came)
    assert (
        cell.sentence.startswith(f"held in {came} of {came} runs; ")
        and f"in {12 - came} it could not be asked" in cell.sentence
    )


def test_what_only_some_runs_could_be_asked_is_as_sure_as_those_are_many(tmp_path):
    """Wrong: 3 of 3 with the confidence of 12 of 12, as the seeds are so many."""
    outcome = flown(tmp_path, {"x": 'mttf = "20 s"'}, 'detects = "m0.y > 1.5 m"\nwithin = 0.0', seeds="1-12", stop=10.0)
    cell = cells(outcome)["R-0"]
    assert cell.distinct == cell.total < 12 and cell.interval == wilson(cell.held, cell.total)


def several(folder, *entries, stop=20.0):
    """Over at 2 and at 15 s."""
    return flown(folder, {"a": "start = 1.0\nduration = 1.0", "b": "start = 14.0\nduration = 1.0"}, *entries, stop=stop)


def test_of_several_ends_each_counts(tmp_path):
    """Wrong: the violation after the first end is forgotten as the run ends soon after the second one, or told as if
    it had come after that; an end after which the fault came again in time is one from which it was recovered."""
    outcome = several(
        tmp_path,
        'recovers = "time >= 7 s"\nwithin = 4.0',
        'recovers = "5 s <= time < 14 s"\nwithin = 6.0',  # not again in the 5 s before the end of the run
        'recovers = "5 s <= time < 14 s"\nwithin = 2.0',
        'recovers = "time >= 18.05 s"\nwithin = 12.0',  # the fault comes again before that
        'recovers = "time >= 18.05 s"\nwithin = 11.0',
        'recovers = "time < 14 s or time >= 18.05 s"\nwithin = 3.0',
        'recovers = "time >= 18.05 s and not time >= 19 s"\nwithin = 12.5',
    )
    found = [finding(outcome, f"R-{number}") for number in range(7)]
    assert [f and f.held for f in found] == [False, None, False, True, False, False, None]
    assert [f and f.first_violation for f in found] == pytest.approx([6.0, None, 17.0, None, 13.0, 18.0, None])
    assert [f.worst for f in (found[0], found[3], found[5])] == pytest.approx([5.0, 3.1, 3.1])
    assert math.isnan(found[2].worst) and math.isnan(found[4].worst)
    assert found[0].worst_time == pytest.approx(7.0) and found[3].worst_time == pytest.approx(18.1)
    sentence = cells(outcome)["R-0"].sentence
    assert sentence == "held in 0 of 1 runs; worst: seed 1, after 5 s, violated at t = 6 s"


def test_a_search_says_of_which_runs_nothing_is_known(tmp_path):
    """A fault of 3 s in a run of 10 s has its end, and 1 s more, if it begins at 6 s or before; recovered from it is
    always. Wrong: a bracket, and not a word on what it stands on."""
    axis = '[[axis]]\nvary = "fault.x.start"\nlow = 1.0\nhigh = 9.0\nsearch = "R-0"\ntolerance = 0.5'
    faults = {"x": "start = 2.0\nduration = 3.0"}
    outcome = flown(tmp_path, faults, f'recovers = "true"\nwithin = 1.0\n\n{axis}\n')
    (threshold,) = outcome.thresholds
    silent = sum(not probe.findings for probe in threshold.probes)
    assert silent > 0 and threshold.sentence.endswith(
        f"; in {silent} of its {len(threshold.probes)} runs it could not be asked, which counts as violated"
    )


def test_where_a_fault_always_comes_again_nothing_is_known(tmp_path):
    """It pauses for 1 s at a time. Wrong: recovered from, after 1 s."""
    loose = {"x": "start = 1.0\non = 1.0\noff = 1.0"}
    outcome = flown(tmp_path, loose, 'recovers = "false"\nwithin = 2.0', 'recovers = "false"\nwithin = 0.5', stop=9.5)
    assert finding(outcome, "R-0") is None and finding(outcome, "R-1").held is False
    assert finding(outcome, "R-1").first_violation == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ('detects = "m0.y > 3 m"', "line 14: 'detects' needs 'within' beside it: how long it may take"),
        ('detects = "m0.y > 3 m"\nwithin = -1', "'within' is -1.0, expected a time in s, 0 or more"),
        ('detects = "m0.y"\nwithin = 1', "character 1: expected a truth value"),
        ('detects = "m0.y > 3 m"\nwithin = 1\nfault = "y"', "there is no fault 'y' (faults: x)"),
        ('detects = "m0.y > 3 m"\nwithin = 1\nfrom = 3', "'from' does not go with 'detects', of which 'within' says"),
        ('detects = "m0.y > 3 m"\nwithin = 1\nat_most = 3', "'at_most' does not go with 'detects'"),
        ('recovers = "m0.y > 3 m"\nwithin = 1\npercent = 95', "'percent' does not go with 'recovers'"),
        ('signal = "m0.y"\nat_most = 3\nwithin = 1', "'within' goes with 'detects' or 'recovers', not with 'signal'"),
        ('events = "m0.y > 3"\nfault = "x"', "'fault' goes with 'detects' or 'recovers', not with 'events'"),
        ('detects = "m0.y > 3"\nevents = "m0.y > 3"\nwithin = 1', "expected one of 'signal', 'events', 'detects', 're"),
        ('detcts = "m0.y > 3"', "unknown entry 'detcts'; did you mean 'detects'?"),
    ],
)
def test_entries_that_do_not_fit_are_told(tmp_path, entry, sentence):
    with pytest.raises(NavfmuError) as caught:
        flown(tmp_path, {"x": "start = 2.0"}, entry)
    assert sentence in str(caught.value)
