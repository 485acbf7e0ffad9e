"""NumPy's functions on traced arrays: those that have a form of their own, and those that only move elements about."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from navfmu.export.tracing import linear, order
from navfmu.export.tracing.products import cross, einsum, kron, product, tensordot
from navfmu.export.tracing.rules import OTHERS, Scalar, refuse, where
from navfmu.export.tracing.traced import (
    Traced,
    as_fresh,
    as_numpy,
    at_each_place,
    broadcast_columns,
    contains_traced,
    has_symbols,
    objects,
    others,
    type_of,
    uniform,
    wrapped,
)


def _np_where(condition: Any, *branches: Any) -> Any:
    if len(branches) != 2:
        refuse("np.where with one argument depends on values", "give both branches, np.where(condition, a, b)")
    columns, shape = broadcast_columns((condition, *branches))
    both = uniform([*columns[1], *columns[2]])
    columns[1:] = [both[: len(columns[1])], both[len(columns[1]) :]]
    return at_each_place(where, columns, shape)


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
    if has_symbols(xp):
        refuse("np.interp needs constant abscissae", "look the row up with a Table")
    if period is not None:
        refuse("np.interp(..., period=...) is not traced", "take np.mod(x, period) first")
    xp, known = np.asarray(as_numpy(xp), float), not contains_traced(fp)
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
    return np.full(np.shape(a), fill_value, dtype or type_of(a))


def _np_mean(a: Any, axis: Any = None, keepdims: bool = False) -> Any:
    total = np.sum(a, axis=axis, keepdims=keepdims)
    return total / (np.size(a) // max(np.size(total), 1))


def _np_var(a: Any, axis: Any = None, dtype: None = None, out: None = None, ddof: float = 0, **options: Any) -> Any:
    a = np.asanyarray(a).astype(float)
    apart = a - np.mean(a, axis=axis, keepdims=True)
    squares = np.sum(apart * apart, axis=axis, **options)
    return squares / max(np.size(a) // max(np.size(squares), 1) - ddof, 0)


def _np_linspace(
    start: Any, stop: Any, num: int = 50, endpoint: bool = True, retstep: bool = False, dtype: Any = None, axis: int = 0
) -> Any:
    parts = num - 1 if endpoint else num
    start, stop = np.asanyarray(start) * 1.0, np.asanyarray(stop) * 1.0
    width = stop - start
    places = np.arange(num).reshape(-1, *[1] * np.ndim(width)) * 1.0
    step = width / parts if parts > 0 else np.nan
    if parts > 0:
        tiny = np.any(step == 0)  # NumPy then divides first
        result = np.where(tiny, places / parts * width, places * step) + start
    else:
        result = places * width + start
    if endpoint and num > 1:
        result = np.concatenate([result[:-1], np.broadcast_to(stop, np.shape(width))[None]])
    result = np.moveaxis(result, 0, axis)
    result = result if dtype is None else result.astype(dtype)
    return (result, step) if retstep else result


def _np_nan_to_num(x: Any, copy: bool = True, nan: Any = 0.0, posinf: Any = None, neginf: Any = None) -> Any:
    x = np.asanyarray(x)
    if type_of(x) is not float:
        return x
    x = np.where(np.isnan(x), nan, x)
    x = np.where(x == np.inf, np.finfo(float).max if posinf is None else posinf, x)
    return np.where(x == -np.inf, np.finfo(float).min if neginf is None else neginf, x)


def _np_isclose(a: Any, b: Any, rtol: Any = 1e-5, atol: Any = 1e-8, equal_nan: bool = False) -> Any:
    a, b = np.asanyarray(a), np.asanyarray(b) * 1.0
    near = np.logical_and(np.abs(a - b) <= atol + rtol * np.abs(b), np.isfinite(b))
    result = np.logical_or(near, a == b)
    return np.logical_or(result, np.logical_and(np.isnan(a), np.isnan(b))) if equal_nan else result


def _np_fill_diagonal(a: Any, val: Any, wrap: bool = False) -> None:
    places = np.zeros(np.shape(a), np.int8)
    np.fill_diagonal(places, 1, wrap)
    indices, values = np.nonzero(places), np.ravel(val)
    a[indices] = values[np.arange(len(indices[0])) % len(values)]


def _np_insert(arr: Any, obj: Any, values: Any, axis: Any = None) -> Any:
    return wrapped(np.insert._implementation(arr, obj, np.array(values).astype(type_of(arr)), axis))


def _np_roll(a: Any, *args: Any, **kwargs: Any) -> Any:
    a = np.asarray(a)
    return a.ravel()[np.roll(np.arange(a.size).reshape(a.shape), *args, **kwargs)]


FUNCTIONS: dict[Callable, Callable] = {
    np.mean: _np_mean,
    np.insert: _np_insert,
    np.fill_diagonal: _np_fill_diagonal,
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
    np.shape: lambda a: objects(a).shape,
    np.ndim: lambda a: objects(a).ndim,
    np.size: lambda a, axis=None: objects(a).size if axis is None else objects(a).shape[axis],
    np.dot: lambda a, b, out=None: product(np.dot, a, b),
    np.inner: lambda a, b: product(np.inner, a, b),
    np.tensordot: tensordot,
    np.einsum: einsum,
    np.kron: kron,
    np.cross: cross,
    np.linalg.cross: lambda x1, x2, /, *, axis=-1: cross(x1, x2, axis=axis),
    np.vdot: lambda a, b: np.dot(np.ravel(a), np.ravel(b)),
    np.outer: lambda a, b, out=None: np.multiply.outer(np.ravel(a), np.ravel(b)),
    np.linalg.outer: lambda a, b: np.multiply.outer(np.ravel(a), np.ravel(b)),
    np.var: _np_var,
    np.std: lambda a, **options: np.sqrt(np.var(a, **options)),
    np.linspace: _np_linspace,
    np.nan_to_num: _np_nan_to_num,
    np.isclose: _np_isclose,
    np.allclose: lambda a, b, *args, **kwargs: np.all(np.isclose(a, b, *args, **kwargs)),
    np.argmax: order.argmax,
    np.argmin: order.argmin,
    np.sort: order.sort,
    np.median: order.median,
    **linear.FUNCTIONS,
}

# NumPy's own implementation of these only moves elements about, or calls ufuncs.
_STRUCTURAL = """
concatenate stack vstack hstack dstack column_stack block diag diagonal
diagflat trace transpose reshape ravel squeeze expand_dims broadcast_to broadcast_arrays tile repeat flip fliplr
flipud atleast_1d atleast_2d atleast_3d triu tril copy moveaxis swapaxes rollaxis rot90 append take split array_split
hsplit vsplit delete diff sum prod cumsum cumprod max min amax amin any all round around polyval
linalg.multi_dot linalg.matrix_power linalg.trace linalg.diagonal linalg.matrix_transpose
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
    "argsort": "order the values themselves with np.sort, or select with np.where",
    "lstsq": "solve the normal equations with np.linalg.solve",
    "pinv": "write np.linalg.solve(A.T @ A, A.T)",
    **dict.fromkeys(("eig", "eigh", "eigvals", "eigvalsh", "qr", "svd"), "iterate a fixed number of times"),
    **dict.fromkeys(("searchsorted", "digitize"), "look the row up with a Table"),
    **dict.fromkeys(("percentile", "quantile"), "order the values with np.sort and take one at a constant index"),
    **dict.fromkeys(
        ("nansum", "nanmean", "nanmax", "nanmin"), "choose first what stands for NaN, np.where(np.isnan(x), 0.0, x)"
    ),
    "piecewise": "choose with np.select",
    "average": "write np.sum(weights * x) / np.sum(weights)",
    "unwrap": "wrap each difference: np.mod(x + np.pi, 2 * np.pi) - np.pi",
    "copyto": "build the array with np.where or np.concatenate",
}


def apply(function: Callable, args: tuple, kwargs: dict) -> Any:
    """Return what a function of NumPy gives for traced arguments, or refuse it."""
    if function in FUNCTIONS:
        return FUNCTIONS[function](*args, **kwargs)
    if function not in STRUCTURAL:
        if not has_symbols((args, kwargs)) and kwargs.get("out") is None:
            return as_fresh(function(*as_numpy(args), **as_numpy(kwargs)))
        name = f"{function.__module__}.{function.__name__}".replace("numpy", "np", 1)
        remedy = _REMEDIES.get(function.__name__, OTHERS)
        refuse(f"{name} cannot be traced", remedy)
    if kwargs.get("out") is not None:
        refuse(f"np.{function.__name__}(..., out=...) is not traced", "assign the result to a name")
    return wrapped(function._implementation(*args, **kwargs))


def _answer(self: Any, function: Callable, types: Any, args: tuple, kwargs: dict) -> Any:
    return NotImplemented if others(types) else apply(function, args, kwargs)


Traced.__array_function__ = _answer
Scalar.__array_function__ = _answer
