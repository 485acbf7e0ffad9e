"""The wind: Berman-Powell over travelling time, profile, layers, shear and gusts (F26)."""

import numpy as np
import pytest
from scipy import stats

from fmus.air.wind import Wind
from navfmu import System
from navfmu.errors import NavfmuError, NavfmuWarning
from navfmu.ssp.writer import SystemSource
from tests.built import fmu, folder
from tests.models.native import Native, interpret

COUNT = 400
CALM = {"sigma": (0.0, 0.0, 0.0)}


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Wind, tmp_path_factory.mktemp("wind"))


def ensemble(native, ratio, stop=400.0):
    """North and east wind of many seeds at the begin and the end."""
    runs = []
    for seed in range(COUNT):
        values = native.run(
            stop, stop, ["wind_n"], {"seed": seed, "travelling_time_ratio": ratio, "mean_n": (3.0, -7.0, 0.5)}
        )["wind_n"]
        runs.append(values)
    return np.array(runs)


def test_the_wind_has_5_metres_per_second_and_400_seconds(native):
    """Mean, sigma at t = 0 and 400 s later, correlation e^-1 between; north and east independent. Bounds at 1e-6."""
    runs = ensemble(native, 1.0)
    np.testing.assert_array_equal(runs[:, :, 2], 0.5)  # no vertical variation
    variation = runs[:, :, :2] - (3.0, -7.0)
    assert np.max(np.abs(np.mean(variation, axis=0))) < 4.9 * 5.0 / np.sqrt(COUNT)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], COUNT) / COUNT
    for moment in (0, 1):
        for axis in (0, 1):
            assert low < np.mean(variation[:, moment, axis] ** 2) / 25.0 < high
    bound = 4.9 / np.sqrt(COUNT - 3)
    for axis in (0, 1):
        r = np.corrcoef(variation[:, 0, axis], variation[:, 1, axis])[0, 1]
        assert abs(np.arctanh(r) - np.arctanh(np.exp(-1.0))) < bound
    assert abs(np.arctanh(np.corrcoef(variation[:, 0, 0], variation[:, 0, 1])[0, 1])) < bound


def test_travelling_time_shortens_the_correlation(native):
    """In a climb the travelling time is twice the time: the correlation over 400 s is e^-2."""
    variation = ensemble(native, 2.0)[:, :, :2] - (3.0, -7.0)
    r = np.corrcoef(variation[:, 0].ravel(), variation[:, 1].ravel())[0, 1]
    assert abs(np.arctanh(r) - np.arctanh(np.exp(-2.0))) < 4.9 / np.sqrt(2 * COUNT - 3)


def test_steps_have_the_exact_size(native):
    """Squared steps over 0.1 s average to 2 sigma^2 (1 - phi)."""
    values = native.run(2000.0, 0.1, ["wind_n"], {"sigma": (4.0, 4.0, 4.0)})["wind_n"]
    steps = np.diff(values, axis=0).ravel()
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], steps.size) / steps.size
    assert low < np.mean(steps**2) / (2 * 16.0 * (1 - np.exp(-0.1 / 400.0))) < high


def test_the_wind_is_held_between_samples():
    run = interpret(Wind)
    first = run.get("wind_n")
    run.do_step(0.0, 0.05)
    np.testing.assert_array_equal(run.get("wind_n"), first)
    run.do_step(0.05, 0.05)
    assert np.all(run.get("wind_n")[:2] != first[:2])


@pytest.mark.parametrize(
    ("velocity", "ratio"),
    [((60.0, 0.0, 0.0), 2.0), ((-60.0, 25.0, 0.0), 3.0), ((4.0, 50.0, -2.5), 4.0), ((50.0, 0.3, 0.0), 2.09)],
)
def test_travelling_time_is_that_of_the_flight(native, velocity, ratio):
    """(3.35): sqrt(2) along one axis, sqrt(3) level, 2 in a climb, at any speed; 0.3 m/s are 0.3 of an axis.

    To rounding the wind is the one whose travelling_time_ratio says so.
    """
    told = native.run(300.0, 1.0, ["wind_n"], {"travelling_time_ratio": np.sqrt(ratio)})["wind_n"]
    flown = native.run(300.0, 1.0, ["wind_n"], {"velocity_n": velocity})["wind_n"]
    np.testing.assert_allclose(flown, told, rtol=0, atol=1e-11)
    assert np.max(np.abs(flown - native.run(300.0, 1.0, ["wind_n"])["wind_n"])) > 0.1


def test_noise_is_the_same_for_every_step_size(native):
    """Whatever the host's step, the wind at a time has the same bits, events included."""
    everything = {
        "turbulence_sigma": 2.0,
        "velocity_n": (40.0, 20.0, 0.0),
        "shear": True,
        "shear_time": 20.0,
        "gust": True,
    }
    reference = native.run(42.0, 0.1, ["wind_n"], everything)["wind_n"]
    for step, stride in ((0.3, 3), (0.7, 7), (1.0, 10), (2.1, 21)):
        found = native.run(42.0, step, ["wind_n"], everything)["wind_n"]
        np.testing.assert_array_equal(found, reference[::stride][: len(found)])
    assert not np.any(native.run(42.0, 0.1, ["wind_n"], {**everything, "seed": 2})["wind_n"][:, :2] == reference[:, :2])


def test_parts_add_up(native):
    """Wander and turbulence draw numbers of their own: each alone is what it is together with the other."""
    wander = native.run(60.0, 0.1, ["wind_n"])["wind_n"]
    eddies = native.run(60.0, 0.1, ["wind_n"], {**CALM, "turbulence_sigma": 3.0})["wind_n"]
    both = native.run(60.0, 0.1, ["wind_n"], {"turbulence_sigma": 3.0})["wind_n"]
    np.testing.assert_allclose(both, wander + eddies, rtol=0, atol=1e-13)
    r = np.corrcoef(np.diff(wander[:, 0]), np.diff(eddies[:, 0]))[0, 1]
    assert abs(np.arctanh(r)) < 4.9 / np.sqrt(600 - 3)


def at(native, altitudes, **parameters):
    """Wind at altitudes, a second for each."""
    run = native.run(
        len(altitudes), 1.0, ["wind_n"], {**CALM, **parameters}, lambda t: {"altitude": altitudes[round(t)]}
    )
    return run["wind_n"][1:]


def test_the_profile_is_the_power_law(native):
    """Over open country, 10 m/s at 274 m are 6 at 10 m: 10 (10/274)^(1/6.5), and 10 from 274 m on."""
    heights = np.array([-3.0, 0.5, 1.0, 10.0, 60.0, 273.0, 274.0, 300.0, 5000.0])
    found = at(native, heights + 200.0, mean_n=(10.0, -4.0, 0.0), profile_exponent=1 / 6.5, ground_altitude=200.0)
    part = (np.array([1.0, 1.0, 1.0, 10.0, 60.0, 273.0, 274.0, 274.0, 274.0]) / 274.0) ** (1 / 6.5)
    np.testing.assert_allclose(found, part[:, None] * [10.0, -4.0, 0.0], rtol=1e-12)
    assert found[3, 0] == pytest.approx(6.01, abs=0.01)
    np.testing.assert_array_equal(at(native, heights, mean_n=(10.0, -4.0, 0.0)), np.tile([10.0, -4.0, 0.0], (9, 1)))


def test_layers_are_interpolated_as_numpy_does(native):
    """Three layers of a low-level jet; outside of them the nearest one; rows behind the count are not looked at."""
    table = np.array([[100.0, 2.0, 1.0], [400.0, 14.0, -6.0], [1200.0, 5.0, 9.0]])
    rows = np.zeros((8, 3))
    rows[:3] = table
    rows[3:] = (50.0, 99.0, 99.0)
    layers = {"layer_altitude": rows[:, 0], "layer_wind_n": np.insert(rows[:, 1:], 2, 0.5, axis=1), "layer_count": 3}
    altitudes = np.array([-50.0, 100.0, 250.0, 399.0, 400.0, 777.0, 1200.0, 3000.0])
    expected = [np.interp(altitudes, table[:, 0], table[:, k]) for k in (1, 2)]
    found = at(native, altitudes, mean_n=(1.0, 0.0, 0.0), **layers)
    np.testing.assert_allclose(found, np.stack([expected[0] + 1.0, expected[1], 0.5 + 0 * altitudes], 1), atol=1e-12)
    one = at(native, altitudes, **{**layers, "layer_count": 1})
    np.testing.assert_array_equal(one, np.tile([2.0, 1.0, 0.5], (8, 1)))
    np.testing.assert_array_equal(at(native, altitudes, **{**layers, "layer_count": 0}), 0.0)


def test_two_layers_of_one_altitude_are_a_step(native):
    """F26, a shear layer without thickness: below it one wind, from it on the other."""
    altitude = np.concatenate([[300.0, 300.0], np.zeros(6)])
    wind = np.zeros((8, 3))
    wind[:2, 0] = (-3.0, 12.0)
    found = at(
        native, np.array([100.0, 299.99, 300.0, 301.0]), layer_altitude=altitude, layer_wind_n=wind, layer_count=2
    )
    np.testing.assert_array_equal(found[:, 0], [-3.0, -3.0, 12.0, 12.0])


def test_layers_out_of_order_are_refused():
    with pytest.raises(
        NavfmuError, match=r"layer_altitude falls from one row to the next; expected heights that do no"
    ):
        interpret(Wind, layer_altitude=[100.0, 50.0, *6 * [0.0]], layer_count=2)
    interpret(Wind, layer_altitude=[100.0, 50.0, *6 * [0.0]], layer_count=1)


def while_set(name, begin, end):
    """Inputs by time: the fault is there from begin to end."""
    return lambda t: {name: begin <= t + 1e-9 < end}


def test_shear_sets_in_and_goes(native):
    """F26: the whole step at the first sample after its onset; without it all is bit for bit as if it had not been."""
    parameters = {"shear_n": (-12.0, 5.0, 1.0)}
    calm = native.run(40.0, 0.1, ["wind_n"], parameters)["wind_n"]
    run = native.run(40.0, 0.1, ["wind_n"], parameters, while_set("shear", 10.0, 25.0))["wind_n"]
    np.testing.assert_allclose(run[101:251] - calm[101:251], np.tile((-12.0, 5.0, 1.0), (150, 1)), atol=1e-14)
    np.testing.assert_array_equal(run[:101], calm[:101])
    np.testing.assert_array_equal(run[251:], calm[251:])


def test_shear_takes_its_time(native):
    """F26, a ramp: 12 m/s in 6 s are 2 m/s2, and back as long; taken away half-way it turns round."""
    parameters = {**CALM, "shear_n": (12.0, 0.0, 0.0), "shear_time": 6.0}
    run = native.run(30.0, 0.1, ["wind_n"], parameters, while_set("shear", 5.0, 15.0))["wind_n"][:, 0]
    t = np.arange(301) * 0.1
    expected = np.minimum(np.clip(2.0 * (t - 5.0), 0.0, 12.0), np.clip(12.0 - 2.0 * (t - 15.0), 0.0, 12.0))
    np.testing.assert_allclose(run, expected, atol=1e-10)
    short = native.run(30.0, 0.1, ["wind_n"], parameters, while_set("shear", 5.0, 8.0))["wind_n"][:, 0]
    assert np.max(short) == pytest.approx(6.0, abs=1e-10)
    np.testing.assert_allclose(short[110:], 0.0, atol=1e-10)


def test_the_gust_is_that_of_the_certification(native):
    """F26: CS-25.341 (a)(2), U = U_ds / 2 (1 - cos(pi s / H)) for s up to 2 H, at 50 m/s; it ends by itself.

    The input's end does not end it, and behind it all is bit for bit as if it had not been.
    """
    parameters = {"gust_n": (0.0, 3.0, -10.0), "gust_gradient": 100.0, "true_airspeed": 50.0}
    calm = native.run(20.0, 0.1, ["wind_n"], parameters)["wind_n"]
    for end in (5.1, 20.0):
        run = native.run(20.0, 0.1, ["wind_n"], parameters, while_set("gust", 5.0, end))["wind_n"]
        s = 50.0 * (np.arange(201) * 0.1 - 5.1)
        inside = (s >= 0.0) & (s <= 200.0)
        expected = np.where(inside, 0.5 * (1.0 - np.cos(np.pi * s / 100.0)), 0.0)
        np.testing.assert_allclose(run - calm, expected[:, None] * [0.0, 3.0, -10.0], atol=1e-11)
        np.testing.assert_array_equal(run[s > 200.0], calm[s > 200.0])
        np.testing.assert_array_equal(run[s < 0.0], calm[s < 0.0])
    twice = native.run(20.0, 0.1, ["wind_n"], parameters, lambda t: {"gust": t % 10.0 >= 5.0})["wind_n"] - calm
    np.testing.assert_allclose(twice[151:], twice[51:101], atol=1e-11)
    assert np.max(twice[:, 1]) > 2.9


def test_an_endless_gust_and_a_wake(native):
    """F26: MIL-F-8785C's gust stays at its peak; a wake of 40 m is met as a step, 0.8 s long at 50 m/s."""
    parameters = {**CALM, "gust_n": (0.0, 0.0, 6.0), "true_airspeed": 50.0}
    endless = {**parameters, "gust_gradient": 200.0, "gust_plateau": 1e7}
    run = native.run(20.0, 0.1, ["wind_n"], endless, while_set("gust", 5.0, 20.0))["wind_n"][:, 2]
    s = np.clip(50.0 * (np.arange(201) * 0.1 - 5.1), 0.0, 200.0)
    np.testing.assert_allclose(run, 3.0 * (1.0 - np.cos(np.pi * s / 200.0)), atol=1e-11)
    wake = {**parameters, "gust_gradient": 0.5, "gust_plateau": 40.0}
    run = native.run(20.0, 0.1, ["wind_n"], wake, while_set("gust", 5.0, 5.5))["wind_n"][:, 2]
    assert np.count_nonzero(run == 6.0) == 8
    assert np.count_nonzero(run) == 8


def test_the_wind_where_the_aircraft_is(tmp_path, tmp_path_factory):
    """Connected in a circle with an aircraft that descends through a layer: it meets the layer's wind, a step late."""
    for name in ("wind", "aircraft"):
        fmu(name, tmp_path_factory)
    source = SystemSource("descent", fmus=folder(tmp_path_factory), stop_time=2000.0, step=0.1, description="a layer")
    source.component("wind", "wind.fmu").component("aircraft", "aircraft.fmu")
    source.connect("wind.wind_n", "aircraft.wind_n")
    for name in ("altitude", "velocity_n", "true_airspeed"):
        source.connect(f"aircraft.{name}", f"wind.{name}")
    low, high = 700.0, 1300.0
    layers = {
        "layer_altitude": (low, high, *6 * (0.0,)),
        "layer_wind_n": np.concatenate([[(4.0, -2.0, 0.0), (16.0, 8.0, 0.0)], np.zeros((6, 3))]),
        "layer_count": 2,
    }
    source.parameters("wind", {**CALM, **layers})
    system = System.load(source.pack(tmp_path / "descent.ssp"))
    names = ["wind.wind_n[1]", "wind.wind_n[2]", "aircraft.altitude"]
    with pytest.warns(
        NavfmuWarning, match=r"cycles; one communication step late: aircraft\.altitude -> wind\.altitude"
    ):
        flight = system.run(seed=1, record=names, record_period=1.0)
    altitude = flight["aircraft.altitude"]
    assert altitude.max() > high and altitude.min() < low
    for name, ends in (("wind.wind_n[1]", (4.0, 16.0)), ("wind.wind_n[2]", (-2.0, 8.0))):
        expected = np.interp(altitude, (low, high), ends)
        assert np.max(np.abs(flight[name] - expected)) < 0.02 * 5.0 * 0.2  # 1/s of shear by 5 m/s for two steps
