"""Differential GPS: what two receivers share goes away, by number, age and link (F38), and what they do not stays."""

from __future__ import annotations

import numpy as np
import pymap3d
import pytest
from scipy import stats

from fmus.satellite.gps_differential import GpsDifferential
from fmus.satellite.gps_errors import GpsErrors
from models.satellite import klobuchar, saastamoinen
from navfmu import Fault, NavfmuError, System
from navfmu.export.interpreter import Interpreter
from navfmu.ssp.writer import SystemSource
from tests.built import fmu, folder
from tests.models.native import Native
from tests.models.receiving import PLACE, QUIET

SHARED = ("range_error", "ionosphere_error", "zenith_error")
OWN = dict.fromkeys(("own_sigma", "ionosphere_sigma", "troposphere_sigma"), 0.0)
START = 345609.0
LIGHT, EARTH_RATE = 299792458.0, 7.2921151467e-5
RISE = 1e-6


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    for name in ("gps_signals", "gps_errors", "gps_differential", "gps_solver"):
        fmu(name, tmp_path_factory)
    source = SystemSource("differential", fmus=folder(tmp_path_factory), step=1.0)
    source.component("errors", "gps_errors.fmu")
    for receiver in ("station", "rover"):
        source.component(receiver, "gps_signals.fmu")
        for name in SHARED:
            source.connect(f"errors.{name}", f"{receiver}.{name}")
    source.component("differential", "gps_differential.fmu")
    source.connect("station.signals", "differential.reference").connect("rover.signals", "differential.signals")
    for name, signals in (("solver", "differential.differential"), ("alone", "rover.signals")):
        source.component(name, "gps_solver.fmu").connect(signals, f"{name}.signals")
    return System.load(source.pack(tmp_path_factory.mktemp("differential") / "differential.ssp"))


@pytest.fixture
def run(system):
    def run(stop=30, north=0.0, seeds=(1, 2), record=(), faults=(), second=START, both=QUIET, **parameters):
        """A row each second from 1 s on, with errors of the position, m, as `solver.off` and `alone.off`."""
        latitude = pymap3d.ned2geodetic(north, 0.0, 0.0, *PLACE.values(), deg=False)[0]
        places = {"station": PLACE, "rover": {**PLACE, "latitude": float(latitude)}}
        told = {"errors.seed": 7, **{f"differential.reference_{name}": value for name, value in PLACE.items()}}
        for (name, place), seed in zip(places.items(), seeds, strict=True):
            given = {**place, **OWN, **both, "start_seconds": second, "seed": seed}
            told |= {f"{name}.{key}": value for key, value in given.items()}
        for name, given in parameters.items():
            told |= {f"{name}.{key}": value for key, value in given.items()}
        fixes = [f"{name}.fix.{axis}" for name in ("solver", "alone") for axis in PLACE]
        of_differential = ["differential.satellites", "differential.age"]
        names = [*fixes, *of_differential, "rover.signals", "differential.differential", *record]
        frame = system.run(stop=stop, step=1.0, record=names, record_period=1.0, parameters=told, faults=list(faults))
        frame = frame.iloc[1:]
        found = {}
        for name in dict.fromkeys(column.partition("[")[0] for column in frame):
            columns = [column for column in frame if column.partition("[")[0] == name]
            found[name] = np.squeeze(frame[columns].to_numpy(float))
        for name in ("solver", "alone"):
            at = [found[f"{name}.fix.{axis}"] for axis in PLACE]
            found[f"{name}.off"] = np.stack(pymap3d.geodetic2ned(*at, *places["rover"].values(), deg=False), axis=1)
        return found

    return run


def of_satellites(found, name):
    """By PRN from 1 on, NaN where none is tracked."""
    bundle = name.rpartition(".")[0]
    number, tracked = found[f"{bundle}.number"].astype(int), found[f"{bundle}.tracked"] > 0.0
    values = np.full((len(number), 33), np.nan)
    rows = np.repeat(np.arange(len(number))[:, None], number.shape[1], axis=1)
    values[rows[tracked], number[tracked]] = found[name][tracked]
    return values


# --- what is shared -------------------------------------------------------------------------------------------------


def test_at_the_same_place_nothing_is_left_but_what_each_receiver_has_for_itself(run):
    """With the same noise in both, every error at its start values: 1 um, where one receiver alone is off by metres. A
    wrong sign doubles the error. The clock is off by the delays of the air, some tens of ns, and not by the station's
    0.1 ms."""
    record, fresh = ["solver.clock_bias", "rover.clock_bias"], {"latency": 0.0}
    found = run(60, seeds=(3, 3), both={}, record=record, differential=fresh, solver={"exclusions": 0})
    assert np.max(np.abs(found["solver.clock_bias"] - found["rover.clock_bias"])) < 2e-7
    assert np.max(np.abs(found["solver.off"])) < 1e-6
    assert np.sqrt(np.mean(found["alone.off"] ** 2)) > 1.0
    np.testing.assert_array_equal(found["differential.age"], 0.0)


def test_satellites_are_matched_by_their_numbers(run):
    """The station sees what is above 20 degrees, so that satellites have other places in its bundle: taken by places
    corrections would be off by tens of metres. The rover's others are not passed on, nor what it has of WAAS."""
    record = ["station.signals.number", "station.signals.tracked"]
    high, fresh = {"elevation_mask": np.radians(20.0)}, {"latency": 0.0}
    found = run(20, record=record, station=high, rover={"waas": True}, differential=fresh)
    assert np.any(found["rover.signals.correction_sigma"] > 0.0)
    assert not np.any(found["differential.differential.correction_sigma"])
    station = [
        n
        for n, seen in zip(found["station.signals.number"][-1], found["station.signals.tracked"][-1], strict=True)
        if seen
    ]
    rover = found["rover.signals.number"][-1][found["rover.signals.tracked"][-1] > 0.0]
    passed = found["differential.differential.number"][-1][found["differential.differential.tracked"][-1] > 0.0]
    assert set(station) < set(rover) and not np.array_equal(found["station.signals.number"][-1][: len(rover)], rover)
    assert set(passed) == set(station) and found["differential.satellites"][-1] == len(station) >= 4
    assert np.max(np.abs(found["solver.off"])) < 0.2


def test_thirty_kilometres_away_what_is_left_is_the_air_between(run):
    """Pseudoranges with corrections, less distances by pymap3d: their differences from satellite to satellite are those
    of Klobuchar's and Saastamoinen's delays here and there, up to half a metre, within 1 cm (the noise is the same)."""
    record = ["rover.elevation", "station.elevation"]
    found = run(5, 30e3, seeds=(3, 3), record=record, differential={"latency": 0.0}, errors=OWN)
    k, bundle = -1, "differential.differential"
    seen = found[f"{bundle}.tracked"][k] > 0.0
    latitude = float(pymap3d.ned2geodetic(30e3, 0.0, 0.0, *PLACE.values(), deg=False)[0])
    delays, distances = [], []
    for place in ({**PLACE, "latitude": latitude}, PLACE):
        satellite = found[f"{bundle}.satellite_e"][k].reshape(-1, 3)[seen]
        receiver = np.array(pymap3d.geodetic2ecef(*place.values(), deg=False))
        angle = EARTH_RATE * np.linalg.norm(satellite - receiver, axis=1) / LIGHT
        x, y, z = satellite.T
        turned = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x, z
        azimuth, elevation, distance = pymap3d.ecef2aer(*turned, *place.values(), deg=False)
        delay = klobuchar.delay(
            place["latitude"], place["longitude"], elevation, (np.sin(azimuth), np.cos(azimuth)),
            found["rover.signals.seconds"][k], np.array([3.82e-8, 1.49e-8, -1.79e-7, 0.0]),
            np.array([1.43e5, 0.0, -3.28e5, 1.13e5]),
        )  # fmt: skip
        zenith = sum(saastamoinen.zenith(place["latitude"], place["altitude"], saastamoinen.HUMIDITY))
        delays.append(delay + saastamoinen.slant(zenith, np.sin(elevation)))
        distances.append(distance)
    measured = found[f"{bundle}.pseudorange"][k] + LIGHT * found[f"{bundle}.satellite_clock"][k]
    left = (measured + found[f"{bundle}.correction"][k])[seen] - distances[0]
    between = delays[0] - delays[1]
    assert 0.2 < np.ptp(between) < 2.0
    np.testing.assert_allclose(left - left.mean(), between - between.mean(), rtol=0.0, atol=0.01)


def test_an_antenna_of_the_station_that_is_not_where_it_should_be_moves_all_positions(run):
    """12 m to the north in the parameter: so is the other receiver, in its fix and in nothing else."""
    there = float(pymap3d.ned2geodetic(12.0, 0.0, 0.0, *PLACE.values(), deg=False)[0])
    found = run(10, 30e3, seeds=(3, 3), both={}, differential={"latency": 0.0, "reference_latitude": there})
    right = run(10, 30e3, seeds=(3, 3), both={}, differential={"latency": 0.0})
    np.testing.assert_allclose(found["solver.off"] - right["solver.off"], np.tile([12.0, 0.0, 0.0], (10, 1)), atol=0.1)


# --- the link -------------------------------------------------------------------------------------------------------


def test_messages_have_the_age_that_period_and_latency_give_them(run):
    """Each 5 s from 1 s on, 2 s under way: a message of t is used from t + 2 to t + 6. Across the end of a week, where
    seconds alone would make it -604798 s; tags are by clocks that differ by nanoseconds. Meanwhile, held, corrections
    are the same to the last bit."""
    given = {"message_period": 5.0, "latency": 2.0, "carried": False}
    for second in (START, 604790.0):
        found = run(30, second=second, differential=given)
        expected = [2.0 + (t - 3) % 5 if t >= 3 else 0.0 for t in range(1, 31)]
        np.testing.assert_allclose(found["differential.age"], expected, atol=1e-5)
        np.testing.assert_array_equal(found["differential.satellites"] > 0.0, np.array(expected) > 0.0)
        changed = np.any(np.diff(found["differential.differential.correction"], axis=0) != 0.0, axis=1)
        np.testing.assert_array_equal(changed, np.array(expected[1:]) == 2.0)


def test_a_message_that_the_next_one_overtakes_is_refused():
    component = Interpreter(GpsDifferential)
    component.set("latency", 2.0)
    with pytest.raises(NavfmuError, match="expected latency not above message_period"):
        component.setup()


def test_a_link_that_is_lost_leaves_the_receiver_alone_after_the_timeout(run):
    """F38: from 20 s on no message; the last one, of 20 s at most, is used until it is 10 s old, then signals are those
    of the receiver, bit for bit, and so is the fix; at 50 s it is as good as before."""
    lost = Fault("link", "differential.link_lost", "input", value=True, start=20.0, duration=30.0)
    found = run(60, faults=[lost], differential={"timeout": 10.5})
    used = found["differential.satellites"] > 0.0
    assert np.all(used[1:29]) and not np.any(used[31:49]) and np.all(used[52:])
    assert np.max(found["differential.age"]) == pytest.approx(10.0, abs=1e-5)
    for name in ("pseudorange", "correction", "tracked", "corrected", "correction_sigma"):
        ours, its = found[f"differential.differential.{name}"], found[f"rover.signals.{name}"]
        np.testing.assert_array_equal(ours[31:49], its[31:49])
    apart = np.linalg.norm(found["solver.off"] - found["alone.off"], axis=1)
    assert np.max(apart[35:49]) < 1e-3 and np.min(apart[1:29]) > 1.0 and np.min(apart[52:]) > 1.0


def test_rates_of_satellites_without_an_error_carry_nothing_on(run):
    """30 s long; velocities in e of sending and not of reception are some cm/s off."""
    found = run(30, errors=OWN, differential={"message_period": 60.0, "latency": 0.0})
    correction = of_satellites(found, "differential.differential.correction")
    assert found["differential.age"][-1] == pytest.approx(29.0, abs=1e-5)
    assert np.nanmax(np.abs(correction[-1] - correction[0])) < 0.01


def test_a_satellite_that_runs_away_is_carried_on(run):
    """F36 in both receivers, 0.5 m/s from 5 s on, messages of 10 s and 19 s: held it is 4 m off 8 s later, by its rate
    1 cm. A rate of the wrong sign is 8 m off, an age that is counted from the use of a message 0.5 m for each s."""
    ramp = [0.0] * 32
    number = int(run(3)["rover.signals.number"][-1][2])
    ramp[number - 1] = 0.5
    faults = [
        Fault(name, f"{name}.range_ramp", "input", value=ramp, start=5.0, duration=100.0)
        for name in ("station", "rover")
    ]
    left = {}
    for carried in (True, False):
        given = {"message_period": 9.0, "latency": 0.0, "carried": carried}
        found = run(27, faults=faults, errors=OWN, differential=given)
        pure = run(27, errors=OWN, differential=given)
        change = [
            of_satellites(x, "differential.differential.pseudorange")
            + of_satellites(x, "differential.differential.correction")
            for x in (found, pure)
        ]
        change = change[0] - change[1]
        others = np.delete(change, [0, number], axis=1)
        left[carried] = change[:, number] - np.nanmean(others, axis=1)
    age = found["differential.age"]
    running = (np.arange(1, 28) >= 10) & (age > 0.5)
    np.testing.assert_allclose(left[True][running], 0.0, atol=0.01)
    np.testing.assert_allclose(left[False][running], 0.5 * age[running], atol=0.01)


# --- what is not corrected ------------------------------------------------------------------------------------------


def test_with_fewer_than_four_in_common_all_is_passed_on_as_it_came(run):
    """With corrections of WAAS that the receiver has itself."""
    found = run(10, station={"channels": 3}, rover={"waas": True})
    for name in ("pseudorange", "correction", "tracked", "corrected", "correction_sigma", "seconds"):
        np.testing.assert_array_equal(found[f"differential.differential.{name}"], found[f"rover.signals.{name}"])
    assert np.all(found["differential.satellites"] == 0.0) and np.any(found["rover.signals.corrected"] > 0.0)


def corrected(pseudorange, **more):
    """The component after signals of both receivers of satellites 1 to 6, which stand still; those of the other one are
    10 s younger."""
    component = Interpreter(GpsDifferential)
    for name, value in {**{f"reference_{name}": value for name, value in PLACE.items()}, "latency": 0.0}.items():
        component.set(name, value)
    component.setup()
    number = np.where(np.arange(24) < 6, np.arange(24) + 1, 0)
    for bundle, ranges, at in (("reference", pseudorange, 0.0), ("signals", np.full(24, 2.3e7), 10.0)):
        values = {"tracked": number > 0, "number": number, "pseudorange": ranges, "satellite_e": STILL, "seconds": at}
        for name, value in {**values, "valid": True, "sequence": 1, "time_of_validity": at, **more}.items():
            component.set(f"{bundle}.{name}", value)
    component.do_step(0.0, 11.0)
    return component


STILL = 1.5e7 * np.stack([np.cos(np.arange(24.0)), np.sin(np.arange(24.0)), np.ones(24)], axis=1)


def test_clocks_of_satellites_are_no_error_of_theirs():
    """Ranges with clocks of up to 0.1 ms and 1e-9, which would be 30 km, and 3 m in 10 s: corrected is nothing."""
    clock = np.linspace(-1e-4, 1e-4, 24)
    receiver = np.array(pymap3d.geodetic2ecef(*PLACE.values(), deg=False))
    travel = np.linalg.norm(STILL - receiver, axis=1) / LIGHT
    angle = EARTH_RATE * travel
    x, y, z = STILL.T
    turned = np.stack([np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x, z], axis=1)
    pseudorange = np.linalg.norm(turned - receiver, axis=1) - LIGHT * clock
    given = {"satellite_clock": clock, "satellite_clock_rate": 1e-5 * clock, "range_rate": -1e-5 * LIGHT * clock}
    component = corrected(pseudorange, **given)
    assert component.get("age") == 10.0 and component.get("satellites") == 6
    np.testing.assert_allclose(np.asarray(component.get("differential.correction")), 0.0, atol=1e-3)


@pytest.mark.parametrize("none", [np.nan, np.inf, 1e300])
def test_a_measurement_of_the_station_that_is_no_number_is_not_in_the_corrections_of_others(none):
    component = corrected(np.where(np.arange(24) == 2, none, 2.3e7))
    seen = np.asarray(component.get("differential.corrected"))
    assert seen[:6].tolist() == [True, True, False, True, True, True]
    assert np.all(np.isfinite(np.asarray(component.get("differential.correction"))))
    assert np.max(np.abs(component.get("differential.correction"))) < 1e8


# --- errors that are shared -----------------------------------------------------------------------------------------


def test_errors_have_the_spread_and_the_time_of_their_parameters(tmp_path):
    """32 satellites of 2 m and 100 s, sampled each 100 s for 20 000 s: the variance of n values of a process with
    rho = 1/e has 2 (1 + rho^2) / ((1 - rho^2) n) for its own; the correlation from one to the next is 1/e within
    5 / sqrt(n). From the first sample on: 200 seeds of it within chi-square at 1e-6."""
    errors = Native(GpsErrors, tmp_path)
    given = {"own_sigma": 2.0, "own_time": 100.0, "sample_period": 100.0, "seed": 5}
    found = errors.run(20_000.0, 100.0, ["range_error"], given)["range_error"]
    n, rho = found.size, np.exp(-1.0)
    assert np.mean(found**2) / 4.0 == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 * (1 + rho**2) / (1 - rho**2) / n))
    assert np.mean(found[1:] * found[:-1]) / np.mean(found**2) == pytest.approx(rho, abs=5.0 / np.sqrt(n))
    first = [errors.run(0.0, 1.0, SHARED, {"seed": seed}) for seed in range(1, 201)]
    low, high = stats.chi2.ppf([RISE / 2, 1 - RISE / 2], 200) / 200
    for name, sigma in (("ionosphere_error", 0.2), ("zenith_error", 0.05)):
        assert low < np.mean([run[name][0] ** 2 for run in first]) / sigma**2 < high
    low, high = stats.chi2.ppf([RISE / 2, 1 - RISE / 2], 6400) / 6400
    assert low < np.mean([run["range_error"][0] ** 2 for run in first]) < high


def test_old_uploads_and_lies_make_the_errors_of_satellites_larger(tmp_path):
    """60 m in 7 days (Coriat), and F40, ten times as large as told: the same numbers."""
    errors = Native(GpsErrors, tmp_path)
    plain = errors.run(1.0, 1.0, SHARED)
    old = errors.run(1.0, 1.0, SHARED, {"upload_age": 7.0 * 86400.0, "own_sigma": 0.0})
    np.testing.assert_allclose(old["range_error"], 60.0 * plain["range_error"], rtol=1e-12)
    lies = errors.run(1.0, 1.0, SHARED, inputs=lambda _: {"accuracy_lie": 9.0})
    np.testing.assert_allclose(lies["range_error"][1], 10.0 * plain["range_error"][1], rtol=1e-12)
    np.testing.assert_array_equal(lies["zenith_error"], plain["zenith_error"])


def test_receivers_are_too_far_by_them(run):
    """Pseudoranges with and without, of the same noise: the satellite's error, by its number, 1 / sin(elevation) of the
    zenith's, and the factor of Klobuchar's delay; within 1 cm (the noise of the code at another C/N0 is none)."""
    record = ["rover.elevation", *(f"errors.{name}" for name in SHARED)]
    large = {"own_sigma": 10.0, "ionosphere_sigma": 0.0, "troposphere_sigma": 1.0}
    found, pure = run(5, record=record, errors=large), run(5, errors=OWN)
    seen = found["rover.signals.tracked"][-1] > 0.0
    change = (found["rover.signals.pseudorange"] - pure["rover.signals.pseudorange"])[-1][seen]
    number = found["rover.signals.number"][-1][seen].astype(int)
    of_satellite, zenith = found["errors.range_error"][-1][number - 1], found["errors.zenith_error"][-1]
    expected = of_satellite + saastamoinen.slant(zenith, np.sin(found["rover.elevation"][-1][seen]))
    np.testing.assert_allclose(change, expected, rtol=0.0, atol=0.01)
    assert np.ptp(of_satellite) > 5.0
    factor = run(5, record=record, errors={**OWN, "ionosphere_sigma": 0.2})
    by_scale = run(5, both={**QUIET, "ionosphere_scale": 1.0 + factor["errors.ionosphere_error"][-1]}, errors=OWN)
    np.testing.assert_allclose(
        factor["rover.signals.pseudorange"][-1], by_scale["rover.signals.pseudorange"][-1], rtol=0.0, atol=1e-6
    )
