"""Flights of attitude references: what counts as an error, and which claim says that sigmas are too small."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.sensors import attitude
from navfmu.report.page import Page


def flights(ratio: float, before: float = 0.0) -> attitude.Flights:
    """Ten flights of 2000 s with sigmas of 2 deg and errors of about ``ratio`` times that, ``before`` SETTLED more."""
    rng = np.random.default_rng(5)
    error = 2.0 * ratio * rng.standard_normal((10, 3, 2000))
    error[:, :, : attitude.SETTLED] += before
    return attitude.Flights(error, np.full_like(error, 2.0), np.full((10, 2000), 300.0))


def found(ratio: float) -> attitude.Found:
    each = {name: flights(ratio) for name in attitude.REFERENCES}
    return attitude.Found(dict.fromkeys(attitude.CASES, each), {"tactical": each})


@pytest.mark.parametrize(("ratio", "holds"), [(0.9, True), (1.0, True), (1.1, False)])
def test_sigmas_that_are_too_small_miss_the_claim(ratio, holds):
    """Squares of 20 000 errors are within 3 % of their mean; 1.1 has 1.21. A mean of sizes would have 0.8 of it."""
    claims = attitude.make_claims(found(ratio))
    assert [claim.holds for claim in claims] == [holds] * len(attitude.HONEST)


def test_one_angle_that_is_overconfident_is_enough():
    flown = flights(0.5)
    flown.error[:, 1] *= 3.0
    assert flown.overconfident() > 1.0


def test_what_is_before_it_has_settled_and_where_it_is_not_valid_does_not_count():
    flown = flights(0.5, before=100.0)
    flown.error[0, :, 500:600] = np.nan
    flown.sigma[0, :, 500:600] = np.nan
    roll, *_, valid, position = flown.row()
    assert float(roll.partition(" ")[0]) == pytest.approx(1.0, abs=0.02) and position == "300"
    assert float(valid) == pytest.approx(100.0 * (1.0 - 100.0 / 10.0 / (2000 - attitude.SETTLED)), abs=0.05)


def test_the_page_has_a_row_for_each_reference_and_case():
    page = Page("")
    attitude.section(found(0.5)).write(page)
    assert page.html().count("<td>ahrs_vectors</td>") == len(attitude.CASES) + 1
