"""Traced arrays: an ``ndarray`` of dtype object whose elements are Python numbers (constants) or :class:`Scalar`.

:class:`Traced` answers NumPy's own protocols, ``__array_ufunc__`` (``ufuncs.py``) and ``__array_function__``
(``functions.py``), so a model that knows nothing of tracing traces as it stands.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from navfmu.export.record import arrays, graph
from navfmu.export.record.graph import Node
from navfmu.export.tracing import wholes
from navfmu.export.tracing.extent import current
from navfmu.export.tracing.rules import (
    Scalar,
    expression,
    is_boolean,
    is_whole,
    number,
    refuse,
    scalar_power,
    truth,
    whole,
)
from navfmu.export.tracing.selected import Selected


def unwrapped(element: Any) -> Any:
    """Return an element as a Python number or Scalar: NumPy's scalars and arrays without axes hold one."""
    if isinstance(element, np.generic):
        return element.item()
    if isinstance(element, np.ndarray) and element.ndim == 0:
        return unwrapped(element.item())
    return element


def objects(x: Any) -> np.ndarray:
    """Return ``x`` as a base-class object array of Python numbers and Scalars."""
    if isinstance(x, np.ndarray):
        if x.dtype != object:
            return x.astype(object).view(np.ndarray)
        array = x.view(np.ndarray)
    else:
        array = _ARRAY(x, dtype=object)
    if any(isinstance(e, np.generic | np.ndarray) for e in array.ravel().tolist()):
        return built(array.shape, [unwrapped(e) for e in array.ravel().tolist()]).view(np.ndarray)
    return array


def uniform(elements: list) -> list:
    """Return truth values only, whole numbers only or real numbers only: an array has one type."""
    return elements if all(is_boolean(e) for e in elements) else as_numbers(elements)


def as_numbers(elements: list) -> list:
    """Return whole numbers only, or real numbers only."""
    return [whole(e) for e in elements] if all(is_whole(e) for e in elements) else [number(e) for e in elements]


def type_of(array: Any) -> type:
    """Return the type that an array has in NumPy: bool, int or float."""
    elements = objects(array).ravel().tolist()
    if not elements or not all(is_whole(e) for e in elements):
        return float
    return bool if all(is_boolean(e) for e in elements) else int


def _all_boolean(array: np.ndarray) -> bool:
    return type_of(array) is bool


def built(shape: tuple[int, ...], elements: list) -> Traced:
    """Return elements as a traced array of a shape, all of one type."""
    return filled(shape, uniform(elements))


def filled(shape: tuple[int, ...], elements: list) -> Traced:
    """Return elements, which are of one type already, as a traced array of a shape."""
    result = np.empty(len(elements), object)
    for i, element in enumerate(elements):
        result[i] = element
    return result.reshape(shape).view(Traced)


def wrapped(x: Any) -> Any:
    """Return base-class object arrays, also in lists and tuples, as traced arrays."""
    if isinstance(x, Scalar):
        return built((), [x])
    if isinstance(x, np.ndarray) and x.dtype == object:
        found = built(x.shape, objects(x).ravel().tolist())
        same = all(map(operator.is_, found.ravel().tolist(), x.ravel().tolist()))
        return x if same and isinstance(x, Traced) else found  # a view stays one: what is assigned to it is seen
    if isinstance(x, tuple | list):
        return type(x)(wrapped(e) for e in x)
    return x


def others(types: Iterable[type]) -> bool:
    """Whether there is a type among them that answers NumPy's protocols itself and may know what to do."""
    return any(hasattr(t, "__array_ufunc__") and not issubclass(t, np.ndarray | np.generic | Scalar) for t in types)


def contains_traced(x: Any) -> bool:
    """Whether nested lists, tuples or arrays hold a traced value."""
    if isinstance(x, Traced | Scalar):
        return True
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(e, Scalar) for e in x.ravel().tolist())
    return isinstance(x, list | tuple) and any(contains_traced(e) for e in x)


def has_symbols(x: Any) -> bool:
    """Whether nested lists, tuples, dicts or arrays hold a value that is not known while tracing."""
    if isinstance(x, Traced) or (isinstance(x, np.ndarray) and x.dtype == object):
        return any(type(e) is Scalar for e in x.ravel().tolist())
    if isinstance(x, dict):
        return any(has_symbols(e) for e in x.values())
    return isinstance(x, Scalar) or (isinstance(x, list | tuple) and any(has_symbols(e) for e in x))


def as_numpy(x: Any) -> Any:
    """Return traced arrays of constants as NumPy's, also in lists, tuples and dicts."""
    if isinstance(x, Traced):
        return np.array(x.view(np.ndarray).tolist(), type_of(x)).reshape(x.shape)
    if isinstance(x, dict):
        return {key: as_numpy(e) for key, e in x.items()}
    return type(x)(as_numpy(e) for e in x) if type(x) in (list, tuple) else x


def as_fresh(x: Any) -> Any:
    """Return what NumPy has made of such arrays as what can be assigned to, like these."""
    if type(x) in (list, tuple):
        return type(x)(as_fresh(e) for e in x)
    return x.astype(object).view(Traced) if type(x) is np.ndarray and x.dtype in (float, bool) else x


def at_each_place(rule: Callable, columns: list[list], shape: tuple[int, ...]) -> Traced:
    """Apply a rule at each place of columns of elements; in one node where arrays are kept whole."""
    if is_kept_whole(math.prod(shape), *columns):
        return filled(shape, wholes.mapped(rule, columns, shape))
    return built(shape, [rule(*elements) for elements in zip(*columns, strict=True)])


def is_kept_whole(size: int, *columns: list) -> bool:
    """Return whether what is calculated from columns of elements becomes one node.

    It must be large, and while most arrays are single numbers it must read what lies together already: to gather
    numbers from many places costs more than a loop saves.
    """
    extent = current()
    extent.meet(size)
    return size >= extent.whole and (extent.calls or all(wholes.lies_together(column) for column in columns))


def broadcast_columns(inputs: Iterable) -> tuple[list[list], tuple[int, ...]]:
    """Return the elements of arrays that are broadcast to one shape, and that shape."""
    given = [objects(x) for x in inputs]
    shape = np.broadcast_shapes(*[a.shape for a in given])
    return [np.broadcast_to(a, shape).ravel().tolist() for a in given], shape


def _known(key: Any) -> Any:
    """Return an index with traced arrays that are constants, and have no traced value, as NumPy's."""
    if isinstance(key, tuple):
        return tuple(map(_known, key))
    if isinstance(key, Traced) and not any(type(e) is Scalar for e in key.ravel().tolist()):
        return np.array(key.view(np.ndarray).tolist(), type_of(key)).reshape(key.shape)[()]
    return key


def _refused(name: str, remedy: str) -> Callable:
    def method(self: Traced, *args: Any, **kwargs: Any) -> Any:
        if has_symbols((self, args, kwargs)):
            refuse(f".{name}() depends on values and cannot be traced", remedy)
        return getattr(as_numpy(self), name)(*args, **kwargs)

    return method


class Traced(np.ndarray):
    """An array of traced numbers; see the module's first lines."""

    __array_priority__ = 1000.0

    def __getitem__(self, key: Any) -> Any:
        key = _known(key)
        if isinstance(key, Traced) and type_of(key) is bool and key.shape == self.shape[: key.ndim]:
            return Selected(key, self)
        if contains_traced(key):
            refuse("an array is indexed with a traced value", "select with np.where, or index with constants")
        result = super().__getitem__(key)
        return result if isinstance(result, Traced) else built((), [result])

    def __setitem__(self, key: Any, value: Any) -> None:
        if not self.flags.writeable:
            refuse("a variable's array is read-only", "assign a whole new array: self.x = np.array([...])")
        key = _known(key)
        if isinstance(key, Traced) and type_of(key) is bool and key.shape == self.shape[: key.ndim]:
            mask = key.reshape(key.shape + (1,) * (self.ndim - key.ndim))
            if isinstance(value, Selected):
                value = value.at(key)
            elif np.ndim(value) > self.ndim - key.ndim:
                refuse(
                    "what is assigned where a traced mask holds has as many elements as the mask holds for",
                    "assign one value, x = np.where(mask, values, x), or x[mask] = values[mask]",
                )
            key, value = ..., np.where(mask, value, self)
        if contains_traced(key):
            refuse("an array is indexed with a traced value", "select with np.where, or index with constants")
        value = objects(value)
        value = value.view(Traced).astype(type_of(self)).view(np.ndarray)
        super().__setitem__(key, value.item() if value.ndim == 0 else value)

    def __iter__(self) -> Iterator[Traced]:
        return (self[i] for i in range(len(self)))

    def _only(self) -> Any:
        if self.size != 1:
            raise TypeError("only arrays of one element can be converted to a Python number")
        return self.reshape(-1).view(np.ndarray)[0]

    def __bool__(self) -> bool:
        return bool(self._only())

    def __float__(self) -> float:
        return float(self._only())

    def __int__(self) -> int:
        return int(self._only())

    def __index__(self) -> int:
        return self._only().__index__()

    def __complex__(self) -> complex:
        return complex(self._only())

    def __round__(self, digits: int | None = None) -> Traced:
        return self.round(digits or 0).astype(int if digits is None else float)

    def __hash__(self) -> int:
        refuse("a traced value cannot be a key of a dict or set", "select with np.where")

    def astype(
        self, dtype: Any, order: Any = "K", casting: Any = "unsafe", subok: bool = True, copy: Any = True
    ) -> Any:
        """Convert between truth values, whole numbers and real numbers."""
        kind = np.dtype(dtype).kind
        if not copy and np.dtype(dtype) == type_of(self):
            return self
        elements = self.ravel().tolist()
        if kind == "b":
            return at_each_place(truth, [elements], self.shape)
        if np.dtype(dtype) not in (np.float64, np.int64):
            refuse(f"numbers of type {np.dtype(dtype)} are not traced", "use float, int or bool")
        if kind == "f":
            return built(self.shape, [number(e) for e in elements])
        if all(is_whole(e) for e in elements):
            return built(self.shape, [whole(e) for e in elements])
        return np.where(np.abs(self) < 2.0**63, whole_numbers(np.trunc(self)), -(2**63))  # as x86 does, for NaN too

    def __pow__(self, exponent: Any) -> Traced:
        if self.ndim or np.ndim(exponent) or isinstance(exponent, Traced):
            return np.power(self, exponent)
        return built((), [scalar_power(self._only(), unwrapped(exponent))])

    def fill(self, value: Any) -> None:
        """Set all elements."""
        self[...] = value

    def dot(self, other: Any) -> Traced:
        """Matrix product."""
        return np.dot(self, other)

    def mean(self, axis: Any = None, keepdims: bool = False) -> Traced:
        """Sum divided by the number of elements."""
        return np.mean(self, axis=axis, keepdims=keepdims)

    def round(self, decimals: int = 0, out: None = None) -> Traced:
        """Nearest whole numbers, halves to even."""
        if decimals or out is not None:
            refuse("rounding to decimals is not traced", "scale, then np.rint")
        return self if type_of(self) is int else np.rint(self)

    def argmax(self, axis: Any = None, out: None = None, *, keepdims: bool = False) -> Traced:
        """Index of the first largest element."""
        return np.argmax(self, axis=axis, keepdims=keepdims)

    def argmin(self, axis: Any = None, out: None = None, *, keepdims: bool = False) -> Traced:
        """Index of the first smallest element."""
        return np.argmin(self, axis=axis, keepdims=keepdims)

    def var(self, axis: Any = None, ddof: float = 0, keepdims: bool = False) -> Traced:
        """Mean square of what the elements are away from their mean."""
        return np.var(self, axis=axis, ddof=ddof, keepdims=keepdims)

    def std(self, axis: Any = None, ddof: float = 0, keepdims: bool = False) -> Traced:
        """Square root of the variance."""
        return np.sqrt(self.var(axis, ddof, keepdims))

    def sort(self, axis: int = -1) -> None:
        """Put the elements in order, in place."""
        self[...] = np.sort(self, axis=axis)

    argsort = _refused("argsort", "order the values themselves with np.sort, or select with np.where")
    nonzero = _refused("nonzero", "select with np.where")
    searchsorted = _refused("searchsorted", "look the row up with a Table")


def _in_place(name: str) -> Callable:
    """Return ``x += y`` and its kin: a lone number gets a new one, as NumPy's do, where an array is changed."""
    new, changed = getattr(operator, name), getattr(np.ndarray, f"__i{name.strip('_')}__")
    return lambda self, other: changed(self, other) if self.ndim else new(self, other)


for _name in "add sub mul truediv floordiv mod pow matmul and_ or_ xor".split():
    setattr(Traced, f"__i{_name.strip('_')}__", _in_place(_name))

_ARRAY = np.array


def symbols(vector: str, kinds: str, first: int = 0) -> Traced:
    """Return elements of a vector, from ``first`` on, as a traced array; ``kinds`` has a letter for each: real "f",
    whole "i" or truth value "b".
    """
    return filled((len(kinds),), [Scalar(graph.element(vector, first + i), kind) for i, kind in enumerate(kinds)])


def whole_numbers(array: Any) -> Traced:
    """Return numbers that have no fractions as NumPy's integers."""
    return at_each_place(
        lambda e: e if type(e) is float else whole(e), [objects(array).ravel().tolist()], np.shape(array)
    )


def routine(
    name: str,
    operands: Iterable[Any],
    shape: tuple[int, ...],
    kind: str = "f",
    numbers: tuple[int, ...] = (),
    before: tuple[str, ...] = (),
) -> Traced:
    """Return an array of this shape that a C function of the runtime calculates: ``name(*before, *numbers, *operands,
    r)``.

    An operand is ``const double *`` with its elements in C order, or ``double`` if it has no axes; ``numbers`` are
    ints, and ``before`` are texts, names of what the function of a task is given. ``r`` is the result. Whether it is
    called, and how often, must make no difference: it only calculates.
    """
    given = [objects(x) for x in operands]
    columns = [as_numbers(x.ravel().tolist()) for x in given]
    read = [wholes.block(c) if x.ndim else wholes.operand(c) for x, c in zip(given, columns, strict=True)]
    values = frozenset(k for k, x in enumerate(given) if not x.ndim)
    how = arrays.Routine(name, tuple(numbers), tuple(before), values)
    return filled(shape, wholes.elements(wholes.made(how, math.prod(shape), read), kind))


def expressions(array: Any) -> list[Node]:
    """Return the nodes of the elements of an array, in C order."""
    return [expression(e) for e in objects(array).ravel().tolist()]
