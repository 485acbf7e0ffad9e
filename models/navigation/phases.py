"""Which means of navigation serves: the flow chart and the time line of thesis section 2.3 (Figs 2.2, 2.3).

The chart is a row of questions, each of which ends it when its answer is no; so it is a table here.
"""

from __future__ import annotations

import numpy as np

INITIALISING, CALIBRATING, COASTING = range(3)
"""Phases of Fig 2.3: nothing is known yet; GPS is there and calibrates what is used without it; it is not there."""

NO_GUIDANCE, PRECISION, ALONE, BACKUP = range(4)
"""What Fig 2.2 comes to: there is no position; GPS with its augmentation, for all approaches; GPS alone, which is
sufficient but for precision approaches; the backup, to land as soon as practical by a non-precision approach."""

PHASES = (INITIALISING, COASTING), CALIBRATING
"""By whether there has been a position, and whether there is GPS of sufficient accuracy."""
GUIDANCE = (NO_GUIDANCE, BACKUP, ALONE), PRECISION
"""By these two, and whether GPS is augmented: its loss alone does not make the backup necessary (p. 23)."""


def outcome(chart, answers):
    """What a ``chart`` (what a no to each question ends with, and what is left) comes to by the ``answers``."""
    ends, value = chart
    for end, answer in reversed(list(zip(ends, answers, strict=True))):
        value = np.where(answer, value, end)
    return value


def augmented(protection, limit):
    """Whether the horizontal ``protection`` level (m) that the augmentation gives serves up to a ``limit`` (m): GPS
    without it has none, which receivers tell by a very large one."""
    return np.isfinite(protection) & (protection <= limit)


def sigma_of(told, usual):
    """Standard deviation (m) of north and of east of a fix, by the horizontal one it ``told`` of itself, the root of
    the sum of both squares; ``usual`` where it told none (0)."""
    return np.where(told > 0.0, told * np.sqrt(0.5), usual)
