"""Covariance analysis of errors in closed form: who is honest, who is not, and where."""

from __future__ import annotations

import json

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.analysis.consistency import bounds, judge, normalised_squares
from navfmu.analysis.covariance import covariance
from navfmu.analysis.ensemble import Ensemble, Window
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from tests.analysis import made

SEEDS = tuple(range(1, 61))


def analysed(seeds=SEEDS, window=Window(), **given):  # noqa: B008
    return covariance(System.load(made.drifter()).experiment(**given), seeds, window, jobs=2)


@pytest.fixture(scope="module")
def honest():
    return analysed()


def test_what_is_claimed_is_what_the_closed_form_says(honest):
    """sigma_x^2 = (0.4 t)^2 + 9, sigma_y^2 = (0.2 t)^2 + 9. One that takes elements in another order fails."""
    time = honest.ensemble.time
    assert time[0] == 2.0 and time[-1] == 40.0 and len(time) == 39  # it runs from 2 s on, a point a second
    assert honest.claimed[:, 0] == pytest.approx(np.hypot(0.4 * time, 3.0), rel=1e-12)
    assert honest.claimed[:, 1] == pytest.approx(np.hypot(0.2 * time, 3.0), rel=1e-12)


def test_an_honest_claim_is_consistent(honest):
    """60 runs: the rms of an axis lies within 0.79 to 1.21 of sigma with 98 % at a point."""
    assert honest.verdict.word == "consistent" and honest.verdict.chance > 0.05
    ratio = honest.observed[-1] / honest.claimed[-1]
    assert np.all((ratio > 0.75) & (ratio < 1.25))


def test_the_normalised_square_takes_the_correlation_in():
    """At 40 s x and y correlate by 0.93: without P_xy the mean is 2 as well, but its spread is not chi-square's.

    The variance of chi-square with 2 degrees of freedom is 4; of the sum of two squares that correlate by r it is
    4 (1 + r^2), 7.5 here. 400 draws of known covariance: the sample variance of an exponential has a relative standard
    error of sqrt(8/400) = 14 %.
    """
    factor = np.array([[16.0, 0.0], [8.0, 3.0]])
    claimed = factor @ factor.T
    draws = np.random.default_rng(5).normal(size=(400, 1, 2)) @ factor.T
    packed = np.broadcast_to([claimed[0, 0], claimed[0, 1], claimed[1, 1]], (400, 1, 3))
    squares = normalised_squares(Ensemble(("x", "y"), "m", np.array([0.0]), draws, packed))
    assert squares.var() == pytest.approx(4.0, rel=0.42)
    direct = np.einsum("rpi,ij,rpj->rp", draws, np.linalg.inv(claimed), draws)
    assert squares == pytest.approx(direct, rel=1e-9)


def test_who_claims_too_little_or_too_much_is_told():
    """Sigmas of 0.7 and 1.4 of what they are: squares of 4.1 and 1.02 in the mean of 60 runs."""
    small = analysed(parameters={"drifter.told_slope": 0.28, "teller.value": 2.1})
    large = analysed(parameters={"drifter.told_slope": 0.56, "teller.value": 4.2})
    assert (small.verdict.word, large.verdict.word) == ("overconfident", "cautious")
    honest = analysed().verdict
    assert small.verdict.mean == pytest.approx(honest.mean / 0.49, rel=1e-9)
    assert small.verdict.chance < 0.05 < large.verdict.chance


def test_the_interval_covers_in_95_of_100_experiments():
    """A verdict of 20 honest runs whose points are all alike: 300 repetitions, 95 % within three sigma of a binomial.

    The square of one run is exponential here, which is as skewed as it can be: Student's interval then covers less, 91
    to 92 % with 20 runs; one that took the points for independent would cover a quarter of the time.
    """
    random = np.random.default_rng(11)
    points, covered = 50, 0
    for _ in range(300):
        error = np.repeat(random.normal(size=(20, 1, 2)), points, axis=1)
        packed = np.broadcast_to([1.0, 0.0, 1.0], (20, points, 3))
        covered += judge(Ensemble(("x", "y"), "m", np.arange(points) * 1.0, error, packed)).word == "consistent"
    assert 0.86 < covered / 300 < 0.97


def test_bounds_are_those_of_chi_square():
    """Of 80 degrees of freedom, Abramowitz and Stegun table 26.8: 57.153 and 106.629."""
    assert bounds(40) == pytest.approx((57.153 / 40, 106.629 / 40), abs=1e-4)


def test_the_answer_is_the_same_for_any_number_of_jobs():
    experiment = System.load(made.drifter()).experiment()
    one, three = (covariance(experiment, range(1, 8), jobs=jobs) for jobs in (1, 3))
    assert np.array_equal(one.ensemble.error, three.ensemble.error) and one.verdict == three.verdict


def test_a_window_leaves_out_what_is_not_in_it():
    found = analysed((1, 2), Window(10.0, 25.0)).ensemble.time
    assert (found[0], found[-1]) == (10.0, 25.0)


# ---- sentences -------------------------------------------------------------------------------------------------------


def test_a_trajectory_that_is_too_short_is_told():
    with pytest.raises(NavfmuError, match=r"too short: from 0 s to 8 s there are 7 points .* expected at least 10"):
        analysed((1,), stop=8.0)


def test_what_is_no_number_is_told():
    with pytest.raises(NavfmuError, match=r"seed 3: .* not a finite number at 31 s"):
        analysed((3,), parameters={"drifter.nothing": 30.0})


def test_a_system_without_a_table_is_told():
    from tests.components import systems

    with pytest.raises(NavfmuError, match=r"says nothing about analyses; its report.toml needs a table \[analysis\]"):
        covariance(System.load(systems.tracker()).experiment())


WRONG = {
    "x_errr": ('"drifter.x_error"', '"drifter.x_errr"', "has no variable 'x_errr'; did you mean 'x_error'?"),
    "one": ('"drifter.covariance"', '"drifter.x_error"', "'drifter.x_error' stands for 1 signals, expected 3"),
    "sigma": ("drifter.slope_sigma", "drifter.slop_sigma", "did you mean 'slope_sigma'?"),
    "output": ("drifter.slope_sigma", "drifter.x_error", "is a Real output, expected a Real parameter or input"),
    "twice": ('name = "offsets"', 'name = "slope"', "there are two sources 'slope'"),
    "pattern": ("drifter.offset*", "drifter.ofset*", "no parameter matches 'drifter.ofset*'"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_table_is_told_with_its_line(case):
    before, after, sentence = WRONG[case]
    system = System.load(made.drifter(made.TABLE.replace(before, after), f"wrong_{case}"))
    with pytest.raises(NavfmuError) as told:
        covariance(system.experiment())
    assert sentence in str(told.value) and "report.toml, line" in str(told.value)


# ---- the command -----------------------------------------------------------------------------------------------------


def navfmu(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def test_the_command_writes_table_numbers_picture_and_report(tmp_path):
    answer = navfmu("analyse", "covariance", made.drifter(), "--seeds", "1-12", "--from", 5, "--out", tmp_path)
    assert answer.exit_code == 0, answer.stderr
    table = pandas.read_csv(tmp_path / "analysis.csv")
    assert table.time.iloc[0] == 5.0 and table.x_claimed.iloc[-1] == pytest.approx(np.hypot(16.0, 3.0))
    about = json.loads((tmp_path / "analysis.json").read_text())
    assert about["word"] == "consistent" and about["word"] in answer.stdout
    assert (tmp_path / "analysis.png").read_bytes()[:4] == b"\x89PNG" and (tmp_path / "report.html").is_file()
    words = about["provenance"]["command"].split()
    assert words[:3] == ["navfmu", "analyse", "covariance"]
    again = navfmu(*words[1:], "--out", tmp_path / "again")
    assert again.exit_code == 0, again.stderr
    assert (tmp_path / "again" / "analysis.csv").read_bytes() == (tmp_path / "analysis.csv").read_bytes()


def test_the_command_tells_what_is_wrong(tmp_path):
    for words, sentence in (
        (["--seed", "3"], "--seed: an analysis has a run for each of its seeds"),
        (["--seeds", "x"], "--seeds: 'x' is not a seed"),
        (["--from", "soon"], "--from is 'soon', expected a time"),
        (["--stop", "5"], "the trajectory is too short"),
    ):
        answer = navfmu("analyse", "covariance", made.drifter(), *words)
        assert answer.exit_code == 2 and sentence in " ".join(answer.stderr.split()), answer.stderr
    assert "did you mean 'covariance'" in navfmu("analyse", "covarianc").stderr
