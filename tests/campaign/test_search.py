"""Searches: brackets against closed forms, what they cost, going on, and what is said where nothing is found."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pandas
import pytest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.axis import Axis, Goal, Span
from navfmu.campaign.case import Case
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.search import Bracket, Search
from navfmu.errors import Interrupted, NavfmuError
from tests.components import systems

# A lag of time constant tau that samples every T: after n samples of an input b it is at b (1 - (1 - T / tau)^n).
PERIOD, STOP, START = 0.1, 5.0, 0.5
SAMPLES = 45  # a fault at 0.5 s is first seen at 0.6 s, and for the last time at 5 s
LIMIT = 2.0

LAG = f"""
system = "{{system}}"
stop = {STOP}
step = {PERIOD}
{{head}}

[parameters]
lag.tau = 2.0

[[case]]
name = "pushed"
faults = "push.toml"

[[axis]]
name = "size"
vary = "{{vary}}"
low = {{low}}
high = {{high}}
search = "R"
tolerance = {{tolerance}}
{{axis}}

[[requirement]]
id = "R"
signal = "lag.y"
at_most = {LIMIT}
{{more}}
"""


def lag(folder: Path, vary: str, low: float, high: float, tolerance: float, **more: str) -> Path:
    """A campaign file that searches for where a lag that a fault pushes exceeds its limit."""
    push = '[[fault]]\nid = "push"\ntarget = "lag.bias"\ntype = "input"\nvalue = 3.0\nstart = 0.5\n'
    (folder / "push.toml").write_text(push)
    (folder / "campaign.toml").write_text(
        LAG.format(
            system=alone(folder),
            vary=vary,
            low=low,
            high=high,
            tolerance=tolerance,
            **{name: more.get(name, "") for name in ("head", "axis", "more")},
        )
    )
    return folder / "campaign.toml"


def alone(folder: Path) -> Path:
    """A system that is one lag."""
    from navfmu.ssp.writer import SystemSource

    file = folder / "lag.ssp"
    if not file.is_file():
        SystemSource("lag", fmus=systems.fmus()).component("lag", "lag.fmu").pack(file)
    return file


def searched(file: Path, out: Path, **more: object) -> Outcome:
    return run_campaign(load_campaign(file), out, workers="thread", **more)


def share(samples: int, tau: float = 2.0) -> float:
    """Of an input that a lag has reached after so many samples."""
    return 1.0 - (1.0 - PERIOD / tau) ** samples


def check(bracket: Bracket, truth: float, tolerance: float, holds_below: bool = True) -> None:
    below, above = bracket.holds_at, bracket.violated_at
    if not holds_below:
        below, above = above, below
    assert below <= truth <= above and above - below <= tolerance


@pytest.mark.parametrize("scale", ["linear", "log"])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_the_smallest_size_that_violates_is_that_of_the_closed_form(tmp_path, scale, algorithm):
    head = f'algorithm = "{algorithm}"'
    file = lag(tmp_path, "fault.push.value", 0.5, 20.0, 1e-4, head=head, axis=f'scale = "{scale}"')
    (threshold,) = searched(file, tmp_path / "out").thresholds
    check(threshold.bracket, LIMIT / share(SAMPLES), 1e-4)
    most = threshold.sought.search.most
    assert len(threshold.probes) <= most and (scale == "log" or most == 2 + math.ceil(math.log2(19.5 / 1e-4)))


def test_the_lesser_value_may_be_the_one_that_violates(tmp_path):
    """b (1 - (1 - T/tau)^n) = limit: the slower the lag, the better."""
    tau = PERIOD / (1.0 - (1.0 - LIMIT / 3.0) ** (1.0 / SAMPLES))
    file = lag(tmp_path, "parameter.lag.tau", 0.5, 30.0, 1e-3)
    (threshold,) = searched(file, tmp_path / "out").thresholds
    check(threshold.bracket, tau, 1e-3, holds_below=False)


def test_the_latest_onset_that_violates_is_the_communication_point_of_the_closed_form(tmp_path):
    """It takes n samples to the limit; a fault that acts at t_k is seen in STOP / h - k samples."""
    needed = math.ceil(math.log(1.0 - LIMIT / 3.0) / math.log(1.0 - PERIOD / 2.0))
    assert share(needed) * 3.0 > LIMIT >= share(needed - 1) * 3.0
    file = lag(tmp_path, "fault.push.start", 0.0, 4.0, 1e-3)
    (threshold,) = searched(file, tmp_path / "out").thresholds
    check(threshold.bracket, STOP - needed * PERIOD, 1e-3, holds_below=False)


def test_what_should_be_violated_is_searched_as_well(tmp_path):
    file = lag(tmp_path, "fault.push.value", 0.5, 20.0, 0.01, more='expect = "violated"')
    (threshold,) = searched(file, tmp_path / "out").thresholds
    check(threshold.bracket, LIMIT / share(SAMPLES), 0.01, holds_below=False)


@pytest.mark.parametrize(("low", "high", "holds"), [(0.0, 1.0, True), (10.0, 20.0, False)])
def test_where_both_ends_are_alike_nothing_is_made_up(tmp_path, low, high, holds):
    outcome = searched(lag(tmp_path, "fault.push.value", low, high, 0.01), tmp_path / "out")
    (threshold,) = outcome.thresholds
    assert threshold.bracket == (Bracket(high, None) if holds else Bracket(None, low))
    assert len(threshold.probes) == 2
    words = f"{'holds' if holds else 'is violated'} at both ends, size = {low:g} and at {high:g}: nothing between"
    assert threshold.sentence.startswith(words) and words in outcome.report.read_text()
    row = pandas.read_csv(tmp_path / "out" / "thresholds.csv").loc[0]
    assert np.isnan(row.violated_at if holds else row.holds_at)


@pytest.mark.parametrize("span", [Span(0.0, 7.0), Span(-3.0, 4.0), Span(1e-4, 1e3, True), Span(5.0, 5.5, True)])
@pytest.mark.parametrize("tolerance", [10.0, 0.3, 1e-3, 1e-6])
def test_a_bracket_is_as_narrow_as_was_asked_and_its_cost_is_known_before(span, tolerance):
    """Over thresholds everywhere, also at the ends; the cost is the greatest of them all."""
    search, costs = Search(Case("c"), Axis("a", (), span, goal=Goal("R", tolerance))), []
    for u in np.linspace(0.0, 1.0, 201):
        truth, asked = span.at(u), []
        bracket = search.bracket(lambda value, truth=truth, asked=asked: asked.append(value) or value < truth)
        costs.append(len(asked))
        assert len(set(asked)) == len(asked) and all(span.low <= value <= span.high for value in asked)
        if span.low < truth <= span.high:
            assert bracket.holds_at < truth <= bracket.violated_at
            assert bracket.violated_at - bracket.holds_at <= tolerance
            assert {bracket.holds_at, bracket.violated_at} <= set(asked)  # both were seen
    assert max(costs) == search.most


def test_runs_of_a_search_are_rows_but_no_verdicts(tmp_path):
    head = 'seeds = "1-2"'
    more = '\n[[case]]\nname = "left alone"\n'
    file = lag(tmp_path, "fault.push.value", 0.0, 8.0, 1.0, head=head, more=more, axis="")
    outcome = searched(file, tmp_path / "out")
    assert outcome.passed and [cell.case for cell in outcome.cells] == ["left alone"]
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv")
    own = rows[rows["case"] != "left alone"]
    assert list(own["size"]) == [0.0, 8.0, 4.0, 2.0, 3.0] * 2 and list(own["seed"]) == [1] * 5 + [2] * 5
    assert list(own["held"]) == [size * share(SAMPLES) <= LIMIT for size in own["size"]]
    assert all(name == f"pushed (size={size:g})" for name, size in zip(own["case"], own["size"], strict=True))
    thresholds = pandas.read_csv(tmp_path / "out" / "thresholds.csv")
    assert list(thresholds["holds_at"]) == [2.0] * 2 and list(thresholds["violated_at"]) == [3.0] * 2
    about = json.loads((tmp_path / "out" / "campaign.json").read_text())
    assert about["searches"][0]["axis"] == "size" and list(about["cases"]) == ["left alone"]
    report = outcome.report.read_text()
    assert "Where requirements begin to be violated" in report and report.count("value = 8") >= 2  # repeat commands


def test_a_search_in_every_point_of_other_axes(tmp_path):
    """Threshold = limit / share(n), with n from the onset: a search that forgot the point would find one for all."""
    more = '\n[[axis]]\nname = "onset"\nvary = "fault.push.start"\nvalues = [0.5, 2.5, 4.5]\n'
    outcome = searched(lag(tmp_path, "fault.push.value", 0.0, 50.0, 1e-3, more=more), tmp_path / "out")
    assert [t.sought.search.case.name for t in outcome.thresholds] == [f"pushed (onset={t})" for t in (0.5, 2.5, 4.5)]
    for threshold, onset in zip(outcome.thresholds, (0.5, 2.5, 4.5), strict=True):
        check(threshold.bracket, LIMIT / share(round((STOP - onset) / PERIOD)), 1e-3)
    rows = pandas.read_csv(tmp_path / "out" / "thresholds.csv")
    assert list(rows["onset"]) == [0.5, 2.5, 4.5] and "size" not in rows
    cases = {probe.run.case.name for threshold in outcome.thresholds for probe in threshold.probes}
    assert "pushed (onset=2.5, size=50)" in cases


def test_the_report_has_the_range_over_the_seeds(tmp_path):
    """The sensor's noise makes the threshold of each seed another one."""
    (tmp_path / "bias.toml").write_text(
        '[[fault]]\nid = "B"\ntarget = "sensor.reading.length"\ntype = "bias"\nvalue = 1\n'
    )
    text = f'system = "{systems.tracker()}"\nseeds = "1-4"\nstop = 2.0\n[[case]]\nname = "c"\nfaults = "bias.toml"\n'
    text += '[[axis]]\nvary = "fault.B.value"\nlow = "-2 m"\nhigh = "9 m"\nsearch = "R"\ntolerance = "1 mm"\n'
    text += '[[requirement]]\nid = "R"\nsignal = "estimator.solution.length"\nat_most = 5.0\n'
    (tmp_path / "c.toml").write_text(text)
    with pytest.raises(NavfmuError, match=r"'tolerance' is '1 mm', expected it in the unit of 'low' and 'high'"):
        load_campaign(tmp_path / "c.toml")
    (tmp_path / "c.toml").write_text(text.replace("1 mm", "0.001 m"))
    outcome = searched(tmp_path / "c.toml", tmp_path / "out")
    rows = pandas.read_csv(tmp_path / "out" / "thresholds.csv")
    assert len(set(rows["holds_at"])) == 4
    cells = re.findall(r"<td[^>]*>(.*?)</td>", outcome.report.read_text())
    place = cells.index("B.value (m)")
    ranges = [f"{rows[name].min():.9g} to {rows[name].max():.9g}" for name in ("violated_at", "holds_at")]
    assert cells[place + 1 : place + 5] == ["4", "4", *ranges]
    assert "searched: B.value from -2 m to 9 m for R" in cells


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("[!.]*")) if p.is_file()}


def test_a_search_goes_on_where_it_was_interrupted_and_jobs_do_not_matter(tmp_path, monkeypatch):
    from navfmu.campaign import executor

    more = '\n[[axis]]\nname = "onset"\nvary = "fault.push.start"\nvalues = [0.5, 2.5]\n'
    file = lag(tmp_path, "fault.push.value", 0.0, 50.0, 0.1, head='seeds = "1-2"', more=more)
    whole = searched(file, tmp_path / "whole", jobs=1)
    fly, flown = executor.fly, []

    def tired(run, *rest):
        if len(flown) == 7:
            raise KeyboardInterrupt
        fly(run, *rest)
        flown.append(run.key)

    monkeypatch.setattr(executor, "fly", tired)
    with pytest.raises(Interrupted, match=r"interrupted: 7 runs of searches are finished and kept in"):
        searched(file, tmp_path / "out", jobs=1)
    monkeypatch.setattr(executor, "fly", lambda run, *rest: fly(run, *rest) or flown.append(run.key))
    run_campaign(load_campaign(file), tmp_path / "out", 2, workers="thread")
    assert len(flown) == len(set(flown)) == len(whole.every)
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")
    monkeypatch.setattr(executor, "fly", lambda *_: pytest.fail("it was flown again"))
    searched(file, tmp_path / "out")


def test_variants_that_are_alike_share_their_runs(tmp_path, monkeypatch):
    """They are one run each, also where two searches ask for it at a time."""
    import time

    from navfmu.campaign import executor
    from navfmu.ssp.writer import SystemSource

    file, fly, flown = lag(tmp_path, "fault.push.value", 0.0, 50.0, 5.0), executor.fly, []
    source = SystemSource("lag", fmus=systems.fmus()).component("lag", "lag.fmu")
    source.variant("twin", parameters={})
    source.pack(tmp_path / "lag.ssp")
    file.write_text('variants = ["main", "twin"]\n' + file.read_text())
    monkeypatch.setattr(
        executor, "fly", lambda run, *rest: flown.append(run.key) or time.sleep(0.05) or fly(run, *rest)
    )
    one, other = run_campaign(load_campaign(file), tmp_path / "out", 2, workers="thread").thresholds
    assert one.bracket == other.bracket and [probe.run.variant for probe in other.probes] == ["twin"] * 6
    assert len(flown) == len(set(flown)) == 6


def test_no_axis_takes_the_name_of_another_column(tmp_path):
    """The value of the axis would stand where the other should, or the other way round."""
    from navfmu.campaign.axes import TAKEN

    searched(lag(tmp_path, "fault.push.value", 0.0, 8.0, 1.0, more='[[case]]\nname = "left"'), tmp_path / "out")
    columns = set()
    for name in ("runs", "verdicts", "thresholds"):
        columns |= set(pandas.read_csv(tmp_path / "out" / f"{name}.csv").columns)
    assert columns == {*TAKEN, "size"}


def test_worker_processes_search_alike(tmp_path):
    file = lag(tmp_path, "fault.push.value", 0.0, 50.0, 0.5)
    run_campaign(load_campaign(file), tmp_path / "processes")
    searched(file, tmp_path / "threads")
    assert contents(tmp_path / "processes") == contents(tmp_path / "threads")


def test_another_bound_is_asked_in_new_runs(tmp_path, monkeypatch):
    from navfmu.campaign import executor

    file, fly, flown = lag(tmp_path, "fault.push.value", 0.0, 50.0, 0.5), executor.fly, []
    searched(file, tmp_path / "out")
    monkeypatch.setattr(executor, "fly", lambda run, *rest: fly(run, *rest) or flown.append(run.case.values["size"]))
    file.write_text(file.read_text().replace(f"at_most = {LIMIT}", "at_most = 20.0"))
    (threshold,) = searched(file, tmp_path / "out").thresholds
    check(threshold.bracket, 20.0 / share(SAMPLES), 0.5)
    assert len(flown) == len(threshold.probes)


def test_a_damaged_answer_of_a_search_is_said_and_flown_again(tmp_path):
    file = lag(tmp_path, "fault.push.value", 0.0, 50.0, 0.5)
    first = searched(file, tmp_path / "out")
    probe = first.thresholds[0].probes[3]
    probe.run.recording(tmp_path / "out").write_bytes(b"wreck")
    again = searched(file, tmp_path / "out")
    assert len(again.mended) == 1 and probe.run.key in again.mended[0]
    assert again.thresholds[0].bracket == first.thresholds[0].bracket


def test_a_run_that_fails_in_a_search_counts_as_violated_and_is_said(tmp_path, monkeypatch):
    from navfmu.engine.recording import RunError
    from navfmu.system.experiment import Experiment

    fly = Experiment.run

    def failing(self, *rest, **more):
        if self.faults[0].parameters["value"] > 1.3:
            raise RunError("component 'lag': it broke (fmi2DoStep returned Error at t = 3 s)")
        return fly(self, *rest, **more)

    monkeypatch.setattr(Experiment, "run", failing)
    outcome = searched(lag(tmp_path, "fault.push.value", 0.0, 8.0, 0.1), tmp_path / "out")
    check(outcome.thresholds[0].bracket, 1.3, 0.1)
    failed = sum(probe.error is not None for probe in outcome.thresholds[0].probes)
    assert failed > 1 and pandas.read_csv(tmp_path / "out" / "thresholds.csv").runs_with_error[0] == failed
    assert not outcome.passed and "it broke" in outcome.report.read_text()


def test_a_fault_that_does_nothing_at_one_end_is_no_finding_and_at_both_is_an_error(tmp_path):
    file = lag(tmp_path, "fault.push.value", 0.0, 8.0, 1.0)
    assert searched(file, tmp_path / "out").passed
    late = (tmp_path / "push.toml").read_text().replace("start = 0.5", "start = 7.0")
    (tmp_path / "push.toml").write_text(late)
    with pytest.raises(NavfmuError, match=r"line 16: variant 'main', case 'pushed \(size=8\)': .*it cannot act"):
        load_campaign(file)


def test_a_fault_that_changes_nothing_in_any_run_is_a_finding(tmp_path):
    """A bias smaller than the last bit: the plan cannot know."""
    file = lag(tmp_path, "fault.push.value", 1e-30, 1e-29, 1e-30)
    hide = '[[fault]]\nid = "hide"\ntarget = "lag.y"\ntype = "stuck"\nvalue = 1.0\n'
    tiny = '[[fault]]\nid = "push"\ntarget = "lag.y"\ntype = "bias"\nvalue = 1e-30\n'
    (tmp_path / "push.toml").write_text(hide + tiny)
    outcome = searched(file, tmp_path / "out")
    assert not outcome.passed and [fault for _, _, fault, _ in outcome.idle] == ["push"]


def test_a_requirement_that_gets_no_verdict_is_refused(tmp_path):
    """It stood in the report without a word on whether it holds."""
    more = '\n[[requirement]]\nid = "other"\nsignal = "lag.y"\nat_most = 1.0\n'
    file = lag(tmp_path, "fault.push.value", 0.0, 8.0, 1.0, more=more)
    line = file.read_text().splitlines().index('id = "other"') + 1
    with pytest.raises(NavfmuError, match=rf"line {line}: other is asked in cases only that are searched for another"):
        load_campaign(file)
    load_campaign(lag(tmp_path, "fault.push.value", 0.0, 8.0, 1.0, more=more + '[[case]]\nname = "left alone"\n'))


def test_only_variants_that_the_requirement_is_asked_of_are_searched(tmp_path):
    text = f'system = "{systems.tracker()}"\nvariants = ["main", "slow"]\nstop = 5.0\n'
    text += '[[case]]\nname = "c"\n[[axis]]\nvary = "parameter.truth.amplitude"\nlow = 0.0\nhigh = 100.0\n'
    text += 'search = "R"\ntolerance = 20.0\n[[requirement]]\nid = "R"\nsignal = "lag.y"\nat_most = 5.0\n'
    (tmp_path / "c.toml").write_text(text + 'variants = ["slow"]\n')
    outcome = searched(tmp_path / "c.toml", tmp_path / "out")
    assert [threshold.sought.variant for threshold in outcome.thresholds] == ["slow"]
    assert {judged.run.variant for judged in outcome.every} == {"slow"}


def test_a_value_at_which_the_fault_does_nothing_is_no_margin_in_silence(tmp_path):
    """The condition is true from 1.1 s of 5 s on: held for 3.9 s the fault never acts, and nothing is violated.

    Wrong: "holds at size = 3.8125" as if the system had stood it.
    """
    file = lag(tmp_path, "fault.push.hold", 0.1, 10.0, 0.5, head="seeds = [1]")
    push = tmp_path / "push.toml"
    push.write_text(push.read_text().replace("value = 3.0", 'value = 80.0\nwhen = "time > 1 s"'))
    outcome = run_campaign(load_campaign(file), tmp_path / "out", workers="thread")
    (found,) = outcome.thresholds
    assert found.bracket == Bracket(3.8125, 3.503125)
    told = "; at 3.8125 fault 'push' never acted: 'time > 1 s' did not hold for 3.8125 s just before any point"
    assert told in found.sentence and "at 3.503125 fault" not in found.sentence

    push.write_text(push.read_text().replace("value = 80.0", "value = 1.0"))
    outcome = run_campaign(load_campaign(file), tmp_path / "mild", workers="thread")
    sentence = outcome.thresholds[0].sentence
    assert sentence.startswith(
        "holds at both ends, size = 0.1 and at 10: nothing between them was looked at; at 10 fault"
    )
    assert "'push' never acted" in sentence and "at 0.1 fault" not in sentence
