"""Flights of navigators: what counts as an error, and which claim says that it is not what a navigator says."""

from __future__ import annotations

import numpy as np
import pytest

from evidence import navigators
from navfmu.report.page import Page


def flights(ratio: float, late: float = 1.0) -> navigators.Flights:
    """Flights of half an hour with errors that are ``ratio`` times what is said of them, ``late`` times that in the
    last third; north and east are correlated by a half."""
    rng = np.random.default_rng(5)
    root = np.linalg.cholesky(100.0**2 * np.array([[1.0, 0.5], [0.5, 1.0]]))
    errors = ratio * rng.standard_normal((len(navigators.SEEDS), 1800, 2)) @ root.T
    errors[:, 1200:] *= late
    return navigators.Flights(errors, np.broadcast_to(root @ root.T, (*errors.shape, 2)), np.zeros((2101, 4)))


def found(**how: float) -> dict[str, dict[str, navigators.Flights]]:
    each = dict.fromkeys(navigators.FLOWN, flights(**how))
    return dict.fromkeys(navigators.CASES, each)


@pytest.mark.parametrize(
    ("how", "holds"),
    [({"ratio": 1.0}, True), ({"ratio": 1.7}, False), ({"ratio": 0.6}, False), ({"ratio": 1.0, "late": 2.0}, False)],
    ids=["right", "boasting", "timid", "boasting at last"],
)
def test_errors_that_are_not_what_is_said_miss_the_claim(how, holds):
    """Either way, and at a single moment: a mean over all moments, or a bound on one side, lets the others pass."""
    claims = navigators.make_claims(found(**how))
    assert len(claims) == 4
    assert [claim.holds for claim in claims] == [holds] * 4


def test_squares_take_the_correlation_of_north_and_east():
    """One sigma on both axes, to the side to which a correlation of a half points: 2 (1 - rho) / (1 - rho^2) = 4/3,
    where sums of squares over the sigmas are 2."""
    flown = flights(1.0)
    flown.errors[:] = 100.0
    np.testing.assert_allclose(flown.squares, 4.0 / 3.0)


def test_a_row_says_how_many_flights_keep_half_a_mile():
    flown = flights(1.0)
    flown.errors[:10] += 3000.0
    error, last, kept, inside, *_ = flown.row()
    assert kept == f"{100.0 - 1000.0 / len(navigators.SEEDS):.0f}"
    assert float(inside) == pytest.approx(100.0 * 0.9949 * (1.0 - 10.0 / len(navigators.SEEDS)), abs=0.3)
    assert error.endswith("(141)") and last.endswith("(141)")  # 100 m on both axes


def test_the_page_has_a_row_for_each_navigator_and_case():
    page = Page("")
    navigators.section(found(ratio=1.0)).write(page)
    for name in navigators.FLOWN:
        assert page.html().count(f"<td>{name}</td>") == len(navigators.CASES)
