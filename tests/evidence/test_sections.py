"""Evidence follows the data: a missed claim is said, in table, title and exit code."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pygeomag
import pytest
from click.testing import CliRunner
from scipy import stats

from benchmarks.contest import Contest
from evidence import __main__ as command
from evidence import closure, headline, public_fmus, real_flights, speed, step_sizes
from evidence.recorded import figures
from evidence.recorded.flight import VARIANTS, Flown, moved
from evidence.section import Section
from navfmu.fmi.fmu import describe
from navfmu.navaids.coverage import Coverage
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
    assert page.index("All is well") < page.index("Something</h2>")


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
         "Not at every time 95 % of the flights are inside their filter's own 3 sigma, scanning receiver"),
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


def flown(
    error: float = 100.0,
    sigma: float = 100.0 / np.sqrt(2.0),
    attitude: float = 1.0,
    consistent: float = 97.0,
    correlation: float = 0.0,
    latitude: float = 0.7,
    longitude: float = 0.1,
    stations: tuple[int, ...] = (0, 1),
) -> Flown:
    """A flight of 1000 s with three seeds; ``attitude`` is the error of all angles over their sigma of 1 deg."""
    time = np.arange(0.0, 1001.0)
    one = np.radians(1.0)
    columns = {
        "evaluation.horizontal_error": error,
        "evaluation.north_error": error,
        "evaluation.east_error": 0.0,
        "evaluation.consistent": np.arange(len(time)) % 100 < consistent,
        "navigator.north_sigma": sigma,
        "navigator.east_sigma": sigma,
        "navigator.position_covariance[2]": correlation * sigma**2,
        "navigator.used": 7.0,
        "navigator.rejected": 3.0,
    }
    for angle in ("roll", "pitch", "heading"):
        columns |= {f"aircraft.{angle}": 0.3, f"ahrs.attitude.{angle}_sigma": one}
        columns |= {f"ahrs.attitude.{angle}": 0.3 + attitude * one * (-1.0) ** np.arange(len(time))}
    run = pd.DataFrame(columns, index=time)
    where = {"latitude": latitude, "longitude": longitude, "altitude": 3000.0}
    track = {"time": time} | {name: value + 0.0 * time for name, value in where.items()}
    nothing = Coverage(stations, None, *(np.zeros(0),) * 3)
    return Flown("made", None, track, nothing, nothing, {variant: [run] * 3 for variant in VARIANTS})


def test_recorded_flights_say_whether_the_filters_know_their_error():
    assert all(claim.holds for claim in real_flights.Judged(flown()).claims())
    for wrong, told in (
        ({"consistent": 60.0}, "position is outside of the navigator's own 3 sigma"),
        ({"attitude": 1.5}, "the heading is overconfident"),
        ({"sigma": 50.0}, "the position is overconfident"),
        ({"sigma": 100.0}, "the position is overcautious"),
        ({"attitude": 0.5}, "the roll is overcautious"),
        ({"attitude": 4.0}, "the heading is outside of its own 3 sigma"),
    ):
        claims = real_flights.Judged(flown(**wrong)).claims()
        assert any(told in claim.sentence for claim in claims if not claim.holds), told
    attitude, position = real_flights.titles([real_flights.Judged(flown(attitude=1.5))])
    assert attitude == "Attitude: 7 of 10 claims on its sigmas hold"
    assert position == "Position without GPS: as wrong as it says on every flight"


def test_nothing_is_said_of_positions_that_were_not_judged():
    alone = real_flights.Judged(flown(stations=()))
    assert real_flights.titles([alone])[1] == "Position without GPS: not judged on any flight"
    assert "Position without GPS: not judged on any flight" in real_flights.document([alone])


@pytest.mark.parametrize(("latitude", "longitude"), [(1.3, -1.6), (-1.2, 2.4)], ids=["north", "south"])
def test_the_field_is_steep_near_both_of_its_poles(latitude, longitude):
    """The dip is negative in the south. What turns the needle has the horizontal field against it."""
    claims = real_flights.Judged(flown(attitude=2.0, latitude=latitude, longitude=longitude)).claims()
    north, east, _, total = magnetic(latitude, longitude)
    (bound,) = [claim.bound for claim in claims if "the heading's error" in claim.text]
    assert bound == pytest.approx(2.6 * np.cos(np.radians(78.0)) * total / np.hypot(north, east), rel=1e-3)
    assert real_flights.heading_bound(78.0) == real_flights.heading_bound(-78.0) == pytest.approx(2.6)
    assert real_flights.heading_bound(81.0) == pytest.approx(3.456, abs=1e-3)
    assert real_flights.heading_bound(60.0) == 1.6


def magnetic(latitude, longitude):
    """North, east and down field and its strength, by an independent program."""
    at = pygeomag.GeoMag(coefficients_file="wmm/WMM_2025.COF").calculate(
        np.degrees(latitude), np.degrees(longitude), 3.0, 2026.0
    )
    return at.x, at.y, at.z, at.f


@pytest.mark.parametrize(
    ("decay", "share", "expected"),
    [(0.0, 0.0, 2000.0), (0.0, 1.0, 1.0), (np.exp(-1.0 / 50.0), 0.0, 2000.0 / 50.0), (np.exp(-1.0 / 50.0), 0.5, 3.6)],
    ids=["white", "constant", "Gauss-Markov", "half of it constant"],
)
def test_a_run_has_as_many_degrees_of_freedom_as_its_errors_correlation_leaves(decay, share, expected):
    """White noise has its samples, a constant one, exp(-t / tau) has T / tau. Half of the variance constant for a run:
    1 / nu = 1/4 + 2 / 4 x 2 tau / T + 1/4 x tau / T. The estimate is of 400 runs.

    No more of the worst of ten runs than 5 % exceed their bound of that chance: binomial at 1e-6, of 400 tens; with
    samples for degrees of freedom most do. Chi-square stands for a sum of unequal ones, which has a longer tail where
    the parts differ most: 1.5 times as often there.
    """
    rng = np.random.default_rng(11)
    runs, count = 4000, 2000
    errors = np.empty((runs, count))
    value = rng.standard_normal(runs)
    for k in range(count):
        errors[:, k] = value
        value = decay * value + np.sqrt(1.0 - decay**2) * rng.standard_normal(runs)
    errors = np.sqrt(1.0 - share) * errors + np.sqrt(share) * rng.standard_normal((runs, 1))
    nu = figures.freedom(errors[:400])
    assert nu == pytest.approx(expected, rel=0.1)
    worst = np.max(np.mean(errors**2, axis=1).reshape(-1, 10), axis=1)
    beyond = np.mean(worst > figures.worst(1.0, nu, 10, 0.05))
    assert beyond <= stats.binom.ppf(1.0 - 1e-6, 400, 0.075 if share == 0.5 else 0.05) / 400


@pytest.mark.parametrize("lasting", [0.0, 1.0], ids=["scatters", "lasts"])
def test_a_single_run_that_is_too_far_off_is_told(lasting):
    """One of three flights is wrong by four sigma all the time: its mean square of 16 is beyond any chi-square of as
    many degrees of freedom as a run with changing errors has, and, by a little, beyond that of a single one: an error
    that lasts for the run leaves all of them no more."""
    rng = np.random.default_rng(5)
    honest = flown()
    runs = [run.copy() for run in honest.runs["main"]]
    for run, size in zip(runs, (0.7, 0.7, 4.0), strict=True):
        noise = size * (rng.standard_normal(len(run)) if lasting == 0.0 or size < 1.0 else np.ones(len(run)))
        run["ahrs.attitude.heading"] = run["aircraft.heading"] + run["ahrs.attitude.heading_sigma"] * noise
        run["evaluation.north_error"] = run["navigator.north_sigma"] * np.sqrt(2.0) * noise
    judged = real_flights.Judged(replace(honest, runs={"main": runs}))
    told = [claim.sentence for claim in judged.claims() if not claim.holds]
    assert any("the heading is overconfident in a single run" in sentence for sentence in told)
    assert any("the position is overconfident in a single run" in sentence for sentence in told)


def test_figures_of_recorded_flights_are_those_that_can_be_said_beforehand():
    heading = figures.angle(flown(attitude=2.0).runs["main"], "heading")
    assert heading.rms == pytest.approx(2.0)
    assert heading.nees.value == pytest.approx(4.0) and heading.nees.half == pytest.approx(0.0, abs=1e-9)
    where = figures.position(flown(300.0, 100.0).runs["main"])
    assert (where.median, where.above, where.used, where.rejected) == (300.0, 0.0, 7.0, 3.0)
    assert where.nees.value == pytest.approx(9.0)
    across = figures.position(flown(300.0, 100.0, correlation=0.8).runs["main"])
    assert across.nees.value == pytest.approx(25.0), "the error is not along the long axis of the uncertainty"
    assert figures.position(flown(np.nan).runs["main"]).above == 100.0
    gone = figures.position(flown(consistent=20.0).runs["main"])
    assert (gone.longest, gone.lost) == (80.0 / 60.0, 7 * 80.0 / 60.0)
    assert figures.position(flown(consistent=50.0).runs["main"]).lost == 0.0, "no stretch is longer than a minute"
    wrapped = pd.DataFrame(flown(attitude=0.0).runs["main"][0])
    wrapped["aircraft.heading"] += 2.0 * np.pi
    assert figures.angle([wrapped], "heading").rms == pytest.approx(0.0, abs=1e-9)


def test_a_mean_over_seeds_has_the_interval_of_students_t():
    mean = figures.Mean.of(np.array([1.0, 2.0, 3.0]))
    assert (mean.value, mean.least, mean.most) == (2.0, 1.0, 3.0)
    assert mean.half == pytest.approx(4.302653 / np.sqrt(3.0), rel=1e-6)


@pytest.mark.parametrize(("first", "last"), [(5.0, 5.5), (179.9, -179.6), (-179.8, 179.7), (179.4, 179.9)])
def test_a_moved_flight_flies_the_same_distances(first, last, tmp_path):
    """Over the date line, too, as recorded or where it is moved to: longitudes stay from -180 to 180."""
    table = pd.DataFrame({"time_s": [0, 60], "latitude_deg": [40.0, 40.2], "longitude_deg": [first, last]})
    table.to_csv(tmp_path / "flight.csv", index=False)
    there = pd.read_csv(moved(tmp_path / "flight.csv", 70.0, tmp_path / "there.csv"))
    assert there["latitude_deg"].tolist() == pytest.approx([70.0, 70.2])
    assert np.max(np.abs(there["longitude_deg"])) <= 180.0
    east = np.remainder(there["longitude_deg"][1] - first + 180.0, 360.0) - 180.0
    flown_east = np.remainder(last - first + 180.0, 360.0) - 180.0
    assert east * np.cos(np.radians(70.2)) == pytest.approx(flown_east * np.cos(np.radians(40.2)))


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
