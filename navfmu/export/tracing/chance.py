"""Random numbers of NumPy and Python: while tracing, one that is drawn would be the same number at every tick."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Iterable, Iterator
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from navfmu.export.tracing.rules import refuse

_GENERATORS = np.random.Generator, np.random.RandomState, random.Random


def _drawn() -> NoReturn:
    refuse(
        "a random number that is drawn while the model is traced is the same at every tick",
        "let the task take noise: noise(n) are n standard normal numbers, fresh at each tick (constants are drawn "
        "outside of functions)",
    )


class _Refusing:
    """Stands for a generator of the model."""

    def __getattr__(self, name: str) -> NoReturn:
        _drawn()


def stand_ins(modules: list[ModuleType]) -> Iterator[tuple[ModuleType, str, Any, Any]]:
    """Yield what refuses the functions of the modules random numbers: owner, name, original and what stands for it."""
    names = {module.__name__ for module in modules}
    found = {id(function): _refusing(function, names) for _, function in _functions((np.random, random))}
    for owner in (np.random, random):
        yield from ((owner, name, value, found[id(value)]) for name, value in _functions([owner]))
    for module in modules:
        for name, value in vars(module).items():
            if id(value) in found or isinstance(value, _GENERATORS):
                yield module, name, value, found.get(id(value)) or _Refusing()


def _functions(owners: Iterable[ModuleType]) -> Iterator[tuple[str, Callable]]:
    """Yield what draws numbers or makes what draws them; classes are asked for, too, and stay."""
    for owner in owners:
        for name in owner.__all__:
            value = getattr(owner, name)
            if callable(value) and not isinstance(value, type):
                yield name, value


def _refusing(original: Callable, names: set[str]) -> Callable:
    def function(*args: Any, **kwargs: Any) -> Any:
        if sys._getframe(1).f_globals.get("__name__") in names:
            _drawn()
        return original(*args, **kwargs)

    return function
