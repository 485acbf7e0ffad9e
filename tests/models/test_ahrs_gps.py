"""GPS attitude in the AHRS (thesis section 4.11.1): what it makes of angles and gyro biases, and what is left without.

Level flight to the south, where heading jumps from pi to -pi; accelerometers and field say next to nothing.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from fmus.attitude.ahrs import Ahrs
from models.attitude import attitude
from navfmu.constants import STANDARD_GRAVITY
from tests.models.native import Native

STEP, AIDING, SIGMA = 0.1, 0.5, np.radians(0.25)
GYRO = {"gyro_noise": np.radians(0.05), "gyro_drift_sigma": np.radians(0.05), "gyro_drift_time": 1000.0, "alpha": 1.0}
"""Thesis Table 4.2, the Horizon gyros."""
DEAF = {"tilt_sigma": 50.0, "tilt_sigma_min": 50.0, "field_sigma": 1e4, "sample_period": STEP}
BIAS = np.radians([0.3, -0.2, 0.25])
HEADING = 3.1413
ANGLES = ("roll", "pitch", "heading")
LOST = 300.0


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Ahrs, tmp_path_factory.mktemp("ahrs_gps"))


def fly(native, stop, lost=LOST, seed=1, late=0.0, wrong=lambda now: np.zeros(3)):
    """Outputs at each step; GPS attitude comes at 2 Hz until ``lost``, ``late`` s after it held, ``wrong`` by rad."""
    rng = np.random.default_rng(seed)
    c_nb = attitude.dcm(0.0, 0.0, HEADING)
    fixed = {
        "imu.specific_force": [0.0, 0.0, -STANDARD_GRAVITY],
        "field.field_b": c_nb.T @ np.array([2.3e-5, 0.5e-5, 4.2e-5]),
        "air.true_airspeed": 46.3,
    }

    def inputs(t):
        k = round(t / STEP) + 1
        now = k * STEP
        values = {**fixed, "imu.rate": BIAS + GYRO["gyro_noise"] * rng.standard_normal(3)}
        for bundle in ("imu", "field", "air"):
            values |= {f"{bundle}.valid": True, f"{bundle}.sequence": k, f"{bundle}.time_of_validity": now}
        if k % 5 == 0:
            roll, pitch, yaw = SIGMA * rng.standard_normal(3) + wrong(now)
            values |= {"gps.roll": roll, "gps.pitch": pitch, "gps.heading": attitude.wrap(HEADING + yaw)}
            values |= {"gps.valid": now <= lost, "gps.sequence": k // 5, "gps.time_of_validity": now - late}
        return values

    names = [f"attitude.{name}{suffix}" for name in ANGLES for suffix in ("", "_sigma")]
    got = native.run(stop, STEP, [*names, "gyro_bias", "covariance"], {**DEAF, **GYRO, "declination": 0.2}, inputs)
    error = np.stack([got["attitude.roll"], got["attitude.pitch"], attitude.wrap(got["attitude.heading"] - HEADING)])
    return got, error


def riccati():
    """Covariance after an update of an angle and the bias of its gyro, in the end."""
    phi = np.array([[1.0, -AIDING], [0.0, 1.0]])
    q = np.diag([GYRO["gyro_noise"] ** 2 * STEP * AIDING, drift() * AIDING])
    h = np.array([[1.0, 0.0]])
    before = solve_discrete_are(phi.T, h.T, q, np.array([[SIGMA**2]]))
    return before - before @ h.T @ h @ before / (before[0, 0] + SIGMA**2)


def drift():
    """Density of the random walk of a bias, (4.44), rad2/s3."""
    return 2.0 * GYRO["gyro_drift_sigma"] ** 2 / GYRO["gyro_drift_time"]


def variances(got, k):
    """Of the three angles and the three biases."""
    matrix = np.zeros((11, 11))
    matrix[np.triu_indices(11)] = got["covariance"][k]
    return np.diag(matrix)[:3], np.diag(matrix)[3:6]


def test_angles_and_biases_are_known_as_the_riccati_equation_says(native):
    """By SciPy, of two states an axis. Taken twice, or at a wrong rate, they would be known by 1.4 times."""
    got, error = fly(native, LOST)
    angles, biases = variances(got, -1)
    final = riccati()
    np.testing.assert_allclose(angles, final[0, 0], rtol=0.01)
    np.testing.assert_allclose(biases, final[1, 1], rtol=0.01)
    settled = got["time"] > 60.0
    np.testing.assert_allclose(np.std(error[:, settled], axis=1), np.sqrt(final[0, 0]), rtol=0.5)
    assert np.max(np.abs(error[:, settled])) < 5.0 * np.sqrt(final[0, 0])


def test_gyro_biases_settle_within_four_minutes(native):
    """Thesis Fig 4.10: 3 to 4 minutes from power up. From there on within four of their sigmas of the null shift."""
    got, _ = fly(native, LOST)
    late = got["time"] > 240.0
    wrong = got["gyro_bias"][late] - BIAS
    assert np.max(np.abs(wrong)) < 4.0 * np.sqrt(riccati()[1, 1])
    assert np.max(np.abs(wrong)) < 0.05 * np.max(np.abs(BIAS))


def test_what_is_left_after_it_is_lost_grows_as_its_integral(native):
    """Thesis Fig 4.11: less than 4 degrees five minutes after. The sigma has P_a - 2 t P_ab + t2 P_b + q t3 / 3 and the
    noise of the gyros. With GPS attitude what stands still in the aircraft is not in the sigma, without it is."""
    got, error = fly(native, LOST + 300.0)
    assert np.max(np.abs(error[:, got["time"] > 60.0])) < np.radians(4.0)
    (pa, pab), (_, pb) = riccati()
    t = 300.0
    expected = pa - 2.0 * t * pab + t * t * pb + drift() * t**3 / 3.0 + GYRO["gyro_noise"] ** 2 * STEP * t
    angles, _ = variances(got, -1)
    np.testing.assert_allclose(angles, expected, rtol=0.01)
    before, after = (np.flatnonzero(got["time"] > moment)[0] for moment in (LOST - 1.0, LOST + 3.0))
    seen = np.stack([got[f"attitude.{name}_sigma"] for name in ANGLES], axis=1)
    np.testing.assert_allclose(seen[before] ** 2, variances(got, before)[0], rtol=0.02)
    assert np.all(seen[after] ** 2 > 4.0 * variances(got, after)[0])


def test_attitude_that_is_older_than_what_is_lost_is_not_taken(native):
    """2 s, as for what comes no more. Taken after 30 s, carried on by the rates of now, angles come to be 100 degrees
    off in straight flight; of 1 s ago they are as good as of now."""
    none, _ = fly(native, 100.0, lost=-1.0)
    old, _ = fly(native, 100.0, late=30.0)
    for name, values in none.items():
        np.testing.assert_array_equal(old[name], values)
    _, error = fly(native, 100.0, late=1.0)
    assert np.max(np.abs(error[:, 600:])) < 5.0 * np.sqrt(1.5 * riccati()[0, 0])


def test_attitude_that_is_wrong_is_followed_until_it_is_right_again(native):
    """No gate looks at GPS: heading is off by the 3 degrees that it is told, whatever the magnetometer says, and sigma
    does not tell. From 300 s on it is right, and what was wrong decays as the gains of the Riccati equation let it."""
    off = np.radians([0.0, 0.0, 3.0])
    got, error = fly(native, 420.0, lost=420.0, wrong=lambda now: off * (now < 300.0))
    wrong = (got["time"] > 240.0) & (got["time"] < 300.0)
    final = riccati()
    assert np.mean(error[2, wrong]) == pytest.approx(off[2], rel=0.02)
    assert np.mean(got["attitude.heading_sigma"][wrong]) < 0.1 * off[2]
    closed = (np.eye(2) - np.outer(final[:, 0], [1.0, 0.0]) / SIGMA**2) @ np.array([[1.0, -AIDING], [0.0, 1.0]])
    for seconds in (2.0, 5.0, 10.0, 20.0, 100.0):
        after = np.flatnonzero(got["time"] > 300.0 + seconds - 1e-6)[0]
        left, _ = np.linalg.matrix_power(closed, 1 + round(seconds / AIDING)) @ np.array([off[2], 0.0])
        assert abs(error[2, after] - left) < 5.0 * np.sqrt(final[0, 0]), seconds
