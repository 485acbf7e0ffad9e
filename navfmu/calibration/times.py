"""Times of the samples of an inertial unit."""

from __future__ import annotations

import numpy as np

from navfmu.calibration.allan.stretches import FEWEST
from navfmu.errors import NavfmuError
from navfmu.recorded.replay.file import File

TIME = "time"
GAP = 1.5
"""Intervals of more than this many usual ones are gaps."""
INTERVALS = (1e-5, 2.0)
"""Between samples, s: the thesis charts samples a second apart."""


def usual(file: File, time: np.ndarray) -> float:
    """The mean of intervals that are no gaps, s: stamps may be coarse or late. Times that go back are refused."""
    interval = np.diff(time)
    if len(time) < FEWEST or not np.all(interval > 0.0):
        at = int(np.argmax(interval <= 0.0)) + 1 if len(interval) else 0
        what = "time does not increase" if len(time) >= FEWEST else f"has {len(time)} rows only"
        raise NavfmuError(f"{file.path}, {file.row(at)}: {what}; expected samples one after the other")
    near = interval[interval <= GAP * np.median(interval)]
    period = float(np.format_float_positional(np.mean(near), 5, fractional=False))
    if not INTERVALS[0] <= period <= INTERVALS[1]:
        raise NavfmuError(
            f"{file.path}: samples are {period:.4g} s apart; expected {INTERVALS[0]:g} to {INTERVALS[1]:g}; name the "
            "unit of the time, as in --unit time=ms"
        )
    return period
