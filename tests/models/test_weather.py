"""The weather of the day: over distance and not over time, from the first sample, and the same for all that use it."""

import numpy as np
import pytest
from scipy import stats

from fmus.air.weather import Weather
from models.air import atmosphere
from navfmu import System
from navfmu.ssp.writer import SystemSource
from tests.built import fmu, folder
from tests.models.native import Native

COUNT = 400
SIGNALS = ["temperature_deviation", "sea_level_pressure"]
STILL = {"temperature_sigma": 0.0, "pressure_sigma": 0.0}


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Weather, tmp_path_factory.mktemp("weather"))


@pytest.mark.parametrize(("velocity", "stop"), [((50.0, 0.0, 0.0), 1000.0), ((-60.0, 80.0, 9.0), 500.0)])
def test_sigma_and_correlation_over_the_ground(native, velocity, stop):
    """Of 400 seeds, at t = 0 and 50 km later, at any speed: 2 K, 120 Pa, exp(-1/2); bounds at 1e-6 each.

    A correlation over time, or one that counts the climb, has another one in one of the two cases.
    """
    runs = []
    for seed in range(COUNT):
        run = native.run(stop, stop, SIGNALS, {"seed": seed, "velocity_n": velocity})
        runs.append([run["temperature_deviation"] / 2.0, (run["sea_level_pressure"] - 101325.0) / 120.0])
    values = np.array(runs)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], COUNT) / COUNT
    square = np.mean(values**2, axis=0)
    assert np.all((square > low) & (square < high)), square
    bound = 4.9 / np.sqrt(COUNT - 3)
    for which in (0, 1):
        r = np.corrcoef(values[:, which, 0], values[:, which, 1])[0, 1]
        assert abs(np.arctanh(r) - np.arctanh(np.exp(-0.5))) < bound
    assert abs(np.arctanh(np.corrcoef(values[:, 0, 0], values[:, 1, 0])[0, 1])) < bound


def test_the_way_flown_is_that_over_the_ground_in_any_direction(native):
    """100 m/s north, and as fast to the north-west in a climb: the same seed has the same weather."""
    north, west = (
        native.run(500.0, 10.0, SIGNALS, {"velocity_n": v}) for v in ((100.0, 0.0, 0.0), (60.0, -80.0, -9.0))
    )
    for name in SIGNALS:
        np.testing.assert_allclose(west[name], north[name], rtol=1e-12)


def test_distances_of_their_own(native):
    """Steps of 5 km, over which one process changes altogether and the other hardly: 400 of them, bounds at 1e-6."""
    parameters = {"velocity_n": (50.0, 0.0, 0.0), "sample_period": 100.0, "pressure_distance": 1e7}
    run = native.run(40000.0, 100.0, SIGNALS, {**parameters, "temperature_distance": 1000.0})
    for name, sigma, distance in (("temperature_deviation", 2.0, 1e3), ("sea_level_pressure", 120.0, 1e7)):
        steps = np.diff(run[name]) / sigma
        expected = 2.0 * (1.0 - np.exp(-5e3 / distance))
        low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], steps.size) / steps.size
        # steps of a process that changes altogether are correlated by -1/2: 1 + 2 / 4 times the variance
        spread = np.sqrt(1.0 + 2.0 * 0.25)
        assert 1 - spread * (1 - low) < np.mean(steps**2) / expected < 1 + spread * (high - 1)


def test_gradients_over_the_way_flown(native):
    """North, then east, then back to where it began: in closed form, and the weather of the beginning."""
    legs = [(40.0, 0.0, 0.0), (0.0, 60.0, 0.0), (-40.0, -60.0, 0.0)]
    parameters = {
        **STILL,
        "temperature_mean": 7.0,
        "temperature_gradient": (-1e-4, 2e-4),
        "pressure_mean": 100000.0,
        "pressure_gradient": (-3e-3, 1e-3),
    }
    run = native.run(300.0, 100.0, SIGNALS, parameters, lambda t: {"velocity_n": legs[round(t / 100.0)]})
    np.testing.assert_allclose(run["temperature_deviation"], [7.0, 6.6, 7.8, 7.0], atol=1e-9)
    np.testing.assert_allclose(run["sea_level_pressure"], [1e5, 1e5 - 12.0, 1e5 - 6.0, 1e5], atol=1e-7)


def test_who_stands_still_keeps_the_day(native):
    run = native.run(3600.0, 60.0, SIGNALS, {"seed": 3})
    for name in SIGNALS:
        assert np.ptp(run[name]) == 0.0
    other = native.run(60.0, 60.0, SIGNALS, {"seed": 4})
    assert run["sea_level_pressure"][0] != other["sea_level_pressure"][0]


def test_noise_is_the_same_for_every_step_size(native):
    flying = {"velocity_n": (30.0, 40.0, 0.0)}
    reference = native.run(60.0, 1.0, SIGNALS, flying)
    for step, stride in ((2.0, 2), (5.0, 5), (0.5, 1)):
        run = native.run(60.0, step, SIGNALS, flying)
        for name in SIGNALS:
            found = run[name] if step >= 1.0 else run[name][::2]
            np.testing.assert_array_equal(found, reference[name][::stride])


def test_one_weather_for_two_air_data(tmp_path, tmp_path_factory):
    """Connected, the day is in both pressure altitudes alike, as the hydrostatic equation has it, and the temperature.

    10 hPa less at sea level are 83 m more there by hand (8.3 m for each hPa), and some more where the air is thinner.
    """
    for name in ("weather", "air_data"):
        fmu(name, tmp_path_factory)
    source = SystemSource("day", fmus=folder(tmp_path_factory), stop_time=5.0, step=0.1, description="one weather")
    source.component("weather", "weather.fmu")
    exact = {
        f"{name}_sigma": 0.0
        for name in ("airspeed_error", "altitude_error", "pitot_coefficient", "pressure_offset", "temperature_error")
    }
    for name, altitude in (("one", 0.0), ("two", 2000.0)):
        source.component(name, "air_data.fmu")
        source.parameters(name, {**exact, "altitude": altitude, "velocity_n": (46.3, 0.0, 0.0)})
        for output in SIGNALS:
            source.connect(f"weather.{output}", f"{name}.{output}")
    source.parameters("weather", {**STILL, "temperature_mean": 10.0, "pressure_mean": 100325.0})
    record = [f"{name}.air.{signal}" for name in ("one", "two") for signal in ("pressure_altitude", "temperature")]
    last = System.load(source.pack(tmp_path / "day.ssp")).run(seed=1, record=record).iloc[-1]
    assert last["one.air.pressure_altitude"] == pytest.approx(83.0, abs=1.0)
    for name, altitude in (("one", 0.0), ("two", 2000.0)):
        height = atmosphere.geopotential(altitude)
        expected = atmosphere.pressure_altitude(atmosphere.pressure(height, 10.0, 100325.0))
        assert last[f"{name}.air.pressure_altitude"] == pytest.approx(expected, abs=1e-6)
        assert last[f"{name}.air.temperature"] == pytest.approx(298.15 - 0.0065 * height, abs=1e-6)
