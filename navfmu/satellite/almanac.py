"""What almanacs have in common: a row holds for long, and its week is modulo 1024."""

from __future__ import annotations

from collections.abc import Mapping

from navfmu.satellite.calendar import CLOSE, WEEK
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import RANGES, check


def entry(lines: Lines, at: int, week: int, toa: float, values: Mapping[str, float]) -> dict[str, float]:
    """Return the row of a satellite; the clock's reference is that of the orbit, t_oa."""
    return {
        **{name: check(lines, at, name, value) for name, value in values.items() if name in RANGES},
        "toe_week": week,
        "toe": check(lines, at, "toe", toa),
        "toc_week": week,
        "toc": toa,
        "sent_week": week - CLOSE,  # it is there when it is wanted
        "limit": CLOSE * WEEK,
    }
