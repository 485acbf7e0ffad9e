"""Room for traced values in arrays of constants: ``F = np.array([[1.0, 0.0], [0.0, 1.0]])``, then ``F[0, 1] = dt``.

Arrays of constants are NumPy's own while a model is traced, and NumPy calculates with them. Where that ends because a
traced value is stored in one, the model is traced again, and then all arrays of constants that NumPy's functions make
for it are traced ones. Those of its modules are so, too, and read-only: what is copied from them can be assigned to.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from threading import get_ident
from types import FunctionType
from typing import Any

import numpy as np

from navfmu.export.tracing.extent import current
from navfmu.export.tracing.fresh import FRESH, is_model, owners, running
from navfmu.export.tracing.rules import NoRoom
from navfmu.export.tracing.traced import Traced


def with_room(function: Callable[[], Any], before: Callable[[], None] = lambda: None) -> Any:
    """Call a function that traces; if a traced value finds no room once more, with room for it. ``before`` is called
    before each time."""
    before()
    try:
        return function()
    except NoRoom as error:
        first = error
    before()
    current().begin()
    try:
        with _room():
            return function()
    except Exception:
        raise first from None


@contextmanager
def _room() -> Iterator[None]:
    places = [*_functions(), *_constants()]
    try:
        for owner, name, _, roomy in places:
            setattr(owner, name, roomy)
        running().has_room = True
        yield
    finally:
        running().has_room = False
        for owner, name, before, _ in places:
            setattr(owner, name, before)


def _functions() -> Iterator[tuple[Any, str, Any, Any]]:
    """Yield NumPy's functions: owner, name, function, and the one that gives arrays with room."""
    found: dict[int, Any] = {}
    for owner in (np, np.linalg):
        for name, value in vars(owner).items():
            is_function = isinstance(value, FunctionType | type(np.diag) | type(np.arange))
            if is_function and not name.startswith("_") and name not in FRESH:
                found.setdefault(id(value), _roomy(value))
                yield owner, name, value, found[id(value)]
    for module in running().modules:
        for name, value in vars(module).items():
            if id(value) in found:
                yield module, name, value, found[id(value)]


def _roomy(function: Callable) -> Callable:
    @wraps(function)
    def made(*args: Any, **kwargs: Any) -> Any:
        result = function(*args, **kwargs)
        is_its = running().thread == get_ident() and is_model(sys._getframe(1))
        return _with_room(result, [*args, *kwargs.values()]) if is_its else result

    if hasattr(function, "_implementation"):
        made._implementation = function._implementation
    return made


def _with_room(result: Any, given: Any) -> Any:
    """Return a new array of constants as a traced one; what shares memory with others stays theirs."""
    if isinstance(result, tuple | list):
        return type(result)(_with_room(one, given) for one in result) if type(result) in (tuple, list) else result
    if type(result) is not np.ndarray or result.dtype not in (float, bool):
        return result
    if any(np.may_share_memory(result, one) for one in given if isinstance(one, np.ndarray)):
        return result
    return result.astype(object).view(Traced)


def _constants() -> Iterator[tuple[Any, str, Any, Any]]:
    """Yield the arrays of the model's modules and classes: owner, name, array, and the one that is traced."""
    for owner in owners(running().modules):
        for name, value in vars(owner).items():
            if type(value) is np.ndarray and value.dtype in (float, bool):
                traced = value.astype(object).view(Traced)
                traced.setflags(write=False)
                yield owner, name, value, traced
