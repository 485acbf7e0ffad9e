"""Lags of gyros in the rules for coning: their squared modulus against SciPy, the numbers against the fractions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from fmus.inertial.imu import Imu
from models.inertial import bandwidth, cone, coning, sculling, series, shaping
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret
from tests.models.rotation import matrix, together
from tests.models.test_coning import PASSED, error_by_formula
from tests.models.test_imu import QUIET

PERIOD = 0.01
LAGS = {"first": (40.0, 1, 0.7), "second": (40.0, 2, 0.7), "resonant": (60.0, 2, 0.2), "slow": (8.0, 2, 0.7)}
"""Bandwidth in Hz, order, damping."""


def response(lag, a: float) -> complex:
    """What a lag makes of exp(i a k) that is linear between samples, by SciPy's discretisation of its state space."""
    w, zeta = 2 * np.pi * lag[0], lag[2]
    if lag[1] == 1:
        system = ([[-w]], [[w]], [[1.0]], [[0.0]])
    else:
        system = ([[0.0, 1.0], [-w * w, -2 * zeta * w]], [[0.0], [w * w]], [[1.0, 0.0]], [[0.0]])
    system = tuple(np.array(matrix) for matrix in system)
    above, below = signal.ss2tf(*signal.cont2discrete(system, PERIOD, method="foh")[:4])
    return signal.freqz(above[0], below, worN=[a])[1][0]


def passed(lag, a: float) -> float:
    return abs(response(lag, a))


def squared(lag):
    return shaping.squared(bandwidth.transition(*lag, PERIOD), bandwidth.times(*lag), PERIOD)


@pytest.mark.parametrize("lag", LAGS.values(), ids=LAGS)
def test_the_powers_are_those_of_the_lag(lag):
    """Four powers leave an error of the eighth: by halves of a it falls 256-fold. A wrong one would be seen at once."""
    powers = np.array(squared(lag))
    a = np.array([0.4, 0.2]) * min(1.0, 2 * np.pi * lag[0] * PERIOD)
    left = np.array([passed(lag, x) ** 2 - np.polynomial.polynomial.polyval(x * x, powers) for x in a])
    assert np.all(np.abs(left) < 0.01)
    assert np.log2(left[0] / left[1]) == pytest.approx(8.0, abs=0.7)


def test_no_lag_passes_everything():
    none = (0.0, 2, 0.7)
    np.testing.assert_allclose(squared(none), [1.0, 0.0, 0.0, 0.0], atol=1e-15)


@pytest.mark.parametrize("shape", coning.SHAPES)
@pytest.mark.parametrize("count", [1, 2, 3])
def test_fitted_numbers_are_the_fractions(shape, count):
    powers = [float(x) for x in series.product(coning.SHAPES[shape], coning.SHAPES[shape])[:4]]
    np.testing.assert_allclose(
        coning.fitted(count, powers), [float(c) for c in coning.before(count, shape)], rtol=1e-12
    )


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Imu, tmp_path_factory.mktemp("imu"))


def drift(native, lag, samples: int, around: int, fits: bool) -> float:
    """Drift over the coning rate of a gyro with a lag, on a cone of 0.1 milliradians."""
    half_angle, each = 1e-4, 5
    frequency = 2 * np.pi / (around * PERIOD)
    parameters = {**QUIET, "increment_samples": each, "coning_samples": samples, "coning_fits_lag": fits}
    parameters |= dict(zip(("gyro_bandwidth", "gyro_lag_order", "gyro_damping"), lag, strict=True))
    run = native.run(
        20 * around * PERIOD,
        PERIOD,
        ["increment.angle"],
        parameters,
        lambda t: {"rate": cone.rate(half_angle, frequency, t)},
    )
    angles = run["increment.angle"][each::each][10 * around // each :]
    return together(angles)[2] / (len(angles) * each / around * np.pi * half_angle**2)


@pytest.mark.parametrize("lag", [LAGS["first"], LAGS["second"], LAGS["resonant"]], ids=("first", "second", "resonant"))
@pytest.mark.parametrize("samples", [2, 3, 4])
def test_a_gyro_with_a_lag_cones_to_the_same_order(native, lag, samples):
    """Its cone is narrower, and with numbers that fit it leads back; the error falls with the power 2 m."""
    around = np.array([20, 40])
    found = np.array([drift(native, lag, samples, n, True) for n in around])
    numbers = coning.fitted(samples - 1, series.product(_trapezoid(), squared(lag)))
    for n, value in zip(around, found, strict=True):
        a = 2 * np.pi / n
        assert value == pytest.approx(_error(numbers, passed(lag, a) * PASSED["trapezoid"](a), a), abs=3e-8)
    if samples < 4:  # of order 8 too little is left at 2.5 Hz
        assert np.log2(found[0] / found[1]) == pytest.approx(2 * samples, abs=0.5)


def test_numbers_that_do_not_fit_leave_what_the_lag_takes(native):
    """1 - F^2 of the lag, whatever the order: 1.5 % at 5 Hz behind a lag of the first order of 40 Hz."""
    lag, a = LAGS["first"], 2 * np.pi / 20
    found = drift(native, lag, 4, 20, False)
    f = passed(lag, a)
    leftover = error_by_formula(coning.before(3, "trapezoid"), 1, "trapezoid", a)
    assert found == pytest.approx(f * f * leftover + (1.0 - f * f), abs=3e-8)
    assert abs(drift(native, lag, 4, 20, True)) < 0.01 * abs(found)


def test_a_lag_that_is_too_slow_is_refused():
    """At 8 Hz and 100 samples a second the products would be 42 times those of the increments."""
    sentence = "gyro_bandwidth is 8 Hz; with a sample_period of 0.01 s expected 0 or at least a tenth"
    with pytest.raises(NavfmuError, match=sentence):
        interpret(Imu, gyro_bandwidth=8.0, coning_fits_lag=True)
    interpret(Imu, gyro_bandwidth=8.0)
    interpret(Imu, gyro_bandwidth=10.0, coning_fits_lag=True)


def test_accelerometers_later_than_gyros_scull_where_nothing_does(native):
    """Swing and force a quarter apart do not scull; with a lag of the accelerometers alone they do, by Im(p) / 2."""
    lag, around, each, swing, force = LAGS["second"], 20, 5, 1e-5, 2.0
    parameters = {**QUIET, "increment_samples": each, "specific_force": 0.0, "vibrating": True}
    parameters |= dict(
        zip(("accelerometer_bandwidth", "accelerometer_lag_order", "accelerometer_damping"), lag, strict=True)
    )
    parameters |= {"vibration_frequency": 1.0 / (around * PERIOD), "accelerometer_rectification": 0.0}
    parameters |= {"vibration_swing_sine": (swing, 0.0, 0.0), "vibration_swing_cosine": 0.0}
    parameters |= {"vibration_shake_sine": 0.0, "vibration_shake_cosine": (0.0, force, 0.0)}
    run = native.run(20 * around * PERIOD, PERIOD, ["increment.angle", "increment.velocity"], parameters)
    first = 10 * around // each
    angles, velocities = (run[f"increment.{name}"][each::each][first:] for name in ("angle", "velocity"))
    attitude, gained = np.zeros(3), np.zeros(3)
    for angle, velocity in zip(angles, velocities, strict=True):
        gained = gained + matrix(attitude) @ sculling.at_the_beginning(angle, velocity)
        attitude = attitude + angle
    a = 2 * np.pi / around
    lagged = response(lag, a)
    acceleration = gained[2] / (len(angles) * each * PERIOD)
    assert acceleration / (0.5 * swing * force) == pytest.approx(-lagged.imag, abs=1e-6)
    assert abs(lagged.imag) > 0.1


def _trapezoid():
    return [float(x) for x in series.product(coning.SHAPES["trapezoid"], coning.SHAPES["trapezoid"])[:4]]


def _error(numbers, f: float, a: float) -> float:
    square = (f * np.sinc(a / (2 * np.pi))) ** 2
    return sum(-2 * c * a * square * np.sin(p * a) for p, c in enumerate(numbers, 1)) - (
        f * f * np.sinc(a / np.pi) - 1.0
    )
