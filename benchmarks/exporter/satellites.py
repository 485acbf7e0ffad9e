"""Position and clock from the pseudoranges to 24 satellites: weighted least squares, four times linearised."""

from __future__ import annotations

import numpy as np

ITERATIONS = 4


def normal_equations(at, positions, ranges, weights):
    """H' W H, shape (4, 4), and H' W (z - h) at a position and clock offset (m, m, m, m)."""
    apart = positions - at[:3]
    distance = np.sqrt(np.sum(apart * apart, axis=1))
    matrix = np.concatenate([-apart / distance[:, None], np.ones((len(ranges), 1))], axis=1)
    weighted = matrix * weights[:, None]
    return weighted.T @ matrix, weighted.T @ (ranges - distance - at[3])


def solve_by_library(matrix, right):
    """Solve four linear equations, np.linalg.solve."""
    return np.linalg.solve(matrix, right)


def solve_written_out(matrix, right):
    """Solve four linear equations with a symmetric, positive definite matrix by its factors L D L'."""
    lower, d, y = [[1.0] * 4 for _ in range(4)], [0.0] * 4, [0.0] * 4
    for j in range(4):
        d[j] = matrix[j, j] - sum(lower[j][k] * lower[j][k] * d[k] for k in range(j))
        for i in range(j + 1, 4):
            lower[i][j] = (matrix[i, j] - sum(lower[i][k] * lower[j][k] * d[k] for k in range(j))) / d[j]
        y[j] = right[j] - sum(lower[j][k] * y[k] for k in range(j))
    x = [y[i] / d[i] for i in range(4)]
    for i in reversed(range(3)):
        x[i] = x[i] - sum(lower[k][i] * x[k] for k in range(i + 1, 4))
    return np.array(x)


def fix(start, positions, ranges, weights, solve):
    """Position and clock offset (m), four elements; satellites have the shape (24, 3), all else one number for each."""
    at = start
    for _ in range(ITERATIONS):
        at = at + solve(*normal_equations(at, positions, ranges, weights))
    return at
