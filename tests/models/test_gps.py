"""GPS: white errors of thesis section 3.10, and what a jammed receiver says."""

import numpy as np
import pytest
from scipy import stats

from fmus.satellite.gps import Gps
from models.earth import earth
from models.satellite import gps
from tests.models.native import Native, interpret

TRUTH = {
    "latitude": 0.65,
    "longitude": -2.1,
    "altitude": 1500.0,
    "velocity_n": (40.0, -20.0, 1.0),
    "roll": 0.2,
    "pitch": 0.05,
    "heading": 3.1413,
}


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Gps, tmp_path_factory.mktemp("gps"))


def test_errors_have_the_stated_sigmas_and_are_white(native):
    names = ["fix.latitude", "fix.longitude", "fix.altitude", "fix.velocity_n"]
    names += ["attitude.roll", "attitude.pitch", "attitude.heading"]
    got = native.run(4000.0, 1.0, names, {}, lambda t: TRUTH if t == 0.0 else {})
    north_south, east_west = earth.radii(0.65)
    errors = {
        2.0: np.stack(
            [
                (got["fix.latitude"] - 0.65) * (north_south + 1500.0),
                (got["fix.longitude"] + 2.1) * (east_west + 1500.0) * np.cos(0.65),
            ]
        ),
        5.0: got["fix.altitude"][None] - 1500.0,
        0.1: got["fix.velocity_n"].T - np.array(TRUTH["velocity_n"])[:, None],
        np.radians(0.25): np.stack(
            [
                got["attitude.roll"] - 0.2,
                got["attitude.pitch"] - 0.05,
                (got["attitude.heading"] - 3.1413 + np.pi) % (2 * np.pi) - np.pi,
            ]
        ),
    }
    assert np.max(np.abs(got["attitude.heading"])) <= np.pi  # wrapped, although the truth lies at the seam
    for sigma, error in errors.items():
        error = error[:, 1:] / sigma
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], error.size) / error.size
        assert low < np.mean(error**2) < high
        assert abs(np.mean(error[:, 1:] * error[:, :-1])) < 4.9 / np.sqrt(error.size)


def test_displaced_moves_by_metres():
    latitude, longitude = gps.displaced(0.65, -2.1, 1500.0, 100.0, -200.0)
    a, b = earth.to_ecef(0.65, -2.1, 1500.0), earth.to_ecef(latitude, longitude, 1500.0)
    assert np.linalg.norm(b - a) == pytest.approx(np.hypot(100.0, 200.0), rel=1e-4)


def test_a_jammed_receiver_reports_that_it_has_no_fix_and_holds_the_last():
    run = interpret(Gps, **TRUTH)
    run.do_step(0.0, 3.0)
    before = {name: run.get(name) for name in ("fix.latitude", "fix.altitude", "attitude.roll")}
    assert (run.get("fix.valid"), run.get("fix.sequence"), run.get("attitude.sequence")) == (True, 3, 6)
    run.set("jammed", True)
    run.do_step(3.0, 4.0)
    assert (run.get("fix.valid"), run.get("fix.sequence"), run.get("fix.time_of_validity")) == (False, 7, 7.0)
    assert run.get("attitude.valid") is False
    assert {name: run.get(name) for name in before} == before
    run.set("jammed", False)
    run.do_step(7.0, 1.0)
    assert run.get("fix.valid") is True and run.get("attitude.valid") is True
    assert run.get("fix.latitude") != before["fix.latitude"]
