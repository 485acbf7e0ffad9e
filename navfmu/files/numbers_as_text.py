"""The same columns of numbers as a text that people read and edit: CSV with a header line.

Of a grid there is a line for each point: its place on both axes, then the surfaces; the second axis goes first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.files.numbers import is_grid


def text(columns: Mapping[str, np.ndarray]) -> str:
    """Return the text; numbers have the shortest form that reads back as the same bits."""
    numbers = list(columns.values())
    if is_grid(columns):
        numbers[:2] = np.meshgrid(*numbers[:2], indexing="ij")
    rows = zip(*(column.ravel().tolist() for column in numbers), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"


def columns(text: str, like: Mapping[str, np.ndarray], what: str) -> dict[str, np.ndarray]:
    """Return the columns that a text holds, which are those of ``like``; ``what`` it is begins every sentence."""
    header, *lines = text.removeprefix("\ufeff").splitlines() or [""]
    if header.strip() != ",".join(like):
        raise NavfmuError(f"{what}, line 1: the columns are '{header.strip()}'; expected '{','.join(like)}'")
    rows = [_row(line, len(like), f"{what}, line {i}") for i, line in enumerate(lines, 2) if line.strip()]
    numbers = np.array(rows, float).reshape(-1, len(like)).T
    if is_grid(like):
        return dict(zip(like, _grid(numbers, what), strict=True))
    return dict(zip(like, numbers, strict=True))


def _row(line: str, count: int, where: str) -> list[float]:
    try:
        row = [] if "_" in line else [float(word) for word in line.split(",")]
    except ValueError:
        row = []
    if len(row) != count or not all(map(math.isfinite, row)):
        raise NavfmuError(f"{where}: expected {count} numbers separated by commas")
    return row


def _grid(numbers: np.ndarray, what: str) -> list[np.ndarray]:
    """Return axes (n,) and (m,) and surfaces (n, m) of n m lines."""
    first, second = np.unique(numbers[0]), np.unique(numbers[1])
    points = np.meshgrid(first, second, indexing="ij")
    if numbers.shape[1] != points[0].size or any(np.any(p.ravel() != n) for p, n in zip(points, numbers, strict=False)):
        raise NavfmuError(
            f"{what}: has {numbers.shape[1]} points; expected each of {len(first)} numbers of the first axis with each "
            f"of {len(second)} of the second one, in increasing order, the second axis first"
        )
    return [first, second, *(surface.reshape(points[0].shape) for surface in numbers[2:])]
