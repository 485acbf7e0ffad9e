"""What the parameters of a fault may be, as far as that can be said without its target."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.expressions.parser import ExpressionError, parse
from navfmu.fmi.seconds import is_finite, seconds, short

NOT_FINITE = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


def _time(name: str, value: Any) -> float:
    time = seconds(value, f"'{name}'")
    if not 0 < time < math.inf:
        raise NavfmuError(f"'{name}' must be a positive time in s, not {short(value)}")
    return time


def _delay(name: str, value: Any) -> float:
    time = seconds(value, f"'{name}'")
    if not 0 <= time < math.inf:
        raise NavfmuError(f"'{name}' must be a time in s, 0 or longer, not {short(value)}")
    return time


def _stream(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**31:
        raise NavfmuError(f"'{name}' must be a whole number from 0 to 2147483647, not {short(value)}")
    return value


def _order(name: str, value: Any) -> list[int]:
    order = value.tolist() if hasattr(value, "tolist") else value
    whole = isinstance(order, list | tuple) and all(isinstance(n, int) and not isinstance(n, bool) for n in order)
    if not whole or sorted(order) != list(range(1, len(order) + 1)):
        raise NavfmuError(
            f"'{name}' must have each of the places 1, 2, ... once, such as [2, 1, 3], not {short(value)}"
        )
    return list(order)


def _unit(name: str, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise NavfmuError(f"'{name}' must be the name of a unit, such as 'ft', not {short(value)}")
    return value


def _not_finite(name: str, value: Any) -> str:
    text = value if isinstance(value, str) else repr(value)
    if text not in NOT_FINITE:
        hint = nearest(text, NOT_FINITE)
        raise NavfmuError(f"'{name}' must be 'nan', 'inf' or '-inf', not {short(value)}{hint}")
    return text


def _positive(name: str, value: Any) -> float:
    if not (is_finite(value) and value > 0):
        raise NavfmuError(f"'{name}' must be a positive number, not {short(value)}")
    return value


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise NavfmuError(f"'{name}' must be a text that is not empty, not {short(value)}")
    return value


def _expression(name: str, value: Any) -> str:
    try:
        parse(_text(name, value))
    except ExpressionError as error:
        raise NavfmuError(f"'{name}': {error}") from None
    return value


#: By the sort of a parameter: the value to keep, or the sentence why it cannot be. Others need the unit of the target.
SORTS: dict[str, Callable[[str, Any], Any]] = {
    "time": _time,
    "delay": _delay,
    "stream": _stream,
    "order": _order,
    "unit": _unit,
    "not finite": _not_finite,
    "positive": _positive,
    "text": _text,
    "expression": _expression,
}
