"""GPS: white errors of thesis section 3.10, and what a jammed receiver says."""

import numpy as np
import pymap3d
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


QUIET = dict.fromkeys(("horizontal_sigma", "vertical_sigma", "velocity_sigma", "attitude_sigma"), 0.0)
EARTH = 6.371e6


def fixes(seconds, inputs, **parameters):
    """Errors north, east, down in m, velocity, and `fix.valid` and `attitude.valid` after each second."""
    run = interpret(Gps, **TRUTH, **{**QUIET, **parameters})
    errors, velocities, valid = [], [], []
    for k in range(seconds):
        for name, value in inputs(float(k)).items():
            run.set(name, value)
        run.do_step(float(k), 1.0)
        at = [run.get(f"fix.{name}") for name in ("latitude", "longitude", "altitude")]
        errors.append(pymap3d.geodetic2ned(*at, TRUTH["latitude"], TRUTH["longitude"], TRUTH["altitude"], deg=False))
        velocities.append(run.get("fix.velocity_n"))
        valid.append([run.get("fix.valid"), run.get("attitude.valid")])
    return np.array(errors, float), np.array(velocities, float), np.array(valid, bool)


def jammer(distance):
    """Where the first jammer is, on the ground to the north."""
    return {"jammer_latitude": TRUTH["latitude"] + distance / EARTH, "jammer_longitude": TRUTH["longitude"]}


def test_spoofed_fixes_are_those_of_another_place():
    """F39: jump and carry-off, with the signs and the times that gps_signals and its solver show for the same input."""
    jump = np.array([1000.0, -500.0, -50.0])
    error, velocity, valid = fixes(6, lambda t: {"spoofing_n": jump * (t >= 3.0)})
    np.testing.assert_allclose(error[:3], 0.0, atol=1e-3)
    np.testing.assert_allclose(error[3:], np.tile(jump, (3, 1)), atol=0.3)
    np.testing.assert_allclose(velocity, np.tile(TRUTH["velocity_n"], (6, 1)))
    error, velocity, _ = fixes(6, lambda t: {"spoofing_rate_n": [0.0, 5.0 * (1.0 <= t < 5.0), 0.0]})
    np.testing.assert_allclose(error[:, 1], [0, 5, 10, 15, 20, 0], atol=1e-3)
    np.testing.assert_allclose(velocity[:, 1] + 20.0, [0, 5, 5, 5, 5, 0], atol=1e-9)
    assert np.all(valid)


def test_a_lie_about_accuracy_makes_errors_larger():
    """F40: by 1 + the factor."""
    (one, slow, _), (five, fast, _) = (
        fixes(3, lambda t, x=x: {"accuracy_lie": x}, horizontal_sigma=2.0, vertical_sigma=5.0, velocity_sigma=0.1)
        for x in (0.0, 4.0)
    )
    np.testing.assert_allclose(five, 5.0 * one, rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(fast - TRUTH["velocity_n"], 5.0 * (slow - TRUTH["velocity_n"]), rtol=1e-9)


def test_within_a_region_there_is_no_fix_and_outside_of_it_at_once():
    """F34: the middle is 20 km away."""
    middle = {"region_latitude": TRUTH["latitude"] + 20e3 / EARTH, "region_longitude": TRUTH["longitude"]}
    _, _, valid = fixes(6, lambda t: {"region_radius": 30e3 if 2.0 <= t < 4.0 else 10e3}, **middle)
    np.testing.assert_array_equal(valid.T, [[1, 1, 0, 0, 1, 1]] * 2)


def test_a_jammer_takes_the_fix_from_the_distance_on_that_the_link_budget_says():
    """Signal S, density N0 and jammer J behind an antenna with -5 dB along its plane and 1 dB less a degree: C/N0 is
    25 dB-Hz where 10^2.5 = S / (N0 + J / R_c). A loss by the mere distance, or by dB of one way, would be elsewhere."""
    signal, noise, least = 10.0 ** ((42.5 - 201.5) / 10.0), 10.0**-20.15, 10.0**2.5
    allowed = (signal / least - noise) * 1.023e6
    north, height = 15e3, TRUTH["altitude"]
    level = {"roll": 0.0, "pitch": 0.0}
    _, up, slant = pymap3d.geodetic2aer(
        TRUTH["latitude"] + north / EARTH, TRUTH["longitude"], 30.0,
        TRUTH["latitude"], TRUTH["longitude"], height, deg=False,
    )  # fmt: skip
    gain = 10.0 ** ((-5.0 + np.degrees(up)) / 10.0)
    power = allowed / gain * (4.0 * np.pi * slant / 0.190294) ** 2
    for share, kept in ((0.98, True), (1.02, False)):
        inputs = {**level, "jammer_power": [share * power, 0.0, 0.0, 0.0]}
        assert np.all(fixes(3, lambda t, inputs=inputs: inputs, **jammer(north))[2] == kept)
    far = {**level, "jammer_power": [1e6, 0.0, 0.0, 0.0]}
    assert np.all(fixes(3, lambda t: far, **jammer(300e3))[2])  # behind the radio horizon


def test_signals_are_found_again_when_they_have_been_strong_for_the_time_that_it_takes():
    """F34, RTO MP-43 (Sabatini): 20 s, as gps_signals; without that time at once."""
    power = [100.0, 0.0, 0.0, 0.0]
    off = np.zeros(4)
    for needed, first in ((0.0, 15), (20.0, 34)):
        _, _, valid = fixes(
            40, lambda t: {"jammer_power": power if 5.0 <= t < 15.0 else off}, acquisition_time=needed, **jammer(20e3)
        )
        expected = (np.arange(40) < 5) | (np.arange(40) >= first)
        np.testing.assert_array_equal(valid.T, [expected] * 2)
    weaker = [0.4, 0.0, 0.0, 0.0]  # between the two thresholds: followed, but not found
    _, _, valid = fixes(12, lambda t: {"jammer_power": weaker if t < 10.0 else off, "jammed": t < 2.0}, **jammer(15e3))
    np.testing.assert_array_equal(valid[:, 0], [0] * 10 + [1] * 2)
    assert np.all(fixes(12, lambda t: {"jammer_power": weaker}, **jammer(15e3))[2])


def test_at_a_pole_a_longitude_is_within_a_turn_and_elsewhere_it_goes_on():
    """A displacement over the cosine of a latitude of 90 degrees is 1e10 rad; beyond the date line nothing jumps."""
    here = np.pi / 2.0, 3.0, 0.0
    _, longitude = gps.displaced(*here, 2.0, 2.0)
    assert abs(longitude - 3.0) <= np.pi
    _, longitude = gps.displaced(0.0, np.pi - 1e-9, 0.0, 0.0, 6378137.0 * 1e-3)
    assert longitude == np.pi - 1e-9 + 1e-3
