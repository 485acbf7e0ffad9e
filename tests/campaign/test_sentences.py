"""Sentences and tables of a campaign's report, as a reader finds them, against recordings and tables of runs."""

from __future__ import annotations

import html
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas
import pytest
from scipy.stats import binomtest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.conclusion import not_tested, verdict
from navfmu.campaign.drawn import drawn
from navfmu.campaign.page import page
from navfmu.campaign.pictured import sections
from navfmu.campaign.story import story
from tests.components import systems

FAULT = '[[fault]]\nid = "{0}"\nfmea = "F4"\ntarget = "sensor.reading.length"\ntype = "{1}"\nstart = 6.0\n{2}'
CAMPAIGN = """
system = "{system}"
variants = ["main", "slow"]
seeds = "1-4"
stop = 20.0
step = 0.1
record_period = 0.1

[[case]]
name = "nominal"
[[case]]
name = "shifted"
faults = "bias.toml"
[[case]]
name = "nothing"
faults = "nan.toml"
[[case]]
name = "sought"
faults = "bias.toml"

[[axis]]
vary = "fault.B.value"
low = 0.0
high = 40.0
search = "R-1"
tolerance = 2.0
cases = ["sought"]

[[requirement]]
id = "R-1"
severity = "major"
signal = "estimator.solution.length"
at_most = "8 m"
percent = 90
from = 2.0
runs = 40
[[requirement]]
id = "R-2"
signal = "estimator.solution.length"
at_most = 30.0
quantile = 0.5
"""
SIGNAL = "estimator.solution.length"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sentences")
    (folder / "bias.toml").write_text(FAULT.format("B", "bias", "value = 3.0\n"))
    (folder / "nan.toml").write_text(FAULT.format("N", "nan", "duration = 0.5\n"))
    (folder / "c.toml").write_text(CAMPAIGN.format(system=systems.tracker()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("navfmu.campaign.pictured.PICTURED", 2)
        return run_campaign(load_campaign(folder / "c.toml"), folder / "out", 2, workers="thread")


@pytest.fixture(scope="module")
def tale(outcome):
    return story(outcome, lambda order: drawn(outcome, order))


def read(text: str) -> str:
    """What is to be read on a page, cells apart by bars."""
    text = re.sub(r"<(script|style|nav)\b.*?</\1>", "", text, flags=re.DOTALL)
    text = re.sub(r"</t[dh]>", " | ", re.sub(r"</(p|tr|li|h\d)>|<br>", "\n", text))
    return re.sub(r"[ \t]+", " ", html.unescape(re.sub(r"<[^>]+>", "", text)))


@pytest.fixture(scope="module")
def text(outcome) -> str:
    return read(outcome.report.read_text(encoding="utf-8"))


def recordings(outcome) -> dict[tuple[str, str, int], pandas.DataFrame]:
    """Those of all runs but the searched ones, read without the package."""
    found = {}
    for judged in outcome.runs:
        frame = pandas.read_parquet(outcome.folder / "runs" / judged.answer.recording).reset_index()
        found[judged.run.variant, judged.run.case.name, judged.run.seed] = frame.set_index("time")
    return found


def held(outcome) -> dict[tuple[str, str], int]:
    """Runs that keep R-1: 8 m at 90 % of the points from 2 s on; what is no number is outside."""
    count: Counter = Counter()
    for (variant, case, _), frame in recordings(outcome).items():
        values = frame[SIGNAL][frame.index >= 2.0 - 1e-9]
        count[variant, case] += int(np.mean(values <= 8.0) >= 0.9)
    return count


def test_each_requirement_has_its_weakest_place_with_its_interval(outcome, text):
    counts = held(outcome)
    least = min(counts.values())
    (found,) = re.findall(r"R-1 \(major\) \|.*?\| (\d) of 6 \| (\w+), (\w+): (\d) of 4 runs \((\d+) to (\d+) %\)", text)
    holds, variant, case, count, low, high = found
    assert int(holds) == sum(n >= 0.4 * 4 for n in counts.values())
    assert int(count) == least == counts[variant, case]
    interval = binomtest(least, 4).proportion_ci(method="wilson")
    assert (int(low), int(high)) == (round(100 * interval.low), round(100 * interval.high))
    assert "R-2 is asked of a percentile of the runs, for which no interval is claimed." in text


def test_what_is_no_number_is_counted_in_the_conclusion_and_told_by_signal(outcome, text):
    strange = {place: frame for place, frame in recordings(outcome).items() if frame.isna().any().any()}
    assert {case for _, case, _ in strange} == {"nothing"}
    assert f"In {len(strange)} of {len(outcome.every)} runs a recorded signal is NaN or infinite" in text
    part = text.partition("Signals that are not finite")[2].partition("\nNotes\n")[0]
    rows = set(re.findall(r"(\w+) \| nothing \| (\d) \| ([\w.]+) \| (\d+) \|", part))
    assert rows == {
        (variant, str(seed), signal, str(int(frame[signal].isna().sum())))
        for (variant, _, seed), frame in strange.items()
        for signal in frame
        if frame[signal].isna().any()
    }


def test_the_worst_cells_are_counted(tale, monkeypatch):
    monkeypatch.setattr("navfmu.campaign.page.WORST", 3)
    text = read(page(tale, [], {"versions": {}}, [], []).html())
    cells = [cell for group in tale["groups"] for cell in group["cells"]]
    violated = sum(not cell["passed"] for cell in cells)
    assert f"The worst 3 of 12 cells, of which {violated} are violated; the matrix opens all." in text
    part = text.partition("What was seen, worst first")[2].partition("All runs")[0]
    assert part.count("| VIOLATED |") == min(3, violated)


def test_the_run_that_pictures_show_is_the_worst_of_its_combination(outcome, text):
    assert "Of 2 of 6 combinations of variant and case, the worst first." in text
    part = text.partition("Pictures of the worst")[2].partition("\nAll runs\n")[0]
    words = r"Where one run is shown it is the worst run, seed (\d)\."
    shown = re.findall(rf"\n ?(\w+), (\w+)\n\s*{words}", part)
    assert len(shown) == 2
    frames = recordings(outcome)
    for variant, case, seed in shown:
        inside = {s: np.mean(frames[variant, case, s][SIGNAL][2.0 - 1e-9 :] <= 8.0) for s in range(1, 5)}
        assert inside[int(seed)] == min(inside.values())


def test_brackets_of_searches_are_those_of_the_runs(outcome, text):
    runs = pandas.read_csv(outcome.folder / "runs.csv")
    runs = runs[(runs.case.str.startswith("sought")) & (runs.requirement == "R-1")]
    axis = next(name for name in runs if name.startswith("B.value"))
    for variant, group in runs.groupby("variant"):
        highest, lowest, brackets = [], [], 0
        for _, one in group.groupby("seed"):
            good, bad = one[one.held][axis], one[~one.held][axis]
            if len(good) and len(bad):
                brackets += 1
                assert 0 < bad.min() - good.max() <= 2.0
            highest += [good.max()] if len(good) else []
            lowest += [bad.min()] if len(bad) else []

        def told(values: list[float]) -> str:
            return " to ".join(f"{v:.9g}" for v in dict.fromkeys((min(values), max(values)))) if values else "-"

        row = rf"{variant} \| sought \| R-1 \| B.value[^|]*\| 4 \| {brackets} \| {told(lowest)} \| {told(highest)} \|"
        assert re.search(row, text), row
    assert "8 searches, one for each seed" in text


def test_what_was_injected_once_is_named(tale):
    once = [sentence for sentence in not_tested(tale) if sentence.startswith("Injected with one onset")]
    assert once == ["Injected with one onset, length and magnitude only: N."]
    (sought,) = tale["searched"]
    without = tale | {"searched": [sought | {"ends": sought["faults"]}]}  # a search that varies something else
    assert "Injected with one onset, length and magnitude only: B, N." in not_tested(without)


def test_notes_are_counted(outcome, text):
    count = Counter(note for judged in outcome.every for note in judged.answer.notes)
    for note, runs in count.items():
        assert f"{note} (in {runs} of {len(outcome.every)} runs)" in text


def test_runs_whose_curves_are_left_out_are_counted(tale):
    runs = [run | {"curves": "" if number in (1, 4, 5) else "x"} for number, run in enumerate(tale["runs"])]
    text = read(page(tale | {"runs": runs}, [], {"versions": {}}, [], []).html())
    assert "The curves of the 3 runs that matter least are left out" in text and "No run is left out" not in text


def test_a_fault_that_changed_nothing_is_told_with_its_line(tale):
    runs = [
        run | {"idle": {"B": "adds 0"} if run["case"] == "shifted" and run["seed"] < 3 else {}} for run in tale["runs"]
    ]
    text = read(page(tale | {"runs": runs}, [], {"versions": {}}, [], []).html())
    (row,) = re.findall(r"F4 \| (.*?) \| (.*?) \| (\d+) \|", text)
    assert row[0].endswith("; changed nothing in 4 runs") and row[2] == "16"


def test_runs_with_an_error_are_no_part_of_the_pictures_and_are_told(outcome):
    broken = [
        replace(judged, answer=replace(judged.answer, error="it broke"), findings={})
        if judged.run.seed == 2
        else judged
        for judged in outcome.runs
    ]
    for section in sections(replace(outcome, runs=broken)):
        assert section.lines[0] == "1 of 4 runs ended with an error and are not in the pictures."
        assert any("3 runs" in each.title for each in section.drawn)


def test_a_verdict_without_violations_still_tells_that_the_campaign_has_not_passed(tale):
    groups = [group | {"cells": [cell | {"passed": True} for cell in group["cells"]]} for group in tale["groups"]]
    said = verdict(tale | {"groups": groups, "passed": False})
    assert said.startswith("All of 12 requirements") and said.endswith(
        "Yet the campaign has not passed: see what was not tested."
    )
    assert "Yet" not in verdict(tale | {"groups": groups, "passed": True})


def test_a_campaign_that_asks_nothing_gives_no_verdict(tale):
    groups = [group | {"cells": []} for group in tale["groups"]]
    nothing = tale | {"groups": groups, "requirements": []}
    assert verdict(nothing).endswith("this campaign gives no verdict.")
    assert "There are no requirements: nothing is judged." in not_tested(nothing)


def test_the_table_of_what_was_tested_counts_the_runs(outcome, text):
    assert re.search(rf"runs \| {len(outcome.runs)} \(2 variants x 3 cases x 4 seeds\), and \d+ of searches \|", text)
    assert "each run | 20 s in steps of 0.1 s, gauss_seidel |" in text
    assert len(list(Path(outcome.folder, "runs").glob("*.json"))) == len({judged.run.key for judged in outcome.every})
