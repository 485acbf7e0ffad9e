"""An integration test: ``pytest examples/test_outage.py``."""

from navfmu import System

HALF_MILE = 926.0  # m


def test_dme_bounds_the_error_when_gps_is_lost():
    system = System.load("backup_navigator", variant="scanning")
    flight = system.run(stop=2100, step=0.01, seed=7, faults="gps_lost", record=["evaluation.horizontal_error"])
    assert flight["evaluation.horizontal_error"].quantile(0.95) < HALF_MILE
