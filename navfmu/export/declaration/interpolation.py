"""Interpolation between neighbours, in plain NumPy: the same text runs on floats and traced."""

from __future__ import annotations

from typing import Any

import numpy as np


def fraction(x: Any, first: Any, second: Any) -> Any:
    """Return how far ``x`` is on the way from ``first`` to ``second``: from 0 to 1, also outside; NaN for NaN."""
    return np.clip((x - first) / (second - first), 0.0, 1.0)


def linear(part: Any, first: Any, second: Any) -> Any:
    """Return ``first`` where ``part`` is 0, exactly ``second`` where it is 1, what lies between them else."""
    return np.where(part == 1.0, second, first + part * (second - first))


def bilinear(u: Any, v: Any, corners: Any) -> Any:
    """Return what lies between four corners, at ``u`` of the way along the first axis and ``v`` along the second.

    ``corners[..., i, j, :]`` are the values at end i of the first axis and end j of the second; u and v have the shape
    of what stands before these. The surface goes through the corners and is linear along each axis, so that cells that
    share an edge have the same values there.
    """
    u, v = np.expand_dims(u, -1), np.expand_dims(v, -1)
    near = linear(u, corners[..., 0, 0, :], corners[..., 1, 0, :])
    far = linear(u, corners[..., 0, 1, :], corners[..., 1, 1, :])
    return linear(v, near, far)
