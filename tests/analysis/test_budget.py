"""Budgets of errors and claims in closed form."""

from __future__ import annotations

import json

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.analysis.budget import budget
from navfmu.analysis.ensemble import Window, recorded
from navfmu.analysis.sources import Sources
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from tests.analysis import made

SEEDS = tuple(range(1, 31))


def made_of(of, seeds=SEEDS, variant=None, **given):
    return budget(System.load(made.drifter(), variant).experiment(**given), of, seeds, jobs=2)


@pytest.fixture(scope="module")
def errors():
    return made_of("errors")


def test_claims_in_closed_form():
    """Slope alone: (0.4 t)^2 (1 + 1/4), offsets alone: 2 * 9, told through an input; they add up to the whole.

    One that sets the value of the connected input, which has no effect, fails; so does one that leaves out an axis.
    """
    found = made_of("claims")
    time = found.time
    assert found.alone["slope"] == pytest.approx(1.25 * (0.4 * time) ** 2, rel=1e-12)
    assert found.alone["offsets"] == pytest.approx(np.full(len(time), 18.0), rel=1e-12)
    assert found.without["slope"] == pytest.approx(found.alone["offsets"], rel=1e-12)
    assert found.sum == pytest.approx(found.all, rel=1e-12) and np.all(found.rest == 0.0)
    assert found.largest == "slope" and list(found.alone) == ["slope", "offsets"]
    assert found.share("slope") == pytest.approx(0.2 * np.sum(time**2) / np.sum(0.2 * time**2 + 18.0), rel=1e-12)


def test_errors_are_those_of_runs_that_have_one_source(errors):
    """Beside runs whose parameters are set by hand."""
    system = System.load(made.drifter())
    squares = []
    for seed in SEEDS:
        frame = system.run(
            seed=seed, parameters={"drifter.offset_sigma": 0.0}, record=["drifter.x_error", "drifter.y_error"],
            record_period=1.0,
        )  # fmt: skip
        squares.append((frame.loc[errors.time] ** 2).sum(axis=1).to_numpy())
    assert errors.alone["slope"] == pytest.approx(np.mean(squares, axis=0), rel=1e-12)


def test_errors_of_what_is_linear_add_up_run_by_run_and_of_what_is_not_do_not(errors):
    """x^2 / 20 of the variant ``bent`` mixes slope and offset: 2 * 0.05 * slope t * offset is in no single run."""
    assert errors.superposed < 1e-12
    assert made_of("errors", variant="bent").superposed > 0.1
    assert errors.adds_up and errors.ratio == pytest.approx(1.0, abs=0.2)


def test_the_sum_of_squares_is_within_what_the_runs_allow(errors):
    """All less the sum is twice the mean product of slope and offsets, 0 in expectation: over 30 runs its deviation at
    40 s is 2 sqrt((16^2 3^2 + 8^2 3^2) / 30) = 19.6 of 338; five of them are allowed, at the end."""
    assert abs(errors.all[-1] - errors.sum[-1]) < 5 * 19.6


def test_a_source_that_changes_nothing_and_one_that_is_not_there_are_told(errors):
    assert "nothing changes nothing: errors are the same with it and without it" in errors.remarks
    assert errors.share("nothing") == 0.0
    found = made_of("errors", (1, 2), parameters={"drifter.slope_sigma": 0.0})
    assert "slope is left out: this variant has no such errors, or all its parameters are 0" in found.remarks
    assert "nothing is left out: this variant knows nothing of it" in made_of("claims").remarks[0]


def test_what_the_estimator_is_told_stays_when_the_sensor_that_tells_it_is_silent():
    """Sensors tell how good they are: without their errors the estimator would be another one. The claim of the run
    without errors is that of the run with them."""
    table = made.TABLE.replace('"drifter.offset*"', '"drifter.offset*", "teller.value"')
    asked = recorded(System.load(made.drifter(table, "telling")).experiment(seed=1))
    sources = Sources.of(asked, "errors", Window())
    silent = sources.moved(sources.factors("errors", 0.0, *sources.names)).run()
    assert np.all(silent["drifter.x_error"] == 0.0)
    assert np.array_equal(silent["drifter.covariance[1]"], asked.run()["drifter.covariance[1]"])


def test_the_answer_is_the_same_for_any_number_of_jobs():
    experiment = System.load(made.drifter()).experiment()
    one, three = (budget(experiment, "errors", (1, 2, 3), jobs=jobs) for jobs in (1, 3))
    assert np.array_equal(one.sum, three.sum) and np.array_equal(one.all, three.all)


def test_no_source_at_all_is_told():
    table = made.TABLE[: made.TABLE.index("[[analysis.source]]")]
    with pytest.raises(NavfmuError, match=r"names no source of errors that this variant has; it needs tables"):
        budget(System.load(made.drifter(table, "sourceless")).experiment())


def test_the_command_writes_its_table_and_says_how_to_repeat_it(tmp_path):
    def navfmu(*words):
        return CliRunner().invoke(main, [str(word) for word in words])

    answer = navfmu("analyse", "budget", made.drifter(), "--of", "claims", "--from", 10, "--out", tmp_path)
    assert answer.exit_code == 0, answer.stderr
    assert "slope is the largest source of the claimed error" in " ".join(answer.stdout.split())
    table = pandas.read_csv(tmp_path / "analysis.csv")
    assert table["slope, alone"].iloc[-1] == pytest.approx(16.0 * np.sqrt(1.25))
    words = json.loads((tmp_path / "analysis.json").read_text())["provenance"]["command"].split()
    again = navfmu(*words[1:], "--out", tmp_path / "again")
    assert again.exit_code == 0, again.stderr
    assert (tmp_path / "again" / "analysis.csv").read_bytes() == (tmp_path / "analysis.csv").read_bytes()
    wrong = navfmu("analyse", "budget", made.drifter(), "--of", "claim")
    assert wrong.exit_code == 2 and "a budget of 'claim'; did you mean 'claims'?" in wrong.stderr
