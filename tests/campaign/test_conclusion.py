"""What a person signs: every sentence of the conclusion against the recordings and independent statistics."""

from __future__ import annotations

import itertools

import numpy as np
import pandas
import pytest
from scipy.stats import binomtest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.conclusion import confidence, lowest, needed, not_tested, verdict
from navfmu.campaign.drawn import drawn
from navfmu.campaign.fmea import by_line
from navfmu.campaign.page import page
from navfmu.campaign.story import story
from tests.components import systems

FAULTS = """
[[fault]]
id = "jump"
fmea = "F10"
target = "sensor.reading.length"
type = "bias"
value = {value}
start = 6.0

[[fault]]
id = "held"
fmea = "F2"
target = "lag.y"
type = "stuck"
start = 30.0
duration = 5.0
"""

CAMPAIGN = """
system = "{system}"
variants = ["main", "slow"]
seeds = "1-4"
stop = 20.0

[[case]]
name = "nominal"
[[case]]
name = "small"
faults = "small.toml"
[[case]]
name = "large"
faults = "large.toml"

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
variants = ["main"]
cases = ["large"]
"""


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """The story of a campaign, and its folder."""
    folder = tmp_path_factory.mktemp("conclusion")
    only = FAULTS.partition('\n[[fault]]\nid = "held"')[0]
    (folder / "small.toml").write_text(only.format(value=0.5))
    (folder / "large.toml").write_text(only.format(value=40.0))
    file = folder / "c.toml"
    file.write_text(CAMPAIGN.format(system=systems.tracker()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("navfmu.campaign.pictured.PICTURED", 1)
        outcome = run_campaign(load_campaign(file), folder / "out", 2, workers="thread")
    return story(outcome, lambda order: drawn(outcome, order)), folder / "out"


def recordings(told) -> dict[tuple[str, str, int], np.ndarray]:
    """The signal of each run from 2 s on, read without the package."""
    tale, folder = told
    found = {}
    for run in tale["runs"]:
        frame = pandas.read_parquet(folder / run["recording"])
        time = frame["time"] if "time" in frame else frame.index
        found[run["variant"], run["case"], run["seed"]] = frame["estimator.solution.length"].to_numpy()[
            time >= 2.0 - 1e-9
        ]
    return found


def held_in(told) -> dict[tuple[str, str], int]:
    """How many of the four runs of each variant and case keep R-1."""
    found: dict[tuple[str, str], int] = {}
    for (variant, case, _), values in recordings(told).items():
        found[variant, case] = found.get((variant, case), 0) + int(np.mean(values <= 8.0) >= 0.9)
    return found


def test_the_first_sentence_counts_what_the_recordings_say(told):
    held = held_in(told)
    good = sum(count >= 0.4 * 4 for count in held.values())
    large = [values for (variant, case, _), values in recordings(told).items() if (variant, case) == ("main", "large")]
    good += all(values.max() <= 30.0 for values in large)
    assert 0 < good < 7
    expected = (
        f"{7 - good} of 7 requirements, each asked of a variant in a case, are violated; {good} hold in the runs flown."
    )
    assert verdict(told[0]) == expected


def test_the_matrix_has_the_counts_of_the_recordings(told):
    cases = [case["name"] for case in told[0]["cases"]]
    cells = {(g["variant"], cases[g["case"]]): g["cells"][0] for g in told[0]["groups"]}
    assert {place: cell["held"] for place, cell in cells.items()} == held_in(told)
    for cell in cells.values():
        interval = binomtest(cell["held"], 4).proportion_ci(method="wilson")
        assert cell["interval"] == pytest.approx([100 * interval.low, 100 * interval.high])


def test_a_number_of_runs_shows_so_much_and_no_more(told):
    said = confidence(told[0])
    low = 100 * binomtest(4, 4).proportion_ci(method="wilson").low
    assert "was put to 4 runs that can differ" in said[0] and f"at least {low:.1f} %" in said[0]
    shown = sum(100 * binomtest(n, 4).proportion_ci(method="wilson").low >= 40.0 for n in held_in(told).values())
    enough = next(n for n in itertools.count(1) if 100 * binomtest(n, n).proportion_ci(method="wilson").low >= 40.0)
    assert f"R-1 asks for 40 % of the runs, which takes at least {enough} runs without a violation" in said[1]
    assert f"it is shown in {shown} of 6 variants and cases" in said[1]
    assert "R-2 asks for every run. No number of runs can show that" in said[2]


def test_requirements_that_ask_for_every_run_share_a_sentence_with_what_their_own_runs_can_show():
    def cell(distinct: int) -> dict:
        return {"passed": True, "distinct": distinct, "interval": [0.0, 100.0], "rank": [1.0, 1.0, 1.0]}

    ids = ("A", "B", "C")
    tale = {
        "requirements": [{"id": name, "runs": 100.0, "quantile": None} for name in ids],
        "cases": [{"name": "one"}],
        "groups": [{"variant": "main", "case": 0, "cells": [cell(4), cell(9), cell(4)]}],
    }
    assert [sentence.partition(" ask")[0] for sentence in confidence(tale)[1:]] == ["A, C", "B"]
    for sentence, count in zip(confidence(tale)[1:], (4, 9), strict=True):
        low = 100 * binomtest(count, count).proportion_ci(method="wilson").low
        assert sentence.endswith(f"{low:.1f} % is what {count} of {count} can show.")


@pytest.mark.parametrize("runs", [1, 4, 8, 35, 1000])
def test_the_lowest_end_is_that_of_wilson(runs):
    assert lowest(runs) == pytest.approx(100 * binomtest(runs, runs).proportion_ci(method="wilson").low)


@pytest.mark.parametrize("share", [50.0, 90.0, 95.0, 99.0, 99.9])
def test_one_run_less_does_not_show_it(share):
    count = needed(share)
    assert lowest(count) >= share > lowest(count - 1)
    assert needed(100.0) is None


def test_what_was_not_tested_is_what_the_file_leaves_out(told):
    said = not_tested(told[0])
    every = {name for names in told[0]["components"].values() for name in names}
    assert any(s.startswith("R-2 is asked in 1 of 6 combinations of variant and case") for s in said)
    (faulted,) = (s for s in said if s.startswith("No fault is injected into"))
    assert f"{len(every) - 1} of {len(every)} components" in faulted
    assert set(faulted.partition(": ")[2].rstrip(".").split(", ")) == every - {"sensor"}
    assert not any("one onset" in s for s in said)  # the jump comes in two sizes
    assert "All runs have one communication step size, 0.1 s." in said


def test_lines_of_the_fmea_have_their_runs(told):
    (line,) = by_line(told[0])
    held = held_in(told)
    assert (line["line"], line["cases"], line["runs"]) == ("F10", ["small", "large"], 16)
    assert line["held"][0] == (sum(n for (_, case), n in held.items() if case != "nominal"), 16)
    assert line["noticed"] is None  # the system does not say how it would


def test_lines_stand_in_the_order_of_their_numbers_and_what_is_noticed_before_a_fault_does_not_count():
    def fault(line: str, start: float) -> dict:
        return {"id": line.lower(), "fmea": line, "description": "", "start": start}

    def run(case: str, *times: float) -> dict:
        return {"case": case, "idle": {}, "events": [["notice", "x", t] for t in times] + [["violation", "R", 99.0]]}

    tale = {
        "requirements": [],
        "noticing": ["x"],
        "cases": [
            {"name": "a", "faults": [fault("F10", 5.0), fault("F2", 50.0)]},
            {"name": "b", "faults": [fault("F2", 3.0), fault("", 0.0)]},
        ],
        "groups": [{"case": 0, "runs": [0, 1], "cells": []}, {"case": 1, "runs": [2], "cells": []}],
        "runs": [run("a", 4.0), run("a", 4.0, 5.0), run("b", 3.5)],
    }
    found = [(line["line"], line["runs"], line["noticed"]) for line in by_line(tale)]
    assert found == [("F2", 3, 1), ("F10", 2, 1), ("(none)", 1, 1)]


def test_a_percentile_asks_nothing_of_a_single_run(told):
    """Of runs half of which may be beyond the bound none is told to be not as asked; lines count variants and cases."""
    folder = told[1].parent
    text = (folder / "c.toml").read_text().replace("percent = 90\n", "quantile = 0.75\n").replace("runs = 40\n", "")
    (folder / "quantile.toml").write_text(text)
    outcome = run_campaign(load_campaign(folder / "quantile.toml"), folder / "quantile", 2, workers="thread")
    tale = story(outcome, lambda order: drawn(outcome, order))
    assert {run["findings"][0]["held"] for run in tale["runs"]} == {None}
    assert not any(event[:2] == ["violation", "R-1"] for run in tale["runs"] for event in run["events"])
    good = {}
    for run in tale["runs"]:
        frame = pandas.read_parquet(outcome.folder / run["recording"])
        time = frame["time"] if "time" in frame else frame.index
        values = frame["estimator.solution.length"].to_numpy()[time >= 2.0 - 1e-9]
        good.setdefault((run["variant"], run["case"]), []).append(values)
    held = {place: np.sort(rows, axis=0)[3].max() <= 8.0 for place, rows in good.items()}  # the third quartile of four
    (line,) = by_line(tale)
    assert line["held"][0] == (sum(ok for (_, case), ok in held.items() if case != "nominal"), 4)
    text = page(tale, [], {"versions": {}}, [], []).html()
    assert f">{line['held'][0][0]} of 4 cells<" in text and "R-1 NOT as asked" not in text


def test_the_worst_run_comes_first(told):
    tale = told[0]
    cells = sorted((c for g in tale["groups"] for c in g["cells"] if c), key=lambda cell: cell["rank"])
    assert tale["order"][0] == cells[0]["worst"] and sorted(tale["order"]) == list(range(len(tale["runs"])))


def test_every_finding_is_that_of_its_recording(told):
    values = recordings(told)
    for run in told[0]["runs"]:
        series, finding = values[run["variant"], run["case"], run["seed"]], run["findings"][0]
        assert finding["inside"] == pytest.approx(100 * np.mean(series <= 8.0))
        assert finding["worst"] == series.max() and finding["held"] == (np.mean(series <= 8.0) >= 0.9)
        assert finding["share"] == f"{np.floor(10 * finding['inside'] + 1e-9) / 10:.1f} %"


def test_what_did_not_happen_is_said(told):
    idle = [[variant, "large", "jump", "1-4", "adds 0"] for variant in ("main", "slow")]
    runs = [run | {"error": "it broke"} if number < 2 else run for number, run in enumerate(told[0]["runs"])]
    said = not_tested(told[0] | {"idle": idle, "runs": runs})
    assert any("changed nothing" in s and s.endswith(": jump (main, large), jump (slow, large).") for s in said)
    assert "2 of 24 runs ended with an error and count as not held; see failed runs." in said
