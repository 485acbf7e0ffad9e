"""Where in a recording nothing moves."""

from __future__ import annotations

import numpy as np

QUIET = 3.5
"""A second is quiet when no column scatters more than this many times as much as in its quietest twentieth."""
FEWEST = 25
"""Samples of what is called a second here, at least."""
SHORTEST = 10
"""Seconds that a stretch must last, at least; the first and the last one of it are left out."""


def quiet(samples: np.ndarray, period: float) -> list[slice]:
    """Stretches of rows of samples (n, columns): the quiet seconds that follow each other."""
    second = max(FEWEST, round(1.0 / period))
    count = len(samples) // second
    if not count:
        return []
    scatter = samples[: count * second].reshape(count, second, -1).std(axis=1)
    still = np.all(scatter <= QUIET * np.quantile(scatter, 0.05, axis=0), axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return [slice((a + 1) * second, (b - 1) * second) for a, b in pairs if b - a >= SHORTEST]
