"""Lines, ports and probe of the air data system, and what each fault shows, from onset to recovery.

Faults by their number in the table of failure modes (F20 to F25).
"""

import ambiance
import numpy as np
import pytest
from scipy.optimize import brentq

from fmus.air.air_data import AirData
from models.air import atmosphere, pneumatics
from models.earth import geoid
from tests.models.native import Native, interpret

FOOT, KNOT = 0.3048, 1852.0 / 3600.0
QUIET = dict.fromkeys(
    (
        "airspeed_error_sigma",
        "altitude_error_sigma",
        "pitot_coefficient_sigma",
        "pressure_offset_sigma",
        "temperature_error_sigma",
    ),
    0.0,
)
READINGS = [
    f"air.{name}"
    for name in (
        "calibrated_airspeed",
        "true_airspeed",
        "mach",
        "pressure_altitude",
        "indicated_altitude",
        "vertical_speed",
        "temperature",
    )
]
PERIOD = 0.1


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(AirData, tmp_path_factory.mktemp("air_data"))


@pytest.fixture
def fly(native):
    """Readings of a flight: altitude(t), speed(t), or numbers; faults by name, each (from, before, value)."""

    def flight(stop, altitude=1000.0, speed=50.0, faults=(), inputs=lambda t: {}, **parameters):
        def at(t):
            values = {
                "altitude": altitude(t) if callable(altitude) else altitude,
                "velocity_n": (speed(t) if callable(speed) else speed, 0.0, 0.0),
                **inputs(t),
            }
            for name, (start, end, value) in dict(faults).items():
                values[name] = value if start - 1e-6 < t + PERIOD < end - 1e-6 else 0
            return values

        found = native.run(stop, PERIOD, READINGS, {**QUIET, **parameters}, at)
        return {name.removeprefix("air."): values for name, values in found.items()}

    return flight


def at(run, name, time):
    return run[name][round(time / PERIOD)]


def impact(airspeed):
    """q_c, Pa, of a calibrated airspeed: the textbook's, written out."""
    return 101325.0 * ((1.0 + (airspeed / 340.294) ** 2 / 5.0) ** 3.5 - 1.0)


def pressure(altitude):
    """Of the standard day at a height above the sea, Pa."""
    return float(ambiance.Atmosphere(altitude).pressure[0])


def equal(a, b, start, end):
    """Bit for bit, from one time until before another."""
    part = slice(round(start / PERIOD), round(end / PERIOD))
    return all(np.array_equal(a[name][part], b[name][part]) for name in a)


# ---- what is measured ----


@pytest.mark.parametrize("height", [0.0, 9000.0, 15000.0])
@pytest.mark.parametrize("recovery", [0.0, 0.8])
def test_mach_number_and_true_airspeed_at_any_height(fly, height, recovery):
    """The recovery of the probe is taken out; without that the temperature is 20 K too high at 220 m/s."""
    run = fly(1.0, altitude=height, speed=220.0, recovery_factor=recovery)
    day = ambiance.Atmosphere(height)
    assert at(run, "mach", 1.0) == pytest.approx(220.0 / day.speed_of_sound[0], rel=1e-6)
    assert at(run, "true_airspeed", 1.0) == pytest.approx(220.0, rel=1e-6)
    assert at(run, "temperature", 1.0) == pytest.approx(day.temperature[0], abs=1e-3)


@pytest.mark.parametrize(("height", "valid"), [(-4900.0, 1), (-5100.0, 0), (20000.0, 1), (20100.0, 0)])
def test_outside_the_standard_atmosphere_the_reading_is_not_valid(height, valid):
    """Its 20 km of geopotential altitude are 20 063 m."""
    run = interpret(AirData, **QUIET, altitude=height, velocity_n=(50.0, 0.0, 0.0))
    run.do_step(0.0, PERIOD)
    assert run.get("air.valid") == valid and run.get("air.sequence") == 1


@pytest.mark.parametrize("name", ["altitude", "velocity_n", "wind_n", "sea_level_pressure", "temperature_deviation"])
def test_without_a_number_the_reading_is_not_valid_until_there_is_one(name):
    run = interpret(AirData, **QUIET)
    before = run.get(name)
    seen = []
    for k, value in enumerate((before, np.full_like(before, np.nan), before)):
        run.set(name, value)
        run.do_step(k * PERIOD, PERIOD)
        seen.append(bool(run.get("air.valid")))
    assert seen == [True, False, True]


def test_the_altimeter_shows_the_field_with_its_setting(fly):
    """On a day of p' at sea level with the standard temperature, h_i = H (p'/p_0)^(R lambda/g): 0 at sea level."""
    for height in (0.0, 1000.0):
        setting = {"sea_level_pressure": 99500.0, "baro_setting": 99500.0}
        run = fly(1.0, altitude=height, inputs=lambda t, setting=setting: setting)
        expected = height * 6356766.0 / (6356766.0 + height) * (99500.0 / 101325.0) ** (1.0 / 5.25588)
        assert at(run, "indicated_altitude", 1.0) == pytest.approx(expected, abs=1e-3)
        low = at(run, "pressure_altitude", 1.0) - at(run, "indicated_altitude", 1.0)
        assert low / FOOT / 18.25 == pytest.approx(27.5, abs=0.3)  # 27.5 ft for each hPa


def test_the_pressure_of_the_day_may_change_in_flight(fly):
    """1 hPa less: 27.3 ft higher at once. A value that is taken at the start only shows nothing."""
    run = fly(2.0, altitude=0.0, inputs=lambda t: {"sea_level_pressure": 101325.0 if t < 0.95 else 101225.0})
    assert at(run, "pressure_altitude", 2.0) - at(run, "pressure_altitude", 0.9) == pytest.approx(27.3 * FOOT, abs=0.1)


def test_heights_above_the_sea_by_position(fly):
    """At a test value of NGA's program (269.8 E, 38.6 N: -31.628 m) within the table's 5.2 m; given height on top."""
    place = {"latitude": np.radians(38.628155), "longitude": np.radians(269.779155)}
    here = geoid.height(**place)
    assert here == pytest.approx(-31.628, abs=5.2)
    without, given, by_position, both = (
        at(fly(0.2, altitude=500.0, inputs=lambda t: place, **p), "pressure_altitude", 0.2)
        for p in ({}, {"geoid_height": 20.0}, {"geoid_by_position": 1}, {"geoid_height": 20.0, "geoid_by_position": 1})
    )
    assert given - without == pytest.approx(-20.0, abs=0.01)
    assert by_position - without == pytest.approx(-here, abs=0.01)
    assert both - without == pytest.approx(-here - 20.0, abs=0.01)


def test_vertical_speed_in_a_steady_climb_and_behind_a_lag(fly):
    """5 m/s from 10 s on: 5 (1 - exp(-t/tau)) of geopotential altitude; a difference of two samples has no lag."""
    run = fly(40.0, altitude=lambda t: 1000.0 + 5.0 * max(t + PERIOD - 10.0, 0.0), vertical_speed_time=4.0)
    geopotential = (6356766.0 / (6356766.0 + 1075.0)) ** 2
    for t in (10.0, 12.0, 14.0, 40.0):
        assert at(run, "vertical_speed", t) == pytest.approx(5.0 * geopotential * (1 - np.exp(-(t - 10) / 4)), abs=1e-3)


# ---- lag, position error, probe ----


def test_time_to_fill_a_line():
    """Hagen and Poiseuille: the flow d^4 pi dp / (128 mu L) into the volume C; checked by its integral, dimension by
    dimension: twice the length or volume, twice the time; half the diameter, sixteen times."""
    tau = pneumatics.fill_time(5.0, 4.7e-3, 3e-4)
    flow = np.pi * 4.7e-3**4 / (128.0 * 1.7894e-5 * 5.0)  # m3/s for each Pa
    assert tau == pytest.approx(3e-4 / (101325.0 * flow), rel=1e-9)
    assert tau == pytest.approx(0.022, abs=0.001)


@pytest.mark.parametrize("height", [0.0, 9000.0])
def test_in_a_climb_the_altitude_lags_by_the_time_constant_at_that_height(fly, height):
    """10 m/s: behind by 10 tau, tau 0.5 s at sea level and 0.5 (p_0/p) (mu/mu_0) above. A lag of the sea level's time
    is 58 % off at 9 km, one that holds its input for a sample by half a sample, 10 % at sea level."""
    day = ambiance.Atmosphere(height)
    viscosity = day.dynamic_viscosity[0] / ambiance.Atmosphere(0.0).dynamic_viscosity[0]
    tau = 0.5 * 101325.0 / day.pressure[0] * viscosity

    def climb(t):
        return height + 10.0 * (t + PERIOD - 20.0)

    clean, late = fly(20.0, altitude=climb), fly(20.0, altitude=climb, static_lag_time=0.5)
    lag = at(clean, "pressure_altitude", 20.0) - at(late, "pressure_altitude", 20.0)
    geopotential = (6356766.0 / (6356766.0 + height)) ** 2
    assert lag == pytest.approx(10.0 * tau * geopotential, rel=1e-3)
    assert at(late, "pressure_altitude", PERIOD) == at(clean, "pressure_altitude", PERIOD)  # settled at first


def test_airspeed_lags_by_the_line_of_the_pitot_tube_only(fly):
    """1 m/s2: the total pressure is late by tau, that of the tube by its inlet and drain, and so the airspeed by tau a,
    less tau^2 a^2 / (2 V) as its square is late."""
    tau = 0.4 / 1.02
    run = fly(20.0, altitude=0.0, speed=lambda t: 60.0 + (t + PERIOD), total_lag_time=0.4)
    assert at(run, "true_airspeed", 20.0) == pytest.approx(80.0 - tau + tau**2 / 160.0, abs=1e-4)
    assert np.ptp(run["pressure_altitude"][1:]) < 1e-9


@pytest.mark.parametrize("coefficient", [0.067, -0.067])
def test_position_error_of_the_regulation_is_30_feet_at_100_knots(fly, coefficient):
    """C_0 q_c more pressure: lower by 30 ft; the airspeed low by 0.067 / 2."""
    run = fly(0.5, altitude=0.0, speed=100.0 * KNOT, static_coefficient=coefficient)
    assert at(run, "pressure_altitude", 0.5) / FOOT == pytest.approx(-np.sign(coefficient) * 30.0, abs=0.5)
    expected = (1.0 - coefficient) * impact(100.0 * KNOT)
    assert impact(at(run, "calibrated_airspeed", 0.5)) == pytest.approx(expected, rel=1e-6)


def test_position_error_with_angle_of_attack_and_sideslip(fly):
    """Level flight north with 8 degrees of pitch: alpha; heading turned by 10 degrees: beta; both signs of beta alike.
    In other axes (n for b, roll left out) the numbers differ."""
    q = impact(at(fly(0.2, altitude=0.0), "calibrated_airspeed", 0.2))
    eight, ten = np.radians(8.0), np.radians(10.0)

    def coefficient(**angles):
        run = fly(
            0.2,
            altitude=0.0,
            inputs=lambda t: angles,
            static_coefficient_attack=0.3,
            static_coefficient_sideslip=-2.0,
        )
        return 1.0 - impact(at(run, "calibrated_airspeed", 0.2)) / q

    assert coefficient(pitch=eight) == pytest.approx(0.3 * eight, rel=1e-6)
    for sign in (-1.0, 1.0):
        assert coefficient(heading=sign * ten) == pytest.approx(-2.0 * ten**2, rel=1e-6)
    # sideslip is the angle out of the plane of symmetry, whatever the angle of attack
    assert coefficient(pitch=eight, heading=ten) == pytest.approx(0.3 * eight - 2.0 * ten**2, rel=1e-6)
    # on the right side: the air from the left comes from below
    assert coefficient(roll=np.pi / 2, heading=ten) == pytest.approx(0.3 * ten, rel=1e-6)


def test_temperature_probe_lags_and_is_warmed_by_the_flow(fly):
    """A climb of 10 m/s, -0.065 K/s: late by 0.065 x 5 s. With the pitot tube blocked at rest the computer knows no
    Mach number, and what it shows is the stagnation temperature, T + V^2 / (2 c_p)."""
    run = fly(60.0, altitude=lambda t: 10.0 * (t + PERIOD), temperature_lag_time=5.0)
    assert at(run, "temperature", 60.0) - ambiance.Atmosphere(600.0).temperature[0] == pytest.approx(0.325, abs=1e-3)
    deaf = fly(
        30.0,
        altitude=0.0,
        speed=lambda t: 0.0 if t < 9.0 else 150.0,
        faults={"pitot_blocked": (5.0, 99.0, 1)},
        recovery_factor=1.0,
    )
    assert at(deaf, "calibrated_airspeed", 30.0) < 0.1
    assert at(deaf, "temperature", 30.0) - 288.15 == pytest.approx(150.0**2 / (2.0 * 3.5 * 287.05287), rel=1e-6)


# ---- faults ----


def test_f20_tube_blocked_and_drain_open_the_airspeed_falls_to_zero(fly):
    """q_c decays with tau / drain, here 0.1 / 0.02 = 5 s at sea level; then it comes back with tau."""
    fault = {"pitot_inlet_blocked": (10.0, 80.0, 1)}
    lags = {"total_lag_time": 0.1, "drain_opening": 0.02, "altitude": 0.0}
    run, clean = fly(120.0, faults=fault, **lags), fly(120.0, **lags)
    q = impact(run["calibrated_airspeed"])
    assert q[round(25.0 / PERIOD)] / q[round(15.0 / PERIOD)] == pytest.approx(np.exp(-10.0 / 5.0), rel=1e-6)
    assert at(run, "calibrated_airspeed", 79.9) < KNOT
    assert equal(run, clean, 0.0, 10.0)
    assert at(run, "calibrated_airspeed", 82.0) == pytest.approx(at(clean, "calibrated_airspeed", 82.0), rel=1e-7)
    assert np.array_equal(run["pressure_altitude"], clean["pressure_altitude"])  # the altimeter knows nothing of it
    at_once = fly(30.0, faults={"pitot_inlet_blocked": (10.0, 20.0, 1)})
    assert at(at_once, "calibrated_airspeed", 10.0) == 0.0
    assert equal(at_once, fly(30.0), 20.0, 30.0)


def hill(t):
    """Level for 10 s, up 200 m, level, down 400 m."""
    return 1000.0 + np.interp(t + PERIOD, [0, 10, 30, 40, 80], [0, 0, 200, 200, -200])


@pytest.mark.parametrize("faults", [("pitot_blocked",), ("pitot_inlet_blocked", "drain_blocked")])
def test_f21_tube_and_drain_blocked_the_airspeed_is_an_altimeter(fly, faults):
    """Rises in the climb, falls in the descent, deaf to speed in between; closed form from the trapped pressure."""
    faults = {name: (9.0, 79.0, 1) for name in faults}
    run = fly(90.0, altitude=hill, speed=lambda t: 50.0 if t < 33.0 else 70.0, faults=faults)
    clean = fly(90.0, altitude=hill, speed=lambda t: 50.0 if t < 33.0 else 70.0)
    before = at(run, "calibrated_airspeed", 8.0)
    trapped = pressure(1000.0) + impact(before)
    for t, height in ((30.0, 1200.0), (39.0, 1200.0), (50.0, 1100.0)):
        assert impact(at(run, "calibrated_airspeed", t)) == pytest.approx(trapped - pressure(height), rel=1e-5)
    assert at(run, "calibrated_airspeed", 30.0) > before + 15.0
    assert at(run, "calibrated_airspeed", 32.0) == at(run, "calibrated_airspeed", 36.0)
    assert at(run, "calibrated_airspeed", 78.0) == 0.0
    assert equal(run, clean, 0.0, 9.0) and equal(run, clean, 79.0, 90.0)


def test_f22_static_port_blocked(fly):
    """Altitude frozen, vertical speed dies away with its lag, airspeed low above and high below."""
    run = fly(90.0, altitude=hill, faults={"static_blocked": (20.0, 70.0, 1)}, vertical_speed_time=2.0)
    clean = fly(90.0, altitude=hill, vertical_speed_time=2.0)
    frozen = run["pressure_altitude"][round(20.0 / PERIOD) : round(70.0 / PERIOD)]
    assert np.ptp(frozen) == 0.0 and at(run, "pressure_altitude", 19.9) == frozen[0]
    ratio = at(run, "vertical_speed", 25.0) / at(run, "vertical_speed", 21.0)
    assert ratio == pytest.approx(np.exp(-2.0), rel=1e-6)
    assert at(run, "calibrated_airspeed", 30.0) < at(clean, "calibrated_airspeed", 30.0) - 5.0
    assert at(run, "calibrated_airspeed", 65.0) > at(clean, "calibrated_airspeed", 65.0) + 5.0
    without_lag = [{k: v for k, v in r.items() if k != "vertical_speed"} for r in (run, clean)]
    assert equal(*without_lag, 70.0, 90.0)
    assert at(run, "vertical_speed", 89.9) == pytest.approx(at(clean, "vertical_speed", 89.9), abs=1e-2)


def test_f22_is_mended_by_the_alternate_source(fly):
    """Cabin air of the pressure outside: the altitude is right again. A source that is only shut off stays frozen."""
    faults = {"static_blocked": (5.0, 99.0, 1), "alternate_static": (50.0, 99.0, 1)}
    run = fly(90.0, altitude=hill, faults=faults, cabin_coefficient=0.0)
    assert at(run, "pressure_altitude", 49.0) > at(run, "pressure_altitude", 70.0)
    assert at(run, "pressure_altitude", 70.0) == at(fly(90.0, altitude=hill), "pressure_altitude", 70.0)


def test_f24_the_alternate_source_is_as_wide_as_the_port(fly):
    """At sea level with a line of 1 s: what is left of the change falls by e in a second."""
    run = fly(30.0, altitude=0.0, faults={"alternate_static": (5.0, 99.0, 1)}, static_lag_time=1.0)
    six, seven, end = (at(run, "pressure_altitude", t) for t in (6.0, 7.0, 30.0))
    assert (end - seven) / (end - six) == pytest.approx(np.exp(-1.0), rel=1e-2)


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 0.98, 1.0])
def test_f23_ice_on_the_tube(fly, share):
    """In the end as much flows in through what is left of the inlet as out through the drain, found by its root.

    Ice grows evenly, to all of it in 30 s, and melts in 10 s; then nothing of it is left.
    """
    times = {"freezing_time": 30.0, "melting_time": 10.0}
    run = fly(80.0, faults={"pitot_ice": (10.0, 60.0, share)}, **times)
    clean = fly(80.0, **times)
    q = impact(at(clean, "calibrated_airspeed", 1.0))
    drain = 0.02

    def leaves(p, inlet):  # the inlet of a clear tube has the excess with which it shows q
        return inlet * (q * (1.0 + drain) - p) - drain * p

    for t, ice in ((25.0, min(share, 15.1 / 30.0)), (59.0, share)):
        expected = brentq(leaves, -1.0, 2.0 * q, args=(1.0 - ice,))
        assert impact(at(run, "calibrated_airspeed", t)) == pytest.approx(expected, rel=1e-5, abs=1e-6)
    assert equal(run, clean, 0.0, 10.0) and equal(run, clean, 60.0 + 10.0 * share + PERIOD, 80.0)
    if share == 0.9:  # slowly, then fast: half of the ice takes 1 % of the airspeed, nine tenths 8 %
        assert at(run, "calibrated_airspeed", 25.0) > 0.98 * at(clean, "calibrated_airspeed", 25.0)
        assert at(run, "calibrated_airspeed", 59.0) < 0.93 * at(clean, "calibrated_airspeed", 59.0)


def test_f23_ice_with_the_drain_shut_traps_the_pressure(fly):
    """Nothing is seen in level flight; the airspeed is an altimeter once the inlet has closed, not before."""
    faults = {"drain_blocked": (1.0, 99.0, 1), "pitot_ice": (1.0, 99.0, 1.0)}
    run = fly(90.0, altitude=hill, faults=faults, freezing_time=34.0)
    assert at(run, "calibrated_airspeed", 34.0) == pytest.approx(at(run, "calibrated_airspeed", 2.0), rel=0.012)
    assert at(run, "calibrated_airspeed", 50.0) < 0.5 * at(run, "calibrated_airspeed", 36.0)


def test_f24_alternate_static_source(fly):
    """Cabin air of 0.1 q_c less: altitude and airspeed high, a moment of climb. At 90 kn within the 50 ft and 6 mph of
    the manual; the port is shut off: an opening beside it would give half of this."""
    run = fly(60.0, altitude=0.0, speed=90.0 * KNOT, faults={"alternate_static": (10.0, 30.0, 1)})
    clean = fly(60.0, altitude=0.0, speed=90.0 * KNOT)
    q = impact(90.0 * KNOT)
    assert impact(at(run, "calibrated_airspeed", 20.0)) == pytest.approx(1.1 * q, rel=1e-6)
    higher = at(run, "pressure_altitude", 20.0) - at(clean, "pressure_altitude", 20.0)
    assert higher == pytest.approx(0.1 * q / (1.225 * 9.80665), rel=2e-3)
    assert 30.0 * FOOT < higher < 50.0 * FOOT
    assert 3.0 * KNOT < at(run, "calibrated_airspeed", 20.0) - 90.0 * KNOT < 6.0 * 0.44704
    assert at(run, "vertical_speed", 10.0) > 5.0 and abs(at(run, "vertical_speed", 29.9)) < 0.01
    without = [{k: v for k, v in r.items() if k != "vertical_speed"} for r in (run, clean)]
    assert equal(*without, 30.0, 60.0)
    assert abs(at(run, "vertical_speed", 60.0)) < 1e-4


@pytest.mark.parametrize("leak", [0.1, 1.0])
def test_f24_leak_into_a_pressurised_cabin(fly, leak):
    """Cabin of 8000 ft at 9 km: the line settles at (p + g p_c) / (1 + g), and reads low; bit for bit afterwards."""
    cabin = pressure(8000.0 * FOOT)
    run = fly(30.0, altitude=9000.0, speed=200.0, faults={"static_leak": (10.0, 20.0, leak)}, cabin_pressure=cabin)
    clean = fly(30.0, altitude=9000.0, speed=200.0, cabin_pressure=cabin)
    expected = (pressure(9000.0) + leak * cabin) / (1.0 + leak)
    assert at(run, "pressure_altitude", 15.0) == pytest.approx(atmosphere.pressure_altitude(expected), abs=0.1)
    assert at(run, "pressure_altitude", 15.0) < at(clean, "pressure_altitude", 15.0) - 500.0
    without = [{k: v for k, v in r.items() if k != "vertical_speed"} for r in (run, clean)]
    assert equal(*without, 20.0, 30.0)


def test_f24_leak_of_the_pitot_line(fly):
    """Cabin of the pressure outside: q_c (1 + drain) / (1 + drain + g), and the altitude is right."""
    run = fly(30.0, faults={"pitot_leak": (10.0, 20.0, 0.1)}, cabin_coefficient=0.0)
    clean = fly(30.0, cabin_coefficient=0.0)
    q = impact(at(clean, "calibrated_airspeed", 15.0))
    assert impact(at(run, "calibrated_airspeed", 15.0)) == pytest.approx(q * 1.02 / 1.12, rel=1e-6)
    assert np.array_equal(run["pressure_altitude"], clean["pressure_altitude"])
    assert equal(run, clean, 20.0, 30.0)


def test_f24_the_leak_of_a_shut_line_is_exponential(fly):
    """As in the proof test of 14 CFR 23.1325(b)(2): port shut, the line goes to the cabin's pressure with tau / g."""
    faults = {"static_blocked": (1.0, 99.0, 1), "static_leak": (1.0, 99.0, 0.01)}
    run = fly(60.0, altitude=0.0, speed=0.0, faults=faults, static_lag_time=0.2, cabin_pressure=1.05 * 101325.0)
    p = 101325.0 * (1.0 - 0.0065 / 288.15 * run["pressure_altitude"]) ** 5.25588
    left = 1.05 * 101325.0 - p
    assert left[round(50.0 / PERIOD)] / left[round(30.0 / PERIOD)] == pytest.approx(np.exp(-20.0 / 20.0), rel=1e-4)


def test_f25_swapped_lines(fly):
    """No airspeed, and the altimeter shows the total pressure: low by V^2 / (2 g), to Mach^2 / 4."""
    run, clean = fly(30.0, altitude=0.0, faults={"lines_swapped": (10.0, 20.0, 1)}), fly(30.0, altitude=0.0)
    assert at(run, "calibrated_airspeed", 15.0) == 0.0 and at(run, "mach", 15.0) == 0.0
    low = at(clean, "pressure_altitude", 15.0) - at(run, "pressure_altitude", 15.0)
    assert low == pytest.approx(50.0**2 / (2.0 * 9.80665), rel=0.01)
    without = [{k: v for k, v in r.items() if k != "vertical_speed"} for r in (run, clean)]
    assert equal(*without, 0.0, 10.0) and equal(*without, 20.0, 30.0)


@pytest.mark.parametrize("height", [0.01, 0.02])
def test_water_in_the_static_line(fly, height):
    """The altimeter sticks until the pressure has changed by rho g h, follows that much late, up and down; drained, it
    is right at once. An offset alone would move at once, and would be on one side."""
    run = fly(90.0, altitude=hill, faults={"static_water": (5.0, 85.0, height)})
    clean = fly(90.0, altitude=hill)
    late = 1000.0 * 9.80665 * height
    for t, sign in ((30.0, 1.0), (39.0, 1.0), (80.0, -1.0)):
        shown = 101325.0 * (1.0 - 0.0065 / 288.15 * at(run, "pressure_altitude", t)) ** 5.25588
        true = 101325.0 * (1.0 - 0.0065 / 288.15 * at(clean, "pressure_altitude", t)) ** 5.25588
        assert shown - true == pytest.approx(sign * late, abs=0.1)
    moved = np.flatnonzero(
        np.diff(run["pressure_altitude"][: round(30.0 / PERIOD)], prepend=run["pressure_altitude"][1])
    )
    moved = moved[moved > round(5.0 / PERIOD)]
    assert hill(moved[0] * PERIOD - PERIOD) - 1000.0 == pytest.approx(late / (1.112 * 9.80665), abs=1.1)
    without = [{k: v for k, v in r.items() if k != "vertical_speed"} for r in (run, clean)]
    assert equal(*without, 85.0, 90.0)


def test_water_in_the_pitot_line(fly):
    """From 50 to 60 m/s and back: q_c late by rho g h = 98 Pa both ways."""

    def speed(t):
        return np.interp(t + PERIOD, [0, 10, 20, 30, 40], [50, 50, 60, 60, 50])

    run = fly(60.0, altitude=0.0, speed=speed, faults={"pitot_water": (5.0, 55.0, 0.01)})
    clean = fly(60.0, altitude=0.0, speed=speed)
    for t, sign in ((25.0, -1.0), (50.0, 1.0)):
        late = impact(at(run, "calibrated_airspeed", t)) - impact(at(clean, "calibrated_airspeed", t))
        assert late == pytest.approx(sign * 98.0665, rel=1e-3)
    assert equal(run, clean, 55.0, 60.0)


def test_drain_blocked_alone_reads_high_by_its_share(fly):
    """The tube is calibrated with its drain: shut, q_c is 2 % high, the airspeed 1 %."""
    run, clean = fly(30.0, faults={"drain_blocked": (10.0, 20.0, 1)}), fly(30.0)
    ratio = impact(at(run, "calibrated_airspeed", 15.0)) / impact(at(clean, "calibrated_airspeed", 15.0))
    assert ratio == pytest.approx(1.02, rel=1e-6)
    assert equal(run, clean, 20.0, 30.0)


@pytest.mark.parametrize("name", ["pitot_ice", "static_leak", "pitot_leak", "static_water", "pitot_water"])
def test_a_fault_of_less_than_nothing_is_none(fly, name):
    assert equal(fly(5.0, faults={name: (1.0, 99.0, -0.5)}), fly(5.0), 0.0, 5.0)


@pytest.mark.parametrize(
    "name", ["altitude", "velocity_n", "wind_n", "sea_level_pressure", "pitot_ice", "static_water"]
)
@pytest.mark.parametrize("lag", [0.0, 0.2])
def test_what_is_no_number_is_forgotten(fly, name, lag):
    """NaN for half a second: afterwards the readings are what they were, as soon as they would be after a start."""
    start = {"wind_n": 0.0, "sea_level_pressure": 101325.0, "pitot_ice": 0.0, "static_water": 0.0}

    def inputs(t):
        bad = 2.0 < t < 2.5
        if name == "velocity_n":
            return {name: np.full(3, np.nan)} if bad else {}
        if name == "altitude":
            return {name: np.nan} if bad else {}
        return {name: np.full_like(start[name], np.nan) if bad else start[name]}

    parameters = {
        "static_lag_time": lag,
        "total_lag_time": lag,
        "temperature_lag_time": lag,
    }
    run, clean = fly(6.0, inputs=inputs, **parameters), fly(6.0, **parameters)
    assert equal(run, clean, 0.0, 2.0)
    for reading in clean:
        np.testing.assert_allclose(run[reading][-10:], clean[reading][-10:], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("fault", ["static_blocked", "pitot_blocked"])
def test_a_port_does_not_trap_what_is_no_number(fly, fault):
    """The altitude is none for 0.5 s, in which the port is blocked: then it keeps the first pressure that there is."""
    run = fly(
        6.0,
        altitude=lambda t: np.nan if 1.95 < t < 2.45 else 1000.0 + 5.0 * t,
        faults={fault: (2.2, 5.0, True)},
    )
    shut = slice(round(2.7 / PERIOD), round(4.9 / PERIOD))
    assert np.all(np.isfinite(run["calibrated_airspeed"][shut]))
    frozen = "pressure_altitude" if fault == "static_blocked" else "calibrated_airspeed"
    assert (np.ptp(run[frozen][shut]) == 0.0) == (fault == "static_blocked")


@pytest.mark.parametrize(("speed", "valid"), [(330.0, True), (345.0, False)])
def test_from_the_speed_of_sound_on_the_reading_is_not_valid(speed, valid):
    """336 m/s at 1000 m."""
    run = interpret(AirData, **QUIET, altitude=1000.0, velocity_n=(speed, 0.0, 0.0))
    run.do_step(0.0, PERIOD)
    assert bool(run.get("air.valid")) == valid
