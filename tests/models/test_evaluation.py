"""Evaluation: errors in metres, consistency, and counters that run while coasting."""

import numpy as np
import pymap3d
import pytest

from fmus.evaluation.evaluation import Evaluation
from models.evaluation import evaluation
from tests.models.native import interpret


def test_position_error_is_metres_north_and_east():
    lat, lon, h = 0.65, -2.1, 1500.0
    north, east = evaluation.position_error(lat, lon, h, lat + 5e-5, lon - 3e-5)
    n, e, _ = pymap3d.geodetic2ned(lat + 5e-5, lon - 3e-5, h, lat, lon, h, deg=False)
    assert (north, east) == pytest.approx((n, e), abs=0.02)  # the level plane bends away by that


def test_position_error_across_the_date_line():
    north, east = evaluation.position_error(0.0, np.pi - 1e-6, 0.0, 0.0, -np.pi + 1e-6)
    assert east == pytest.approx(2e-6 * 6378137.0) and north == 0.0


def compare(run, errors, sigma=100.0):
    """Feed one error (north, east in m) after the other, 1 s each."""
    north_south, east_west = 6335439.327, 6378137.0
    for north, east in errors:
        run.set("solution.latitude", north / north_south)
        run.set("solution.longitude", east / east_west)
        run.set("solution.valid", True)
        run.set("north_sigma", sigma)
        run.set("east_sigma", sigma)
        run.do_step(run.time, 1.0)


def test_counters_run_while_coasting_only():
    run = interpret(Evaluation)
    run.set("mode", 1)
    compare(run, [(5000.0, 0.0)])
    assert run.get("horizontal_error") == pytest.approx(5000.0, rel=1e-6)
    assert run.get("consistent") is False
    assert run.get("coasting_time") == run.get("maximum_error") == run.get("exceeded_share") == 0.0
    run.set("mode", 2)
    compare(run, [(30.0, -40.0), (0.0, 250.0), (301.0, 0.0), (1000.0, 0.0)])
    assert run.get("coasting_time") == 4.0
    assert run.get("consistent_share") == 0.5
    assert run.get("exceeded_share") == 0.25
    assert run.get("maximum_error") == pytest.approx(1000.0, rel=1e-6)
    squares = (0.25 + 6.25 + 3.01**2 + 100.0) / 4
    assert run.get("normalised_error") == pytest.approx(squares, rel=1e-4)


def test_nothing_is_said_about_a_solution_that_is_not_there():
    run = interpret(Evaluation, latitude=0.6)
    run.set("mode", 2)
    run.do_step(0.0, 2.0)
    assert run.get("horizontal_error") == 0.0
    assert run.get("consistent") is False and run.get("coasting_time") == 0.0
