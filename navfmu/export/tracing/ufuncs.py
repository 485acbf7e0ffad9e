"""NumPy's ufuncs on traced arrays: at each place, along an axis, as a matrix product."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from navfmu.export.tracing import wholes
from navfmu.export.tracing.products import product
from navfmu.export.tracing.rules import OTHERS, RULES, NoRoom, Scalar, add, fold, is_boolean, is_whole, refuse, truth
from navfmu.export.tracing.traced import (
    Traced,
    as_fresh,
    as_numbers,
    as_numpy,
    at_each_place,
    broadcast_columns,
    built,
    filled,
    has_symbols,
    is_kept_whole,
    objects,
    others,
    type_of,
)


def applied(ufunc: np.ufunc, elements: tuple) -> Any:
    """Apply a ufunc to elements: constants are folded, else it is the rule for it."""
    if any(type(e) is Scalar for e in elements):
        return RULES[ufunc](*elements)
    return fold(ufunc, *elements)


def _elementwise(ufunc: np.ufunc, inputs: tuple) -> Traced:
    columns, shape = broadcast_columns(inputs)
    if ufunc in (np.add, np.subtract, np.negative) and all(c and all(map(is_boolean, c)) for c in columns):
        if ufunc is not np.add:
            refuse("NumPy does not subtract truth values", "use ^ or np.logical_xor, or ~")
        ufunc = np.logical_or  # what NumPy does for bool + bool
    if ufunc is np.power and not wholes.uniform(columns[1]):  # each exponent has a rule of its own
        return built(shape, [applied(ufunc, elements) for elements in zip(*columns, strict=True)])
    return at_each_place(lambda *elements: applied(ufunc, elements), columns, shape)


def _fold_list(ufunc: np.ufunc, elements: list) -> Any:
    result = elements[0]
    for element in elements[1:]:
        result = applied(ufunc, (result, element))
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
    array = objects(array)
    axis = kwargs.get("axis", 0)
    axes = tuple(range(array.ndim)) if axis is None or array.ndim == 0 else tuple(np.atleast_1d(axis) % array.ndim)
    kept = [i for i in range(array.ndim) if i not in axes]
    shape = [array.shape[i] for i in kept]
    rows = array.transpose(kept + list(axes)).reshape(math.prod(shape), math.prod(array.shape[i] for i in axes))
    fast = not kept or (array.ndim - 1) in axes  # NumPy adds pairwise along the fast axis only
    initial = kwargs.get("initial", np._NoValue)
    given = initial is not np._NoValue and initial is not None
    if kwargs.get("keepdims"):
        shape = [1 if i in axes else array.shape[i] for i in range(array.ndim)]
    if is_kept_whole(rows.size, rows.ravel().tolist()) and rows.shape[1] > 1:
        return filled(tuple(shape), _fold_whole(ufunc, rows, fast, initial if given else None))
    results = []
    for row in rows.tolist():
        if ufunc in (np.add, np.multiply):
            row = as_numbers(row)
        elif ufunc in (np.logical_and, np.logical_or):
            row = [truth(e) for e in row]
        first = np.array(initial).astype(type_of(row)).item() if given else _EMPTY.get(ufunc)
        if first is None and not row:
            refuse(f"np.{ufunc.__name__} of an array without elements has no result", "give it elements")
        if ufunc is np.add and fast and row:
            row = [_pairwise(row)]
        begins = given or not row or (ufunc is np.add and not is_whole(row[0]))  # so a sum of -0.0 alone is 0.0
        results.append(_fold_list(ufunc, [first, *row] if begins else row))
    return built(tuple(shape), results)


def _fold_whole(ufunc: np.ufunc, rows: np.ndarray, fast: bool, initial: Any) -> list:
    column = rows.ravel().tolist()
    if ufunc in (np.add, np.multiply):
        column = as_numbers(column)
    elif ufunc in (np.logical_and, np.logical_or):
        column = at_each_place(truth, [column], (len(column),)).view(np.ndarray).tolist()
    real = not all(map(is_whole, column))
    first = None
    if initial is not None:
        first = float(np.array(initial).astype(type_of(np.array(column, object))).item())
    elif ufunc is np.add and real:
        first = 0.0
    pairwise = ufunc is np.add and fast
    return wholes.folded(lambda a, b: applied(ufunc, (a, b)), column, *rows.shape, first, pairwise)


def _accumulate(ufunc: np.ufunc, array: Any, kwargs: dict) -> Traced:
    array = objects(array)
    moved = np.moveaxis(array, kwargs.get("axis", 0), -1)
    if is_kept_whole(moved.size, moved.ravel().tolist()) and moved.shape[-1] > 1:
        column, length = as_numbers(moved.ravel().tolist()), moved.shape[-1]
        rows = wholes.accumulated(lambda a, b: applied(ufunc, (a, b)), column, len(column) // length, length)
        return np.moveaxis(filled(moved.shape, rows), -1, kwargs.get("axis", 0))
    rows = []
    for row in moved.reshape(math.prod(moved.shape[:-1]), moved.shape[-1]).tolist():
        row = as_numbers(row)
        sums = row[:1]
        for element in row[1:]:
            sums.append(applied(ufunc, (sums[-1], element)))
        rows.extend(sums)
    return np.moveaxis(built(moved.shape, rows), -1, kwargs.get("axis", 0))


def apply(ufunc: np.ufunc, method: str, inputs: tuple, kwargs: dict) -> Any:
    """Return what a ufunc, or one of its methods, gives for traced arguments, or refuse it."""
    out = kwargs.pop("out", None)
    if kwargs.get("where", True) is not True:
        refuse(f"np.{ufunc.__name__}(..., where=...) is not traced", "use np.where")
    if ufunc is not np.matmul and ufunc not in RULES:
        if method != "at" and not has_symbols(inputs):
            return as_fresh(getattr(ufunc, method)(*as_numpy(inputs), **kwargs))
        name = f"np.{ufunc.__name__}" if getattr(np, ufunc.__name__, None) is ufunc else ufunc.__name__
        refuse(f"{name} cannot be traced", OTHERS)
    dtype = kwargs.pop("dtype", None)
    if dtype is not None and method not in ("reduce", "accumulate"):
        refuse(f"np.{ufunc.__name__}(..., dtype=...) is not traced", "convert with x.astype(...)")
    if dtype is not None:
        inputs = (np.array(inputs[0]).astype(dtype), *inputs[1:])
    if method == "__call__" and ufunc is np.matmul:
        result = product(np.matmul, *inputs)
    elif method == "__call__":
        result = _elementwise(ufunc, inputs)
    elif method == "reduce":
        result = _reduce(ufunc, inputs[0], kwargs)
    elif method == "accumulate":
        result = _accumulate(ufunc, inputs[0], kwargs)
    elif method == "outer":
        first, second = (objects(x) for x in inputs)
        result = _elementwise(ufunc, (first.reshape(first.shape + (1,) * second.ndim), second))
    else:
        refuse(f"np.{ufunc.__name__}.{method} cannot be traced", "write it as a new array")
    if out is None or out[0] is None:
        return result
    if not isinstance(out[0], Traced):
        refuse(
            "a traced value is stored in a float array",
            "write x = x + y instead of x += y, and build arrays with np.array([...]), np.stack or np.concatenate",
            NoRoom,
        )
    if [float, int, bool].index(type_of(out[0])) > [float, int, bool].index(type_of(result)):
        refuse("numbers are stored in an array of another type", "write x = x + y instead of x += y")
    out[0][...] = result
    return out[0]


def _answer(self: Any, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
    return NotImplemented if others(map(type, inputs)) else apply(ufunc, method, inputs, kwargs)


Traced.__array_ufunc__ = _answer
Scalar.__array_ufunc__ = _answer  # a lone element answers NumPy as an array does
