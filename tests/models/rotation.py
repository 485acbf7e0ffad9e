"""Rotations put together one after the other, independently of the models."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


def together(angles: np.ndarray) -> np.ndarray:
    """The rotation vector of rotations, (n, 3), one after the other, each in the axes that the last has led to."""
    attitude = np.array([1.0, 0.0, 0.0, 0.0])
    for angle in angles:
        size = np.linalg.norm(angle)
        attitude = _product(attitude, np.concatenate([[np.cos(size / 2)], 0.5 * np.sinc(size / (2 * np.pi)) * angle]))
    sine = np.linalg.norm(attitude[1:])
    return attitude[1:] * (2.0 if sine == 0.0 else 2.0 * np.arctan2(sine, attitude[0]) / sine)


def matrix(angle: np.ndarray) -> np.ndarray:
    """The matrix of a rotation vector: it takes components after the rotation to those before."""
    return Rotation.from_rotvec(angle).as_matrix()


def _product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    scalar = p[0] * q[0] - p[1:] @ q[1:]
    return np.concatenate([[scalar], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])])
