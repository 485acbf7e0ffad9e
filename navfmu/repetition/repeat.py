"""``repeat(function, value, count, most)``: a function applied as often as a value says.

With floats it is a loop in Python. What traces has a method ``__repeat__`` and makes a loop of its own; all forms do
the same operations in the same order.
"""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.place import place

_within: ContextVar[bool] = ContextVar("within", default=False)


def repeat(function: Callable[[Any], Any], value: Any, count: Any, most: int) -> Any:
    """Return ``value`` after ``function`` was applied to it ``count`` times.

    Parameters
    ----------
    function
        Plain NumPy: it takes a value and returns one of the same shape. It reads what it likes and only calculates:
        inside it no variable is assigned and no noise is drawn.
    value
        A number, an array, or a tuple of these.
    count
        How often: a whole number, such as a parameter. Below 1, and for NaN, ``value`` is returned as it is.
    most
        The largest count that counts; a number that is known when the component is built, such as the parameter's max.
    """
    if isinstance(most, bool) or not isinstance(most, int | np.integer) or most < 1:
        _refuse(
            f"repeat(..., most={_shown(most)})", "expected a whole number of at least 1, known when the model is built"
        )
    if not callable(function):
        _refuse(f"repeat({function!r}, ...)", "expected a function of one value")
    if np.shape(count) != ():
        _refuse(f"repeat with a count of shape {np.shape(count)}", "expected one number")
    if own := getattr(type(count), "__repeat__", None):
        return own(function, value, count, int(most))
    done = 0
    while done < most and done < count:
        value = applied(function, value)
        done += 1
    return value


def applied(function: Callable[[Any], Any], value: Any) -> Any:
    """Return ``function(value)``, which must be like the value."""
    token = _within.set(True)
    try:
        result = function(value)
    finally:
        _within.reset(token)
    if result is None or shapes(result) != shapes(value):
        told = f"the function of repeat returns {_told(result)} for {_told(value)}"
        _refuse(told, "return what is like the value that it is given")
    return result


def masked(function: Callable[[Any], Any], value: Any, count: Any, most: int) -> Any:
    """Return the same, calculated ``most`` times and selected."""
    for done in range(most):
        value = _selected(done < count, applied(function, value), value)
    return value


def _selected(condition: Any, new: Any, old: Any) -> Any:
    if isinstance(old, tuple):
        return tuple(_selected(condition, a, b) for a, b in zip(new, old, strict=True))
    return np.where(condition, new, old)


def shapes(value: Any) -> Any:
    """Return the shape of a value, or those of a tuple."""
    return [shapes(part) for part in value] if isinstance(value, tuple) else np.shape(value)


def _shown(value: Any) -> str:
    """A value, or that it is one that is not known before the component runs."""
    return "a value" if hasattr(type(value), "__repeat__") else repr(value)


def _told(value: Any) -> str:
    if value is None:
        return "None"
    if isinstance(value, tuple):
        return f"({', '.join(_told(part) for part in value)})"
    return f"shape {np.shape(value)}"


def outside(what: str) -> None:
    """Refuse what is done by a function that is repeated."""
    if _within.get():
        _refuse(f"{what} in the function of repeat", "let it return what it calculates, and do this before or after")


def _refuse(what: str, remedy: str) -> NoReturn:
    raise NavfmuError(f"{place()}: {what}; {remedy}")
