"""Loss of satellites in motion and by noise alone: R12, R13, R23 of RTO MP-43 and closed forms of carrier loops."""

import numpy as np
import pytest
from scipy import stats

from fmus.satellite.gps_signals import GpsSignals
from models.satellite import tracking
from tests.models.native import Native
from tests.models.receiving import PLACE

G = 9.80665
WAVELENGTH = 299792458.0 / 1575.42e6


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(GpsSignals, tmp_path_factory.mktemp("dynamics"))


def fly(native, seconds, force=lambda t: (0.0, 0.0, -G), **parameters):
    """What is tracked, elevation and C/N0 after each second, (seconds, places)."""
    model = native.fmu
    model.reset()
    model.setupExperiment(startTime=0.0)
    for name, value in parameters.items():
        native._set(model, name, value)
    model.enterInitializationMode()
    model.exitInitializationMode()
    found = []
    for k in range(seconds):
        for name, value in {**PLACE, "specific_force": force(k)}.items():
            native._set(model, name, value)
        model.doStep(float(k), 1.0)
        row = []
        for name, read in (("signals.tracked", model.getBoolean), ("elevation", model.getReal),
                           ("signals.signal_to_noise", model.getReal)):  # fmt: skip
            field = native.fields[name]
            row.append(read(list(range(field.index, field.index + field.size))))
        found.append(np.array(row, float))
    tracked, elevation, strength = np.moveaxis(np.array(found), 1, 0)
    return tracked > 0.0, elevation, strength


def pull(jerk, begin=5):
    """Upwards with a jerk (m/s3) for one second, and on with what that has come to."""
    return lambda k: (0.0, 0.0, -G - jerk * (1.0 if k >= begin else 0.0))


def tolerated(strength, bandwidth=10.0):
    """Jerk along the line of sight, m/s3, of a third-order loop: 45 degrees less three sigmas, by hand."""
    ratio = 10.0 ** (strength / 10.0)
    sigma = np.degrees(np.sqrt(bandwidth / ratio * (1.0 + 25.0 / ratio)))
    return (45.0 - 3.0 * sigma) / 360.0 * WAVELENGTH * bandwidth**3 / 0.4828


@pytest.mark.parametrize("jerk", [5.0 * G, 6.0 * G])
def test_satellites_that_are_high_are_lost_in_a_pull(native, jerk):
    """Of a jerk upwards they feel sin(elevation), and are lost for the second in which it lasts and 20 s more. Catches
    the jerk itself in the place of its part along the line of sight, and a loss that acceleration keeps up."""
    tracked, elevation, strength = fly(native, 30, pull(jerk))
    seen = tracked[4]
    expected = seen & (jerk * np.sin(elevation[4]) < tolerated(np.where(seen, strength[4], 45.0)))
    assert tracked[5].tolist() == expected.tolist() and 0 < np.sum(expected) < np.sum(seen)
    assert np.all(tracked[24] == expected) and np.all(tracked[25:][:, seen])


def test_a_jerk_of_2_8_g_a_second_loses_none(native):
    """RTO MP-43, Sabatini: stick-jerks of 2.8 g/s lost no data. With 10 Hz; one of 7 Hz loses those above."""
    tracked, _, _ = fly(native, 10, pull(2.8 * G))
    assert np.all(tracked == tracked[0])
    tracked, _, _ = fly(native, 10, pull(2.8 * G), phase_bandwidth=7.0)
    assert np.sum(tracked[5]) < np.sum(tracked[4])


def test_a_second_order_loop_is_held_up_by_acceleration(native):
    """As long as it lasts: theta = 0.2809 a / B^2. 3 g upwards on a loop of 8 Hz; level flight (1 g felt) is none."""
    force = lambda k: (0.0, 0.0, -G - (3.0 * G if 5 <= k < 15 else 0.0))  # noqa: E731
    tracked, elevation, strength = fly(native, 40, force, loop_order=tracking.SECOND, phase_bandwidth=8.0)
    seen = tracked[4]
    ratio = 10.0 ** (np.where(seen, strength[4], 45.0) / 10.0)
    sigma = np.degrees(np.sqrt(8.0 / ratio * (1.0 + 25.0 / ratio)))
    most = (45.0 - 3.0 * sigma) / 360.0 * WAVELENGTH * 8.0**2 / 0.2809
    expected = seen & (3.0 * G * np.sin(elevation[4]) < most)
    assert 0 < np.sum(expected) < np.sum(seen)
    for k in (5, 14, 33):
        assert tracked[k].tolist() == expected.tolist()
    assert np.all(tracked[34:][:, seen])  # 20 s after the last second in which it was held up


def test_a_force_that_is_no_number_is_none(native):
    tracked, _, _ = fly(native, 10, lambda k: (np.nan, 0.0, np.inf), loop_order=tracking.THIRD)
    assert np.all(tracked == tracked[0])


def test_slips_come_as_often_as_viterbi_says(native):
    """Signals so weak that the weakest of those above 30 degrees has 29.05 dB-Hz, found at once: each second each of
    them is lost with 1 - exp(-rate), by its C/N0 in a run without slips; Poisson's bound at 1e-6 over 1000 s."""
    bandwidth, weak = 50.0, {
        "carrier_threshold": 5.0, "acquisition_threshold": 5.0, "acquisition_time": 0.0, "loop_bandwidth": 1e-3,
        "search_period": 3600.0, "elevation_mask": np.radians(30.0), "phase_bandwidth": 50.0,
    }  # fmt: skip
    tracked, _, strength = fly(native, 1000, signal_margin=2.0, **weak)
    there = np.all(tracked, axis=0)
    margin = 2.0 - (np.min(strength[:, there]) - 29.05)
    tracked, _, strength = fly(native, 1000, signal_margin=margin, **weak)
    assert np.all(tracked[:, there])
    ratio = 10.0 ** (strength[:, there] / 10.0)
    variance = bandwidth / ratio * (1.0 + 25.0 / ratio)
    expected = np.sum(-np.expm1(-4.0 * bandwidth / np.pi * np.exp(-0.5 / variance)))
    tracked, _, _ = fly(native, 1000, signal_margin=margin, slips=True, **weak)
    lost = np.sum(~tracked[:, there])
    low, high = stats.poisson.ppf([5e-7, 1.0 - 5e-7], expected)
    assert expected > 10.0 and low <= lost <= high, (expected, lost)
