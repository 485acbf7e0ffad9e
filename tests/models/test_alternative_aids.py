"""VOR, fixes by radar, Doppler radar and LORAN: geometry, statistics, latency, and what fails."""

from __future__ import annotations

import navpy
import numpy as np
import pymap3d
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from fmus.radio.doppler_radar import DopplerRadar
from fmus.radio.loran import Loran
from fmus.radio.radar_fix import RadarFix
from fmus.radio.vor import Vor
from models.radio import doppler
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret

DEG, NMI, KNOT = np.pi / 180.0, 1852.0, 1852.0 / 3600.0
HERE = {"latitude": 37.75 * DEG, "longitude": -121.6 * DEG, "altitude": 1500.0}
NORTH = {"velocity_n": [46.3, 0.0, 0.0]}
SEEDS = 400
EXACT_VOR = {"station_sigma": 0.0, "bend_sigma": 0.0, "receiver_sigma": 0.0, "noise_sigma": 0.0}
EXACT_RADAR = {"range_offset_sigma": 0.0, "azimuth_offset_sigma": 0.0, "range_sigma": 0.0, "azimuth_sigma": 0.0}
EXACT_DOPPLER = {"scale_factor_sigma": 0.0, "misalignment_sigma": 0.0, "bias_sigma": 0.0, "fluctuation_sigma": 0.0}
EXACT_LORAN = {"place_sigma": 0.0, "noise_sigma": 0.0}
TABLE = {
    "station_count": 3,
    "station_latitude": np.array([38.0, 37.9, 37.4, 0.0, 0.0]) * DEG,
    "station_longitude": np.array([-121.4, -122.4, -121.6, 0.0, 0.0]) * DEG,
    "station_altitude": [10.0, 1100.0, 50.0, 0.0, 0.0],
}


def within(values, sigma):
    """Whether squares sum up as those of as many normal numbers of sigma do, at 1e-6."""
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], np.size(values)) / np.size(values)
    return low < np.mean(np.square(values)) / sigma**2 < high


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    made = {}

    def of(component):
        if component not in made:
            made[component] = Native(component, tmp_path_factory.mktemp(component.layout.name))
        return made[component]

    return of


def last(fmu, name, parameters, inputs, stop=2.0):
    return fmu.run(stop, 1.0, [name], parameters, lambda t: inputs)[name][-1]


def fault(fmu, names, parameters, inputs, faulty, step, stop, on, off):
    """Two runs with a seed, one with the fault between on and off: (sound, faulty), each name -> rows."""
    told = {"seed": 4, **parameters}

    def given(acting):
        return lambda t: {**inputs, **{n: v if acting and on - 1e-9 < t < off - 1e-9 else 0 for n, v in faulty.items()}}

    return fmu.run(stop, step, names, told, given(False)), fmu.run(stop, step, names, told, given(True))


# ---- VOR ----


def test_a_radial_is_the_azimuth_of_the_aircraft_at_the_station(native):
    """By pymap3d. Wrong: that of the station at the aircraft (0.1 degrees of convergence, and half a turn), a plane."""
    seen = last(native(Vor), "bearing.radial", {**EXACT_VOR, **TABLE, "station_variation": 0.2}, HERE)
    for i in range(3):
        place = (TABLE[f"station_{n}"][i] for n in ("latitude", "longitude", "altitude"))
        azimuth, _, _ = pymap3d.geodetic2aer(*HERE.values(), *place, deg=False)
        assert np.angle(np.exp(1j * (seen[i] - azimuth + 0.2))) == pytest.approx(0.0, abs=1e-9)
    assert np.all(seen[3:] == 0.0)


def test_errors_have_two_degrees_and_the_receiver_has_its_part_in_all(native):
    """400 seeds: the sum, what stations share and do not, bounds at 1e-6. Wrong: all errors common, or all own."""
    exact = last(native(Vor), "bearing.radial", {**EXACT_VOR, **TABLE}, HERE)[:3]
    errors = np.array(
        [last(native(Vor), "bearing.radial", {**TABLE, "seed": s}, {**HERE, **NORTH})[:3] - exact for s in range(SEEDS)]
    )
    errors = np.angle(np.exp(1j * errors)) / DEG
    total, common = np.sqrt(1.0 + 1.0 + 1.4**2 + 0.2**2), 1.4
    assert total == pytest.approx(2.0, abs=0.01)
    assert all(within(errors[:, i], total) for i in range(3))
    rho = np.corrcoef(errors[:, 0], errors[:, 1])[0, 1]
    assert abs(np.arctanh(rho) - np.arctanh((common / total) ** 2)) < stats.norm.isf(5e-7) / np.sqrt(SEEDS - 3)


def test_bends_are_forgotten_over_half_a_mile(native):
    """Correlation exp(-V t / L) after 20 s at 90 kn, 400 seeds, bound of Fisher's z at 1e-6."""
    values = {**TABLE, **EXACT_VOR, "bend_sigma": 1.0 * DEG}
    pairs = []
    for seed in range(SEEDS):
        run = native(Vor).run(21.0, 1.0, ["bearing.radial"], {**values, "seed": seed}, lambda t: {**HERE, **NORTH})
        pairs.append(run["bearing.radial"][[1, 21], 0])
    pairs = np.array(pairs) - last(native(Vor), "bearing.radial", {**values, **EXACT_VOR}, HERE)[0]
    assert within(pairs[:, 0], 1.0 * DEG) and within(pairs[:, 1], 1.0 * DEG)
    expected = np.exp(-46.3 * 20.0 / (0.5 * NMI))
    rho = np.corrcoef(pairs.T)[0, 1]
    assert abs(np.arctanh(rho) - np.arctanh(expected)) < stats.norm.isf(5e-7) / np.sqrt(SEEDS - 3)


def test_a_position_by_five_degrees_is_the_thesis_miles_off(native):
    """Thesis 7.3: 0.35 to 1.7 nmi across the track at 20 nmi with 1 and 5 degrees."""
    for sigma, miles in ((1.0, 0.35), (5.0, 1.75)):
        assert 20.0 * np.tan(sigma * DEG) == pytest.approx(miles, abs=0.01)


@pytest.mark.parametrize(
    ("elevation", "distance", "received"),
    [(38.0, 5e3, True), (42.0, 5e3, False), (1.0, 60e3, True), (-0.5, 150e3, False)],
)
def test_a_station_is_received_below_its_cone_and_above_its_horizon(elevation, distance, received):
    """The last is 470 m up at 150 km, where the horizon ends at 102 km."""
    latitude, longitude, altitude = pymap3d.aer2geodetic(30.0, elevation, distance, 38.0, -121.4, 10.0)
    run = interpret(Vor, **{**TABLE, **EXACT_VOR, "station_count": 1})
    for name, value in {"latitude": latitude * DEG, "longitude": longitude * DEG, "altitude": altitude}.items():
        run.set(name, float(value))
    run.do_step(0.0, 2.0)
    assert bool(run.get("bearing.received")[0]) == bool(run.get("bearing.valid")) == received


def test_a_station_that_is_off_and_one_whose_courses_turn(native):
    """F27 and a turned station from 3 to 6 s: only these radials, at the next sample, bit for bit sound again."""
    names = ["bearing.radial", "bearing.received"]
    faulty = {"station_off": [1, 0, 0, 0, 0], "course_shift": [0.0, 0.1, 0.0, 0.0, 0.0]}
    sound, ill = fault(native(Vor), names[:1], TABLE, {**HERE, **NORTH}, faulty, 1.0, 9.0, 3.0, 6.0)
    sound, ill = sound["bearing.radial"], ill["bearing.radial"]
    acting = np.isin(np.arange(10), (4, 5, 6))
    np.testing.assert_array_equal(sound[~acting], ill[~acting])
    np.testing.assert_array_equal(ill[acting, 0], sound[3, 0])
    np.testing.assert_allclose(ill[acting, 1] - sound[acting, 1], 0.1, rtol=1e-9)
    np.testing.assert_array_equal(sound[acting, 2], ill[acting, 2])


# ---- radar ----


def flying(t):
    """46.3 m/s to the north."""
    north = 46.3 * t
    return {**HERE, "latitude": HERE["latitude"] + north / 6.36e6}


FIX = ["fix.latitude", "fix.longitude", "fix.time_of_validity", "fix.sequence"]
RADAR_LATITUDE, RADAR_LONGITUDE = 37.72, -122.22


def radar(native, parameters=None, inputs=None, stop=24.0):
    """Rows of FIX every 0.2 s."""
    rows = []
    run = interpret(RadarFix, **{**EXACT_RADAR, **(parameters or {})})
    for k in range(round(stop / 0.2)):
        for name, value in {**flying(0.2 * k), **(inputs(0.2 * k) if inputs else {})}.items():
            run.set(name, value)
        run.do_step(0.2 * k, 0.2)
        rows.append([run.time, *(float(run.get(name)) for name in (*FIX, "fix.valid"))])
    return np.array(rows)


@pytest.mark.parametrize("stamped", [True, False])
def test_a_fix_arrives_two_seconds_after_the_look_of_each_turn(native, stamped):
    """Looks at 1 s + 4.8 k, arrives at 3 s + 4.8 k; not stamped the fix is 2 s of flight behind (F10)."""
    rows = radar(native, {"stamped": stamped})
    arrivals = rows[np.flatnonzero(np.diff(rows[:, 4], prepend=0.0))]
    np.testing.assert_allclose(arrivals[:, 0], 3.0 + 4.8 * np.arange(5), atol=1e-9)
    looks = 1.0 + 4.8 * np.arange(5)
    np.testing.assert_allclose(arrivals[:, 3], looks if stamped else looks + 2.0, atol=1e-9)
    truth = HERE["latitude"] + 46.3 * (arrivals[:, 3] - 0.2) / 6.36e6  # inputs are those of the begin of a step
    behind = (truth - arrivals[:, 1]) * 6.36e6
    np.testing.assert_allclose(behind, 0.0 if stamped else 2 * 46.3, atol=1e-6)


def test_errors_lie_along_and_across_the_line_to_the_radar(native):
    """400 turns: 15 m along, 0.08 degrees times 54.7 km = 76 m across. Wrong: swapped, or across without distance."""
    values = {"range_sigma": 15.0, "azimuth_sigma": 0.08 * DEG, "range_offset_sigma": 0.0, "azimuth_offset_sigma": 0.0}
    run = native(RadarFix).run(SEEDS * 4.8, 4.8, ["fix.latitude", "fix.longitude"], values, lambda t: HERE)
    lat, lon = np.degrees(run["fix.latitude"][2:]), np.degrees(run["fix.longitude"][2:])
    ned = navpy.lla2ned(lat, lon, np.full_like(lat, 1500.0), 37.75, -121.6, 1500.0)
    azimuth, _, _ = pymap3d.geodetic2aer(RADAR_LATITUDE, RADAR_LONGITUDE, 20.0, 37.75, -121.6, 1500.0)
    outward = np.radians(azimuth) + np.pi
    far = np.hypot(*navpy.lla2ned(RADAR_LATITUDE, RADAR_LONGITUDE, 20.0, 37.75, -121.6, 1500.0)[:2])
    along = ned[:, 0] * np.cos(outward) + ned[:, 1] * np.sin(outward)
    across = ned[:, 1] * np.cos(outward) - ned[:, 0] * np.sin(outward)
    assert within(along, 15.0) and within(across, 0.08 * DEG * far)
    turned = last(native(RadarFix), "fix.longitude", EXACT_RADAR, {**HERE, "azimuth_shift": 0.5 * DEG}, 12.0)
    lat = last(native(RadarFix), "fix.latitude", EXACT_RADAR, {**HERE, "azimuth_shift": 0.5 * DEG}, 12.0)
    ned = navpy.lla2ned(np.degrees(lat), np.degrees(turned), 1500.0, 37.75, -121.6, 1500.0)
    right = outward + 0.5 * np.pi
    assert ned[0] * np.cos(right) + ned[1] * np.sin(right) == pytest.approx(0.5 * DEG * far, rel=1e-3)


@pytest.mark.parametrize("elevation", [5.0, 40.0, 75.0])
def test_an_error_of_distance_is_more_over_the_ground_the_higher_an_aircraft_is(native, elevation):
    """400 turns, 15 m of distance: 15 m / cos of the elevation, bounds at 1e-6. Wrong: the distance taken for level."""
    values = {**EXACT_RADAR, "range_sigma": 15.0, "highest_elevation": 0.5 * np.pi}
    lat, lon, altitude = pymap3d.aer2geodetic(60.0, elevation, 10e3, RADAR_LATITUDE, RADAR_LONGITUDE, 20.0)
    place = {"latitude": float(lat) * DEG, "longitude": float(lon) * DEG, "altitude": float(altitude)}
    run = native(RadarFix).run(SEEDS * 4.8, 4.8, ["fix.latitude", "fix.longitude"], values, lambda t: place)
    seen = (np.degrees(run[f"fix.{name}"][2:]) for name in ("latitude", "longitude"))
    ned = navpy.lla2ned(*seen, np.full(SEEDS - 1, altitude), lat, lon, altitude)
    along = ned[:, 0] * np.cos(60.0 * DEG) + ned[:, 1] * np.sin(60.0 * DEG)
    assert within(along, 15.0 / np.cos(elevation * DEG))
    assert np.max(np.abs(ned[:, 1] * np.cos(60.0 * DEG) - ned[:, 0] * np.sin(60.0 * DEG))) < 0.1


def test_the_radar_has_its_own_errors_from_seed_to_seed(native):
    values = {**EXACT_RADAR, "range_offset_sigma": 30.0}
    errors = []
    for seed in range(SEEDS):
        lat, lon = (last(native(RadarFix), n, {**values, "seed": seed}, HERE, 6.0) for n in FIX[:2])
        errors.append(np.linalg.norm(navpy.lla2ned(*np.degrees([lat, lon]), 1500.0, 37.75, -121.6, 1500.0)[:2]))
    assert within(errors, 30.0)


@pytest.mark.parametrize(("name", "lost"), [("radar_off", 12.6), ("link_lost", 7.8)])
def test_without_radar_or_link_there_is_no_fix_and_then_the_next_one(native, name, lost):
    """From 6 to 12 s: the look at 10.6 that arrives at 12.6, the arrival at 7.8. It is said, with the old place, at
    that time. Wrong: old fixes as new ones, looks and arrivals confused."""
    sound, rows = radar(native), radar(native, inputs=lambda t: {name: 6.0 - 1e-9 < t < 12.0 - 1e-9})
    ill = np.flatnonzero(rows[:, 5] < sound[:, 5])
    assert rows[ill[0], 0] == pytest.approx(lost) and rows[ill[-1], 0] == pytest.approx(lost + 4.6)
    np.testing.assert_allclose(rows[ill, 3], lost, atol=1e-9)
    np.testing.assert_array_equal(rows[ill, 1:3], np.broadcast_to(rows[ill[0] - 1, 1:3], (len(ill), 2)))
    others = np.setdiff1d(np.arange(len(rows)), ill)
    np.testing.assert_array_equal(rows[others], sound[others])
    np.testing.assert_array_equal(rows[:, 4], sound[:, 4])


@pytest.mark.parametrize(
    ("elevation", "distance", "sees"), [(40.0, 6e3, True), (50.0, 6e3, False), (2.0, 100e3, True), (2.0, 120e3, False)]
)
def test_a_radar_sees_below_its_cone_and_within_its_range(elevation, distance, sees):
    place = pymap3d.aer2geodetic(70.0, elevation, distance, RADAR_LATITUDE, RADAR_LONGITUDE, 20.0)
    run = interpret(RadarFix)
    for name, value in zip(("latitude", "longitude", "altitude"), place, strict=True):
        run.set(name, float(value) * (1.0 if name == "altitude" else DEG))
    run.do_step(0.0, 10.0)
    assert run.get("fix.valid") == sees and run.get("fix.sequence") == 2


def test_a_message_that_arrives_before_the_look_is_refused():
    with pytest.raises(NavfmuError, match=r"a message arrives at 0.5 s and the radar looks at 1 s of a turn of 4.8 s"):
        interpret(RadarFix, arrival_phase=0.5)


# ---- Doppler radar ----


def test_velocity_is_turned_into_the_body_by_scipy_too(native):
    """Wrong: the transposed matrix, mounting on the wrong side."""
    angles = {"heading": 1.1, "pitch": 0.2, "roll": -0.3}
    C_nb = Rotation.from_euler("ZYX", list(angles.values())).as_matrix()
    mounted = {**EXACT_DOPPLER, "misalignment": [0.01, -0.02, 0.03], "scale_factor": 0.02, "bias": [0.1, 0.2, 0.3]}
    velocity_n = np.array([50.0, -20.0, 3.0])
    seen = last(native(DopplerRadar), "velocity.velocity_b", mounted, {**angles, "velocity_n": velocity_n})
    turned = np.eye(3) - np.array([[0.0, -0.03, -0.02], [0.03, 0.0, -0.01], [0.02, 0.01, 0.0]])
    np.testing.assert_allclose(seen, 1.02 * turned @ (C_nb.T @ velocity_n) + [0.1, 0.2, 0.3], rtol=1e-12)


@pytest.mark.parametrize(
    ("wind", "movement"), [(10.0, 3.0), (18.0, 4.0), (30.0, 5.0), (50.0, 6.0), (80.0, 6.0), (5.0, 1.5)]
)
def test_over_a_sea_it_is_too_slow_and_leads_upwind(native, wind, movement):
    """Trials, in knots. Wrong: a sea that moves against the wind, or without the percent."""
    wind_n = np.array([0.6, 0.8, 0.1]) * wind * KNOT
    given = {"velocity_n": [50.0, 0.0, 0.0], "over_water": True, "wind_n": wind_n}
    seen = last(native(DopplerRadar), "velocity.velocity_b", EXACT_DOPPLER, given)
    moves = movement * KNOT * np.array([0.6, 0.8, 0.0])
    np.testing.assert_allclose(seen, 0.99 * (np.array([50.0, 0.0, 0.0]) - moves), rtol=1e-12)
    dry = last(native(DopplerRadar), "velocity.velocity_b", EXACT_DOPPLER, {**given, "over_water": False})
    np.testing.assert_allclose(dry, [50.0, 0.0, 0.0], rtol=1e-12)


def test_the_surface_of_a_calm_sea_stands_still():
    np.testing.assert_array_equal(doppler.surface(np.zeros(3)), 0.0)


def test_fluctuation_and_turn_on_have_their_sigmas(native):
    """750 samples of 7.5 Hz; 400 seeds of scale factor. Bounds at 1e-6."""
    given = {"velocity_n": [50.0, 0.0, 0.0]}
    white = {**EXACT_DOPPLER, "fluctuation_sigma": [0.4, 0.3, 0.1]}
    run = native(DopplerRadar).run(100.0, 1 / 7.5, ["velocity.velocity_b"], white, lambda t: given)
    seen = run["velocity.velocity_b"][2:] - [50.0, 0.0, 0.0]
    assert all(within(seen[:, i], sigma) for i, sigma in enumerate((0.4, 0.3, 0.1)))
    drawn = {**EXACT_DOPPLER, "scale_factor_sigma": 0.002}
    seeds = [last(native(DopplerRadar), "velocity.velocity_b", {**drawn, "seed": s}, given)[0] for s in range(SEEDS)]
    assert within(np.array(seeds) / 50.0 - 1.0, 0.002)


@pytest.mark.parametrize(
    ("name", "value"), [("signal_lost", True), ("roll", 0.9), ("pitch", 0.5), ("altitude", 16000.0), ("roll", -0.9)]
)
def test_what_it_cannot_track_is_not_valid_and_the_last_value_stays(name, value):
    run = interpret(DopplerRadar, **EXACT_DOPPLER)
    run.set("velocity_n", [50.0, 0.0, 0.0])
    run.do_step(0.0, 1.0)
    sound, before = run.get("velocity.velocity_b"), run.get(name)
    assert run.get("velocity.valid")
    run.set(name, value)
    run.set("velocity_n", [60.0, 0.0, 0.0])
    run.do_step(1.0, 1.0)
    assert not run.get("velocity.valid")
    np.testing.assert_array_equal(run.get("velocity.velocity_b"), sound)
    run.set(name, before)
    run.do_step(2.0, 1.0)
    assert run.get("velocity.valid") and run.get("velocity.velocity_b")[0] == 60.0


def test_a_scale_factor_that_changes_acts_at_the_next_sample_and_leaves_nothing(native):
    given = {"velocity_n": [50.0, 0.0, 0.0]}
    args = {}, given, {"scale_factor_change": 0.05}, 1 / 7.5, 6.0, 2.0, 4.0
    sound, ill = (run["velocity.velocity_b"] for run in fault(native(DopplerRadar), ["velocity.velocity_b"], *args))
    acting = (np.arange(len(sound)) > 15) & (np.arange(len(sound)) <= 30)
    np.testing.assert_array_equal(sound[~acting], ill[~acting])
    np.testing.assert_allclose((ill - sound)[acting, 0], 2.5, rtol=0.01)


# ---- LORAN ----


def errors_of_loran(native, parameters, inputs=HERE, stop=1.0, rows=(1,)):
    run = native(Loran).run(stop, 1.0, ["fix.latitude", "fix.longitude"], parameters, lambda t: inputs)
    lat, lon = np.degrees(run["fix.latitude"][list(rows)]), np.degrees(run["fix.longitude"][list(rows)])
    return np.reshape(navpy.lla2ned(lat, lon, np.full_like(lat, 1500.0), 37.75, -121.6, 1500.0), (-1, 3))[:, :2]


def test_two_drms_are_a_quarter_of_a_mile_and_what_is_not_of_the_place_200_feet(native):
    """400 seeds, bounds at 1e-6. Wrong: 0.25 nmi as sigma of an axis, or of both together."""
    errors = np.concatenate([errors_of_loran(native, {"seed": s}) for s in range(SEEDS)])
    assert within(errors, 0.25 * NMI / np.sqrt(8.0))
    noise = errors_of_loran(native, {"place_sigma": 0.0}, stop=float(SEEDS), rows=range(1, SEEDS + 1))
    assert within(noise, 200.0 * 0.3048 / np.sqrt(8.0))


def test_the_place_is_forgotten_over_20_miles(native):
    """Correlation exp(-V t / L) after 100 s at 200 m/s. Fisher's z at 1e-6."""
    given = {**HERE, "velocity_n": [200.0, 0.0, 0.0]}
    pairs = np.array(
        [errors_of_loran(native, {"noise_sigma": 0.0, "seed": s}, given, 101.0, (1, 101))[:, 0] for s in range(SEEDS)]
    )
    expected = np.exp(-200.0 * 100.0 / (20.0 * NMI))
    rho = np.corrcoef(pairs.T)[0, 1]
    assert abs(np.arctanh(rho) - np.arctanh(expected)) < stats.norm.isf(5e-7) / np.sqrt(SEEDS - 3)


def test_static_takes_the_fix_and_a_wrong_cycle_displaces_it(native):
    """From 3 to 6 s: not valid and held; 1.5 km to the north. Then bit for bit as if nothing had been."""
    names, inputs = ["fix.latitude", "fix.longitude"], {**HERE, **NORTH}
    sound, ill = fault(native(Loran), names, {}, inputs, {"cycle_slip": [1500.0, 0.0]}, 1.0, 9.0, 3.0, 6.0)
    acting = np.isin(np.arange(10), (4, 5, 6))
    np.testing.assert_array_equal(sound["fix.latitude"][~acting], ill["fix.latitude"][~acting])
    moved = (ill["fix.latitude"] - sound["fix.latitude"])[acting]
    north_south = pymap3d.rcurve.meridian(HERE["latitude"], deg=False)
    np.testing.assert_allclose(moved, 1500.0 / (north_south + 1500.0), rtol=1e-9)
    np.testing.assert_array_equal(ill["fix.longitude"], sound["fix.longitude"])
    sound, ill = fault(native(Loran), names, {}, inputs, {"precipitation_static": True}, 1.0, 9.0, 3.0, 6.0)
    np.testing.assert_array_equal(ill["fix.latitude"][acting], sound["fix.latitude"][3])
    np.testing.assert_array_equal(ill["fix.latitude"][~acting], sound["fix.latitude"][~acting])
    run = interpret(Loran, **HERE, precipitation_static=True)
    run.do_step(0.0, 3.0)
    assert not run.get("fix.valid") and run.get("fix.sequence") == 3
