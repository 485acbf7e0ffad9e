"""Attitude from the phases of a carrier at three antennas: how good the satellites and the baselines let it be.

A baseline b between two antennas sees a satellite in the direction s at a phase that differs by b s. An attitude that
is off by small angles e turns b by e x b, and the phase changes by e (b x s): least squares of all satellites and both
baselines. All antennas hang on one receiver's oscillator, so differences between them are free of clocks. Thesis
section 4.6 has the idea, Fig 4.9 the antennas. That the number of whole waves is known is taken for
granted.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude

REAR, SIDE = 0.36, 0.50
"""m: the rear baseline and the two others, thesis Fig 4.9."""
ANTENNAS = np.array([[np.sqrt(SIDE**2 - (0.5 * REAR) ** 2), 0.0, 0.0], [0.0, -0.5 * REAR, 0.0], [0.0, 0.5 * REAR, 0.0]])
"""In b, m, rows: the one in front, and the rear ones on the left and on the right."""
SHARED = np.linalg.inv(np.array([[2.0, 1.0], [1.0, 2.0]]))
"""Weights of the differences to the first antenna, whose noise is in both."""
SINGULAR = 1e-9


def information(unit_n, weight, antennas_n):
    """Of small angles about north, east and down, 1/rad2, shape (3, 3).

    ``unit_n`` are unit vectors to satellites in n, shape (satellites, 3), ``weight`` is 1 / variance of a phase at one
    antenna, 1/m2, 0 of those that do not count, ``antennas_n`` are the places of the antennas, shape (3, 3), rows, m.
    """
    across = [attitude.skew(antennas_n[k] - antennas_n[0]) for k in (1, 2)]
    sky = unit_n.T @ (weight[:, None] * unit_n)
    return sum(SHARED[j, k] * across[j] @ sky @ across[k].T for j in range(2) for k in range(2))


def covariance(found):
    """Inverse of :func:`information`, rad2, and whether it has one."""
    sizes = np.prod(np.diagonal(found))
    solvable = np.linalg.det(found) > SINGULAR * sizes
    return np.linalg.inv(np.where(solvable, found, np.eye(3))), solvable


def turned(c_nb, angles_n):
    """C_nb of an attitude that is off by ``angles_n``, rad, about the axes of n: exact for any size."""
    square = np.sum(angles_n * angles_n)
    size = np.sqrt(np.where(square > 0.0, square, 1.0))
    cross = attitude.skew(angles_n / size)
    turn = np.eye(3) + np.sin(size) * cross + (1.0 - np.cos(size)) * (cross @ cross)
    return np.where(square > 0.0, turn, np.eye(3)) @ c_nb
