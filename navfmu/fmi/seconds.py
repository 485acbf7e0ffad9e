"""Times in files: a number of seconds, or a text such as "5 min"."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from numbers import Real
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.units import BASE, COMMON

_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")
_SECOND = tuple(int(name == "s") for name in BASE)
UNITS = {"s": 1.0} | {name: unit.factor for name, unit in COMMON.items() if unit.exponents == _SECOND}


def seconds(value: Any, what: str) -> float:
    """A time in s; ``what`` begins the sentence when it is none. A decimal time is the double nearest to it."""
    if isinstance(value, Real) and not isinstance(value, bool) and not math.isnan(value):
        return value if isinstance(value, int | float) else float(value)
    found = _TEXT.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        raise NavfmuError(f"{what} is {value!r}, expected a time: a number of seconds, or a text such as '5 min'")
    number, unit = found[1], found[2] or "s"
    if unit not in UNITS:
        raise NavfmuError(
            f"{what} is {value!r}: '{unit}' is no unit of time{nearest(unit, UNITS)} ({', '.join(UNITS)})"
        )
    return float(Fraction(number) * Fraction(repr(UNITS[unit])))
