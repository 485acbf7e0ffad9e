"""The analysis of failures: every line has a row, and rows say what the recordings say."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binomtest

from evidence import fmea
from evidence.failures.injection import SIGNALS, Injection, Sighting, _sighting, itself, reference_of, signs_of
from evidence.failures.lines import load_lines
from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.case import Case
from navfmu.faults import Fault

LINES = [f"F{number}" for number in range(1, 48)]
PAGE = Path(__file__).parents[2] / "docs" / "fmea.md"


@pytest.fixture(scope="module")
def campaigns():
    return [load_campaign(path) for path in fmea.CAMPAIGNS]


@pytest.fixture(scope="module")
def lines():
    return load_lines(fmea.LINES)


def cells(text: str, heading: str) -> list[list[str]]:
    """The rows of the table below a heading of the page."""
    part = text.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    rows = [line for line in part.splitlines() if line.startswith("| ")][1:]
    return [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]


def test_every_line_stands_once_and_has_a_failure_or_a_reason(campaigns, lines):
    assert [line.number for line in lines.line] == LINES
    cases = [case for campaign in campaigns for case in campaign.cases]
    named = {fault.fmea for case in cases for fault in case.faults}
    for line in lines.line:
        assert set(line.cases) <= {case.name for case in cases}
        assert line.number in named or line.cases or line.lacking, line.number
    assert named <= set(LINES)


def test_campaigns_ask_for_the_same_signs_in_the_same_way(campaigns):
    """What both ask for stands in both files; whoever changes one would compare a failure with another question."""
    main, signals = (signs_of(campaign.requirements) for campaign in campaigns)
    assert set(signals) - set(main) == {"SATELLITES", "PROTECTION", "APPROACH"} and set(main) <= set(signals)
    for name, sign in main.items():
        other = signals[name]
        told = (sign.signal, sign.when, sign.start, sign.end, sign.tolerance, sign.description)
        assert told == (other.signal, other.when, other.start, other.end, other.tolerance, other.description), name
    harm = [[r for r in each.requirements if r.kind != "events"] for each in campaigns]
    assert [(r.id, r.signal, r.most, r.percent, r.start) for r in harm[0]] == [
        (r.id, r.signal, r.most, r.percent, r.start) for r in harm[1]
    ]


def test_a_failure_is_compared_with_flights_that_differ_in_nothing_else(campaigns, lines):
    """With WAAS as with, without GPS as without: otherwise what differs anyway would be laid to the failure."""
    told = {"backup: echo": "gps_lost", "bad_geometry": "gps_lost", "gps: gps-jammer": "gps_kept"}
    told |= {"signals: gps-jammer": "signals_kept", "waas: waas-lost": "waas_kept"}
    cases = [{case.name: case for case in campaign.cases} for campaign in campaigns]
    for name, expected in told.items():
        own = next(each for each in cases if name in each)
        references = [own[reference] for reference in lines.references if reference in own]
        assert reference_of(own[name], references).name == expected


PHYSICAL = ("F26", "F27", "F28", "F29", "F30", "F31", "F32", "F33", "F35", "F36", "F37", "F38", "F43")
"""Lines whose failures the components have by themselves."""


def test_failures_that_components_have_are_injected_into_these(campaigns):
    """A bias on a range passes the gate, the monitor and the search for a station, which a failure must meet."""
    for fault in (fault for campaign in campaigns for case in campaign.cases for fault in case.faults):
        if fault.fmea in PHYSICAL:
            assert fault.type in ("input", "parameter"), fault.id


def test_the_page_has_a_row_for_each_line_and_each_failure_of_the_campaigns(campaigns, lines):
    """A page that was made from other files is stale."""
    text = PAGE.read_text(encoding="utf-8")
    rows = cells(text, "Every line")
    assert [row[0] for row in rows] == LINES
    by_name = {row[0]: row for row in cells(text, "Every failure")}
    cases = [(campaign, case) for campaign in campaigns for case in campaign.cases]
    faults = {(f.id, f.fmea, f.description) for _, case in cases for f in case.faults if f.id != "gps-jammed"}
    for line, row in zip(lines.line, rows, strict=True):
        assert row[1] == line.failure and line.lacking in row[2]
        assert row[4] or row[2] == f"not injected: {line.lacking}"
        for name, number, words in faults:
            assert (words in row[2]) == (number == line.number), (name, line.number)
    assert len(by_name) == len(cases)
    for campaign, case in cases:
        own = [fault for fault in case.faults if fault.id != "gps-jammed"]
        (variant,) = campaign.systems
        row = by_name[(own[0].id if len(own) == 1 else case.name) + ("" if variant == "main" else f" ({variant})")]
        assert all(f"{fault.type} " in row[2] and fault.targets[0] in row[2] for fault in own)
        assert f" of {len(campaign.seeds)} " in row[7]
    told = {row[0]: row[1:3] for row in cells(text, "The signs")}
    signs = {name: sign for campaign in campaigns for name, sign in signs_of(campaign.requirements).items()}
    assert told == {name: [sign.description, f"`{sign.signal}`"] for name, sign in signs.items()}


# ---- from the recordings ---------------------------------------------------------------------------------------------

FLOWN = ("gps_kept", "gps_lost", "backup: air-silent", "unmonitored: unmonitored-step", "gps: gps-elsewhere")
SEEDS = (3, 4)


@pytest.fixture(scope="module")
def outcome(campaigns, tmp_path_factory):
    campaign = campaigns[0]
    cases = tuple(case for case in campaign.cases if case.name in FLOWN)
    return run_campaign(replace(campaign, cases=cases, seeds=SEEDS), tmp_path_factory.mktemp("fmea"), 2)


@pytest.fixture(scope="module")
def analysis(outcome, lines):
    return fmea.Analysis.of([outcome], lines)


def flown(outcome, case: str) -> dict[int, pd.DataFrame]:
    found = {}
    for judged in outcome.of("main", case):
        frame = pd.read_parquet(outcome.folder / "runs" / judged.answer.recording).reset_index()
        found[judged.run.seed] = frame.set_index("time")
    return found


def signs_in(frame: pd.DataFrame) -> dict[str, float]:
    """When the signs first show at a recorded point, s: their expressions, written down a second time."""
    frame = frame[frame.index >= 300.0]
    sigma = frame[["navigator.north_sigma", "navigator.east_sigma"]].max(axis=1)
    flags = ["air_data.air", "ahrs.attitude", "imu.reading", "magnetometer.field", "dme.ranging"]
    ages = {"air_data.air": 1.0, "ahrs.attitude": 1.0, "dme.ranging": 45.0}
    shown = {
        "DOUBT": frame["navigator.doubted"],
        "GATE": frame["navigator.rejected"] >= 2,
        "SIGMA": sigma > 463.0,
        "INVALID": ~frame["navigator.solution.valid"],
        "WIND": np.hypot(frame["navigator.solution.wind_n[1]"], frame["navigator.solution.wind_n[2]"]) > 20.0,
        "FLAGS": ~np.all([frame[f"{name}.valid"] for name in flags], axis=0),
        "AGE": np.any([frame.index - frame[f"{n}.time_of_validity"] > limit for n, limit in ages.items()], axis=0),
        "HEADING": np.degrees(frame["ahrs.attitude.heading_sigma"]) > 3.0,
    }
    return {name: frame.index[np.asarray(where)][0] for name, where in shown.items() if np.any(where)}


@pytest.mark.slow
@pytest.mark.parametrize("case", FLOWN[2:])
def test_a_row_is_what_the_recordings_say(outcome, analysis, case):
    frames = flown(outcome, case)
    found = next(each for each in analysis.injected if each.case.name == case)
    late = pd.concat([frame[frame.index >= 900.0] for frame in frames.values()])
    errors = np.sort(np.hypot(late["evaluation.north_error"], late["evaluation.east_error"]))
    over = [(late[f"evaluation.{a}_error"] / late[f"navigator.{a}_sigma"]).to_numpy() for a in ("north", "east")]
    row = dict(zip(fmea.EVERY, analysis.every_row(found), strict=True))
    assert row["95 % of the error, m"] == f"{errors[int(np.ceil(0.95 * (len(errors) - 1)))]:.0f}"
    assert row["largest, m"] == f"{errors[-1]:.0f}"
    assert row["inside 3 sigma, %"] == f"{100 * np.mean((np.abs(over[0]) <= 3) & (np.abs(over[1]) <= 3)):.1f}"
    assert row["NEES (2)"] == f"{np.mean(over[0] ** 2 + over[1] ** 2):.2f}"
    for sighting in found.sightings:
        expected = signs_in(frames[sighting.seed])
        if case.startswith("gps"):
            assert not (frames[sighting.seed]["navigator.mode"] == 2).any()
        assert set(expected) == set(sighting.signs) - {"GEOMETRY"}
        for name, time in expected.items():
            assert time - 1.0 <= 900.0 + sighting.signs[name] <= time + 1e-6, name


@pytest.mark.slow
def test_what_is_noticed_and_what_is_not_is_told_apart(outcome, analysis):
    silent, shifted, elsewhere = (
        next(each for each in analysis.injected if each.case.name == case) for case in FLOWN[2:]
    )
    assert (silent.noticed, shifted.noticed, elsewhere.noticed) == (2, 0, 0)
    assert {each.name for each in analysis.unseen} == {"unmonitored-step", "gps-elsewhere"}
    assert silent.reference == "gps_lost" and elsewhere.reference == "gps_kept"
    first = fmea.Analysis.row(analysis, analysis.lines.line[0])
    assert "air-silent" in first[2] and first[4].startswith("in every run: air-silent after 0 s")
    belongs = {each.name: each.lines for each in analysis.injected}
    assert belongs == {"air-silent": ("F1",), "unmonitored-step": ("F31",), "gps-elsewhere": ("F39",)}
    assert analysis.false_alarms == (sum(bool(signs_in(f)) for c in FLOWN[:2] for f in flown(outcome, c).values()), 4)
    misled = {}
    for seed, frame in flown(outcome, FLOWN[3]).items():
        frame = frame[frame.index >= 900.0]
        wrong = sum(abs(frame[f"evaluation.{a}_error"]) > 3 * frame[f"navigator.{a}_sigma"] for a in ("north", "east"))
        misled[seed] = np.count_nonzero(wrong)
    assert [misled[each.seed] for each in shifted.sightings] == list(shifted.misled)


# ---- without flying --------------------------------------------------------------------------------------------------


def sighting(signs: dict[str, float], inside: list[bool], harmed: bool = False, error: float = 1.0) -> Sighting:
    time = 900.0 + np.arange(len(inside))
    return Sighting(1, harmed, signs, time, np.full(len(inside), error), np.ones(len(inside)), np.array(inside))


def injection(*sightings: Sighting, name: str = "x", line: str = "F1", variant: str = "main") -> Injection:
    fault = Fault(name, "a.b", "bias", start=900.0, value=1.0, fmea=line)
    case = Case(name, faults=(fault,))
    return Injection(case, variant, (fault,), "none", (line,), 900.0, sightings, 0, ("A", "OWN"), ("OWN",))


def test_signs_and_harm_that_the_twin_has_as_well_are_not_those_of_the_failure():
    """The twin has the same noise: what it shows would have come up anyway, if at another time."""

    def judged(harmed: bool, **first: float) -> SimpleNamespace:
        findings = {name: SimpleNamespace(first_violation=time, held=False) for name, time in first.items()}
        findings["ERROR"] = SimpleNamespace(first_violation=None, held=not harmed)
        return SimpleNamespace(run=SimpleNamespace(seed=1), findings=findings)

    series = dict.fromkeys(SIGNALS, np.ones(3)) | {"time": np.array([899.0, 900.0, 901.0])}
    outcome = SimpleNamespace(series=lambda judged, signals: series)
    signs = {name: SimpleNamespace(tolerance=10.0) for name in "AB"}
    run = judged(True, A=950.0, B=940.0)
    found = _sighting(outcome, run, judged(True, A=1200.0), signs, 900.0)
    assert found.signs == {"B": 50.0} and not found.harmed and len(found.time) == 2
    found = _sighting(outcome, run, judged(False), signs, 900.0)
    assert found.signs == {"A": 60.0, "B": 50.0} and found.harmed


def test_time_outside_of_the_claim_counts_up_to_the_first_sign():
    inside = [True, False, False, True, False, False]
    assert sighting({}, inside).misled(900.0) == 4.0
    assert sighting({"A": 9.0, "OWN": 2.0}, inside).misled(900.0) == 1.0
    assert sighting({"A": 0.0}, inside).misled(900.0) == 0.0


def test_runs_are_counted_by_any_sign_and_by_those_of_the_navigator():
    found = injection(
        sighting({"A": 3.0, "OWN": 5.0}, [True], True), sighting({"A": 1.0}, [True]), sighting({}, [True], True)
    )
    assert (found.noticed, found.noticed_itself, found.harmed, found.harmed_unseen) == (2, 1, 2, 1)
    assert list(found.delays) == [1.0, 3.0] and found.firsts == ["A"]


def test_an_error_that_is_no_number_is_beyond_every_bound():
    found = injection(sighting({}, [False, False], True, np.nan), sighting({}, [True, True]))
    assert found.largest == np.inf and found.percentile == np.inf and found.inside == 50.0


@pytest.mark.parametrize("count", [0, 3, 7, 15])
def test_a_number_of_runs_shows_so_much(count):
    """0 and all: the exact bound of one side; in between Wilson's interval."""
    said = [float(number) for number in re.findall(r"[\d.]+", fmea._of(count, 15).partition("(")[2])]
    if count in (0, 15):
        share = said[0] / 100
        miss = (1 - share) ** 15 if count == 0 else share**15
        assert miss == pytest.approx(0.05, rel=0.08)  # the share is rounded to whole percents
    else:
        interval = binomtest(count, 15).proportion_ci(method="wilson")
        assert said == [round(100 * interval.low), round(100 * interval.high)]


def test_what_does_harm_and_shows_nothing_stands_by_itself(lines):
    quiet = injection(sighting({}, [True, True]), name="none")
    bad = injection(sighting({}, [False, False], True), name="bad", line="F2")
    seen = injection(sighting({"A": 2.0}, [False, False], True), name="seen", line="F2")
    found = fmea.Analysis(lines, [quiet, quiet], [bad, seen], [], [0, 0], 0)
    assert found.unseen == [bad] and found.title.endswith("1 do harm in some run with no sign")
    noticed = found.row(lines.line[1])[4]
    assert noticed == "HARM AND NO SIGN: bad in 1 of 1; in every run: seen after 2 s; not noticed: bad"
    assert found.row(lines.line[43])[2] == f"not injected: {lines.line[43].lacking}"


def test_a_failure_of_another_variant_has_a_name_of_its_own():
    assert injection(name="jam").name == "jam" and injection(name="jam", variant="signals").name == "jam (signals)"


@pytest.mark.parametrize("which", [0, 1])
def test_signs_of_the_navigator_look_at_nothing_else(campaigns, which):
    own = [name for name, sign in signs_of(campaigns[which].requirements).items() if itself(sign)]
    assert own == ["DOUBT", "GATE", "SIGMA", "INVALID", "NUMBER", "GEOMETRY", "WIND", "MODE"]
