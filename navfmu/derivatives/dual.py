"""Arrays that know their derivatives: :class:`Dual` answers NumPy's protocols, so plain NumPy differentiates itself.

A Dual is a value and the :class:`~navfmu.derivatives.slopes.Slopes` of its elements. Its value goes through exactly the
NumPy calls that the code makes, whatever it consists of: floats, traced values, or Duals of a derivative further out.
``level`` tells the derivatives of nested calls apart: what is of a lower one is a constant for those above.

Views and copies are what NumPy makes of them: an assignment into ``F[0]`` changes ``F``. So every Dual is an array of
its own or shows ``places`` of another one, its ``root``.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, NoReturn
from weakref import WeakValueDictionary

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from navfmu.derivatives.slopes import Slopes
from navfmu.errors import NavfmuError
from navfmu.place import place

#: What differentiates a call: its key (a function; a ufunc; a ufunc and its method) -> rule. A rule gets the function
#: itself, the level and the arguments.
RULES: dict[Any, Callable] = {}
#: Those that may give back a view of their argument, which may depend on x later.
SHOWING: set[Callable] = set()


def refuse(what: str, remedy: str) -> NoReturn:
    """Raise the error for a construct that has no derivative."""
    raise NavfmuError(f"{place()}: {what}; {remedy}")


def _lost() -> NoReturn:
    refuse(
        "a value would lose its derivatives as a float (float(), math.*, a list where NumPy expects an array, np.array "
        "by a name of its own, an array that was made outside of the function, a variable of a component)",
        "use np.sin(x) for math.sin(x), np.array([...]) for a list, make arrays that are filled with np.zeros inside "
        "of the function, and use outside of it what jacobian returns",
    )


class Dual(NDArrayOperatorsMixin):
    """An array and its derivatives; see the module's first lines.

    Parameters
    ----------
    value
        The array, of any shape.
    slopes
        The derivatives of its elements in C order.
    level
        That of the call of ``jacobian`` to which they belong.
    """

    def __init__(self, value: Any, slopes: Slopes, level: int) -> None:
        self.value, self.slopes, self.level = value, slopes, level
        self.root = self

    @cached_property
    def places(self) -> np.ndarray:
        """The places of the elements, counted from 1, in the array of its own that this one shows, or is."""
        return np.arange(1, math.prod(self.value.shape) + 1).reshape(self.value.shape)

    @cached_property
    def views(self) -> WeakValueDictionary[int, Dual]:
        """The arrays that show this one."""
        return WeakValueDictionary()

    def showing(self, value: Any, places: np.ndarray) -> Dual:
        """Return an array that shows these places of the one that this one shows."""
        result = object.__new__(Dual)
        result.value, result.level = value, self.level
        result.root, result.places = self.root, places
        result.slopes = self.root.slopes.moved(places.ravel())
        self.root.views[id(result)] = result
        return result

    shape = property(lambda self: self.value.shape)
    ndim = property(lambda self: self.value.ndim)
    size = property(lambda self: self.value.size)
    dtype = property(lambda self: np.dtype(float))
    T = property(lambda self: np.transpose(self))

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **kwargs: Any) -> Any:
        result = _call(ufunc, None if method == "__call__" else method, inputs, kwargs)
        target = None if out is None else out[0]
        if target is None or (type(target) is not np.ndarray and target.ndim == 0):  # x += 1 of a number is x = x + 1
            return result
        if not isinstance(target, Dual):
            refuse(
                "a value with derivatives is stored in an array that was made outside of the function",
                "write x = x + y instead of x += y, or make the array with np.zeros inside of the function",
            )
        target[...] = result
        return target

    def __array_function__(self, function: Callable, types: Any, args: tuple, kwargs: dict) -> Any:
        return _call(function, None, args, kwargs)

    def __array__(self, *args: Any, **kwargs: Any) -> np.ndarray:
        if self.slopes.entries.size == 0:
            return np.asarray(self.value, *args, **kwargs)
        _lost()

    def __float__(self) -> float:
        if self.slopes.entries.size == 0:
            return float(self.value)
        _lost()

    def __complex__(self) -> complex:
        return complex(float(self))

    def __bool__(self) -> bool:
        return bool(self.value)

    def __int__(self) -> int:
        return int(self.value)

    def __index__(self) -> int:
        refuse("a value with derivatives is no index or count", "index with constants")

    def __round__(self, digits: int | None = None) -> Any:
        return round(self.value, digits)

    __hash__ = None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if self.slopes.entries.size == 0:
            return getattr(self.value, name)
        refuse(
            f".{name} of a value with derivatives is not known", "write it with NumPy's functions (see the tutorial)"
        )

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"Dual({self.value!r})"

    def __pow__(self, exponent: Any) -> Any:
        return _call(operator.pow, None, (self, exponent), {})  # of a number, ** is not np.power to the last bit

    def __rpow__(self, base: Any) -> Any:
        return _call(operator.pow, None, (base, self), {})

    def __getitem__(self, key: Any) -> Any:
        return shown(self, self.value[key], self.places[key])

    def __setitem__(self, key: Any, new: Any) -> None:
        places = np.asarray(self.places[key])
        new = np.array(new) if isinstance(new, list | tuple) else new
        more = max(np.ndim(new) - places.ndim, 0)  # NumPy lets leading axes of one element go
        new = np.broadcast_to(np.reshape(new, np.shape(new)[more:]) if more else new, places.shape)
        if isinstance(new, Dual) and new.level > self.level:
            refuse(
                "a value with derivatives is stored in an array that was made outside of the function",
                "make the array with np.zeros inside of the function",
            )
        root, same = self.root, isinstance(new, Dual) and new.level == self.level
        slopes = new.slopes if same else Slopes.none(places.size, root.slopes.pattern.shape[1])
        sources = root.places.copy()
        sources.reshape(-1)[places - 1] = root.size + 1 + np.arange(places.size).reshape(places.shape)
        root.value = np.concatenate([np.ravel(root.value), np.ravel(new.value if same else new)])[sources - 1]
        root.slopes = Slopes.joined([root.slopes, slopes]).moved(sources.ravel())
        for one in root.views.values():
            one.value = np.ravel(root.value)[one.places - 1]
            one.slopes = root.slopes.moved(one.places.ravel())

    def astype(self, dtype: Any, *args: Any, **kwargs: Any) -> Any:
        """Convert; whole numbers and truth values have no derivatives."""
        if np.dtype(dtype).kind not in "fiub":
            _lost()
        return np.copy(self) if np.dtype(dtype).kind == "f" else self.value.astype(dtype)

    def setflags(self, **flags: Any) -> None:
        """Refuse to be a variable of a component, which would be read-only from now on."""
        _lost()

    def reshape(self, *shape: Any, **kwargs: Any) -> Any:
        """Return the same elements in another shape."""
        return np.reshape(self, shape[0] if len(shape) == 1 else shape, **kwargs)

    def transpose(self, *axes: Any) -> Any:
        """Return the array with its axes in another order."""
        return np.transpose(self, (axes[0] if len(axes) == 1 else axes) or None)

    def flatten(self, order: str = "C") -> Any:
        """Return a copy with one axis."""
        return np.copy(np.ravel(self, order))

    def item(self, *index: Any) -> Any:
        """Return one element."""
        return np.ravel(self)[index[0] if len(index) == 1 else 0] if len(index) < 2 else self[index]

    def fill(self, value: Any) -> None:
        """Assign all elements."""
        self[...] = value


def _method(name: str) -> Callable:
    def method(self: Dual, *args: Any, **kwargs: Any) -> Any:
        return getattr(np, name)(self, *args, **kwargs)

    return method


for _name in """
all any argmax argmin clip copy cumprod cumsum diagonal dot max mean min prod ravel repeat round squeeze std sum
swapaxes take trace var
""".split():
    setattr(Dual, _name, _method(_name))


def shown(source: Dual, value: Any, places: Any) -> Any:
    """Return elements of an array: a view of it where NumPy makes one of its ``places``."""
    if isinstance(places, np.ndarray) and places.flags.writeable and np.may_share_memory(places, source.root.places):
        return source.showing(value, places)
    return dual(value, source.root.slopes.moved(np.ravel(places)), source.level)


def dual(value: Any, slopes: Slopes, level: int) -> Any:
    """Return a Dual, or the value where nothing of it depends on x."""
    return Dual(value, slopes, level) if slopes.entries.size else value


def duals(x: Any) -> Iterator[Dual]:
    """Yield the Duals in nested lists and tuples."""
    if isinstance(x, Dual):
        yield x
    elif isinstance(x, list | tuple):
        for one in x:
            yield from duals(one)


def has_duals(x: Any) -> bool:
    """Whether there is a Dual in nested lists and tuples."""
    return next(duals(x), None) is not None


def replaced(change: Callable[[Dual], Any], x: Any) -> Any:
    """Return nested lists and tuples with their Duals replaced by what ``change`` makes of them."""
    if isinstance(x, Dual):
        return change(x)
    return type(x)([replaced(change, one) for one in x]) if type(x) in (list, tuple) else x


def values(x: Any, level: int) -> Any:
    """Return what Duals of a level are in the values alone."""
    return replaced(lambda one: one.value if one.level == level else one, x)


def _without_slopes(one: Dual) -> Any:
    return one if one.slopes.entries.size else replaced(_without_slopes, one.value)


def _named(function: Callable) -> str:
    """The name of a function of NumPy as one writes it."""
    name = f"{getattr(function, '__module__', 'numpy')}.{function.__name__}"
    return name.replace("numpy", "np", 1).replace("np._core.umath", "np")


def _call(function: Callable, method: str | None, args: tuple, kwargs: dict) -> Any:
    """Return what a call of NumPy gives, with its derivatives; Duals that depend on nothing are their values."""
    call = getattr(function, method) if method else function
    given = list(duals([args, list(kwargs.values())]))
    if function not in SHOWING and any(one.slopes.entries.size == 0 for one in given):
        args = replaced(_without_slopes, args)
        kwargs = {key: replaced(_without_slopes, value) for key, value in kwargs.items()}
        given = list(duals([args, list(kwargs.values())]))
    if not given:
        return call(*args, **kwargs)
    key = (function, method) if method else function
    if kwargs.get("out") is not None:
        refuse(f"{_named(function)}(..., out=...) has no derivative", "assign the result to a name, or to x[...]")
    if isinstance(function, np.ufunc) and kwargs.get("where", True) is not True and method is None:
        refuse(f"{_named(function)}(..., where=...) has no derivative", "use np.where")
    if key not in RULES:
        remedy = _REMEDIES.get(function.__name__, "write it with the functions that have one (see the tutorial)")
        refuse(f"{_named(function)}{f'.{method}' if method else ''} has no derivative", remedy)
    return RULES[key](call, max(one.level for one in given), *args, **kwargs)


_REMEDIES = {
    "partition": "write np.sort",
    "percentile": "write np.sort",
    "quantile": "write np.sort",
    "lstsq": "solve the normal equations with np.linalg.solve",
    "pinv": "write np.linalg.solve(A.T @ A, A.T)",
    "copyto": "assign, x[...] = y",
}
