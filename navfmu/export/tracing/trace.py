"""Tracing: plain NumPy code, run once on symbolic numbers, becomes a graph of operations.

A model is called with traced arrays (``traced.py``). Constants are folded and nothing else is rewritten, so that a
traced function does the operations of the NumPy code in the order of the NumPy code.

What cannot be traced (a value-dependent ``if``, ``float()``, ``math.sin``, a traced value stored in a float array)
raises :class:`~navfmu.errors.NavfmuError` with file, line and remedy; nothing becomes a silent NaN or constant.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType

from navfmu.derivatives.making import LOCK
from navfmu.export.tracing import calls, functions, repetition, ufuncs
from navfmu.export.tracing.fresh import fresh_arrays
from navfmu.export.tracing.traced import Traced, expressions, routine, symbols, whole_numbers

__all__ = [
    "Traced",
    "expressions",
    "functions",
    "repetition",
    "routine",
    "symbols",
    "tracing",
    "ufuncs",
    "whole_numbers",
]


@contextmanager
def tracing(modules: Iterable[ModuleType] = ()) -> Iterator[None]:
    """While tracing, ``np.array`` and its kin return traced arrays, in ``modules`` also by names of their own."""
    modules = list(modules)
    with LOCK, fresh_arrays(modules), _recorded_functions(modules):
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
