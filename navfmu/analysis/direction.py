"""Directions among errors, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import qr

from navfmu.analysis.error_state import State

SMALL = 0.1
"""Of the largest error: what is smaller is not told."""


def apart(directions: np.ndarray) -> np.ndarray:
    """Other directions that span the same, (count, states): each with an error of its own that no other one has.

    Singular vectors of equal values are any mixture of each other; the pivots of a triangular form are errors.
    """
    if len(directions) < 2:
        return directions
    _, triangle, order = qr(directions, mode="economic", pivoting=True)
    count = len(directions)
    found = np.empty_like(directions)
    found[:, order] = np.linalg.solve(triangle[:, :count], triangle)
    return found


def words(direction: np.ndarray, states: Sequence[State]) -> str:
    """Errors that go together, the largest one sigma: "wind 5 m/s to 90 deg with heading -2.1 deg"."""
    direction = direction / np.max(np.abs(direction))
    if direction[np.argmax(np.abs(direction))] < 0.0:
        direction = -direction
    told, sizes = [], []
    for i, state in enumerate(states):
        what, _, towards = state.name.partition(" to ")
        if towards == "east":
            continue
        if towards == "north":  # told with the one to east
            north, east = direction[i] * state.sigma, direction[i + 1] * states[i + 1].sigma
            size = float(np.hypot(direction[i], direction[i + 1]))
            azimuth = np.degrees(np.arctan2(east, north)) % 360.0
            text = f"{what} {np.hypot(north, east) * state.per:.3g} {state.unit} to {round(azimuth) % 360} deg"
        else:
            size = float(abs(direction[i]))
            text = f"{what} {direction[i] * state.sigma * state.per:+.3g} {state.unit}"
        if size >= SMALL:
            told.append(text)
            sizes.append(size)
    return " with ".join(told[i] for i in np.argsort(-np.array(sizes), kind="stable"))
