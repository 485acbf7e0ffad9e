"""What a model's functions may not ask for while they are traced: it would be the same at every tick.

Random numbers of NumPy and Python, clocks, and the environment of the process.
"""

from __future__ import annotations

import datetime
import os
import random
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from threading import get_ident
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from navfmu.export.tracing.rules import refuse

_GENERATORS = np.random.Generator, np.random.RandomState, random.Random
_DATES = datetime.datetime, datetime.date
_CLOCKS = """
time time_ns monotonic monotonic_ns perf_counter perf_counter_ns process_time process_time_ns thread_time
thread_time_ns localtime gmtime asctime ctime
""".split()


def _drawn() -> NoReturn:
    refuse(
        "a random number that is drawn while the model is traced is the same at every tick",
        "let the task take noise: noise(n) are n standard normal numbers, fresh at each tick (constants are drawn "
        "outside of functions)",
    )


def _clock() -> NoReturn:
    refuse(
        "a clock that is read while the model is traced stands still in the FMU",
        "take self.time, the time of the tick (what the time of the build decides is read outside of functions)",
    )


def _environment() -> NoReturn:
    refuse(
        "the environment that is read while the model is traced is that of the build at every tick",
        "declare a Parameter (what the environment of the build decides is read outside of functions)",
    )


class _Refusing:
    """Stands for a generator of the model."""

    def __getattr__(self, name: str) -> NoReturn:
        _drawn()


class _Model:
    """The functions of some modules, in the thread that traces them."""

    def __init__(self, modules: Iterable[ModuleType]) -> None:
        self._names, self._thread = {module.__name__ for module in modules}, get_ident()

    def asks(self) -> bool:
        """Whether one of these calls what calls this."""
        return self._thread == get_ident() and sys._getframe(2).f_globals.get("__name__") in self._names


def stand_ins(modules: list[ModuleType]) -> Iterator[tuple[Any, str, Any, Any]]:
    """Yield what refuses the functions of the modules such a thing: owner, name, original and what stands for it."""
    model = _Model(modules)
    places = [
        *((owner, name, value, _drawn) for owner in (np.random, random) for name, value in _functions(owner)),
        *((time, name, getattr(time, name), _clock) for name in _CLOCKS if hasattr(time, name)),
        (os, "getenv", os.getenv, _environment),
    ]
    found: dict[int, Any] = {}
    for _, _, value, refused in places:
        found.setdefault(id(value), _refusing(value, model, refused, only_now=refused is _clock))
    others = [(datetime, one.__name__, _dated(one, model)) for one in _DATES]
    others.append((os, "environ", _Environment(os.environ, model)))
    found |= {id(getattr(owner, name)): one for owner, name, one in others}
    yield from ((owner, name, value, found[id(value)]) for owner, name, value, _ in places)
    yield from ((owner, name, getattr(owner, name), one) for owner, name, one in others)
    for module in modules:
        for name, value in vars(module).items():
            if id(value) in found or isinstance(value, _GENERATORS):
                yield module, name, value, found.get(id(value)) or _Refusing()


def _functions(owner: ModuleType) -> Iterable[tuple[str, Callable]]:
    """Yield what draws numbers or makes what draws them; classes are asked for, too, and stay."""
    for name in owner.__all__:
        value = getattr(owner, name)
        if callable(value) and not isinstance(value, type):
            yield name, value


def _refusing(original: Callable, model: _Model, refused: Callable, only_now: bool = False) -> Callable:
    """Return a function that does the same, but not for the model; ``only_now``: where it is given nothing."""

    def function(*args: Any, **kwargs: Any) -> Any:
        if model.asks() and not (only_now and args):
            refused()
        return original(*args, **kwargs)

    return function


def _dated(original: Any, model: _Model) -> type:
    """Return the class of dates that tells the model no present one."""

    class Alike(type):
        def __instancecheck__(cls, one: Any) -> bool:
            return isinstance(one, original)

        def __subclasscheck__(cls, one: type) -> bool:
            return issubclass(one, original)

    def present(name: str) -> classmethod:
        def method(cls: type, *args: Any, **kwargs: Any) -> Any:
            if model.asks():
                _clock()
            return getattr(original, name)(*args, **kwargs)

        return classmethod(method)

    own = {name: present(name) for name in ("now", "today", "utcnow") if hasattr(original, name)}
    own["__new__"] = lambda cls, *args, **kwargs: original(*args, **kwargs)
    return Alike(original.__name__, (original,), own)


class _Environment:
    """Stands for the environment of the process."""

    def __init__(self, original: Any, model: _Model) -> None:
        self._original, self._model = original, model

    def __getattr__(self, name: str) -> Any:
        if self._model.asks():
            _environment()
        return getattr(self._original, name)


def _by_operator(name: str) -> Callable:
    def method(self: _Environment, *args: Any) -> Any:
        if self._model.asks():
            _environment()
        return getattr(self._original, name)(*args)

    return method


for _name in "getitem setitem delitem iter len contains eq or ror repr".split():
    setattr(_Environment, f"__{_name}__", _by_operator(f"__{_name}__"))
