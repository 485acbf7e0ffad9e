"""Numbers that are none: nothing leaves them out without saying so."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

LARGEST = 1e300  # in a picture: no double holds the length of an axis from -1e308 to 1e308


def drawn(values: np.ndarray) -> np.ndarray:
    """What a curve can show of the values; what is not finite is a gap. Signals that run away end near 1e308."""
    return np.where(np.isfinite(values), np.clip(values, -LARGEST, LARGEST), np.nan)


def remark(arrays: Iterable[np.ndarray]) -> str:
    """ "not finite at 3 of 8400 points", or "" when everything is a number."""
    bad, total = 0, 0
    for values in arrays:
        bad += int(np.count_nonzero(~np.isfinite(values)))
        total += values.size
    return f"not finite at {bad} of {total} points" if bad else ""


def extremes(values: np.ndarray) -> tuple[float, float]:
    """The least and the greatest finite value; NaN twice when there is none. Say ``remark`` beside them."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (np.nan, np.nan)
