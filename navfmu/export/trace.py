"""Tracing: plain NumPy code, run once on symbolic numbers, becomes a graph of operations.

:class:`Traced` is an ``ndarray`` of dtype object whose elements are Python numbers (constants) or :class:`Scalar`
(a node of the graph). It answers NumPy's own protocols, ``__array_ufunc__`` and ``__array_function__``, so a model that
knows nothing of tracing traces as it stands. Constants are folded here and nothing else is rewritten, so that a traced
function does the operations of the NumPy code in the order of the NumPy code.

What cannot be traced (a value-dependent ``if``, ``float()``, ``math.sin``, a traced value stored in a float array)
raises :class:`~navfmu.errors.NavfmuError` with file, line and remedy; nothing becomes a silent NaN.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from threading import RLock
from types import ModuleType
from typing import Any

import numpy as np

from navfmu.export import arrays, calls, graph
from navfmu.export.extent import current
from navfmu.export.graph import Node
from navfmu.export.rules import (
    RULES,
    Scalar,
    add,
    expression,
    fold,
    is_boolean,
    is_whole,
    number,
    refuse,
    scalar_power,
    truth,
    where,
    whole,
)


def _unwrap(element: Any) -> Any:
    if isinstance(element, np.generic):
        return element.item()
    if isinstance(element, np.ndarray) and element.ndim == 0:
        return _unwrap(element.item())
    return element


def _object(x: Any) -> np.ndarray:
    """Return ``x`` as a base-class object array of Python numbers and Scalars."""
    if isinstance(x, np.ndarray):
        if x.dtype != object:
            return x.astype(object).view(np.ndarray)
        array = x.view(np.ndarray)
    else:
        array = _ARRAY(x, dtype=object)
    if any(isinstance(e, np.generic | np.ndarray) for e in array.ravel().tolist()):
        return _build(array.shape, [_unwrap(e) for e in array.ravel().tolist()]).view(np.ndarray)
    return array


def _uniform(elements: list) -> list:
    """Return truth values only, whole numbers only or real numbers only: an array has one type."""
    return elements if all(is_boolean(e) for e in elements) else _numbers(elements)


def _numbers(elements: list) -> list:
    """Return whole numbers only, or real numbers only."""
    return [whole(e) for e in elements] if all(is_whole(e) for e in elements) else [number(e) for e in elements]


def _dtype(array: Any) -> type:
    """Return the type that an array has in NumPy: bool, int or float."""
    elements = _object(array).ravel().tolist()
    if not elements or not all(is_whole(e) for e in elements):
        return float
    return bool if all(is_boolean(e) for e in elements) else int


def _all_boolean(array: np.ndarray) -> bool:
    return _dtype(array) is bool


def _build(shape: tuple[int, ...], elements: list) -> Traced:
    return _fill(shape, _uniform(elements))


def _fill(shape: tuple[int, ...], elements: list) -> Traced:
    result = np.empty(len(elements), object)
    for i, element in enumerate(elements):
        result[i] = element
    return result.reshape(shape).view(Traced)


def _wrap(x: Any) -> Any:
    if isinstance(x, Scalar):
        return _build((), [x])
    if isinstance(x, np.ndarray):
        return _build(x.shape, _object(x).ravel().tolist()) if x.dtype == object else x
    if isinstance(x, tuple | list):
        return type(x)(_wrap(e) for e in x)
    return x


def contains_traced(x: Any) -> bool:
    """Whether nested lists, tuples or arrays hold a traced value."""
    if isinstance(x, Traced | Scalar):
        return True
    if isinstance(x, np.ndarray):
        return x.dtype == object and any(isinstance(e, Scalar) for e in x.ravel().tolist())
    return isinstance(x, list | tuple) and any(contains_traced(e) for e in x)


def _apply(ufunc: np.ufunc, elements: tuple) -> Any:
    if any(type(e) is Scalar for e in elements):
        return RULES[ufunc](*elements)
    return fold(ufunc, *elements)


def _places(rule: Callable, columns: list[list], shape: tuple[int, ...]) -> Traced:
    """Apply a rule at each place of columns of elements; in one node where arrays are kept whole."""
    if _whole(math.prod(shape)):
        return _fill(shape, arrays.mapped(rule, columns, shape))
    return _build(shape, [rule(*elements) for elements in zip(*columns, strict=True)])


def _whole(size: int) -> bool:
    least = current().whole
    return least is not None and size >= least


def _columns(inputs: Iterable) -> tuple[list[list], tuple[int, ...]]:
    """Return the elements of arrays that are broadcast to one shape, and that shape."""
    given = [_object(x) for x in inputs]
    shape = np.broadcast_shapes(*[a.shape for a in given])
    return [np.broadcast_to(a, shape).ravel().tolist() for a in given], shape


def _elementwise(ufunc: np.ufunc, inputs: tuple) -> Traced:
    columns, shape = _columns(inputs)
    if ufunc in (np.add, np.subtract, np.negative) and all(c and all(map(is_boolean, c)) for c in columns):
        if ufunc is not np.add:
            refuse("NumPy does not subtract truth values", "use ^ or np.logical_xor, or ~")
        ufunc = np.logical_or  # what NumPy does for bool + bool
    if ufunc is np.power and not arrays.uniform(columns[1]):  # each exponent has a rule of its own
        return _build(shape, [_apply(ufunc, elements) for elements in zip(*columns, strict=True)])
    return _places(lambda *elements: _apply(ufunc, elements), columns, shape)


def _fold_list(ufunc: np.ufunc, elements: list) -> Any:
    result = elements[0]
    for element in elements[1:]:
        result = _apply(ufunc, (result, element))
    return result


def _pairwise(elements: list) -> Any:
    """Sum in the order of NumPy's pairwise summation."""
    n = len(elements)
    if n < 8:
        return _fold_list(np.add, elements)
    if n <= 128:
        r, whole = elements[:8], n - n % 8
        for i in range(8, whole, 8):
            r = [add(a, b) for a, b in zip(r, elements[i : i + 8], strict=True)]
        pairs = [add(r[i], r[i + 1]) for i in range(0, 8, 2)]
        return _fold_list(np.add, [add(add(pairs[0], pairs[1]), add(pairs[2], pairs[3])), *elements[whole:]])
    half = n // 2 - (n // 2) % 8
    return add(_pairwise(elements[:half]), _pairwise(elements[half:]))


_EMPTY = {np.add: 0.0, np.multiply: 1.0, np.logical_and: True, np.logical_or: False}


def _reduce(ufunc: np.ufunc, array: Any, kwargs: dict) -> Any:
    array = _object(array)
    axis = kwargs.get("axis", 0)
    axes = tuple(range(array.ndim)) if axis is None else tuple(np.atleast_1d(axis) % max(array.ndim, 1))
    kept = [i for i in range(array.ndim) if i not in axes]
    shape = [array.shape[i] for i in kept]
    rows = array.transpose(kept + list(axes)).reshape(math.prod(shape), math.prod(array.shape[i] for i in axes))
    fast = not kept or (array.ndim - 1) in axes  # NumPy adds pairwise along the fast axis only
    initial = kwargs.get("initial", np._NoValue)
    given = initial is not np._NoValue and initial is not None
    if kwargs.get("keepdims"):
        shape = [1 if i in axes else array.shape[i] for i in range(array.ndim)]
    if _whole(rows.size) and rows.shape[1] > 1:
        return _fill(tuple(shape), _fold_whole(ufunc, rows, fast, initial if given else None))
    results = []
    for row in rows.tolist():
        if ufunc in (np.add, np.multiply):
            row = _numbers(row)
        elif ufunc in (np.logical_and, np.logical_or):
            row = [truth(e) for e in row]
        first = np.array(initial).astype(_dtype(row)).item() if given else _EMPTY.get(ufunc)
        if first is None and not row:
            refuse(f"np.{ufunc.__name__} of an array without elements has no result", "give it elements")
        if ufunc is np.add and fast and row:
            row = [_pairwise(row)]
        begins = given or not row or (ufunc is np.add and not is_whole(row[0]))  # so a sum of -0.0 alone is 0.0
        results.append(_fold_list(ufunc, [first, *row] if begins else row))
    return _build(tuple(shape), results)


def _fold_whole(ufunc: np.ufunc, rows: np.ndarray, fast: bool, initial: Any) -> list:
    column = rows.ravel().tolist()
    if ufunc in (np.add, np.multiply):
        column = _numbers(column)
    elif ufunc in (np.logical_and, np.logical_or):
        column = _places(truth, [column], (len(column),)).view(np.ndarray).tolist()
    real = not all(map(is_whole, column))
    first = None
    if initial is not None:
        first = float(np.array(initial).astype(_dtype(np.array(column, object))).item())
    elif ufunc is np.add and real:
        first = 0.0
    pairwise = ufunc is np.add and fast
    return arrays.folded(lambda a, b: _apply(ufunc, (a, b)), column, *rows.shape, first, pairwise)


def _accumulate(ufunc: np.ufunc, array: Any, kwargs: dict) -> Traced:
    array = _object(array)
    moved = np.moveaxis(array, kwargs.get("axis", 0), -1)
    if _whole(moved.size) and moved.shape[-1] > 1:
        column, length = _numbers(moved.ravel().tolist()), moved.shape[-1]
        rows = arrays.accumulated(lambda a, b: _apply(ufunc, (a, b)), column, len(column) // length, length)
        return np.moveaxis(_fill(moved.shape, rows), -1, kwargs.get("axis", 0))
    rows = []
    for row in moved.reshape(-1, moved.shape[-1]).tolist():
        row = _numbers(row)
        sums = row[:1]
        for element in row[1:]:
            sums.append(_apply(ufunc, (sums[-1], element)))
        rows.extend(sums)
    return np.moveaxis(_build(moved.shape, rows), -1, kwargs.get("axis", 0))


def _product(function: Callable, a: Any, b: Any) -> Any:
    a, b = _object(a), _object(b)
    if _all_boolean(a) and _all_boolean(b):
        refuse("NumPy's product of arrays of truth values is no count", "multiply a.astype(float)")
    if current().whole is not None and a.ndim and b.ndim:
        return _MATRICES[function](a, b)
    return _multiply(function, a, b)


def _multiply(function: Callable, a: np.ndarray, b: np.ndarray) -> Traced:
    products = _object(function(a.view(np.ndarray), b.view(np.ndarray)))
    sums = _numbers(products.ravel().tolist())
    return _build(products.shape, [e if is_whole(e) else add(0.0, e) for e in sums])  # sums begin at 0.0


def _matrix_product(a: np.ndarray, b: np.ndarray) -> Traced:
    """Product of two matrices, in one node if it is large."""
    (rows, inner), columns = a.shape, b.shape[1]
    if inner != len(b) or not _whole(rows * inner * columns // (current().whole or 1)):
        return _multiply(np.matmul, a, b)
    elements = arrays.multiplied(_numbers(a.ravel().tolist()), _numbers(b.ravel().tolist()), rows, inner, columns)
    return _fill((rows, columns), elements)


def _matmul(a: np.ndarray, b: np.ndarray) -> Traced:
    first, second = a[None] if a.ndim == 1 else a, b[:, None] if b.ndim == 1 else b
    stack = np.broadcast_shapes(first.shape[:-2], second.shape[:-2])
    pairs = [np.broadcast_to(x, stack + x.shape[-2:]).reshape(-1, *x.shape[-2:]) for x in (first, second)]
    products = [_matrix_product(x, y) for x, y in zip(*pairs, strict=True)]
    shape = stack + first.shape[-2 : -1 if a.ndim > 1 else -2] + second.shape[-1 if b.ndim > 1 else second.ndim :]
    return _fill(shape, [e for product in products for e in product.ravel().tolist()])


def _dot(a: np.ndarray, b: np.ndarray) -> Traced:
    columns = np.moveaxis(b, -2, 0) if b.ndim > 1 else b[:, None]
    shape = a.shape[:-1] + (b.shape[:-2] + b.shape[-1:] if b.ndim > 1 else ())
    return _matrix_product(a.reshape(-1, a.shape[-1]), columns.reshape(len(columns), -1)).reshape(shape)


def _inner(a: np.ndarray, b: np.ndarray) -> Traced:
    product = _matrix_product(a.reshape(-1, a.shape[-1]), b.reshape(-1, b.shape[-1]).T)
    return product.reshape(a.shape[:-1] + b.shape[:-1])


_MATRICES: dict[Callable, Callable] = {np.matmul: _matmul, np.dot: _dot, np.inner: _inner}


def _np_tensordot(a: Any, b: Any, axes: Any = 2) -> Any:
    a, b = np.asarray(a), np.asarray(b)
    if np.ndim(axes) == 0:
        axes = range(a.ndim - axes, a.ndim), range(axes)
    ours, theirs = ([int(i) % x.ndim for i in np.atleast_1d(list(axis))] for axis, x in zip(axes, (a, b), strict=True))
    kept = [[i for i in range(x.ndim) if i not in gone] for x, gone in ((a, ours), (b, theirs))]
    first, second = np.transpose(a, kept[0] + ours), np.transpose(b, theirs + kept[1])
    shape = first.shape[: len(kept[0])] + second.shape[len(theirs) :]
    inner = math.prod(first.shape[len(kept[0]) :])
    return np.dot(first.reshape(-1, inner), second.reshape(inner, -1)).reshape(shape)


def _ufunc(ufunc: np.ufunc, method: str, inputs: tuple, kwargs: dict) -> Any:
    out = kwargs.pop("out", None)
    if kwargs.get("where", True) is not True:
        refuse(f"np.{ufunc.__name__}(..., where=...) is not traced", "use np.where")
    if ufunc is not np.matmul and ufunc not in RULES:
        refuse(f"np.{ufunc.__name__} cannot be traced", "write it with the functions that can (see the tutorial)")
    dtype = kwargs.pop("dtype", None)
    if dtype is not None and method not in ("reduce", "accumulate"):
        refuse(f"np.{ufunc.__name__}(..., dtype=...) is not traced", "convert with x.astype(...)")
    if dtype is not None:
        inputs = (np.array(inputs[0]).astype(dtype), *inputs[1:])
    if method == "__call__" and ufunc is np.matmul:
        result = _product(np.matmul, *inputs)
    elif method == "__call__":
        result = _elementwise(ufunc, inputs)
    elif method == "reduce":
        result = _reduce(ufunc, inputs[0], kwargs)
    elif method == "accumulate":
        result = _accumulate(ufunc, inputs[0], kwargs)
    elif method == "outer":
        first, second = (_object(x) for x in inputs)
        result = _elementwise(ufunc, (first.reshape(first.shape + (1,) * second.ndim), second))
    else:
        refuse(f"np.{ufunc.__name__}.{method} cannot be traced", "write it as a new array")
    if out is None or out[0] is None:
        return result
    if not isinstance(out[0], Traced):
        refuse(
            "a traced value is stored in a float array",
            "write x = x + y instead of x += y, and build arrays with np.array([...]), np.stack or np.concatenate",
        )
    if [float, int, bool].index(_dtype(out[0])) > [float, int, bool].index(_dtype(result)):
        refuse("numbers are stored in an array of another type", "write x = x + y instead of x += y")
    out[0][...] = result
    return out[0]


# --- functions -------------------------------------------------------------------------------------------------------


def _np_where(condition: Any, *branches: Any) -> Any:
    if len(branches) != 2:
        refuse("np.where with one argument depends on values", "give both branches, np.where(condition, a, b)")
    columns, shape = _columns((condition, *branches))
    both = _uniform([*columns[1], *columns[2]])
    columns[1:] = [both[: len(columns[1])], both[len(columns[1]) :]]
    return _places(where, columns, shape)


def _np_select(conditions: list, choices: list, default: Any = 0) -> Any:
    result = default
    for condition, choice in zip(reversed(conditions), reversed(choices), strict=True):
        result = np.where(condition, choice, result)
    return result


def _np_clip(a: Any, a_min: Any = None, a_max: Any = None, out: Any = None, **kwargs: Any) -> Any:
    a_min, a_max = kwargs.get("min", a_min), kwargs.get("max", a_max)
    if out is not None:
        refuse("np.clip(..., out=...) is not traced", "assign the result to a name")
    if a_min is not None and a_max is not None:
        return np._core.umath.clip(a, a_min, a_max)
    a = a if a_min is None else np.maximum(a, a_min)
    return a if a_max is None else np.minimum(a, a_max)


def _np_norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    if ord not in (None, 2, "fro") or (ord == 2 and axis is None and np.ndim(x) > 1):
        refuse(f"np.linalg.norm(..., ord={ord!r}) cannot be traced", "write the norm with np.sum, np.abs or np.maximum")
    x = np.ravel(x) if axis is None and not keepdims else x
    return np.sqrt(np.sum(x * x, axis=axis, keepdims=keepdims))


def _np_interp(x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None) -> Any:
    if contains_traced(xp):
        refuse("np.interp needs constant abscissae", "look the row up with a Table")
    if period is not None:
        refuse("np.interp(..., period=...) is not traced", "take np.mod(x, period) first")
    xp, known = np.asarray(xp, float), not contains_traced(fp)
    if xp.ndim != 1 or not np.all(np.diff(xp) > 0):
        refuse("np.interp needs abscissae that increase", "sort them")
    result = fp[0] if left is None else left
    for i in range(len(xp) - 1):
        slope = (fp[i + 1] - fp[i]) / (xp[i + 1] - xp[i])
        value = slope * (x - xp[i]) + fp[i]
        if not (known and np.all(np.isfinite([fp[i], fp[i + 1], slope]))):  # NumPy then begins at the other end, too
            other = slope * (x - xp[i + 1]) + fp[i + 1]
            other = np.where(np.isnan(other) & (fp[i] == fp[i + 1]), fp[i], other)
            value = np.where(np.isnan(value), other, value)
        if not (known and fp[i]):
            value = np.where(x == xp[i], fp[i], value)
        result = np.where(x >= xp[i], value, result)
    result = np.where(x >= xp[-1], fp[-1], result)
    result = result if right is None else np.where(x > xp[-1], right, result)
    result = result if len(xp) == 1 else np.where(np.isnan(x), x, result)
    return np.array(result, float)


def _np_full_like(a: Any, fill_value: Any, dtype: Any = None, **_: Any) -> Any:
    return np.full(np.shape(a), fill_value, dtype or _dtype(a))


def _np_mean(a: Any, axis: Any = None, keepdims: bool = False) -> Any:
    total = np.sum(a, axis=axis, keepdims=keepdims)
    return total / (np.size(a) // max(np.size(total), 1))


def _np_insert(arr: Any, obj: Any, values: Any, axis: Any = None) -> Any:
    return _wrap(np.insert._implementation(arr, obj, np.array(values).astype(_dtype(arr)), axis))


def _np_roll(a: Any, *args: Any, **kwargs: Any) -> Any:
    a = np.asarray(a)
    return a.ravel()[np.roll(np.arange(a.size).reshape(a.shape), *args, **kwargs)]


FUNCTIONS: dict[Callable, Callable] = {
    np.mean: _np_mean,
    np.insert: _np_insert,
    np.roll: _np_roll,
    np.where: _np_where,
    np.select: _np_select,
    np.clip: _np_clip,
    np.linalg.norm: _np_norm,
    np.interp: _np_interp,
    np.zeros_like: lambda a, dtype=None, **_: _np_full_like(a, 0, dtype),
    np.ones_like: lambda a, dtype=None, **_: _np_full_like(a, 1, dtype),
    np.full_like: _np_full_like,
    np.count_nonzero: lambda a, axis=None: np.sum(a != 0, axis=axis),
    np.shape: lambda a: _object(a).shape,
    np.ndim: lambda a: _object(a).ndim,
    np.size: lambda a, axis=None: _object(a).size if axis is None else _object(a).shape[axis],
    np.dot: lambda a, b, out=None: _product(np.dot, a, b),
    np.inner: lambda a, b: _product(np.inner, a, b),
    np.tensordot: _np_tensordot,
    np.vdot: lambda a, b: np.dot(np.ravel(a), np.ravel(b)),
    np.outer: lambda a, b, out=None: np.multiply.outer(np.ravel(a), np.ravel(b)),
    np.linalg.outer: lambda a, b: np.multiply.outer(np.ravel(a), np.ravel(b)),
}

# NumPy's own implementation of these only moves elements about, or calls ufuncs.
_STRUCTURAL = """
concatenate stack vstack hstack dstack column_stack block cross einsum kron diag diagonal
diagflat trace transpose reshape ravel squeeze expand_dims broadcast_to broadcast_arrays tile repeat flip fliplr
flipud atleast_1d atleast_2d atleast_3d triu tril copy moveaxis swapaxes rollaxis rot90 append take split array_split
hsplit vsplit delete diff sum prod cumsum cumprod max min amax amin any all round around polyval
linalg.multi_dot linalg.matrix_power linalg.cross linalg.trace linalg.diagonal linalg.matrix_transpose
linalg.matmul linalg.tensordot matrix_transpose
""".split()
STRUCTURAL: set[Callable] = set()
for _name in _STRUCTURAL:
    _owner: Any = np
    for _part in _name.split("."):
        _owner = getattr(_owner, _part, None)
    STRUCTURAL.add(_owner)
STRUCTURAL.discard(None)

_REMEDIES = {
    "solve": "process the measurements one at a time, or write the elimination out",
    "inv": "process the measurements one at a time, or write the inverse out",
    "cholesky": "write the factorisation out",
    "argmax": "select with np.where",
    "argmin": "select with np.where",
    "sort": "order with np.minimum and np.maximum",
    "allclose": "compare with <= and np.all",
    "isclose": "compare with <=",
    "copyto": "build the array with np.where or np.concatenate",
}


def _function(function: Callable, args: tuple, kwargs: dict) -> Any:
    if function in FUNCTIONS:
        return FUNCTIONS[function](*args, **kwargs)
    if function not in STRUCTURAL:
        name = f"{function.__module__}.{function.__name__}".replace("numpy", "np", 1)
        remedy = _REMEDIES.get(function.__name__, "write it with the functions that can (see the tutorial)")
        refuse(f"{name} cannot be traced", remedy)
    if kwargs.get("out") is not None:
        refuse(f"np.{function.__name__}(..., out=...) is not traced", "assign the result to a name")
    return _wrap(function._implementation(*args, **kwargs))


def _refused(name: str, remedy: str) -> Callable:
    return lambda self, *args, **kwargs: refuse(f".{name}() depends on values and cannot be traced", remedy)


class Traced(np.ndarray):
    """An array of traced numbers; see the module's first lines."""

    __array_priority__ = 1000.0

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        return _ufunc(ufunc, method, inputs, kwargs)

    def __array_function__(self, function: Callable, types: Any, args: tuple, kwargs: dict) -> Any:
        return _function(function, args, kwargs)

    def __getitem__(self, key: Any) -> Any:
        if contains_traced(key):
            refuse("an array is indexed with a traced value", "select with np.where, or index with constants")
        result = super().__getitem__(key)
        return result if isinstance(result, Traced) else _build((), [result])

    def __setitem__(self, key: Any, value: Any) -> None:
        if not self.flags.writeable:
            refuse("a variable's array is read-only", "assign a whole new array: self.x = np.array([...])")
        if contains_traced(key):
            refuse("an array is indexed with a traced value", "select with np.where, or index with constants")
        value = _object(value)
        value = value.view(Traced).astype(_dtype(self)).view(np.ndarray)
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

    def astype(self, dtype: Any, *args: Any, **kwargs: Any) -> Traced:
        """Convert between truth values, whole numbers and real numbers."""
        kind = np.dtype(dtype).kind
        elements = self.ravel().tolist()
        if kind == "b":
            return _places(truth, [elements], self.shape)
        if np.dtype(dtype) not in (np.float64, np.int64):
            refuse(f"numbers of type {np.dtype(dtype)} are not traced", "use float, int or bool")
        if kind == "f":
            return _build(self.shape, [number(e) for e in elements])
        if all(is_whole(e) for e in elements):
            return _build(self.shape, [whole(e) for e in elements])
        return np.where(np.abs(self) < 2.0**63, whole_numbers(np.trunc(self)), -(2**63))  # as x86 does, for NaN too

    def __pow__(self, exponent: Any) -> Traced:
        if self.ndim or np.ndim(exponent) or isinstance(exponent, Traced):
            return np.power(self, exponent)
        return _build((), [scalar_power(self._only(), _unwrap(exponent))])

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
        return self if _dtype(self) is int else np.rint(self)

    argmax = _refused("argmax", "select with np.where")
    argmin = _refused("argmin", "select with np.where")
    argsort = _refused("argsort", "order with np.minimum and np.maximum")
    sort = _refused("sort", "order with np.minimum and np.maximum")
    nonzero = _refused("nonzero", "select with np.where")
    searchsorted = _refused("searchsorted", "look the row up with a Table")


Scalar.__array_ufunc__ = Traced.__array_ufunc__  # a lone element answers NumPy as an array does
Scalar.__array_function__ = Traced.__array_function__
_ARRAY = np.array


def symbols(vector: str, kinds: str, first: int = 0) -> Traced:
    """Return elements of a vector, from ``first`` on, as a traced array; ``kinds`` has a letter for each: real "f",
    whole "i" or truth value "b".
    """
    return _fill((len(kinds),), [Scalar(graph.element(vector, first + i), kind) for i, kind in enumerate(kinds)])


def whole_numbers(array: Any) -> Traced:
    """Return numbers that have no fractions as NumPy's integers."""
    return _places(lambda e: e if type(e) is float else whole(e), [_object(array).ravel().tolist()], np.shape(array))


def routine(
    name: str,
    operands: Iterable[Any],
    shape: tuple[int, ...],
    kind: str = "f",
    numbers: tuple[int, ...] = (),
    before: tuple[str, ...] = (),
) -> Traced:
    """Return an array of this shape that a C function of the runtime calculates: ``name(*before, *numbers, *operands, r)``.

    An operand is ``const double *`` with its elements in C order, or ``double`` if it has no axes; ``numbers`` are ints,
    and ``before`` are texts, names of what the function of a task is given. ``r`` is the result. Whether it is called, and
    how often, must make no difference: it only calculates.
    """
    given = [_object(x) for x in operands]
    columns = [_numbers(x.ravel().tolist()) for x in given]
    read = [arrays.block(c) if x.ndim else arrays.operand(c) for x, c in zip(given, columns, strict=True)]
    values = frozenset(k for k, x in enumerate(given) if not x.ndim)
    how = arrays.Routine(name, tuple(numbers), tuple(before), values)
    return _fill(shape, arrays.elements(graph.Array(how, math.prod(shape), read), kind))


def expressions(array: Any) -> list[Node]:
    """Return the nodes of the elements of an array, in C order."""
    return [expression(e) for e in _object(array).ravel().tolist()]


_GLOBAL = RLock()  # one thread at a time changes what belongs to the whole process, and changes it back


# NumPy asks no list how to reduce it: these take a list of traced values as the array that it stands for.
_REDUCING = ("sum", "mean", "prod", "max", "min", "amax", "amin", "any", "all")


@contextmanager
def tracing(modules: Iterable[ModuleType] = ()) -> Iterator[None]:
    """While tracing, ``np.array`` and its kin return traced arrays, in ``modules`` also by names of their own."""
    modules = list(modules)
    with _GLOBAL, _traced_arrays(modules), _recorded_functions(modules):
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


@contextmanager
def _traced_arrays(modules: Iterable[ModuleType]) -> Iterator[None]:
    making = ("array", "asarray", "asanyarray", "ascontiguousarray", "full", "full_like")
    originals = {name: getattr(np, name) for name in (*making, *_REDUCING)}
    by_name = [
        (module, alias, name)
        for module in modules
        for alias, value in vars(module).items()
        for name, original in originals.items()
        if value is original
    ]

    def replaced(name: str) -> Callable:
        original = originals[name]

        def function(*args: Any, **kwargs: Any) -> Any:
            if args and contains_traced(args[0]):
                value = _wrap(_object(args[0]))
                dtype = kwargs.get("dtype", args[1] if len(args) > 1 else None)
                return value if dtype is None or np.dtype(dtype).kind == "O" else value.astype(dtype)
            return original(*args, **kwargs)

        return function

    def full(shape: Any, fill_value: Any, *args: Any, **kwargs: Any) -> Any:
        if contains_traced(fill_value):
            return np.broadcast_to(np.array(fill_value, *args, **kwargs), shape).copy()
        return originals["full"](shape, fill_value, *args, **kwargs)

    def full_like(a: Any, fill_value: Any, dtype: Any = None, **kwargs: Any) -> Any:
        if contains_traced(fill_value) and not contains_traced(a):
            return full(np.shape(a), fill_value, dtype or originals["asarray"](a).dtype)
        return originals["full_like"](a, fill_value, dtype, **kwargs)

    def reducing(name: str) -> Callable:
        def function(a: Any, *args: Any, **kwargs: Any) -> Any:
            listed = isinstance(a, list | tuple) and contains_traced(a)
            return originals[name](np.array(a) if listed else a, *args, **kwargs)

        return function

    try:
        for name in originals:
            own = {"full": full, "full_like": full_like}.get(name)
            setattr(np, name, own or (reducing if name in _REDUCING else replaced)(name))
        for module, alias, name in by_name:
            setattr(module, alias, getattr(np, name))
        yield
    finally:
        for module, alias, name in [*((np, name, name) for name in originals), *by_name]:
            setattr(module, alias, originals[name])
