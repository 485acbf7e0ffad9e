"""What one run says about one requirement, and numbers as people read them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """What one run says about one requirement."""

    held: bool
    percent: float  # of the points inside the bound
    worst: float  # NaN where none of the points was reached
    worst_time: float
    first_violation: float | None  # s
    missing: int = 0  # points that an early end of the run has left out
    rms: float = math.nan  # of the value
    greatest: float = math.nan  # size of the value

    @property
    def reached(self) -> bool:
        """Whether the run came as far as the first point."""
        return not (self.missing and math.isnan(self.worst))

    @property
    def violated_from(self) -> float | None:
        """When it was first outside (s) of a run that does not hold: what is allowed for a time violates nothing."""
        return None if self.held else self.first_violation

    def row(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "held": self.held,
            "percent": self.percent,
            "worst": self.worst,
            "worst_time": self.worst_time,
            "first_violation": self.first_violation,
            "missing": self.missing,
            "rms": self.rms,
            "greatest": self.greatest,
        }


def enough(percent: float, needed: float) -> bool:
    """Whether a share reaches the one that is needed, but for rounding; both in percent, ``needed`` above 0."""
    return percent >= needed * (1.0 - 1e-12)


def percent(value: float) -> str:
    """Rounded down, so that 100 % is all of it and what is below a bound looks so."""
    return f"{math.floor(10.0 * value + 1e-9) / 10.0:.1f} %"


def times(count: float) -> str:
    """ "1 time", "3 times"."""
    return "1 time" if count == 1 else f"{count:g} times"
