"""The recommendation says what the numbers say, also the opposite."""

from __future__ import annotations

import itertools
import re

import pytest

from navfmu.sweep.recommendation import recommendation
from navfmu.sweep.result import ALGORITHMS
from tests.sweep.made import CLEAN, NAN, STEPS, counted, made


def test_the_greatest_step_below_which_all_is_well():
    result = made([0.0, 0.05, 0.3], [0.0, 0.2, 0.05], apart=0.5)
    text = recommendation(result)
    assert result.recommended("gauss_seidel") == 0.2 and result.recommended("jacobi") == 0.1
    assert "Use gauss_seidel with steps up to 0.2 s" in text and "(worst: a.y, rms error 0.05 m)" in text
    assert "At 0.4 s: a.y is off by 0.3 m rms, 3 % of its range." in text
    assert "With jacobi that is so at no step above 0.1 s." in text and "the two algorithms differ by up to 5 %" in text


def test_no_sample_is_lost_only_where_all_counters_are_zero():
    """The smallest step once lost 90 samples and the sentence none, because losses were counted from there on."""
    for numbers in itertools.product((0, 3, 90), repeat=3):
        result = made(lost=counted(*numbers))
        text, step = recommendation(result), result.recommended("gauss_seidel")
        assert ("no sample is lost" in text) <= (result.lost_at("gauss_seidel", step) == 0), (numbers, text)
        if numbers[0]:
            assert re.search(rf"\b{numbers[0]}\b.* at 0.1 s", text), text


def test_samples_lost_at_the_smallest_step_already_are_said():
    text = recommendation(made(lost=counted(90, 90, 200)))
    assert "but 90 samples are lost, and 90 at 0.1 s already: compare smaller steps, too." in text
    assert "At 0.4 s: 110 samples are lost more than the 90 at 0.1 s." in text
    text = recommendation(made(lost=counted(1, 2, 3)))
    assert "No step above 0.1 s" in text and "1 sample is lost at 0.1 s already: compare smaller steps." in text


def test_a_system_without_counters_is_not_praised_for_losing_nothing():
    text = recommendation(made())
    assert "no sample is lost" not in text and "no component counts lost samples" in text


def test_why_no_step_can_be_recommended_is_said_for_both_algorithms():
    text = recommendation(made([0.0, 0.3, 0.4], lost=counted(0, 7, 9)))
    assert "No step above 0.1 s can be recommended." in text
    assert "gauss_seidel at 0.2 s: a.y is off by 0.3 m rms, 3 % of its range and 7 samples are lost." in text
    assert "jacobi at 0.2 s: 7 samples are lost." in text


@pytest.mark.parametrize("problem", ["is not finite at 1 of 3 points", "is valid at no common point"])
def test_a_problem_at_the_smallest_step_leaves_nothing_to_recommend(problem):
    result = made([problem] * 3, [problem] * 3, apart=NAN)
    text = recommendation(result)
    assert "Use" not in text and result.recommended("gauss_seidel") is None
    assert f"Cannot be compared: a.y {problem} (gauss_seidel, 0.1 s, 0.2 s, 0.4 s), {problem} (jacobi," in text


def test_no_step_is_recommended_at_which_or_above_which_a_problem_begins():
    problem = "is not finite at 1 of 3 points"
    text = recommendation(made([0.0, 0.05, problem]))
    assert "Use gauss_seidel with steps up to 0.2 s" in text and f"At 0.4 s: a.y {problem}." in text
    assert f"Cannot be compared: a.y {problem} (gauss_seidel, 0.4 s)." in text
    result = made([0.0, problem, 0.05], [problem] * 3)
    assert result.recommended("gauss_seidel") == 0.1 and "Use" not in recommendation(result)


def test_a_problem_is_worse_than_any_number():
    for errors in ([0.0, "is not finite", 1e9], ["is not finite", 0.0, 0.0]):
        result = made(errors, CLEAN)
        step = STEPS[[isinstance(e, str) for e in errors].index(True)]
        assert result.worst("gauss_seidel", step).problem


def test_a_constant_signal_that_moves_has_no_share_of_its_range():
    text = recommendation(made([0.0, 0.1, 0.1], [0.0, 0.1, 0.1], span=0.0, apart=0.2))
    assert "a.y is off by 0.1 m rms, though it is constant" in text and "in a constant signal (a.y, 0.2 m rms)" in text
    assert "inf" not in text and "nan" not in text


def test_signals_that_are_valid_in_no_run_are_named():
    assert "valid in no run: gps.fix.latitude." in recommendation(made(idle=("gps.fix.latitude",)))


def test_both_algorithms_are_spoken_of():
    for errors in (CLEAN, [0.0, 0.5, 0.5], ["is not finite"] * 3):
        text = recommendation(made(CLEAN, errors))
        assert all(algorithm in text for algorithm in ALGORITHMS)
