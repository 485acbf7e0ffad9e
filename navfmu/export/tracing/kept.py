"""What a model keeps outside of its tasks: all that its functions reach and can change.

These are the variables of its modules, what is in their lists, dicts, sets and arrays, attributes of its classes and
objects, and what its functions hold (defaults, closures, attributes). In an FMU there is none of it: a task is traced
with what was there before, finds that again when it is traced anew, and leaves nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from functools import _lru_cache_wrapper, partial
from types import FunctionType, MethodType, ModuleType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from navfmu.export.tracing.rules import Scalar

_PLAIN = (bool, int, float, complex, str, bytes, np.generic)


class _Thing(NamedTuple):
    """Something that is kept: what it is called, itself, what it was then, and what is in it if that can change."""

    name: str
    itself: Any
    was: Any
    holds: dict[Any, Any] | None


class Kept:
    """What modules and a component keep at a time."""

    def __init__(self, modules: Iterable[ModuleType], component: type) -> None:
        self._modules, self._component = list(modules), component
        self._names = {module.__name__ for module in self._modules} | {component.__module__}
        self._sizes: dict[_lru_cache_wrapper, int] = {}  # of what functools.cache keeps, which nobody sees
        self._things = self._found()

    def later(self) -> Kept:
        """Return what the same keep now."""
        return Kept(self._modules, self._component)

    def restore(self) -> None:
        """Let everything be what it was."""
        for thing in self._things.values():
            if isinstance(thing.itself, np.ndarray):
                if not _same(thing.itself, thing.was):
                    np.copyto(thing.itself, thing.was)
            elif thing.holds is not None and _differs(self._inside(thing.itself), thing.holds):
                _fill(thing.itself, thing.holds)
        for cached, size in self._sizes.items():
            if cached.cache_info().currsize > size:
                cached.cache_clear()

    def added_to(self, before: Kept) -> Iterator[tuple[str, Any]]:
        """Yield what is kept that was not then, or was None: what it is called, and what it is."""
        for path, thing in self._things.items():
            old = before._things.get(path)
            if old is None or (old.was is None and thing.was is not None):
                yield thing.name, thing.itself

    def replaced_in(self, before: Kept) -> Iterator[tuple[str, Any]]:
        """Yield what was something else then, and what is gone: what it is called, and what it is."""
        for path, old in before._things.items():
            new = self._things.get(path)
            if old.was is not None and (new is None or not _same(new.was, old.was)):
                yield old.name, None if new is None else new.itself

    def _found(self) -> dict[tuple, _Thing]:
        found: dict[tuple, _Thing] = {}
        seen: set[int] = set()
        waiting: deque[tuple[tuple, str, Any]] = deque()
        roots = [(f"module {module.__name__}", module) for module in self._modules]
        for k, (name, root) in enumerate([*roots, (f"class {self._component.__name__}", self._component)]):
            waiting.append(((k,), name, root))
        while waiting:
            path, name, itself = waiting.popleft()
            if id(itself) in seen and not isinstance(itself, _PLAIN):
                continue
            seen.add(id(itself))
            holds = self._inside(itself)
            was = itself.copy() if isinstance(itself, np.ndarray) else itself
            if isinstance(itself, _lru_cache_wrapper):
                self._sizes[itself] = itself.cache_info().currsize
            found[path] = _Thing(name, itself, was, holds)
            has_names = len(path) == 1 or isinstance(itself, type | FunctionType)
            for key, part in (_parts(itself) if holds is None else holds).items():
                if not isinstance(part, ModuleType):
                    own = getattr(itself, "__qualname__", name)
                    waiting.append(((*path, key), f"'{key}' of {own}" if has_names else name, part))
        return found

    def _inside(self, itself: Any) -> dict[Any, Any] | None:
        """Return what something holds that can change, by keys; None if that is nothing."""
        if isinstance(itself, dict):
            return dict(itself)
        if isinstance(itself, list | deque):
            return dict(enumerate(itself))
        if isinstance(itself, set):
            return {element: element for element in itself}
        if isinstance(itself, FunctionType):
            return _of_function(itself) if itself.__globals__.get("__name__") in self._names else None
        if isinstance(itself, type):
            return _named(vars(itself)) if itself.__module__ in self._names else None
        if isinstance(itself, ModuleType):
            return _named(vars(itself))
        if type(itself).__module__ in self._names or isinstance(itself, SimpleNamespace):
            return _named({name: getattr(itself, name) for name in _slots(itself)} | getattr(itself, "__dict__", {}))
        return None


def is_traced(x: Any) -> bool:
    """Whether something is a traced value, or an array with one."""
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(type(e) is Scalar for e in x.ravel().tolist())
    return isinstance(x, Scalar)


def _named(attributes: dict[str, Any] | Any) -> dict[str, Any]:
    modules = (ModuleType,)  # one that is imported meanwhile becomes an attribute of its package
    return {k: v for k, v in attributes.items() if not (k.startswith("__") or isinstance(v, modules))}


def _slots(itself: Any) -> list[str]:
    found = []
    for one in type(itself).__mro__:
        slots = vars(one).get("__slots__", ())
        found += [slots] if isinstance(slots, str) else list(slots)
    return [name for name in found if hasattr(itself, name) and not name.startswith("__")]


def _of_function(function: FunctionType) -> dict[str, Any]:
    """Return what a function holds by the names that it has for it."""
    code, defaults = function.__code__, function.__defaults__ or ()
    found = dict(zip(code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount], defaults, strict=True))
    found |= function.__kwdefaults__ or {}
    for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        if cell != _EMPTY:
            found[name] = cell.cell_contents
    return found | vars(function)


_EMPTY = type((lambda x: lambda: x)(0).__closure__[0])()


def _parts(itself: Any) -> dict[Any, Any]:
    """Return what something consists of that cannot change itself."""
    if isinstance(itself, tuple):
        return dict(enumerate(itself))
    if isinstance(itself, partial):
        return {"func": itself.func, "args": itself.args, "keywords": itself.keywords}
    if isinstance(itself, MethodType):
        return {"self": itself.__self__, "function": itself.__func__}
    if isinstance(itself, property):
        return {"fget": itself.fget}
    if isinstance(itself, FunctionType | _lru_cache_wrapper | staticmethod | classmethod):
        return {"wrapped": itself.__wrapped__} if hasattr(itself, "__wrapped__") else {}
    return {}


def _fill(itself: Any, holds: dict[Any, Any]) -> None:
    """Put into something what it has held."""
    if isinstance(itself, dict):
        itself.clear()
        itself.update(holds)
    elif isinstance(itself, list | deque):
        itself.clear()
        itself.extend(holds.values())
    elif isinstance(itself, set):
        itself.clear()
        itself.update(holds)
    elif isinstance(itself, FunctionType):
        for name, cell in zip(itself.__code__.co_freevars, itself.__closure__ or (), strict=True):
            if name in holds:
                cell.cell_contents = holds[name]
        known = {*itself.__code__.co_freevars, *itself.__code__.co_varnames}
        _set_attributes(itself, {k: v for k, v in holds.items() if k not in known}, vars(itself))
    else:
        names = _named({name: getattr(itself, name) for name in _slots(itself)} | dict(getattr(itself, "__dict__", {})))
        _set_attributes(itself, holds, names)


def _set_attributes(itself: Any, holds: dict[str, Any], now: Iterable[str]) -> None:
    for name in set(now) - holds.keys():
        delattr(itself, name)
    for name, value in holds.items():
        if not hasattr(itself, name) or getattr(itself, name) is not value:
            setattr(itself, name, value)


def _differs(now: dict[Any, Any] | None, before: dict[Any, Any]) -> bool:
    return now is None or [*now] != [*before] or any(now[key] is not before[key] for key in before)


def _same(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        alike = one.dtype == other.dtype and one.shape == other.shape
        if one.dtype == object:
            return alike and all(map(_same, one.ravel().tolist(), other.ravel().tolist()))
        return alike and one.tobytes() == other.tobytes()
    if isinstance(one, _PLAIN):
        return one == other or (one != one and other != other)
    return isinstance(one, dict | list | set | deque | tuple) or type(one) is SimpleNamespace
