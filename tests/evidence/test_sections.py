"""Evidence follows the data: a missed claim is said, in table, title and exit code."""

from __future__ import annotations

import html
import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from benchmarks.contest import Contest
from evidence import __main__ as command
from evidence import closure, headline, public_fmus, real_flights, speed, step_sizes
from evidence.section import Section
from navfmu.fmi.fmu import describe
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from tests.foreign.habits import lag, replaced
from tests.sweep.made import counted, made

GOOD = Claim("All is well", 3.0, 5.0, at_least=False, unit="m", opposite="Not all is well")
BAD = Claim("All is well", 7.0, 5.0, at_least=False, unit="m", opposite="Not all is well")


def text_of(section: Section) -> str:
    page = Page("")
    section.write(page)
    return html.unescape(re.sub(r"<[^>]+>", " ", re.sub(r'src="[^"]+"', "", page.html())))


def test_a_claim_holds_at_its_bound_and_never_for_nan():
    assert Claim("", 5.0, 5.0).holds and Claim("", 5.0, 5.0, at_least=False).holds
    assert not Claim("", np.nan, 5.0).holds and not Claim("", np.nan, 5.0, at_least=False).holds
    assert GOOD.sentence == "All is well" and BAD.sentence == "Not all is well"
    assert "not so that: x" in Claim("x", 0.0, 1.0).sentence


def evidence(monkeypatch, tmp_path, **sections: Section):
    """Run the command on sections that are made instead of measured."""
    monkeypatch.setattr(command, "SECTIONS", tuple(sections))
    modules = {f"evidence.{name}": SimpleNamespace(run=lambda out, s=s: s) for name, s in sections.items()}
    monkeypatch.setattr(command, "importlib", SimpleNamespace(import_module=modules.__getitem__))
    run = CliRunner().invoke(command.main, ["--out", str(tmp_path)])
    return run, (tmp_path / "evidence.html").read_text()


def test_claims_that_hold_give_exit_code_0_and_stand_at_the_top(monkeypatch, tmp_path):
    section = Section([GOOD], lambda page: page.heading("Something"))
    run, page = evidence(monkeypatch, tmp_path, something=section)
    assert run.exit_code == 0 and "1 of 1 claims hold." in run.output and "holds" in run.output
    assert page.index("All is well") < page.index("<h2>Something</h2>")


def test_a_missed_claim_gives_exit_code_1_and_is_named(monkeypatch, tmp_path):
    run, page = evidence(
        monkeypatch, tmp_path, a=Section([GOOD], lambda page: None), b=Section([BAD], lambda page: None)
    )
    assert run.exit_code == 1 and "MISSED" in run.output and "1 of 2 claims hold, 1 MISSED." in run.output
    assert "report: " in run.output and "MISSED" in page and 'class="bad"' in page and "7 m" in page


def test_what_was_left_out_is_said_at_the_end_and_not_counted_as_held(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    left = real_flights.run(tmp_path)
    run, page = evidence(monkeypatch, tmp_path, real_flights=left, a=Section([GOOD], lambda page: None))
    assert run.exit_code == 0 and "1 of 1 claims hold. Not measured: real_flights, because" in run.output
    assert "NAVFMU_DATA" in page


def test_a_folder_without_the_flights_is_left_out_with_the_missing_file(monkeypatch, tmp_path):
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    assert "dme_stations.csv" in real_flights.run(tmp_path).left_out


# -- headline ------------------------------------------------------------------------------------------------------


def flights(size: float, sigma: float = 1e4, runs: int = 20) -> headline.Flights:
    time = np.arange(1.0, 1801.0)
    error = np.full((runs, len(time)), size) * time / time[-1]
    return headline.Flights(time, {a: error / np.sqrt(2.0) for a in headline.AXES},
                            {a: np.full(error.shape, sigma) for a in headline.AXES})  # fmt: skip


def all_flights(**changed) -> dict[str, headline.Flights]:
    good = {name: flights(400.0) for name in headline.NAMES}
    return good | {"open_loop": flights(6000.0), "r_as_printed": flights(400.0, sigma=1.0)} | changed


HDOP = pd.Series([1.5] * 5, index=[360.0, 420.0, 480.0, 540.0, 600.0])


def test_headline_holds_on_flights_as_claimed():
    section = headline.section(all_flights(), HDOP, range(1, 21))
    assert all(claim.holds for claim in section.claims)
    assert headline.titles(section.claims) == (
        "Dead reckoning drifts away, DME ranges bound it", "With any receiver 95 % stay within 0.5 nmi"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "titles", "sentence"),
    [
        ({"open_loop": flights(500.0)},
         ("Dead reckoning stays near, DME ranges bound it", "With any receiver 95 % stay within 0.5 nmi"),
         "Half of the flights on dead reckoning alone end within 0.5 nmi"),
        ({"main": flights(2000.0)},
         ("Dead reckoning drifts away, DME ranges do not bound it", "95 % do not always stay within 0.5 nmi"),
         "Not at every time 95 % of the flights are within 0.5 nmi, one receiver, intermittent"),
        ({name: flights(np.nan) for name in headline.RECEIVERS},
         ("Dead reckoning drifts away, DME ranges do not bound it", "95 % do not stay within 0.5 nmi"),
         "Not at every time half of the flights are within 500 m, scanning receiver"),
        ({"scanning": flights(400.0, sigma=10.0)}, None,
         "Not every flight is inside its filter's own 3 sigma for 95 % of the time, scanning receiver"),
        ({"r_as_printed": flights(400.0)}, None, "more than 10 % of the samples are inside 3 sigma"),
    ],
)  # fmt: skip
def test_headline_says_the_opposite_when_it_is_so(changed, titles, sentence):
    """The titles once stood in the program, whatever the flights did."""
    section = headline.section(all_flights(**changed), HDOP, range(1, 21))
    assert not all(claim.holds for claim in section.claims)
    assert sentence in text_of(section)
    assert titles is None or headline.titles(section.claims) == titles


def test_errors_that_are_not_numbers_count_as_above():
    assert flights(np.nan).row()[4] == "100.0"


# -- the other sections --------------------------------------------------------------------------------------------


def test_closure_title_follows_the_drift(monkeypatch):
    titles = []
    monkeypatch.setattr(closure, "picture", lambda north, east, up, title: titles.append(title) or b"")
    none = np.zeros(720_001)
    for north in (none + 0.005, none + 0.02, none + np.nan):
        text_of(closure.section(north, none, none))
    assert "returns the trajectory: within 0.01 m over ground in 30 minutes" in titles[0]
    assert all("does not return the trajectory within 0.01 m" in title for title in titles[1:])
    assert [claim.holds for claim in closure.section(none, none, none + 0.1).claims] == [True, False]


def test_step_sizes_claims_the_systems_own_step_only_if_it_is_good_enough():
    assert all(claim.holds for claim in step_sizes.section(made(lost=counted(0, 0, 9)), 0.2).claims)
    close, lost = step_sizes.section(made([0.0, 0.5, 0.6], lost=counted(3, 3, 9)), 0.2).claims
    assert not close.holds and not lost.holds and lost.measured == 3
    assert not step_sizes.section(made(["is not finite"] * 3), 0.1).claims[0].holds
    assert "Samples lost" not in text_of(step_sizes.section(made(lost=counted(0, 0, 0)), 0.2))


def flown(error: float, consistent: float) -> real_flights.Flown:
    time = np.arange(0.0, 1001.0)
    inside = np.arange(len(time)) % 100 < consistent
    run = pd.DataFrame({"evaluation.horizontal_error": error, "evaluation.consistent": inside}, index=time)
    return real_flights.Flown("made", None, {"time": time}, None, [], {v: [run] * 3 for v in real_flights.VARIANTS})


def test_real_flights_say_whether_the_filter_knows_its_error():
    assert all(claim.holds for claim in flown(100.0, 97.0).claims())
    claims = flown(100.0, 60.0).claims()
    assert not any(claim.holds for claim in claims) and "outside the navigator's own 3 sigma" in claims[0].sentence
    assert [row[4] for row in flown(np.nan, 97.0).rows()] == ["100.0", "100.0"]


def test_speed_tells_what_is_compared():
    contest = Contest("race", "lap", {"hare": [1.0], "tortoise": [3.0]}, work="The hare carries nothing.")
    contest.claim("time of the tortoise over that of the hare", 5.0, contest.ratio("tortoise", "hare"))
    section = speed.section([contest])
    assert [claim.holds for claim in section.claims] == [False] and "The hare carries nothing." in text_of(section)


# -- public FMUs -------------------------------------------------------------------------------------------------------


def test_public_fmus_are_left_out_without_a_folder(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_PUBLIC_FMUS", raising=False)
    assert "NAVFMU_PUBLIC_FMUS does not name a folder" in public_fmus.run(tmp_path).left_out


def test_public_fmus_run_in_both_hosts_each_in_a_process_of_its_own(monkeypatch, tmp_path):
    """One that has a habit, one that crashes, one that is there twice, and those of other versions."""
    for folder in ("a", "b", "c", "d"):
        (tmp_path / folder).mkdir()
    lag(tmp_path / "a", replaced(("<ScalarVariable ", '<ScalarVariable previous="1" ')))
    dead = lag(tmp_path / "b", replaced(('guid="{probe}"', 'guid="{dies}10"'))).rename(tmp_path / "b" / "dead.fmu")
    (tmp_path / "c" / "copy.fmu").write_bytes(dead.read_bytes())
    lag(tmp_path / "d", replaced(('fmiVersion="2.0"', 'fmiVersion="3.0"')))
    (tmp_path / "d" / "empty.fmu").touch()  # no archive
    monkeypatch.setenv("NAVFMU_PUBLIC_FMUS", str(tmp_path))
    section = public_fmus.run(tmp_path)
    text = text_of(section)
    assert "2 FMUs: 1 equal, 1 refused by both." in text and "ended its process with code -11" in text
    assert all(claim.holds for claim in section.claims)


def test_public_fmus_start_with_other_values_than_their_own(tmp_path):
    assert public_fmus.other_start(describe(lag(tmp_path))) == {"u": 2.25, "tau": 1.01}
    file = lag(tmp_path, replaced(('start="2"', 'start="2" max="2.1"')))
    assert public_fmus.other_start(describe(file)) == {"tau": 1.01}


@pytest.mark.parametrize(
    ("here", "verdict", "held"),
    [
        ({"time": [0.0, 1.0], "y": [1.0, 2.0 + 1e-12]}, "equal", [True, True]),
        ({"time": [0.0, 1.0], "y": [1.0, 2.1]}, "differs", [True, False]),
        ({"time": [0.0, 1.0], "y": [1.0, np.nan]}, "differs", [True, False]),
        ({"time": [0.0], "y": [1.0]}, "differs", [True, False]),
        ("no binary", "refused here", [False, True]),
    ],
)
def test_a_public_fmu_that_differs_or_is_refused_misses_a_claim(here, verdict, held):
    outcome = public_fmus.Outcome("x.fmu", "a tool", 0.1, {"time": [0.0, 1.0], "y": [1.0, 2.0]}, here)
    section = public_fmus.section([outcome])
    assert outcome.verdict == verdict and [claim.holds for claim in section.claims] == held
    assert f"1 {verdict}" in text_of(section)
