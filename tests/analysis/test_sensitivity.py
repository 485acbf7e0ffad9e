"""Sensitivities in closed form, and what is not linear."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.analysis.circle import radius
from navfmu.analysis.sensitivity import sensitivity
from navfmu.cli.main import main
from tests.analysis import made

SEEDS = tuple(range(1, 31))


def made_of(seeds=SEEDS, variant=None, jobs=2, **given):
    return sensitivity(System.load(made.drifter(), variant).experiment(**given), seeds, jobs=jobs)


def by_name(found):
    return {response.name: response for response in found.responses}


@pytest.fixture(scope="module")
def found():
    return made_of()


def test_a_response_is_that_of_its_parameter_per_unit(found):
    """Slope d s t in x and half of that in y: mean square 1.25 s^2 t^2 <d^2>, so that its course is t^2 exactly, and
    the response per unit does not depend on the size.

    One that divides by half the size, or leaves an axis out, fails.
    """
    slope = by_name(found)["drifter.slope_sigma"]
    drawn = slope.squares / (1.25 * (0.4 * found.time) ** 2)
    assert drawn == pytest.approx(np.full(len(drawn), drawn[0]), rel=1e-9)
    assert 0.5 < drawn[0] < 1.6  # mean of 30 squares: 1 with a deviation of 0.26
    twice = by_name(made_of(parameters={"drifter.slope_sigma": 0.8}))["drifter.slope_sigma"]
    assert twice.size == 0.8 and twice.rms / twice.size == pytest.approx(slope.rms / slope.size, rel=1e-12)
    assert (slope.size, slope.unit) == (0.4, "m/s")


def test_what_is_linear_adds_up_with_its_signs(found):
    assert found.left < 1e-12 and all(response.bent < 1e-12 for response in found.responses)
    assert np.allclose(found.sum, found.error, rtol=0.0, atol=1e-12 * np.abs(found.error).max())


def test_what_is_not_linear_is_told():
    """y has x^2 / 20: half the slope makes a quarter of it, and the sum lacks the products."""
    bent = made_of(variant="bent")
    assert by_name(bent)["drifter.slope_sigma"].bent > 0.1 and bent.left > 0.1


def test_the_greatest_is_first_and_what_does_nothing_is_told(found):
    assert [r.name for r in found.responses] == ["drifter.slope_sigma", "drifter.offset_sigma", "drifter.idle_sigma"]
    assert found.remarks == ("drifter.idle_sigma changes nothing: errors are the same without it",)


def test_the_circle_holds_its_share_of_the_runs():
    """400 runs at 40 s, where the ellipse is 18.1 to 3 m: 200 of them are inside the circle of 50 %, 396 in that of
    99 %, within four deviations of a binomial.

    One that takes the printed sum of the axes x and y, 1.52 (s1 + s2), has 38 m for 46.7, which holds 96 %.
    """
    last = made_of(tuple(range(1, 401)))
    lengths = np.hypot(*last.error[:, -1].T)
    for share, reach in ((0.5, 40), (0.99, 8)):
        inside = int(np.sum(lengths <= float(radius(last.squares, share))))
        assert abs(inside - 400 * share) <= reach, (share, inside)


def test_the_answer_is_the_same_for_any_number_of_jobs():
    one, three = (made_of((1, 2, 3), jobs=jobs) for jobs in (1, 3))
    assert np.array_equal(one.sum, three.sum) and [r.rms for r in one.responses] == [r.rms for r in three.responses]


def test_the_command_tells_what_does_most(tmp_path):
    words = ["analyse", "sensitivity", str(made.drifter()), "--seeds", "1-5", "--from", "10", "--out", str(tmp_path)]
    answer = CliRunner().invoke(main, words)
    assert answer.exit_code == 0, answer.stderr
    told = " ".join(answer.stdout.split())
    assert "drifter.slope_sigma does most" in told and "m per m/s" in told and "0.589 (s1 + s2)" in told
    about = json.loads((tmp_path / "analysis.json").read_text())
    assert about["left"] < 1e-12
    again = CliRunner().invoke(main, [*about["provenance"]["command"].split()[1:], "--out", str(tmp_path / "again")])
    assert again.exit_code == 0, again.stderr
    assert (tmp_path / "again" / "analysis.csv").read_bytes() == (tmp_path / "analysis.csv").read_bytes()
