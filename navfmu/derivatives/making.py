"""Arrays that are made inside of a function under differentiation: ``np.array([...])``, ``np.zeros``.

These are the calls that NumPy does not ask its arguments about. While a function is differentiated they stand for
others, which do the same and know derivatives.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from threading import RLock
from typing import Any

import numpy as np

from navfmu.derivatives.dual import RULES, Dual, dual, duals, has_duals, values
from navfmu.derivatives.slopes import Slopes
from navfmu.place import is_foreign

#: One thread at a time changes NumPy's names and changes them back. The lock is NumPy's, so to say: twins carry this
#: module under names of their own, and NumPy is all that they share.
LOCK: RLock = vars(np).setdefault("_navfmu_lock", RLock())

for _name in ("zeros_like", "ones_like", "empty_like", "full_like"):
    RULES[getattr(np, _name)] = lambda call, level, array, *args, **kwargs: call(values(array, level), *args, **kwargs)


def _joined(original: Callable, level: int, columns: int, *args: Any, **kwargs: Any) -> Any:
    """``np.array`` of nested lists: their elements in order."""
    given, more = (args[0], args[1:]) if args else (kwargs.pop("object", kwargs.pop("a", None)), ())
    if level not in {one.level for one in duals(given)}:
        return original(given, *more, **kwargs)
    dtype = np.dtype(more[0] if more else kwargs.get("dtype") or float)
    if isinstance(given, Dual):
        return given.astype(dtype)
    value = original(values(given, level), *more, **kwargs)
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


def _itself(original: Callable, level: int, columns: int, *args: Any, **kwargs: Any) -> Any:
    """``np.asarray``: of an array of numbers it is that array."""
    dtype = args[1] if len(args) > 1 else kwargs.get("dtype")
    if args and isinstance(args[0], Dual) and (dtype is None or np.dtype(dtype).kind == "f"):
        return args[0]
    return _joined(original, level, columns, *args, **kwargs)


def _fresh(original: Callable, level: int, columns: int, *args: Any, **kwargs: Any) -> Any:
    """An array that is made by the model's code: values with derivatives can be assigned into it."""
    fill = args[1] if len(args) > 1 else kwargs.get("fill_value")  # of np.full
    if has_duals(fill):
        shape = args[0] if isinstance(args[0], int | tuple | list) else np.shape(args[0])
        return np.copy(np.broadcast_to(fill, shape))
    array = original(*args, **kwargs)
    if array.dtype.kind not in "fO" or is_foreign(sys._getframe(1).f_code.co_filename):
        return array
    return Dual(array, Slopes.none(array.size, columns), level)


def _reducing(original: Callable, level: int, columns: int, a: Any, *args: Any, **kwargs: Any) -> Any:
    listed = isinstance(a, list | tuple) and has_duals(a)
    return original(np.array(a) if listed else a, *args, **kwargs)


_WAYS = {
    "array": _joined,
    **dict.fromkeys(("asarray", "asanyarray", "ascontiguousarray"), _itself),
    **dict.fromkeys(("zeros", "ones", "empty", "full", "eye", "identity"), _fresh),
    **dict.fromkeys(("zeros_like", "ones_like", "empty_like", "full_like"), _fresh),
    **dict.fromkeys(("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all"), _reducing),
}


@contextmanager
def making(level: int, columns: int) -> Iterator[None]:
    """Let arrays be made of values with derivatives by ``columns`` elements."""
    with LOCK:
        originals = {name: getattr(np, name) for name in _WAYS}
        try:
            for name, way in _WAYS.items():
                setattr(np, name, partial(way, originals[name], level, columns))
            yield
        finally:
            for name, original in originals.items():
                setattr(np, name, original)
