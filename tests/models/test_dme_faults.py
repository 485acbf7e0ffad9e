"""What can fail at DME: onset, signature and recovery of each; numbers F of the table in docs/fmea.md."""

import numpy as np
import pytest
from scipy import stats

from fmus.radio.dme import Dme
from models.radio import dme, transponder
from tests.models.native import Native, interpret
from tests.models.test_dme import FLYING, HERE, RANGES, five_stations, true_ranges

ON, OFF, STOP = 20.0, 40.0, 60.0
SCANNING = {**five_stations(), "mode": 3, "seed": 3}
FIRST = np.arange(5) == 0
LIGHT_SPEED = 299792458.0


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Dme, tmp_path_factory.mktemp("dme"))


def flown(native, faults, parameters=None):
    """Readings (60, 5) of a scanning receiver, a second apart; faults act from ON to OFF."""

    def inputs(t):
        given = dict(FLYING) if t == 0.0 else {}
        for name, value in faults.items():
            if t in (ON, OFF):
                given[name] = np.asarray(value) * (t == ON)
        return given

    run = native.run(STOP, 1.0, [RANGES], SCANNING | (parameters or {}), inputs)
    return run[RANGES][1:]


def phases(fault, parameters=None, before=19, during=20, after=20):
    """Phase of the first station each second while an input is set, and then while it is cleared."""
    run = interpret(Dme, **FLYING, **SCANNING, **(parameters or {}))
    run.do_step(0.0, float(before))
    (name, value) = fault
    found = []
    for k in range(during + after):
        if k in (0, during):
            run.set(name, value if k == 0 else np.zeros_like(value))
        run.do_step(run.time, 1.0)
        found.append("-ISTM"[int(run.get("phase")[0])])
    return "".join(found[:during]), "".join(found[during:])


CHANGES = {
    "F27 off the air": ({"station_off": FIRST}, 4),
    "F29 wrong station": ({"wrong_station": FIRST}, 5),
    "F30 echo": ({"echo": 3000.0 * FIRST}, 5),
    "F30 short echo": ({"echo": 300.0 * FIRST}, 0),
    "F31 delay": ({"delay_change": 0.8e-6 * FIRST}, 0),
    "F31 delay beyond the monitor": ({"delay_change": 2e-6 * FIRST}, 4),
    "F31 drift": ({"delay_drift": 4e-8 * FIRST}, 0),
    "F33 replies lost": ({"replies_lost": 0.95 * FIRST}, 4),
    "F33 capacity": ({"traffic": 2000.0 * FIRST}, 4),
}


@pytest.mark.parametrize("name", CHANGES)
def test_it_acts_at_once_on_one_station_and_leaves_nothing_behind(native, name):
    """Bit for bit the same before, on the other four, and once locked in again: no random number more or less."""
    fault, search = CHANGES[name]
    changed, sound = flown(native, fault), flown(native, {})
    on, off = round(ON), round(OFF)
    np.testing.assert_array_equal(changed[:on], sound[:on])
    np.testing.assert_array_equal(changed[:, 1:], sound[:, 1:])
    np.testing.assert_array_equal(changed[off + search :], sound[off + search :])
    assert np.all(changed[on + 1 : off, 0] != sound[on + 1 : off, 0])
    assert np.all(changed[off : off + search, 0] != sound[off : off + search, 0])


def test_f27_f33_a_silent_station_is_searched_for():
    for fault in (("station_off", FIRST), ("replies_lost", 0.95 * FIRST), ("traffic", 2000.0 * FIRST)):
        assert phases(fault) == ("S" * 20, "SSSS" + "T" * 16)
        remembered = phases(fault, {"memory_time": 10.0})
        assert remembered == ("M" * 10 + "S" * 10, "SSSS" + "T" * 16)


def test_f28_a_station_is_lost_below_the_horizon(native):
    """An aircraft that descends by 20 m/s over a station without antenna, 60 km away: at 4 d^2 / (3 R) / 2 of height,
    212 m. Catches the horizon of the Earth's own radius, at 283 m."""
    stations = five_stations(60e3) | {"station_altitude": np.zeros(5), "antenna_height": 0.0}
    run = interpret(Dme, **FLYING, **stations, mode=3)
    altitude, heard = np.arange(600.0, 100.0, -2.0), []
    for height in altitude:
        run.set("altitude", height)
        run.do_step(run.time, 1.0)
        heard.append(run.get("answered_share")[0] > 0.0)
    lost = altitude[np.argmin(heard)]
    assert lost == pytest.approx((60e3) ** 2 / (2.0 * 4.0 / 3.0 * 6371e3), abs=6.0)
    assert not any(heard[np.argmin(heard) :])


def test_f29_another_station_of_the_channel_is_read_as_this_one(native):
    """After a search; the reading is its distance, and its own horizon decides whether it is heard."""
    quiet = {"bias_sigma": 0.0, "noise_sigma": 0.0}
    other = {"other_latitude": HERE["latitude"], "other_longitude": HERE["longitude"] + 0.01, "other_altitude": 0.0}
    changed = flown(native, {"wrong_station": FIRST}, quiet | other)[:, 0]
    there = dme.slant_range(*HERE.values(), *(np.array([x]) for x in other.values()))[0]
    truth = true_ranges(interpret(Dme, **FLYING, **five_stations()))[0]
    # lost at 21 s; lock-in from 22 s, ranging until 26 s
    np.testing.assert_allclose(changed[4:25], truth)
    np.testing.assert_allclose(changed[25:44], there)
    low = flown(native, {"wrong_station": FIRST}, quiet | other | {"other_longitude": HERE["longitude"] + 0.1})[:, 0]
    np.testing.assert_allclose(low[4:], truth)


@pytest.mark.parametrize(
    "fault", [{"station_off": FIRST}, {"delay_change": 2e-6 * FIRST}, {"delay_change": 5e-7 * FIRST}]
)
def test_f29_another_station_is_heard_when_this_one_is_off_or_late(native, fault):
    """Which is when it is heard. Catches the power switch and the delay of one transponder in the other."""
    quiet = {"bias_sigma": 0.0, "noise_sigma": 0.0}
    other = {"other_latitude": HERE["latitude"], "other_longitude": HERE["longitude"] + 0.01, "other_altitude": 0.0}
    there = dme.slant_range(*HERE.values(), *(np.array([x]) for x in other.values()))[0]
    changed = flown(native, {"wrong_station": FIRST} | fault, quiet | other)[:, 0]
    np.testing.assert_allclose(changed[25:40], there)


def test_f29_a_position_that_is_wrong_in_the_database_is_its_way_along_the_line():
    """A wrong place is a table of the navigator's that is not that of the receiver: the difference of distances, and
    to first order its part along the line of sight. North of HERE, 500 m north is 500 m, 500 m east is 4 m."""
    stations = [five_stations()[f"station_{name}"][:1] for name in ("latitude", "longitude", "altitude")]
    truth = dme.slant_range(*HERE.values(), *stations)
    north = dme.slant_range(*HERE.values(), stations[0] + 500.0 / 6.36e6, *stations[1:])
    east = dme.slant_range(*HERE.values(), stations[0], stations[1] + 500.0 / 6.38e6 / np.cos(stations[0]), stations[2])
    assert north - truth == pytest.approx(500.0, rel=0.01)
    assert east - truth == pytest.approx(500.0**2 / 2.0 / 30e3, rel=0.02)


def test_f30_an_echo_is_further_than_the_station(native):
    """A short one is followed at once, a long one after a search; both ways are the same path in the reading."""
    sound = flown(native, {})[:, 0]
    short = flown(native, {"echo": 300.0 * FIRST})[:, 0]
    np.testing.assert_allclose((short - sound)[20:40], 300.0)
    long = flown(native, {"echo": 3000.0 * FIRST})[:, 0]
    np.testing.assert_allclose((long - sound)[25:40], 3000.0)
    assert np.all(long[20:25] == sound[19])


def test_f31_a_delay_is_half_of_its_light_way(native):
    """1 us is 150 m of range; a drift of 40 ns/s, 6 m/s until 1 us is reached. Catches c dt without the half."""
    sound = flown(native, {})[:, 0]
    changed = flown(native, {"delay_change": 0.8e-6 * FIRST})[:, 0]
    np.testing.assert_allclose((changed - sound)[20:40], 0.5 * LIGHT_SPEED * 0.8e-6)
    drift = flown(native, {"delay_drift": 4e-8 * FIRST})[:, 0]
    np.testing.assert_allclose((drift - sound)[20:40], 0.5 * LIGHT_SPEED * 4e-8 * np.arange(1, 21))
    early = flown(native, {"delay_drift": -4e-8 * FIRST}, {"monitor_limit": 2e-7})[:, 0]
    np.testing.assert_allclose((early - sound)[20:24], -0.5 * LIGHT_SPEED * 4e-8 * np.arange(1, 5))
    assert np.all(early[24:40] == early[23])


@pytest.mark.parametrize("degrees", [90.0, 45.0, 30.0])
def test_f32_the_error_of_a_pair_is_that_of_its_angle(degrees):
    """Position error of two equal ranges: sqrt(2) / sin(gamma); 30 degrees double that of a right angle."""
    gamma = np.radians(degrees)
    hdop = dme.dilution(np.array([1.0, np.cos(gamma)]), np.array([0.0, np.sin(gamma)]), np.ones(2, bool))
    assert hdop == pytest.approx(np.sqrt(2.0) / np.sin(gamma))


def test_f33_replies_become_few_and_then_none_are_followed():
    """Share shown against the closed form, for aircraft from 0 to 1000; lock is lost where it is below one half."""
    run = interpret(
        Dme,
        **FLYING,
        **SCANNING,
    )
    run.do_step(0.0, 10.0)
    for aircraft in (0.0, 50.0, 100.0, 1000.0):
        run.set("traffic", np.full(5, aircraft))
        run.do_step(run.time, 1.0)
        rate = 30.5 * aircraft + 5.0
        expected = min(1.0 / (1.0 + 60e-6 * rate), 3000.0 / rate)
        np.testing.assert_allclose(run.get("answered_share"), expected)
        assert np.all(run.get("tracking") > 0.0) == (expected > 0.5)
    assert transponder.load(1.0) == 30.5


@pytest.mark.parametrize("lost", [0.45, 0.5, 0.55])
def test_f33_replies_are_enough_as_often_as_their_share_makes_them(native, lost):
    """One station, 25 pulse pairs a second over 2 s, a memory that does not end: how often the reading is fresh is the
    normal law of the share. Seconds are correlated by exp(-1 / 2): 2.5 times the variance of so many, at most tanh's
    (1 + r) / (1 - r) = 4.1 times; 5 standard errors of 20000 s."""
    parameters = {"station_count": 1, "dead_time": 0.0, "memory_time": 120.0, "noise_sigma": 1.0, "bias_sigma": 0.0}

    def inputs(t):
        return FLYING if t == 0.0 else {"replies_lost": np.full(5, lost)} if t == 10.0 else {}

    run = native.run(20000.0, 1.0, [RANGES], SCANNING | parameters, inputs)[RANGES][12:, 0]
    fresh = np.mean(run[1:] != run[:-1])
    chance = stats.norm.cdf((0.5 - lost) / np.sqrt(lost * (1.0 - lost) / 100.0))
    assert abs(fresh - chance) < 5.0 * np.sqrt(4.1 * chance * (1.0 - chance) / len(run))
