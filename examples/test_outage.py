"""An integration test: ``pytest examples/test_outage.py``."""

HALF_MILE = 926.0  # m


def test_dme_bounds_the_error_when_gps_is_lost(system):
    with system("backup_navigator", variant="scanning") as s:
        s.fault("gps.jammed", at=300)
        flight = s.run(2100, seed=7)
    assert flight["evaluation.horizontal_error"].quantile(0.95) < HALF_MILE
