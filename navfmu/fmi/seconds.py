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


def is_finite(value: Any) -> bool:
    """Whether it is a real number that a double can hold; a truth is none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer of hundreds of digits
        return False


def short(value: Any) -> str:
    """A value as one quotes it in a sentence: in one line, and not at any length."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:40]}... ({len(text)} characters)"


def seconds(value: Any, what: str) -> float:
    """A time in s; ``what`` begins the sentence when it is none. A decimal time is the double nearest to it."""
    if is_finite(value) or (isinstance(value, float) and math.isinf(value)):
        return value if isinstance(value, int | float) else float(value)
    found = _TEXT.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        raise NavfmuError(f"{what} is {short(value)}, expected a time: a number of seconds, or a text such as '5 min'")
    number, unit = found[1], found[2] or "s"
    if unit not in UNITS:
        raise NavfmuError(
            f"{what} is {value!r}: '{unit}' is no unit of time{nearest(unit, UNITS)} ({', '.join(UNITS)})"
        )
    if not math.isfinite(float(number)) or abs(float(number)) * UNITS[unit] > 1e300:
        raise NavfmuError(f"{what} is {short(value)}, expected a time that can be counted")
    return float(Fraction(number) * Fraction(repr(UNITS[unit])))
