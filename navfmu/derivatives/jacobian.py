"""``jacobian(f, x)``: the derivatives of a function in plain NumPy."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any

import numpy as np
from numpy import eye, ones

from navfmu.derivatives import algebra, composed, elementwise, moving, products  # noqa: F401  (their rules)
from navfmu.derivatives.dual import Dual, refuse
from navfmu.derivatives.making import making
from navfmu.derivatives.slopes import Slopes
from navfmu.errors import NavfmuError

_levels = count(1)


def value_and_jacobian(function: Callable, x: Any, *others: Any) -> tuple[Any, Any]:
    """Return ``function(x, *others)`` and its derivatives by ``x``, in one go; see :func:`jacobian`."""
    x = _numbers(x, "jacobian by").astype(float)[()]
    level = next(_levels)
    with making(level, x.size):
        try:
            result = function(Dual(x, Slopes(eye(x.size, dtype=bool), ones(x.size)), level), *others)
        except ValueError as error:  # NumPy's, where an assignment into an array of floats has been refused
            if isinstance(error.__cause__, NavfmuError):
                raise error.__cause__ from None
            raise
        result = _numbers(result, "jacobian of a function that returns")
    if not (isinstance(result, Dual) and result.level == level):
        return result, np.zeros((*np.shape(result), *np.shape(x)))
    return result.value, np.reshape(result.slopes.dense(), (*result.shape, *np.shape(x)))


def _numbers(x: Any, what: str) -> Any:
    """Return an array, whatever its type, if it is one of numbers."""
    try:
        array = np.array(x)
    except ValueError:
        array = None
    if array is None or (type(array) is np.ndarray and array.dtype.kind not in "fiub"):
        refuse(f"{what} {x!r}", "expected numbers, in an array of one shape")
    return array


def jacobian(function: Callable, x: Any, *others: Any) -> Any:
    """Return the derivatives of ``function(x, *others)`` by the elements of ``x``, exact to rounding.

    Parameters
    ----------
    function
        Plain NumPy. It may make arrays, assign into them, branch, loop and call other functions.
    x
        Where, an array of any shape; n states, shape (n,), as a rule.
    others
        Further arguments, which are constants here.

    Returns
    -------
    An array of shape ``(*shape of the result, *shape of x)``: F or H of an extended Kalman filter, shape (m, n), for
    vectors of m and n elements; their units are those of the result per those of x.

    Notes
    -----
    At a kink (``abs``, ``np.maximum``, ``np.where``, ``np.interp``) it is the derivative of the branch that is taken,
    of ``abs`` at 0 it is 0. Where there is none (a norm at the origin) it is what the formula gives, NaN or infinite,
    so guard the formula there. What goes in steps (``np.floor``, comparisons, ``np.argmax``) has the derivative 0.
    """
    return value_and_jacobian(function, x, *others)[1]
