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


def fly(native, stop, lost=LOST, seed=1):
    """Outputs at each step; GPS attitude comes at 2 Hz until ``lost``."""
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
            roll, pitch, yaw = SIGMA * rng.standard_normal(3)
            values |= {"gps.roll": roll, "gps.pitch": pitch, "gps.heading": attitude.wrap(HEADING + yaw)}
            values |= {"gps.valid": now <= lost, "gps.sequence": k // 5, "gps.time_of_validity": now}
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
