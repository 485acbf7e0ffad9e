"""Arrays that are made inside of a function under differentiation: ``np.array([...])``, ``np.zeros``.

These are the calls that NumPy does not ask its arguments about. While a function is differentiated they stand for
others, which do the same and know derivatives; only in the thread that differentiates, and only until it is done, also
where a module that is imported meanwhile keeps them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from threading import RLock, get_ident
from typing import Any, NamedTuple

import numpy as np

from navfmu.derivatives.dual import RULES, Dual, dual, duals, has_duals, values
from navfmu.derivatives.slopes import Slopes
from navfmu.place import is_foreign

#: One thread at a time changes NumPy's names and changes them back. The lock is NumPy's, so to say: twins carry this
#: module under names of their own, and NumPy is all that they share.
LOCK: RLock = vars(np).setdefault("_navfmu_lock", RLock())

for _name in ("zeros_like", "ones_like", "empty_like", "full_like"):
    RULES[getattr(np, _name)] = lambda call, level, array, *args, **kwargs: call(values(array, level), *args, **kwargs)


class _Running(NamedTuple):
    """A call of ``jacobian`` that is running."""

    level: int
    columns: int
    thread: int
    originals: dict[str, Callable]


_running: list[_Running] = []  # the innermost one last


def _joined(original: Callable, *args: Any, **kwargs: Any) -> Any:
    """``np.array`` of nested lists: their elements in order."""
    given, more = (args[0], args[1:]) if args else (kwargs.pop("object", kwargs.pop("a", None)), ())
    found = list(duals(given))
    if not found:
        return original(given, *more, **kwargs)
    dtype = np.dtype(more[0] if more else kwargs.get("dtype") or float)
    if isinstance(given, Dual):
        return given.astype(dtype)
    level = max(one.level for one in found)
    columns = next(one for one in found if one.level == level).slopes.pattern.shape[1]
    value = _joined(original, values(given, level), *more, **kwargs)
    leaves: list[Slopes] = []

    def collect(x: Any) -> None:
        if isinstance(x, list | tuple):
            for one in x:
                collect(one)
        else:
            own = isinstance(x, Dual) and x.level == level
            leaves.append(x.slopes if own else Slopes.none(np.size(x), columns))

    collect(given)
    return dual(value, Slopes.joined(leaves), level) if dtype.kind == "f" else value


def _itself(original: Callable, *args: Any, **kwargs: Any) -> Any:
    """``np.asarray``: of an array of numbers it is that array."""
    dtype = args[1] if len(args) > 1 else kwargs.get("dtype")
    if args and isinstance(args[0], Dual) and (dtype is None or np.dtype(dtype).kind == "f"):
        return args[0]
    return _joined(original, *args, **kwargs)


def _fresh(original: Callable, *args: Any, **kwargs: Any) -> Any:
    """An array that is made by the model's code: values with derivatives can be assigned into it."""
    fill = args[1] if len(args) > 1 else kwargs.get("fill_value")  # of np.full
    if has_duals(fill):
        shape = args[0] if isinstance(args[0], int | tuple | list) else np.shape(args[0])
        return np.copy(np.broadcast_to(fill, shape))
    array = original(*args, **kwargs)
    if array.dtype.kind not in "fO" or is_foreign(sys._getframe(2).f_code.co_filename):
        return array
    innermost = _running[-1]
    return Dual(array, Slopes.none(array.size, innermost.columns), innermost.level)


def _reducing(original: Callable, a: Any, *args: Any, **kwargs: Any) -> Any:
    listed = isinstance(a, list | tuple) and has_duals(a)
    return original(np.array(a) if listed else a, *args, **kwargs)


_WAYS = {
    "array": _joined,
    **dict.fromkeys(("asarray", "asanyarray", "ascontiguousarray"), _itself),
    **dict.fromkeys(("zeros", "ones", "empty", "full", "eye", "identity"), _fresh),
    **dict.fromkeys(("zeros_like", "ones_like", "empty_like", "full_like"), _fresh),
    **dict.fromkeys(("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all"), _reducing),
}


def _replacement(name: str, way: Callable) -> Callable:
    numpys = getattr(np, name)

    @wraps(numpys)
    def function(*args: Any, **kwargs: Any) -> Any:
        for innermost in _running[-1:]:
            original = innermost.originals[name]
            return way(original, *args, **kwargs) if innermost.thread == get_ident() else original(*args, **kwargs)
        return numpys(*args, **kwargs)

    return function


_REPLACEMENTS = {name: _replacement(name, way) for name, way in _WAYS.items()}


@contextmanager
def making(level: int, columns: int) -> Iterator[None]:
    """Let arrays be made of values with derivatives by ``columns`` elements."""
    with LOCK:
        before = {name: getattr(np, name) for name in _REPLACEMENTS}
        originals = dict(before)
        if _running:  # of a nested one, too, the originals are those of the outermost
            originals |= {n: _running[-1].originals[n] for n, own in before.items() if own is _REPLACEMENTS[n]}
        _running.append(_Running(level, columns, get_ident(), originals))
        try:
            for name, function in _REPLACEMENTS.items():
                setattr(np, name, function)
            yield
        finally:
            _running.pop()
            for name, function in before.items():
                setattr(np, name, function)
