"""How good orbits and clocks are that satellites send: the longer ago they were told them, the worse.

Without an upload the error of a range is about 60 m after seven days: AGARD CP-298 (1981), Coriat.
"""

from __future__ import annotations

import numpy as np

RATE = 60.0 / (7.0 * 86400.0)
"""m/s."""


def sigma(fresh, age):
    """Standard deviation of a range by orbit and clock, m: ``fresh`` m, and that of an ``age`` in s."""
    return np.sqrt(fresh * fresh + (RATE * age) ** 2)
