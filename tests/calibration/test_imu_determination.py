"""Errors of an inertial unit from its stands: found within what is said, and what is not told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from evidence.sensors.turntable import ALTITUDE, LATITUDE, eight_by_three, faces, turns
from navfmu.calibration.imu.determination import determine, lacking
from navfmu.calibration.imu.earth import ROTATION, gravity, rotation_n, to_body
from navfmu.calibration.imu.stands import Stands
from navfmu.calibration.imu.terms import MISALIGNMENT, SQUARE, TERMS, readings, split
from navfmu.errors import NavfmuError

G = gravity(LATITUDE, ALTITUDE)
SIGMA = np.array([2e-5, 1e-3])
SIZES = np.concatenate([np.full(len(term.elements), term.size) for term in TERMS])
CHANCE = 1e-4


def acting(attitudes, turning=0.0):
    to_b = to_body(*attitudes.T)
    rate_n = rotation_n(LATITUDE) + np.multiply.outer(np.broadcast_to(turning, len(to_b)), [0.0, 0.0, 1.0])
    return np.einsum("nij,nj->ni", to_b, rate_n), to_b @ [0.0, 0.0, -G]


def made(rng, errors, attitudes, turning=0.0, table=True):
    """Stands of a unit with these errors."""
    rate, force = acting(attitudes, turning)
    means = readings(split(errors, TERMS), rate, force)
    read = [mean + sigma * rng.standard_normal(mean.shape) for mean, sigma in zip(means, SIGMA, strict=True)]
    time = np.arange(len(rate), dtype=float)
    return Stands("made", time, time, *read, G, *((rate, force) if table else ()))


def table():
    turned = turns()
    attitudes = np.vstack([eight_by_three(), turned[:, :3]])
    return attitudes, np.concatenate([np.zeros(24), turned[:, 3]])


@pytest.mark.slow
def test_errors_are_found_within_their_covariance_over_seeds():
    """20 units whose errors are drawn from what is known before, on a table: the squared errors over their covariance
    are chi-square with all 48 elements of each, and the scatter that is estimated is that of the readings, chi-square
    with the degrees of freedom that are left. Two sides, 1e-4 in all.

    Wrong: sigma of one reading for that of a mean, degrees of freedom that count none of the parameters (the scatter is
    a sixth too small), N and C_m in the other order (1e-3 of 1e-4).
    """
    squares, scatter, left = 0.0, np.zeros(2), np.zeros(2)
    count = 20
    for seed in range(count):
        rng = np.random.default_rng(seed)
        errors = 0.3 * SIZES * rng.standard_normal(len(SIZES))
        stands = made(rng, errors, *table())
        known = determine(stands, sigma=SIGMA)
        off = known.fit.values - errors
        squares += off @ np.linalg.solve(known.fit.covariance, off)
        free = determine(stands)
        scatter += free.fit.left * (free.fit.sigma / SIGMA) ** 2
        left += free.fit.left
        assert all(element.told for element in known.elements)
    for value, freedom in ((squares, count * len(SIZES)), *zip(scatter, left, strict=True)):
        low, high = stats.chi2.ppf([CHANCE / 6.0, 1.0 - CHANCE / 6.0], freedom)
        assert low < value < high


@pytest.mark.slow
def test_attitudes_that_nobody_told_are_enough_for_what_gravity_tells():
    """20 units in 40 attitudes at random: scale factors, leaning and null shifts of the accelerometers are within their
    covariance, chi-square with 9 elements of each; the misalignment is not among what is found.

    Wrong: the size of the readings for that of the specific force, a turn of the case that gravity were to tell.
    """
    squares, count = 0.0, 20
    for seed in range(count):
        rng = np.random.default_rng(100 + seed)
        errors = SIZES * rng.standard_normal(len(SIZES))
        errors[: len(MISALIGNMENT.elements)] = 0.0
        attitudes = np.stack([*rng.uniform(-np.pi, np.pi, (2, 40)), np.zeros(40)], axis=1)
        found = determine(made(rng, errors, attitudes, table=False), sigma=np.array([2.0 * ROTATION, SIGMA[1]]))
        assert MISALIGNMENT not in found.terms and lacking(found)[0].startswith("misalignment: not told")
        wanted = ("nonorthogonality", "scale_factor", "null_shift")
        names = [f"accelerometer_{name}" for name in wanted]
        at = [i for i, element in enumerate(found.elements) if element.term.name in names]
        off = found.fit.values[at] - errors[3:][at]
        squares += off @ np.linalg.solve(found.fit.covariance[np.ix_(at, at)], off)
        assert all(found.elements[i].told for i in at)
    low, high = stats.chi2.ppf([CHANCE / 2.0, 1.0 - CHANCE / 2.0], 9 * count)
    assert low < squares < high


def test_what_stands_do_not_tell_is_named_with_what_is_missing():
    """Two columns that are alike, or one that is 0: the elements keep the sigma that they had before, and are not told.

    On the faces alone the square of a specific force and its size are one column: of the two the asymmetry is told as
    well as the square is known before. Without turns no gyro has a scale.
    Wrong: an inverse of a singular matrix, a value that half of the stands would contradict.
    """
    rng = np.random.default_rng(1)
    found = determine(made(rng, np.zeros(len(SIZES)), np.vstack([faces()] * 3)))
    said = lacking(found)
    for name, needs in (
        ("accelerometer_square", "45 degrees"),
        ("gyro_scale_factor", "table_rate"),
        ("gyro_nonorthogonality", "table_rate"),
        ("gyro_anisoelasticity", "45 degrees"),
    ):
        assert any(line.startswith(f"{name}: not told") and needs in line for line in said)
    told = {element.term.name for element in found.elements if element.told}
    assert told == {
        "misalignment", "accelerometer_nonorthogonality", "accelerometer_scale_factor", "accelerometer_null_shift",
        "accelerometer_scale_factor_asymmetry", "gyro_null_shift", "gyro_g_sensitivity",
    }  # fmt: skip
    bent = next(element for element in found.elements if element.name == "accelerometer_scale_factor_asymmetry x")
    assert bent.sigma == pytest.approx(SQUARE.size * G, rel=0.05)
    flat = next(element for element in found.elements if element.name == "gyro_anisoelasticity x")
    assert flat.sigma == pytest.approx(flat.term.size, rel=1e-6)


def test_one_attitude_tells_the_size_of_nothing():
    """Level, ten times: no accelerometer has a null shift apart from its scale.

    Wrong: the mean over the columns that happen to come first.
    """
    rng = np.random.default_rng(2)
    found = determine(made(rng, 0.1 * SIZES, np.zeros((10, 3)), table=False))
    assert {element.term.name for element in found.elements if element.told} <= {"gyro_null_shift"}
    assert any(line.startswith("accelerometer_scale_factor: not told") for line in lacking(found))


def test_too_few_stands_are_refused():
    """Wrong: a scatter from no degrees of freedom, which is 0 and makes every interval a point."""
    rng = np.random.default_rng(3)
    with pytest.raises(NavfmuError, match=r"made: 6 stands leave nothing to tell .* from chance; expected more stands"):
        determine(made(rng, 0.1 * SIZES, faces(), table=False))


def test_a_table_that_turned_the_other_way_is_refused():
    """Wrong: scale factors of -2 in a parameter set."""
    attitudes, turning = table()
    rng = np.random.default_rng(5)
    other = made(rng, 0.1 * SIZES, attitudes, turning)
    rate, force = acting(attitudes, -turning)
    with pytest.raises(
        NavfmuError, match=r"gyro_scale_factor [xyz] would be -.* ppm; expected 2.5e\+05 at most: .*table_r"
    ):
        determine(replace(other, true_rate=rate, true_force=force))


def test_an_error_that_there_is_not_is_refused():
    with pytest.raises(NavfmuError, match=r"--without gyro_scale: .*did you mean 'gyro_scale_factor'"):
        determine(made(np.random.default_rng(4), 0.1 * SIZES, *table()), ["gyro_scale"])
