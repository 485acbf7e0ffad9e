"""Positions of made pseudoranges: anywhere on the earth, with few satellites, wrong ones, and none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymap3d
import pytest
from scipy import stats

from fmus.satellite.gps_solver import GpsSolver
from fmus.satellite.signals import PLACES
from fmus.satellite.signals import signals as bundle_of_signals
from models.satellite import dilution, protection_level
from navfmu.export import Component, Output, Parameter, every
from tests.models.made_signals import LIGHT, Place, signals
from tests.models.native import Native

REALS = [
    "fix.latitude", "fix.longitude", "fix.altitude", "fix.velocity_n", "fix.time_of_validity", "clock_bias",
    "clock_drift", "pdop", "gdop", "hdop", "squares", "threshold", "horizontal_protection", "vertical_protection",
    "horizontal_sigma", "vertical_sigma", "residual",
]  # fmt: skip
BARE = {"ionosphere": 2, "troposphere": 3, "tick_period": 1.0}
"""No atmosphere, as the made signals have none."""


@pytest.fixture(scope="module")
def solver(tmp_path_factory):
    return Native(GpsSolver, tmp_path_factory.mktemp("solver"))


def solve(solver: Native, *epochs: dict[str, Any], **parameters: Any) -> dict[str, Any]:
    """Outputs after one fix of each of the epochs."""
    found = solver.run(
        len(epochs),
        1.0,
        REALS,
        {**BARE, **parameters},
        lambda t: {**epochs[round(t)], "signals.sequence": round(t) + 1},
    )
    found = {name: values[-1] for name, values in found.items()}
    for name in ("fix.valid", "detected", "alarm", "used", "excluded"):
        field = solver.fields[name]
        got = solver.fmu.getBoolean(list(range(field.index, field.index + field.size)))
        found[name] = np.array(got, bool) if field.shape else bool(got[0])
    found["satellites"] = solver.fmu.getInteger([solver.fields["satellites"].index])[0]
    found["sequence"] = solver.fmu.getInteger([solver.fields["fix.sequence"].index])[0]
    return found


def error(found: dict[str, Any], place: Place) -> np.ndarray:
    """Position error, m."""
    got = pymap3d.geodetic2ecef(found["fix.latitude"], found["fix.longitude"], found["fix.altitude"], deg=False)
    return np.linalg.norm(np.array(got) - place.position_e)


@pytest.mark.parametrize(
    "place",
    [
        Place(),
        Place(0.0, 0.0, 0.0, (0.0, 250.0, 0.0)),
        Place(1.5, 3.1, 1.2e4, (100.0, -200.0, -30.0)),
        Place(-1.0, -0.3, -50.0, (-5.0, 3.0, 1.0)),
    ],
)
def test_a_first_fix_is_exact_anywhere(solver, place):
    """From nothing, a clock off by 1 ms, drifting by 1e-7. Without the earth's turning meanwhile it is 20 m off, and
    without the time of travel that changes meanwhile 1 mm/s too fast."""
    found = solve(solver, signals(place, 10, clock=1e-3, drift=1e-7))
    assert found["fix.valid"]
    assert error(found, place) < 1e-3
    np.testing.assert_allclose(found["fix.velocity_n"], place.velocity_n, atol=1e-5)
    assert found["clock_bias"] * LIGHT == pytest.approx(1e-3 * LIGHT, abs=1e-3)
    assert found["clock_drift"] * LIGHT == pytest.approx(1e-7 * LIGHT, abs=1e-5)
    assert found["fix.time_of_validity"] == 0.25
    assert found["satellites"] == 10
    assert found["squares"] < 1e-6


def test_a_fix_after_another_one_is_as_exact_after_ten_kilometres(solver):
    near, far = Place(0.66), Place(0.6616, -2.101, 2500.0)
    assert error(solve(solver, signals(near, 10), signals(far, 10)), far) < 1e-3


def test_twenty_four_satellites_fit(solver):
    found = solve(solver, signals(Place(), PLACES))
    assert found["satellites"] == PLACES
    assert error(found, Place()) < 1e-3


def test_dilution_and_sigma_are_those_of_numpy(solver):
    """Of sight lines by pymap3d; with equal sigmas of 5 m the horizontal one is 5 HDOP."""
    made = signals(Place(), 7)
    found = solve(solver, made, equal_sigma=5.0)
    sight = made["signals.satellite_e"][:7] - Place().position_e
    sight /= np.linalg.norm(sight, axis=1, keepdims=True)
    east, north, up = pymap3d.ecef2enuv(*sight.T, 0.66, -2.1, deg=False)
    h = np.stack([-east, -north, -up, np.ones(7)], axis=1)
    q = np.linalg.inv(h.T @ h)
    assert found["pdop"] == pytest.approx(np.sqrt(np.trace(q[:3, :3])), rel=1e-4)
    assert found["hdop"] == pytest.approx(np.sqrt(np.trace(q[:2, :2])), rel=1e-4)
    assert found["horizontal_sigma"] == pytest.approx(5.0 * found["hdop"], rel=1e-9)


@pytest.mark.parametrize("bias", [60.0, -300.0, 5000.0])
def test_a_wrong_satellite_is_left_out(solver, bias):
    """F35: detected, excluded and the position as without it, whichever it is."""
    for wrong in (0, 4, 8):
        made = signals(Place(), 9)
        made["signals.pseudorange"][wrong] += bias
        found = solve(solver, made)
        assert found["detected"]
        assert not found["alarm"]
        np.testing.assert_array_equal(np.flatnonzero(found["excluded"]), [wrong])
        assert found["satellites"] == 8
        assert error(found, Place()) < 2e-3


def test_two_wrong_satellites_need_two_exclusions(solver):
    made = signals(Place(), 10)
    made["signals.pseudorange"][[2, 5]] += (400.0, -250.0)
    assert not solve(solver, made)["fix.valid"]
    found = solve(solver, made, exclusions=2)
    assert found["fix.valid"]
    np.testing.assert_array_equal(np.flatnonzero(found["excluded"]), [2, 5])
    assert error(found, Place()) < 1e-3


def test_with_five_satellites_nobody_knows_which(solver):
    """The alarm stays, no fix is valid, and the last good one is held; told to go on, it shows the wrong one."""
    good, bad = signals(Place(), 5), signals(Place(), 5)
    bad["signals.pseudorange"][1] += 500.0
    found = solve(solver, good, bad)
    assert found["alarm"]
    assert not found["fix.valid"]
    assert found["sequence"] == 2
    assert error(found, Place()) < 1e-3
    assert not np.any(found["excluded"])
    assert found["horizontal_protection"] == found["vertical_protection"] == protection_level.NONE
    wrong = solve(solver, good, bad, withhold=False)
    assert wrong["fix.valid"]
    assert error(wrong, Place()) > 50.0


def test_a_clock_that_jumps_moves_nothing_but_the_clock(solver):
    """F41: 0.5 ms between two fixes, 150 km in each pseudorange."""
    before, after = signals(Place(), 8, clock=1e-4), signals(Place(), 8, clock=6e-4)
    found = solve(solver, before, after)
    assert found["fix.valid"] and not found["detected"]
    assert error(found, Place()) < 1e-3
    assert found["clock_bias"] == pytest.approx(6e-4, abs=1e-11)


def test_signals_that_agree_on_another_place_are_believed(solver):
    """F39: what is consistent has no residuals, and nothing here sees it."""
    other = Place(0.67, -2.11, 2000.0)
    found = solve(solver, signals(Place(), 8), signals(other, 8))
    assert found["fix.valid"] and not found["detected"]
    assert error(found, other) < 1e-3


def test_satellites_of_another_time_are_no_fix(solver):
    """Positions of 18 s later, as when leap seconds are missed; one left out mends nothing."""
    made = signals(Place(), 9)
    made["signals.satellite_e"] = made["signals.satellite_e"] + 18.0 * made["signals.satellite_velocity_e"]
    found = solve(solver, signals(Place(), 9), made)
    assert found["alarm"] and not found["fix.valid"]
    assert error(found, Place()) < 1e-3  # that of before


def test_four_satellites_protect_nothing(solver):
    """There is a position, and no test of it: a bias goes in, and the protection level says so."""
    made = signals(Place(), 4, seed=5)
    found = solve(solver, made)
    assert found["fix.valid"]
    assert found["threshold"] == 0.0
    assert found["horizontal_protection"] == found["vertical_protection"] == protection_level.NONE
    assert error(found, Place()) < 1e-3


def test_three_satellites_have_no_fix_without_an_altitude(solver):
    found = solve(solver, signals(Place(), 6), signals(Place(), 3))
    assert not found["fix.valid"]
    assert found["pdop"] == dilution.NONE
    assert found["horizontal_sigma"] == protection_level.NONE
    assert error(found, Place()) < 1e-3  # that of before


def test_three_satellites_and_an_altitude_have_one(solver):
    """From nothing. An altitude that is 100 m too high makes the position 100 m too high."""
    for height in (1500.0, 1600.0):
        made = signals(Place(velocity_n=(50.0, 20.0, 0.0)), 3, clock=1e-4, seed=5)
        made |= {"altitude.height": height, "altitude.valid": True}
        found = solve(solver, made)
        assert found["fix.valid"]
        assert found["fix.altitude"] == pytest.approx(height, abs=1e-3)
        if height == 1500.0:
            assert error(found, Place()) < 1e-3
            np.testing.assert_allclose(found["fix.velocity_n"], (50.0, 20.0, 0.0), atol=1e-5)


def test_an_altitude_is_not_asked_where_four_satellites_are(solver):
    made = signals(Place(), 6) | {"altitude.height": 0.0, "altitude.valid": True}
    assert error(solve(solver, made), Place()) < 1e-3
    always = solve(solver, made, altitude_below=PLACES + 1, altitude_sigma=0.1, exclusions=0, withhold=False)
    assert always["alarm"]
    assert always["fix.altitude"] == pytest.approx(0.0, abs=10.0)


def test_an_altitude_that_is_no_number_spoils_no_fix(solver):
    """It was asked for by nobody, and took the fix of nine satellites away; of three it makes none."""
    given = {"altitude.height": np.nan, "altitude.valid": True}
    found = solve(solver, signals(Place(), 9) | given)
    assert found["satellites"] == 9 and error(found, Place()) < 1e-3
    assert not solve(solver, signals(Place(), 3) | given)["fix.valid"]


def test_channels_limit_what_is_used(solver):
    """Four of ten, which lie well."""
    made = signals(Place(), 10)
    found = solve(solver, made, channels=4)
    assert found["satellites"] == 4
    assert error(found, Place()) < 1e-3
    assert found["gdop"] < 5.0


def test_where_two_satellites_are_alike_the_wrong_one_may_go_and_protection_levels_say_how_far(solver):
    """Six satellites of 60 skies, one 1000 m too far, errors of 1 m. A level that is that of six, or that counts on the
    right satellite being gone, is beyond its fix there."""
    place, rng, others = Place(), np.random.default_rng(5), 0
    for seed in range(60):
        made = signals(place, 6, seed=seed)
        wrong = seed % 6
        made["signals.pseudorange"][:6] += rng.standard_normal(6)
        made["signals.pseudorange"][wrong] += 1000.0
        found = solve(solver, made)
        if found["fix.valid"]:
            others += not found["excluded"][wrong]
            assert error(found, place) <= np.hypot(found["horizontal_protection"], found["vertical_protection"])
    assert others > 0


@pytest.mark.parametrize("huge", [np.inf, -2e9, 1e300])
def test_what_is_low_weak_or_no_number_is_not_used(solver, huge):
    """A pseudorange of 1e300 m took the fix away, and its squares were no numbers."""
    made = signals(Place(), 10, lowest=2.0)
    made["signals.signal_to_noise"][0] = 20.0
    made["signals.pseudorange"][1] = np.nan if huge == np.inf else huge
    made["signals.satellite_e"][2, 1] = huge
    made["signals.tracked"][3] = 0
    found = solve(solver, made, signal_mask=25.0, elevation_mask=0.0)
    np.testing.assert_array_equal(np.flatnonzero(found["used"]), np.arange(4, 10))
    assert error(found, Place()) < 1e-3 and np.isfinite([found["squares"], *found["residual"]]).all()
    high = solve(solver, signals(Place(), 20, lowest=2.0), elevation_mask=0.5)
    assert 4 <= high["satellites"] < 16


@pytest.mark.parametrize("name", ["range_rate", "satellite_velocity_e", "satellite_clock_rate"])
def test_a_rate_that_is_no_number_spoils_no_fix(solver, name):
    """Receivers measure ranges without a Doppler. A whole fix was lost by one of them; where fewer than four rates are
    left there is no velocity, and none is made up."""
    place = Place(velocity_n=(200.0, -100.0, 3.0))
    made = signals(place, 7)
    made[f"signals.{name}"][2] = np.nan
    found = solve(solver, made)
    assert found["satellites"] == 7 and error(found, place) < 1e-3
    np.testing.assert_allclose(found["fix.velocity_n"], place.velocity_n, atol=1e-3)
    made[f"signals.{name}"][3:6] = np.nan
    assert not solve(solver, made)["fix.valid"]


def test_a_correction_that_is_no_number_spoils_no_fix(solver):
    made = signals(Place(), 7, corrected=np.ones(7), correction=np.where(np.arange(7) == 2, np.nan, 0.0))
    found = solve(solver, made)
    assert found["satellites"] == 6 and error(found, Place()) < 1e-3


def test_geometry_that_is_too_poor_is_no_fix(solver):
    found = solve(solver, signals(Place(), 8), pdop_limit=1.05)
    assert not found["fix.valid"]


def test_differential_corrections_take_out_what_two_receivers_share(solver):
    """Errors of 30 m on each satellite, and corrections of a station that has them, too, and a clock 5 km ahead.

    Less than 0.1 m is left. With the sign turned, or with the atmosphere modelled once more, metres are left.
    """
    shared, rover = 30.0 * np.random.default_rng(4).standard_normal(8), Place()
    made, correction = signals(rover, 8, clock=2e-4), np.zeros(PLACES)
    correction[:8] = -shared - 5000.0
    made["signals.pseudorange"][:8] += shared
    without = solve(solver, made, exclusions=0, withhold=False)
    assert error(without, rover) > 5.0
    made |= {"signals.correction": correction, "signals.corrected": np.ones(PLACES)}
    found = solve(solver, made, ionosphere=1, troposphere=1)
    assert found["fix.valid"]
    assert error(found, rover) < 0.1


def test_alarms_come_as_often_as_they_are_allowed(solver):
    """4000 epochs of noise with equal sigmas at 1e-2 in the FMU itself: binomial bounds at 1e-6."""
    rng = np.random.default_rng(9)
    made = signals(Place(), 8)
    clean = made["signals.pseudorange"].copy()
    names = [f"signals.{name}" for name in ("pseudorange", "sequence")]

    def inputs(t):
        noisy = clean.copy()
        noisy[:8] += 5.0 * rng.standard_normal(8)
        fresh = dict(zip(names, (noisy, round(t) + 1), strict=True))
        return fresh if t > 0 else {**made, **fresh}

    found = solver.run(4000.0, 1.0, ["squares", "threshold"], {**BARE, "equal_sigma": 5.0, "false_alarm": 1e-2}, inputs)
    count = np.count_nonzero(found["squares"][1:] > found["threshold"][1:])
    assert found["threshold"][-1] == pytest.approx(stats.chi2.isf(1e-2, 4), rel=1e-9)
    low, high = stats.binom.ppf([5e-7, 1 - 5e-7], 4000, 1e-2)
    assert low <= count <= high


def test_sigmas_are_those_of_errors_that_are_as_large_as_the_weights_say(solver):
    """4000 epochs, each range off by its own variance (RTKLIB 2.4.3): squares of errors over those told are 1, the sum
    is its degrees of freedom. Weights that are no inverse variances, or a sigma of one axis for two, would be seen."""
    rng = np.random.default_rng(10)
    place = Place()
    made = signals(place, 8)
    sight = made["signals.satellite_e"][:8] - place.position_e
    up = pymap3d.ecef2enuv(*sight.T, place.latitude, place.longitude, deg=False)[2]
    sine = up / np.linalg.norm(sight, axis=1)
    sigma = np.sqrt(0.09 * (1.0 + 1.0 / sine) + 2.4**2 + 0.09 + (0.3 / (sine + 0.1)) ** 2)
    clean = made["signals.pseudorange"].copy()

    def inputs(t):
        noisy = clean.copy()
        noisy[:8] += sigma * rng.standard_normal(8)
        fresh = {"signals.pseudorange": noisy, "signals.sequence": round(t) + 1}
        return fresh if t > 0 else {**made, **fresh}

    place_of_fix = [f"fix.{name}" for name in ("latitude", "longitude", "altitude")]
    found = solver.run(
        4000.0, 1.0, [*place_of_fix, "horizontal_sigma", "vertical_sigma", "squares"], {**BARE, "exclusions": 0}, inputs
    )
    off = pymap3d.geodetic2ned(
        *(found[name][1:] for name in place_of_fix), place.latitude, place.longitude, place.altitude, deg=False
    )
    horizontal, vertical = found["horizontal_sigma"][1:], found["vertical_sigma"][1:]
    for name, square, freedom in (
        ("horizontal", (off[0] ** 2 + off[1] ** 2) / horizontal**2, 1),  # at most as uncertain as one number
        ("vertical", off[2] ** 2 / vertical**2, 1),
        ("squares", found["squares"][1:], 4),
    ):
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 4000 * freedom) / 4000
        assert low <= np.mean(square) <= high, name


def test_what_measures_has_the_bundle_of_what_solves():
    """Names, shapes and types, so that one connection is enough; the solver of a system takes whatever publishes it."""

    class Measuring(Component):
        """What measures."""

        tick_period = Parameter("s", start=1.0)
        signals = bundle_of_signals(Output)

        @every("tick_period")
        def measure(self):
            self.signals.publish(pseudorange=np.full(PLACES, 2e7))

    def told(component):
        fields = component.layout.fields.values()
        return {f.name: (f.shape, f.type) for f in fields if f.name.startswith("signals.") and "lost" not in f.name}

    assert told(Measuring) == told(GpsSolver)
    assert len(told(Measuring)) == 18
