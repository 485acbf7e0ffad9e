"""A receiver of satellites: what it measures solved again, and what it makes of jammers, banks, failures (F34-F41)."""

from __future__ import annotations

import numpy as np
import pymap3d
import pytest

from fmus.satellite.gps_signals import GpsSignals
from models.satellite import multipath, orbit, selection, slots
from models.satellite.ephemeris import COLUMNS, Ephemeris
from navfmu import NavfmuError
from navfmu.export import Grid, Table
from navfmu.export.interpreter import Interpreter
from tests.models.receiving import PLACE, QUIET, Receiving, off

LIGHT = 299792458.0


@pytest.fixture(scope="module")
def receiving(tmp_path_factory):
    return Receiving(tmp_path_factory.mktemp("receiving"))


def tracked(found, k=-1):
    """PRN that are tracked."""
    return set(found["signals.number"][k][found["signals.tracked"][k] > 0.0].astype(int))


def numbers(prn, value):
    """For each of 32 satellites."""
    return np.where(np.arange(1, 33) == prn, value, 0.0)


class OfTheirTime(GpsSignals):
    """Orbits that hold for two hours, of satellites that call themselves unhealthy."""

    name = "gps_signals_of_their_time"
    orbits = Table(
        columns=COLUMNS,
        rows=Ephemeris.of(slots.constellation())._replace(limit=7200.0, health=63.0).rows(),
        key="place",
    )


@pytest.mark.parametrize(
    ("week", "seconds", "held"),
    [
        (slots.EPOCH[0], slots.EPOCH[1] + 7199.0, True),
        (slots.EPOCH[0], slots.EPOCH[1] + 7201.0, False),
        (slots.EPOCH[0] + 1024, slots.EPOCH[1], False),
    ],
)
def test_a_start_for_which_there_are_no_orbits_is_refused(week, seconds, held):
    """No satellite would ever have been there, without a word; that all are unhealthy is what they say."""
    receiver = Interpreter(OfTheirTime)
    receiver.set("start_week", week)
    receiver.set("start_seconds", seconds)
    if held:
        receiver.setup()
    else:
        with pytest.raises(NavfmuError, match=f"of the table orbits none holds in week {week}, "):
            receiver.setup()


@pytest.mark.parametrize(
    ("name", "turned"),
    [
        ("semi_major_axis", np.sqrt),
        ("inclination", np.degrees),
        ("node", np.degrees),
        ("eccentricity", lambda value: value + 0.5),
    ],
)
def test_orbits_in_other_units_are_refused(name, turned):
    """Satellites would be far from where they are, with pseudoranges that agree."""
    told = Ephemeris.of(slots.constellation())
    rows = told._replace(**{name: turned(getattr(told, name))}).rows()

    class Other(GpsSignals):
        """With a table that was written by hand."""

        orbits = Table(columns=COLUMNS, rows=rows, key="place")

    with pytest.raises(NavfmuError, match="the table orbits has an orbit that no satellite of GPS has"):
        Interpreter(Other).setup()


@pytest.mark.parametrize(
    ("azimuths", "elevations"),
    [
        ([0.0, 2.0 * np.pi], [-0.5 * np.pi, 0.5 * np.pi]),  # half of it would have had the gain of azimuth 0
        ([-180.0, 180.0], [-90.0, 90.0]),
        ([-np.pi, np.pi], [0.0, 0.5 * np.pi]),
    ],
)
def test_an_antenna_that_lacks_directions_is_refused(azimuths, elevations):
    class Other(GpsSignals):
        """With another antenna."""

        antenna = Grid(
            axes=(("azimuth", "rad", np.array(azimuths)), ("elevation", "rad", np.array(elevations))),
            surfaces=(("gain", "1", np.zeros((2, 2))),),
        )

    with pytest.raises(NavfmuError, match="antenna does not have all directions: expected azimuths from -pi to pi"):
        Interpreter(Other).setup()


def test_what_is_measured_is_solved_to_the_truth(receiving):
    """The solver is held against light times of its own (test_gps_solver). Satellites at reception would be 50 m off,
    a clock of the wrong sign 2e4 m."""
    velocity = np.array([30.0, -40.0, 2.0])
    found = receiving.run(5, lambda t: {"velocity_n": velocity}, **QUIET)
    assert np.all(found["fix.valid"] > 0.0)
    assert np.max(np.abs(off(found))) < 0.05
    np.testing.assert_allclose(found["fix.velocity_n"], np.tile(velocity, (5, 1)), atol=5e-4)
    np.testing.assert_allclose(found["solved_clock"], found["clock_bias"], rtol=0.0, atol=0.05 / LIGHT)
    np.testing.assert_allclose(found["solved_drift"], found["clock_drift"], rtol=0.0, atol=5e-4 / LIGHT)


class Drifting(GpsSignals):
    """Satellites with clocks that are off by up to 0.2 ms and 2e-9, on orbits that are not round."""

    name = "gps_signals_drifting"
    orbits = Table(
        columns=COLUMNS,
        rows=Ephemeris.of(slots.constellation())
        ._replace(
            eccentricity=0.02,
            clock_bias=np.linspace(-2e-4, 2e-4, 24),
            clock_drift=np.linspace(2e-9, -2e-9, 24),
            group_delay=np.linspace(0.0, 2e-8, 24),
        )
        .rows(),
        key="place",
    )


def test_clocks_of_satellites_are_in_what_is_measured(tmp_path):
    """What they say of them must free it again: a wrong sign is 10 km, or 0.1 m/s."""
    found = Receiving(tmp_path, Drifting).run(4, **QUIET)
    assert np.ptp(found["signals.satellite_clock"][-1]) > 1e-4
    assert np.all(found["fix.valid"] > 0.0)
    assert np.max(np.abs(off(found))) < 0.05
    np.testing.assert_allclose(found["fix.velocity_n"], 0.0, atol=5e-4)


def test_all_satellites_above_the_mask_are_measured(receiving):
    """Elevations by pymap3d of the positions of the slots."""
    found = receiving.run(2, **QUIET)
    week, second = slots.EPOCH
    satellites = Ephemeris.of(slots.constellation())
    where = orbit.state(satellites, week, second + 2.0)[0]
    here = PLACE["latitude"], PLACE["longitude"], PLACE["altitude"]
    _, elevation, _ = pymap3d.ecef2aer(*where.T, *here, deg=False)
    assert tracked(found) == set(satellites.prn[elevation > np.radians(5.0)].astype(int))
    assert 6 <= len(tracked(found)) <= 12


def test_a_jammer_raises_the_noise_by_its_power_over_the_width_of_the_code(receiving):
    """1 / (C/N0) grows by J / (S Q R_c): of a jammer at 20 km the J that is shown, by free space and the antenna."""
    place = {"jammer_latitude": PLACE["latitude"], "jammer_longitude": PLACE["longitude"] + 20e3 / 5.05e6}
    power = 0.3
    clear, found = (
        receiving.run(3, lambda t, p=p: {"jammer_power": [p, 0.0, 0.0, 0.0]}, **QUIET, **place, carrier_threshold=10.0)
        for p in (0.0, power)
    )
    seen = (clear["signals.tracked"][2] > 0.0) & (found["signals.tracked"][2] > 0.0)
    before, after = (10.0 ** (x["signals.signal_to_noise"][2][seen] / 10.0) for x in (clear, found))
    noise, jammer = 10.0**-20.15, 10.0 ** (found["jamming"][2] / 10.0)
    np.testing.assert_allclose(1.0 / after - 1.0 / before, jammer / (before * noise * 1.023e6), rtol=1e-3)
    free_space = power * (0.19029 / (4.0 * np.pi * 20.1e3)) ** 2
    assert found["jamming"][2] == pytest.approx(10.0 * np.log10(free_space) - 5.0 - 4.3, abs=0.3)
    assert np.sum(seen) > 0 and clear["jamming"][2] == -300.0


def test_what_is_lost_to_a_jammer_is_found_20_s_after_it_stops(receiving):
    """F34. RTO MP-43, Sabatini: 20 s. Held by the mere C/N0 it would be back at once."""
    found = receiving.run(45, lambda t: {"jammer_power": [100.0 * (5.0 <= t < 15.0), 0.0, 0.0, 0.0]}, **QUIET)
    seen = found["satellites"]
    assert np.all(seen[:5] == seen[0]) and np.all(seen[5:34] == 0.0) and np.all(seen[35:] >= seen[0] - 1)
    assert np.all(found["fix.valid"][5:34] == 0.0) and found["fix.valid"][36] > 0.0
    assert np.all(found["signals.valid"] > 0.0)


def test_a_jammer_behind_the_horizon_does_nothing(receiving):
    far = {"jammer_latitude": PLACE["latitude"] + 300e3 / 6.37e6, "jammer_longitude": PLACE["longitude"]}
    found = receiving.run(3, lambda t: {"jammer_power": [1e6, 0.0, 0.0, 0.0]}, **QUIET, **far)
    assert np.all(found["jamming"] == -300.0)


@pytest.mark.parametrize("inputs", [{"jammed": True}, {"region_radius": 30e3}])
def test_in_a_region_without_signals_there_are_none(receiving, inputs):
    """F34: the middle is 20 km away; a smaller radius does nothing."""
    middle = {"region_latitude": PLACE["latitude"] + 20e3 / 6.37e6, "region_longitude": PLACE["longitude"]}
    assert np.all(receiving.run(3, lambda t: inputs, **QUIET, **middle)["satellites"] == 0.0)
    smaller = {name: 10e3 for name in inputs if name == "region_radius"}
    assert np.all(receiving.run(3, lambda t: smaller, **QUIET, **middle)["satellites"] > 6.0)


def test_a_bank_hides_the_satellites_that_the_wing_rises_before(receiving):
    """RTO MP-43, Sabatini: banks of 50 degrees and more lose satellites. Banked to the right and flying north those in
    the west are hidden, not those in the east; turned about, the other way round."""
    level = receiving.run(2, **QUIET)
    azimuth = {}
    for prn, satellite in zip(level["signals.number"][-1], level["signals.satellite_e"][-1], strict=True):
        if prn:
            here = PLACE["latitude"], PLACE["longitude"], PLACE["altitude"]
            azimuth[int(prn)], *_ = pymap3d.ecef2aer(*satellite, *here, deg=False)
    for heading in (0.0, np.pi):
        banked = receiving.run(2, lambda t, h=heading: {"roll": np.radians(60.0), "heading": h}, **QUIET)
        lost = tracked(level) - tracked(banked)
        assert lost
        west = np.array([np.sin(azimuth[prn]) < 0.0 for prn in lost])
        assert np.all(west == (heading == 0.0))


def test_a_step_of_one_satellite_is_excluded_and_gone_again(receiving):
    """F35."""
    level = receiving.run(1, **QUIET)
    prn = level["signals.number"][0][np.argmax(level["elevation"][0])]
    found = receiving.run(9, lambda t: {"range_step": numbers(prn, 300.0 * (3.0 <= t < 6.0))}, **QUIET)
    out = np.sum(np.where(found["excluded"] > 0.0, found["signals.number"], 0.0), axis=1)
    np.testing.assert_array_equal(out, [0, 0, 0, prn, prn, prn, 0, 0, 0])
    assert np.max(np.abs(off(found))) < 0.1


def test_a_ramp_of_one_satellite_runs_away_with_its_rate(receiving):
    """F36: beside a run without it, m and m/s."""
    prn = max(tracked(receiving.run(1, **QUIET)))
    good = receiving.run(8)
    bad = receiving.run(8, lambda t: {"range_ramp": numbers(prn, 2.0 * (2.0 <= t < 6.0))})
    place = np.flatnonzero(good["signals.number"][0] == prn)[0]
    change = (bad["signals.pseudorange"] - good["signals.pseudorange"])[:, place]
    np.testing.assert_allclose(change, [0, 0, 2, 4, 6, 8, 0, 0], atol=1e-6)
    rate = (bad["signals.range_rate"] - good["signals.range_rate"])[:, place]
    np.testing.assert_allclose(rate, [0, 0, 2, 2, 2, 2, 0, 0], atol=1e-9)


def test_satellites_that_are_silent_are_lost_and_found_later(receiving):
    """F37: all but three."""
    seen = sorted(tracked(receiving.run(1, **QUIET)))
    silent = np.isin(np.arange(1, 33), seen[3:])
    found = receiving.run(30, lambda t: {"satellite_off": silent & (2.0 <= t < 5.0)}, **QUIET)
    np.testing.assert_array_equal(found["satellites"][:6], [len(seen), len(seen), 3, 3, 3, 3])
    assert found["fix.valid"][3] == 0.0 and found["fix.valid"][-1] > 0.0


def test_spoofed_signals_are_those_of_another_place(receiving):
    """F39: jump and carry-off. Nothing in the residuals shows it; of one satellite alone they would."""
    jump = np.array([1000.0, -500.0, -50.0])
    found = receiving.run(6, lambda t: {"spoofing_n": jump * (t >= 3.0)}, **QUIET)
    np.testing.assert_allclose(off(found)[:3], 0.0, atol=0.05)
    np.testing.assert_allclose(off(found)[3:], np.tile(jump, (3, 1)), atol=0.2)
    assert np.all(found["squares"] < 0.1) and np.all(found["excluded"] == 0.0)
    found = receiving.run(6, lambda t: {"spoofing_rate_n": [0.0, 5.0 * (1.0 <= t < 5.0), 0.0]}, **QUIET)
    np.testing.assert_allclose(off(found)[:, 1], [0, 5, 10, 15, 20, 0], atol=0.05)
    np.testing.assert_allclose(found["fix.velocity_n"][:, 1], [0, 5, 5, 5, 5, 0], atol=1e-3)


def test_a_lie_about_accuracy_makes_errors_larger_than_told(receiving):
    """F40: by 1 + the factor, what is told stays."""
    runs = [receiving.run(3, lambda t, x=x: {"accuracy_lie": x}) for x in (0.0, 1.0, 4.0)]
    ranges = [run["signals.pseudorange"] for run in runs]
    seen = runs[0]["signals.tracked"] > 0.0
    own, more = (ranges[1] - ranges[0])[seen], (ranges[2] - ranges[0])[seen]
    np.testing.assert_allclose(more, 4.0 * own, atol=1e-6)
    assert 0.4 < np.std(own) < 2.0
    np.testing.assert_array_equal(runs[2]["signals.accuracy"], runs[0]["signals.accuracy"])


def test_a_jump_of_the_clock_is_common_to_all(receiving):
    """F41."""
    found = receiving.run(6, lambda t: {"clock_jump": 1e-3 * (2.0 <= t < 4.0)}, **QUIET)
    jump = found["solved_clock"] - 1e-4 - 1e-7 * np.arange(1.0, 7.0)
    np.testing.assert_allclose(jump, [0, 0, 1e-3, 1e-3, 0, 0], atol=1e-9)
    assert np.max(np.abs(off(found))) < 0.1


def test_acceleration_changes_the_frequency_of_the_clock(receiving):
    """AGARD CP-298, Dyment and Liang: S a, here of 4 g along an axis with 1e-10 s2/m."""
    found = receiving.run(
        4, lambda t: {"specific_force": [0.0, 0.0, -40.0]}, **QUIET, clock_sensitivity=[0.0, 0.0, 1e-10]
    )
    np.testing.assert_allclose(found["solved_drift"], 1e-7 - 4e-9, atol=1e-11)
    np.testing.assert_allclose(found["clock_bias"], 1e-4 + (1e-7 - 4e-9) * np.arange(1.0, 5.0), atol=1e-15)


def test_with_few_channels_few_are_tracked(receiving):
    found = receiving.run(3, **QUIET, channels=5)
    assert np.all(found["satellites"] == 5.0)


def test_time_tags_go_over_the_end_of_a_week(receiving):
    """By the receiver's clock, which is 0.1 ms ahead."""
    found = receiving.run(3, **QUIET, start_week=2111, start_seconds=604798.0)
    np.testing.assert_array_equal(found["signals.week"], [2111, 2112, 2112])
    np.testing.assert_allclose(found["signals.seconds"], np.array([604799.0, 0.0, 1.0]) + 1e-4, atol=1e-6)
    assert np.max(np.abs(off(found))) < 0.1


@pytest.mark.parametrize("none", [np.nan, np.inf, -np.inf])
def test_a_place_that_is_no_number_is_no_measurement_and_spoils_nothing(receiving, none):
    """An infinite height is within the reach of all jammers, which is infinite, too."""
    found = receiving.run(40, lambda t: {"altitude": none if 2.0 <= t < 4.0 else 1500.0}, **QUIET)
    assert all(np.isfinite(values).all() for values in found.values())
    np.testing.assert_array_equal(found["signals.valid"][:6], [1, 1, 0, 0, 1, 1])
    assert found["fix.valid"][-1] > 0.0 and np.max(np.abs(off(found)[-5:])) < 0.1


def test_errors_of_ranges_have_the_spread_of_their_parts(receiving):
    """Own errors of 3 m, the rest quiet: 40 draws of some 10 satellites. Their variance, over the fixed 9 m2, is within
    4 sqrt(2 / n)."""
    drawn = []
    quiet = receiving.run(1, **QUIET)
    for seed in range(40):
        found = receiving.run(1, **{**QUIET, "own_sigma": 3.0, "seed": seed + 1})
        drawn.append((found["signals.pseudorange"] - quiet["signals.pseudorange"])[found["signals.tracked"] > 0.0])
    drawn = np.concatenate(drawn)
    assert np.mean(drawn**2) / 9.0 == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / len(drawn)))


class OneByOne(GpsSignals):
    """32 satellites on one orbit, of which one after the other is above the mask, for some time each."""

    name = "gps_signals_one_by_one"
    orbits = Table(
        columns=COLUMNS,
        rows=Ephemeris.of(np.repeat(slots.constellation()[:1], 32, axis=0))
        ._replace(
            place=selection.place(np.arange(1.0, 33.0), *slots.EPOCH),
            prn=np.arange(1.0, 33.0),
            mean_anomaly=np.radians(np.arange(32) * 360.0 / 32),
        )
        .rows(),
        key="place",
    )


@pytest.mark.parametrize("what", ["own_sigma", "multipath_scale"])
def test_a_satellite_in_a_place_that_became_free_has_errors_of_its_own(tmp_path, what):
    """Errors that last for ever, so that each satellite has one number, in one channel.

    That number has the variance 1 from the first sample, and those of two that follow each other are independent: both
    within 4 sigma. An error that stayed in its place would be one number for all, with a correlation of 1; one that
    began at 0 would be 0.
    """
    forever = {"own_time": 1e15, "multipath_time": 1e15, "channels": 1, "measurement_period": 60.0}
    forever |= {"search_period": 60.0, "elevation_mask": 1.0}
    receiving, drawn = Receiving(tmp_path, OneByOne), []
    quiet = receiving.run(80_000, every=60, **QUIET, **forever)
    number = quiet["signals.number"][:, 0]
    first = np.flatnonzero((number > 0) & (number != np.roll(number, 1)))
    for seed in range(10):
        found = receiving.run(80_000, every=60, **{**QUIET, what: 1.0, "seed": seed + 1}, **forever)
        error = (found["signals.pseudorange"] - quiet["signals.pseudorange"])[:, 0]
        if what == "multipath_scale":
            error = error / multipath.sigma(quiet["elevation"][:, 0])
        drawn.append(error[first])
        for begin in first:  # for ever
            same = error[begin:][: np.argmax(number[begin:] != number[begin])]
            np.testing.assert_allclose(same, error[begin], atol=0.3)
    drawn = np.array(drawn)
    assert drawn.size > 80
    assert np.mean(drawn**2) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / drawn.size))
    following = drawn[:, 1:] * drawn[:, :-1]
    assert abs(np.mean(following)) < 4.0 / np.sqrt(following.size)
