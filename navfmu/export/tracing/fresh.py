"""Arrays that a model's code makes itself: ``np.array([...])`` of traced values, ``np.zeros`` that is filled later.

NumPy asks the arguments of these nothing. While tracing they stand for functions that do the same and return traced
arrays, in the thread that traces and in the functions of the model: other libraries get what they know, and so does a
module that is imported meanwhile.
"""

from __future__ import annotations

import inspect
import os
import sys
import sysconfig
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import _lru_cache_wrapper, wraps
from threading import get_ident
from types import FrameType, ModuleType
from typing import Any, NoReturn

import numpy as np

from navfmu.export.tracing.rules import refuse
from navfmu.export.tracing.surroundings import stand_ins
from navfmu.export.tracing.traced import Traced, contains_traced, objects, wrapped
from navfmu.place import is_foreign

_MAKING = ("array", "asarray", "asanyarray", "ascontiguousarray", "full_like", "full")
_EMPTY = ("zeros", "ones", "eye", "identity", "empty")
# NumPy asks no list how to reduce it: these take a list of traced values as the array that it stands for.
_REDUCING = ("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all")
#: Those of which a model always gets traced arrays.
FRESH = (*_EMPTY, "full")
#: The functions of NumPy that make arrays, and traced ones while tracing.
MAKES = (*_MAKING, *_EMPTY)
_ORIGINALS = {name: getattr(np, name) for name in (*_MAKING, *_EMPTY, *_REDUCING)}


_LIBRARIES = tuple(sysconfig.get_path(name) + os.sep for name in ("stdlib", "platstdlib", "purelib", "platlib"))


@dataclass
class _Running:
    """A trace that is running."""

    thread: int
    modules: list[ModuleType]  # of the model
    has_room: bool = False  # arrays of constants are traced ones, too (room.py)


_running: list[_Running] = []  # the innermost one last


def running() -> _Running | None:
    """Return the trace that is running."""
    return _running[-1] if _running else None


def is_model(frame: FrameType) -> bool:
    """Whether a frame is one of a function of the model: what a module or a class keeps outlives the trace."""
    file, name = frame.f_code.co_filename, frame.f_globals.get("__name__")
    if is_foreign(file) or not frame.f_code.co_flags & inspect.CO_OPTIMIZED:
        return False
    return any(name == module.__name__ for module in _running[-1].modules) or not file.startswith(_LIBRARIES)


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
        same = isinstance(value, Traced) and (name != "array" or kwargs.get("copy", True) is not True)
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
    if array.dtype not in (float, bool) or not is_model(sys._getframe(3)):
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


def _while_tracing(name: str, traced: Callable) -> Callable:
    original = _ORIGINALS[name]

    @wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        is_tracing = bool(_running) and _running[-1].thread == get_ident()
        return (traced if is_tracing else original)(*args, **kwargs)

    return function


_WAYS = {name: _array(name) for name in _MAKING}
_WAYS |= {name: _fresh(name) for name in _EMPTY} | {name: _reducing(name) for name in _REDUCING}
_WAYS |= {"full": _full, "full_like": _full_like}
_TRACED = {name: _while_tracing(name, way) for name, way in _WAYS.items()}


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
    for owner in owners(modules):
        for alias, value in vars(owner).items():
            if isinstance(value, _lru_cache_wrapper):
                places.append((owner, alias, value, _kept(value, places)))
    _running.append(_Running(get_ident(), modules))
    try:
        for owner, name, _, traced in places:
            setattr(owner, name, traced)
        yield
    finally:
        _running.pop()
        for owner, name, original, _ in places:
            setattr(owner, name, original)


def owners(modules: Iterable[ModuleType]) -> Iterator[ModuleType | type]:
    """Yield modules and the classes that they define."""
    for module in modules:
        yield module
        yield from (x for x in vars(module).values() if isinstance(x, type) and x.__module__ == module.__name__)


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
