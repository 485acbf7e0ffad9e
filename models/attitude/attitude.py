"""Attitude: Euler angles, direction cosine matrices and quaternions.

``C_nb`` takes components in b (forward, right, down) to components in n (north, east, down). Euler angles are
heading, pitch, roll in this order of rotation in rad. Quaternions are (q0, q1, q2, q3), scalar
first, of the same rotation.
"""

from __future__ import annotations

import numpy as np


def dcm(roll, pitch, heading):
    """C_nb from Euler angles."""
    return dcm_from_sines(np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch), np.sin(heading), np.cos(heading))


def dcm_from_sines(sin_roll, cos_roll, sin_pitch, cos_pitch, sin_heading, cos_heading):
    """C_nb where sines and cosines are known already."""
    return np.array(
        [
            [
                cos_pitch * cos_heading,
                sin_roll * sin_pitch * cos_heading - cos_roll * sin_heading,
                cos_roll * sin_pitch * cos_heading + sin_roll * sin_heading,
            ],
            [
                cos_pitch * sin_heading,
                sin_roll * sin_pitch * sin_heading + cos_roll * cos_heading,
                cos_roll * sin_pitch * sin_heading - sin_roll * cos_heading,
            ],
            [-sin_pitch, sin_roll * cos_pitch, cos_roll * cos_pitch],
        ]
    )


def euler(matrix):
    """Roll, pitch, heading (-pi, pi] from C_nb."""
    return (
        np.arctan2(matrix[2, 1], matrix[2, 2]),
        np.arcsin(np.clip(-matrix[2, 0], -1.0, 1.0)),
        np.arctan2(matrix[1, 0], matrix[0, 0]),
    )


def euler_rates(rate_nb, roll, pitch):
    """Rates of roll, pitch and heading, rad/s, from the rate of b with respect to n in b: thesis (4.4)."""
    p, q, r = rate_nb[0], rate_nb[1], rate_nb[2]
    turning = q * np.sin(roll) + r * np.cos(roll)
    return np.array([p + turning * np.tan(pitch), q * np.cos(roll) - r * np.sin(roll), turning / np.cos(pitch)])


def body_rate(roll_rate, pitch_rate, heading_rate, sin_roll, cos_roll, sin_pitch, cos_pitch):
    """Rate of b with respect to n in b, rad/s: the inverse of (4.4)."""
    return np.array(
        [
            roll_rate - heading_rate * sin_pitch,
            pitch_rate * cos_roll + heading_rate * sin_roll * cos_pitch,
            heading_rate * cos_roll * cos_pitch - pitch_rate * sin_roll,
        ]
    )


def skew(v):
    """Matrix of the cross product: skew(v) @ u = v x u."""
    return np.array([[0.0 * v[0], -v[2], v[1]], [v[2], 0.0 * v[0], -v[0]], [-v[1], v[0], 0.0 * v[0]]])


def mounting(rotation):
    """C_m = I - [rotation x], thesis (3.29): body axes to those of an instrument turned by small angles, rad."""
    return np.eye(3) - skew(rotation)


def wrap(angle):
    """The angle in [-pi, pi)."""
    return angle - 2.0 * np.pi * np.floor((angle + np.pi) / (2.0 * np.pi))
