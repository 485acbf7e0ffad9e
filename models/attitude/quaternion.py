"""Quaternions (q0, q1, q2, q3) of C_nb, scalar first: products, rotation vectors, Euler angles.

Thesis section 4.11.2 and Shuster, *A Survey of Attitude Representations*, J. Astronautical Sci. 41 (1993), p. 439.
None of these functions has a singular attitude, but for the angles that :func:`attitude.euler` gives.
"""

from __future__ import annotations

import numpy as np

SMALL = 1.0e-8
"""Square of an angle below which sine and cosine are series: what they leave out is 1e-17."""


def product(left, right):
    """Quaternion of the rotation ``right`` and then ``left``: C(left right) = C(left) C(right)."""
    a, b, c, d = left
    w, x, y, z = right
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )


def inverse(q):
    """Of a unit quaternion."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def unit(q):
    """The quaternion with the length 1."""
    return q / np.sqrt(np.sum(q * q))


def of_rotation(vector):
    """Quaternion of a rotation vector, rad, of any length."""
    square = np.sum(vector * vector)
    small = square < SMALL
    angle = np.sqrt(np.where(small, 1.0, square))
    cosine = np.where(small, 1.0 - square / 8.0, np.cos(0.5 * angle))
    sine = np.where(small, 0.5 - square / 48.0, np.sin(0.5 * angle) / angle)
    return np.concatenate([np.reshape(cosine, (1,)), sine * vector])


def rotation(q):
    """Rotation vector, rad, of the turn by at most half a circle: the inverse of :func:`of_rotation`."""
    q = np.where(q[0] < 0.0, -q, q)
    square = np.sum(q[1:] * q[1:])
    small = square < SMALL
    sine = np.sqrt(np.where(small, 1.0, square))
    return q[1:] * np.where(small, 2.0 + square / 3.0, 2.0 * np.arctan2(sine, q[0]) / sine)


def of_euler(roll, pitch, heading):
    """Quaternion of Euler angles, rad."""
    zero = 0.0 * roll
    down = np.stack([np.cos(0.5 * heading), zero, zero, np.sin(0.5 * heading)])
    right = np.stack([np.cos(0.5 * pitch), zero, np.sin(0.5 * pitch), zero])
    forward = np.stack([np.cos(0.5 * roll), np.sin(0.5 * roll), zero, zero])
    return product(down, product(right, forward))


def dcm(q):
    """C_nb of a unit quaternion."""
    w, x, y, z = q
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
