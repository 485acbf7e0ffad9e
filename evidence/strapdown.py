"""An independent strapdown navigator: the motion integrated in inertial space from specific force and angular rate.

It shares nothing with ``models.motion.aircraft`` but the magnitude of gravity: no local level, no transport rate, no
Coriolis term, no Euler angles. Attitude by a fourth-order Magnus step over two samples, position by twice integrating
C_ib f + G(r), where G is gravity plus the centrifugal term, iterated (Picard) until it stands.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymap3d
from scipy.spatial.transform import Rotation

from models.earth import earth

SPIN = np.array([0.0, 0.0, earth.EARTH_RATE])


def _integral(values: np.ndarray, step: float) -> np.ndarray:
    """Integral at the even samples (Simpson), started with 0."""
    parts = step / 3.0 * (values[:-2:2] + 4.0 * values[1:-1:2] + values[2::2])
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(parts, axis=0)])


def _fill(even: np.ndarray, rate: np.ndarray, step: float) -> np.ndarray:
    """All samples from the even ones and the derivative at all samples."""
    full = np.empty_like(rate)
    full[::2] = even
    full[1::2] = even[:-1] + step / 12.0 * (5.0 * rate[:-2:2] + 8.0 * rate[1:-1:2] - rate[2::2])
    return full


def _level(latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """Matrices C_en: columns north, east, down in e."""
    s, c = np.sin(latitude), np.cos(latitude)
    sl, cl = np.sin(longitude), np.cos(longitude)
    zero = np.zeros_like(s)
    north, east, down = (-s * cl, -s * sl, c), (-sl, cl, zero), (-c * cl, -c * sl, -s)
    return np.stack([np.stack(v, -1) for v in (north, east, down)], -1)


def navigate(
    period: float,
    specific_force: np.ndarray,
    rate: np.ndarray,
    latitude: float,
    longitude: float,
    altitude: float,
    velocity_n: np.ndarray,
    euler: Sequence[float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Latitude (rad), longitude (rad), altitude (m), arrays over all samples, and the final C_nb, shape (3, 3).

    An odd number of samples every ``period`` (s): specific force (m/s2) and angular rate of b in inertial space
    (rad/s), both in b, shape (samples, 3). Start: position (rad, rad, m), velocity in n (m/s) and (roll, pitch,
    heading) (rad) at the first sample; e and inertial axes coincide then.
    """
    count = len(rate)
    time = np.arange(count) * period
    start_level = _level(np.array([latitude]), np.array([longitude]))[0]
    roll, pitch, heading = euler
    c_ib = start_level @ Rotation.from_euler("ZYX", [heading, pitch, roll]).as_matrix()

    # attitude: rotation over two samples, Magnus expansion with the rate's mean and first moment
    two = 2.0 * period
    mean = (rate[:-2:2] + 4.0 * rate[1:-1:2] + rate[2::2]) / 6.0
    slope = (rate[2::2] - rate[:-2:2]) / two
    steps = Rotation.from_rotvec(two * mean + two**3 / 12.0 * np.cross(mean, slope)).as_matrix()
    first_mean = (5.0 * rate[:-2:2] + 8.0 * rate[1:-1:2] - rate[2::2]) / 12.0
    first_slope = (rate[1:-1:2] - rate[:-2:2]) / period
    halves = Rotation.from_rotvec(
        period * first_mean + period**3 / 12.0 * np.cross(first_mean, first_slope)
    ).as_matrix()
    force = np.empty_like(specific_force)
    for k in range(len(steps)):
        force[2 * k] = c_ib @ specific_force[2 * k]
        force[2 * k + 1] = c_ib @ (halves[k] @ specific_force[2 * k + 1])
        c_ib = c_ib @ steps[k]
    force[-1] = c_ib @ specific_force[-1]

    r0 = np.array(pymap3d.geodetic2ecef(latitude, longitude, altitude, deg=False))
    v0 = start_level @ velocity_n + np.cross(SPIN, r0)
    spun = earth.EARTH_RATE * time
    c, s = np.cos(spun), np.sin(spun)
    position = r0 + v0 * time[:, None]
    for _ in range(40):
        x, y, z = position.T
        e = (c * x + s * y, c * y - s * x, z)
        lat, lon, h = (np.asarray(a) for a in pymap3d.ecef2geodetic(*e, deg=False))
        down = _level(lat, lon)[:, :, 2] * earth.gravity(lat, h)[:, None]
        gravity = np.stack([c * down[:, 0] - s * down[:, 1], s * down[:, 0] + c * down[:, 1], down[:, 2]], -1)
        acceleration = force + gravity + np.cross(SPIN, np.cross(SPIN, position))
        velocity = _fill(v0 + _integral(acceleration, period), acceleration, period)
        new = _fill(r0 + _integral(velocity, period), velocity, period)
        moved = np.max(np.abs(new - position))
        position = new
        if moved < 1e-6:
            break
    x, y, z = position.T
    lat, lon, h = pymap3d.ecef2geodetic(c * x + s * y, c * y - s * x, z, deg=False)
    c_ei = np.array([[c[-1], s[-1], 0.0], [-s[-1], c[-1], 0.0], [0.0, 0.0, 1.0]])
    return lat, lon, h, _level(lat[-1:], lon[-1:])[0].T @ c_ei @ c_ib
