"""Tracing: plain NumPy code, run once on symbolic numbers, becomes a graph of operations.

A model is called with traced arrays (``traced.py``). Constants are folded and nothing else is rewritten, so that a
traced function does the operations of the NumPy code in the order of the NumPy code.

What cannot be traced (a value-dependent ``if``, ``float()``, ``math.sin``, a traced value stored in a float array)
raises :class:`~navfmu.errors.NavfmuError` with file, line and remedy; nothing becomes a silent NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np

from navfmu.derivatives.making import LOCK
from navfmu.export import calls, functions, ufuncs
from navfmu.export.traced import Traced, contains_traced, expressions, objects, routine, symbols, whole_numbers, wrapped

__all__ = ["Traced", "expressions", "functions", "routine", "symbols", "tracing", "ufuncs", "whole_numbers"]

# NumPy asks no list how to reduce it: these take a list of traced values as the array that it stands for.
_REDUCING = ("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all")


@contextmanager
def tracing(modules: Iterable[ModuleType] = ()) -> Iterator[None]:
    """While tracing, ``np.array`` and its kin return traced arrays, in ``modules`` also by names of their own."""
    modules = list(modules)
    with LOCK, _traced_arrays(modules), _recorded_functions(modules):
        yield


@contextmanager
def _recorded_functions(modules: Iterable[ModuleType]) -> Iterator[None]:
    found = list(calls.functions(modules))
    wrapped = {function: calls.recorded(function) for _, _, function in found}
    try:
        for module, name, function in found:
            setattr(module, name, wrapped[function])
        yield
    finally:
        for module, name, function in found:
            setattr(module, name, function)


@contextmanager
def _traced_arrays(modules: Iterable[ModuleType]) -> Iterator[None]:
    making = ("array", "asarray", "asanyarray", "ascontiguousarray", "full", "full_like")
    originals = {name: getattr(np, name) for name in (*making, *_REDUCING)}
    by_name = [
        (module, alias, name)
        for module in modules
        for alias, value in vars(module).items()
        for name, original in originals.items()
        if value is original
    ]

    def replaced(name: str) -> Callable:
        original = originals[name]

        def function(*args: Any, **kwargs: Any) -> Any:
            if args and contains_traced(args[0]):
                value = wrapped(objects(args[0]))
                dtype = kwargs.get("dtype", args[1] if len(args) > 1 else None)
                return value if dtype is None or np.dtype(dtype).kind == "O" else value.astype(dtype)
            return original(*args, **kwargs)

        return function

    def full(shape: Any, fill_value: Any, *args: Any, **kwargs: Any) -> Any:
        if contains_traced(fill_value):
            return np.broadcast_to(np.array(fill_value, *args, **kwargs), shape).copy()
        return originals["full"](shape, fill_value, *args, **kwargs)

    def full_like(a: Any, fill_value: Any, dtype: Any = None, **kwargs: Any) -> Any:
        if contains_traced(fill_value) and not contains_traced(a):
            return full(np.shape(a), fill_value, dtype or originals["asarray"](a).dtype)
        return originals["full_like"](a, fill_value, dtype, **kwargs)

    def reducing(name: str) -> Callable:
        def function(a: Any, *args: Any, **kwargs: Any) -> Any:
            listed = isinstance(a, list | tuple) and contains_traced(a)
            return originals[name](np.array(a) if listed else a, *args, **kwargs)

        return function

    try:
        for name in originals:
            own = {"full": full, "full_like": full_like}.get(name)
            setattr(np, name, own or (reducing if name in _REDUCING else replaced)(name))
        for module, alias, name in by_name:
            setattr(module, alias, getattr(np, name))
        yield
    finally:
        for module, alias, name in [*((np, name, name) for name in originals), *by_name]:
            setattr(module, alias, originals[name])
