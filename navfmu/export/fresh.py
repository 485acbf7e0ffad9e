"""Arrays that a model's code makes itself: ``np.array([...])`` of traced values, ``np.zeros`` that is filled later.

NumPy asks the arguments of these nothing. While tracing they stand for functions that do the same and return traced
arrays.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import _lru_cache_wrapper, wraps
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from navfmu.export.chance import stand_ins
from navfmu.export.rules import refuse
from navfmu.export.traced import Traced, contains_traced, objects, wrapped
from navfmu.place import is_foreign

_MAKING = ("array", "asarray", "asanyarray", "ascontiguousarray", "full_like", "full")
_EMPTY = ("zeros", "ones", "eye", "identity", "empty")
# NumPy asks no list how to reduce it: these take a list of traced values as the array that it stands for.
_REDUCING = ("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all")
#: The functions of NumPy that make arrays, and traced ones while tracing.
MAKES = (*_MAKING, *_EMPTY)
_ORIGINALS = {name: getattr(np, name) for name in (*_MAKING, *_EMPTY, *_REDUCING)}


class Unset:
    """An element of ``np.empty`` before it is assigned."""

    def __float__(self) -> NoReturn:
        refuse("an element of np.empty is read before it is assigned", "make the array with np.zeros")


def _array(name: str) -> Callable:
    original = _ORIGINALS[name]

    def function(*args: Any, **kwargs: Any) -> Any:
        if not args or not contains_traced(args[0]):
            return original(*args, **kwargs)
        value = args[0]
        same = isinstance(value, Traced) and (name != "array" or not kwargs.get("copy", True))
        value = value if same else wrapped(objects(value))
        dtype = kwargs.get("dtype", args[1] if len(args) > 1 else None)
        return value if dtype is None or np.dtype(dtype).kind == "O" else value.astype(dtype, copy=False)

    return function


def _full(shape: Any, fill_value: Any, *args: Any, **kwargs: Any) -> Any:
    if contains_traced(fill_value):
        return np.broadcast_to(np.array(fill_value, *args, **kwargs), shape).copy()
    return _filled_later(_ORIGINALS["full"](shape, fill_value, *args, **kwargs))


def _full_like(a: Any, fill_value: Any, dtype: Any = None, **kwargs: Any) -> Any:
    if contains_traced(fill_value) and not contains_traced(a):
        return _full(np.shape(a), fill_value, dtype or _ORIGINALS["asarray"](a).dtype)
    return _ORIGINALS["full_like"](a, fill_value, dtype, **kwargs)


def _filled_later(array: np.ndarray, unset: bool = False) -> Any:
    """Return a new array of constants as a traced one, if the model made it and traced values may come into it."""
    if array.dtype not in (float, bool) or is_foreign(sys._getframe(2).f_code.co_filename):
        return array
    values = array.astype(object)
    if unset and array.dtype.kind == "f":
        values[...] = Unset()
    return values.view(Traced)


def _fresh(name: str) -> Callable:
    original = _ORIGINALS[name]

    def function(*args: Any, **kwargs: Any) -> Any:
        return _filled_later(original(*args, **kwargs), name == "empty")

    return function


def _reducing(name: str) -> Callable:
    original = _ORIGINALS[name]

    def function(a: Any, *args: Any, **kwargs: Any) -> Any:
        listed = isinstance(a, list | tuple) and contains_traced(a)
        return original(np.array(a) if listed else a, *args, **kwargs)

    return function


_TRACED = {name: _array(name) for name in _MAKING}
_TRACED |= {name: _fresh(name) for name in _EMPTY} | {name: _reducing(name) for name in _REDUCING}
_TRACED |= {"full": _full, "full_like": _full_like}


@contextmanager
def fresh_arrays(modules: Iterable[ModuleType]) -> Iterator[None]:
    """Let arrays be traced that code makes, in the modules also where it has NumPy's functions by names of its own, and
    let no random numbers be drawn there.

    What a function keeps (``functools.cache``) is made of constants and stays as NumPy has it: it outlives the trace.
    """
    modules = list(modules)
    places: list[tuple[Any, str, Any, Any]] = [(np, name, _ORIGINALS[name], _TRACED[name]) for name in _ORIGINALS]
    places += stand_ins(modules)
    for module in modules:
        for alias, value in vars(module).items():
            name = next((name for name, original in _ORIGINALS.items() if value is original), None)
            if name is not None:
                places.append((module, alias, value, _TRACED[name]))
            elif isinstance(value, _lru_cache_wrapper):
                places.append((module, alias, value, _kept(value, places)))
    try:
        for owner, name, _, traced in places:
            setattr(owner, name, traced)
        yield
    finally:
        for owner, name, original, _ in places:
            setattr(owner, name, original)


def _kept(function: Callable, places: list[tuple[Any, str, Any, Any]]) -> Callable:
    @wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        before = [(owner, name, getattr(owner, name)) for owner, name, _, _ in places]
        try:
            for owner, name, original, _ in places:
                setattr(owner, name, original)
            return function(*args, **kwargs)
        finally:
            for owner, name, value in before:
                setattr(owner, name, value)

    return called
