"""Orders of errors: found, exact, or none."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.sweep.order import fit
from tests.sweep.made import made

STEPS = np.array([0.2, 0.4, 0.8, 1.6])


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.0])
def test_the_order_takes_into_account_that_the_reference_has_an_error_too(order):
    errors = [3.0 * (h**order - 0.1**order) for h in (0.1, 0.2, 0.4)]
    assert made(errors).order("gauss_seidel", "a.y").value == pytest.approx(order, abs=1e-4)


def test_two_errors_fit_exactly_and_that_is_told_apart():
    found = made([0.0, 0.02, 0.06]).order("gauss_seidel", "a.y")
    assert found.deviation is None and found.points == 2 and "exact" in str(found)
    clean = fit(STEPS, STEPS**2 - 0.01, 0.1)
    assert clean.deviation < 1e-3 and str(clean) == "2.00 ± 0.00"


def test_the_deviation_is_that_of_repeated_sweeps():
    """Errors with 10 % of noise, many times: the scatter of the orders is what each fit says of itself."""
    random = np.random.default_rng(1)
    found = [fit(STEPS, (STEPS - 0.1) * np.exp(random.normal(0.0, 0.1, 4)), 0.1) for _ in range(400)]
    scatter = np.std([order.value for order in found])
    claimed = np.sqrt(np.mean([order.deviation**2 for order in found]))
    assert claimed == pytest.approx(scatter, rel=0.15)


@pytest.mark.parametrize("errors", [[1e-9, 1.0, 2.0, 3.0], [1.0, 1.0, 1.0, 1.0], [3.0, 2.0, 1.0, 0.5], [1e-9, 1e9]])
def test_errors_without_an_order_get_none_and_not_the_edge_of_the_search(errors):
    """A jump once was of order 6.00, a constant of order 0.05."""
    assert fit(STEPS[: len(errors)], errors, 0.1) is None


def test_one_error_or_an_unknown_one_gives_no_order():
    assert made([0.0, 0.0, 0.3]).order("gauss_seidel", "a.y") is None
    assert made([0.0, 0.1, "is not finite"], steps=(0.1, 0.2, 0.4)).order("gauss_seidel", "a.y") is None
