"""Functions that are differentiated as what they consist of; their values are NumPy's own."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial, reduce
from inspect import signature
from typing import Any

import numpy as np

from navfmu.derivatives.dual import RULES, Dual, dual, refuse, values


def composed(*keys: Any) -> Callable:
    """Register what a function of NumPy consists of, written with functions that have derivatives."""

    def register(function: Callable) -> Callable:
        known = signature(function).parameters
        takes_all = any(one.kind is one.VAR_KEYWORD for one in known.values())

        def rule(call: Callable, level: int, *args: Any, **kwargs: Any) -> Any:
            kwargs = {key: one for key, one in kwargs.items() if one is not np._NoValue}
            for key in kwargs:
                if key not in known and not takes_all:
                    refuse(f"np.{call.__name__}(..., {key}=...) has no derivative", "write it out, or use np.where")
            value = call(*values(args, level), **{key: values(one, level) for key, one in kwargs.items()})
            result = function(*args, **kwargs)
            return dual(value, result.slopes, level) if isinstance(result, Dual) and result.level == level else value

        RULES.update(dict.fromkeys(keys, rule))
        return function

    return register


# --- choices ---------------------------------------------------------------------------------------------------------


@composed(np.maximum)
def _maximum(a: Any, b: Any) -> Any:
    return np.where(np.logical_or(np.greater(a, b), np.isnan(a)), a, b)


@composed(np.minimum)
def _minimum(a: Any, b: Any) -> Any:
    return np.where(np.logical_or(np.less(a, b), np.isnan(a)), a, b)


@composed(np.fmax)
def _fmax(a: Any, b: Any) -> Any:
    return np.where(np.logical_or(np.greater(a, b), np.isnan(b)), a, b)


@composed(np.fmin)
def _fmin(a: Any, b: Any) -> Any:
    return np.where(np.logical_or(np.less(a, b), np.isnan(b)), a, b)


@composed(np.clip, np._core.umath.clip)
def _clip(a: Any, low: Any = None, high: Any = None, **kwargs: Any) -> Any:
    low, high = kwargs.get("min", low), kwargs.get("max", high)
    if low is not None and low is not np._NoValue:
        a = np.where(np.less(a, low), low, a)
    if high is not None and high is not np._NoValue:
        a = np.where(np.greater(a, high), high, a)
    return a


@composed(np.select)
def _select(conditions: list, choices: list, default: Any = 0) -> Any:
    result = default
    for condition, choice in zip(reversed(conditions), reversed(choices), strict=True):
        result = np.where(condition, choice, result)
    return result


@composed(np.nan_to_num)
def _nan_to_num(x: Any, **kwargs: Any) -> Any:
    return np.where(np.isfinite(x), x, 0.0)


@composed(np.interp)
def _interp(x: Any, xp: Any, fp: Any, left: Any = None, right: Any = None, period: Any = None) -> Any:
    """Each abscissa belongs to the segment on its right, the last one to that on its left."""
    if period is not None:
        refuse("np.interp(..., period=...) has no derivative", "take np.mod(x, period) first")
    if isinstance(xp, Dual):
        refuse("np.interp has no derivative by its abscissae", "write the interpolation out")
    fp = np.array(fp)
    result = fp[0] if left is None else left
    for i in range(len(xp) - 1):
        slope = (fp[i + 1] - fp[i]) / (xp[i + 1] - xp[i])
        result = np.where(np.greater_equal(x, xp[i]), fp[i] + slope * (x - xp[i]), result)
    return np.where(np.greater(x, xp[-1]), fp[-1] if right is None else right, result)


# --- over axes -------------------------------------------------------------------------------------------------------


def _given(keepdims: Any) -> bool:
    return keepdims is True


def _axes(array: Any, axis: Any) -> tuple[int, ...]:
    if axis is None or array.ndim == 0:
        return tuple(range(array.ndim))
    return tuple(i % array.ndim for i in np.atleast_1d(axis).tolist())


def _sum(
    call: Callable, level: int, array: Any, axis: Any = None, dtype: Any = None, keepdims: Any = False, **kwargs: Any
) -> Any:
    given = {key: one for key, one in kwargs.items() if one is not np._NoValue and one is not None}
    if given.keys() - {"initial", "where"} or isinstance(given.get("initial"), Dual):
        refuse(f"np.sum(..., {', '.join(given)}=...) has no derivative", "write it with + and np.where")
    value = call(array.value, axis=axis, keepdims=_given(keepdims), **given)
    array = np.where(given["where"], array, 0.0) if "where" in given else array
    shape = tuple(1 if i in _axes(array, axis) else n for i, n in enumerate(array.shape))
    groups = np.broadcast_to(np.arange(math.prod(shape)).reshape(shape), array.shape)
    return dual(value, array.slopes.summed(groups.ravel(), math.prod(shape)), level)


RULES[np.sum] = _sum
RULES[np.add, "reduce"] = lambda call, level, array, axis=0, *args, **kwargs: _sum(
    call, level, array, axis, *args, **kwargs
)


def _rows(array: Any, axis: Any) -> list:
    """The elements along an axis, or along several."""
    axes = _axes(array, axis)
    kept = [i for i in range(array.ndim) if i not in axes]
    moved = np.transpose(array, (*axes, *kept))
    return list(np.reshape(moved, (-1, *(array.shape[i] for i in kept))))


def _kept(result: Any, array: Any, axis: Any) -> Any:
    """The result with the axes that it went over, of length 1."""
    return np.reshape(result, [1 if i in _axes(array, axis) else n for i, n in enumerate(array.shape)])


def _folded(ufunc: np.ufunc, array: Any, axis: Any = 0, *args: Any, keepdims: Any = False, **kwargs: Any) -> Any:
    given = [key for key, one in kwargs.items() if one is not np._NoValue and one is not None and key != "dtype"]
    if given:
        refuse(f"np.{ufunc.__name__}.reduce(..., {given[0]}=...) has no derivative", "write it with np.where")
    result = reduce(ufunc, _rows(array, axis))
    return _kept(result, array, axis) if _given(keepdims) else result


def _accumulated(ufunc: np.ufunc, array: Any, axis: Any = 0, *args: Any, **kwargs: Any) -> Any:
    if axis is None:
        array, axis = np.ravel(array), 0
    results = []
    for row in _rows(array, axis):
        results.append(ufunc(results[-1], row) if results else row)
    return np.stack(results, axis)


for _ufunc, _all, _running in (
    (np.multiply, [np.prod], [np.cumprod]),
    (np.maximum, [np.max, np.amax], []),
    (np.minimum, [np.min, np.amin], []),
    (np.add, [], [np.cumsum]),
):
    if _all:
        composed((_ufunc, "reduce"))(partial(_folded, _ufunc))
    composed((_ufunc, "accumulate"))(partial(_accumulated, _ufunc))
    for _functions, _way in ((_all, _folded), (_running, _accumulated)):
        composed(*_functions)(
            lambda a, axis=None, *args, _way=_way, _ufunc=_ufunc, **kwargs: _way(_ufunc, a, axis, *args, **kwargs)
        )


@composed(np.mean)
def _mean(a: Any, axis: Any = None, dtype: Any = None, out: Any = None, keepdims: Any = False) -> Any:
    return np.sum(a, axis, keepdims=_given(keepdims)) / math.prod(a.shape[i] for i in _axes(a, axis))


@composed(np.var)
def _var(a: Any, axis: Any = None, dtype: Any = None, out: None = None, ddof: Any = 0, keepdims: Any = False) -> Any:
    apart = a - np.mean(a, axis, keepdims=True)
    count = math.prod(a.shape[i] for i in _axes(a, axis))
    return np.sum(apart * apart, axis, keepdims=_given(keepdims)) / (count - ddof)


@composed(np.std)
def _std(a: Any, axis: Any = None, *args: Any, **kwargs: Any) -> Any:
    return np.sqrt(np.var(a, axis, *args, **kwargs))


@composed(np.ptp)
def _ptp(a: Any, axis: Any = None, out: Any = None, keepdims: Any = False) -> Any:
    return np.max(a, axis, keepdims=_given(keepdims)) - np.min(a, axis, keepdims=_given(keepdims))


@composed(np.sort)
def _sort(a: Any, axis: Any = -1, **kwargs: Any) -> Any:
    """Neighbours change places until all are in order; which do, values say, how often they are compared does not."""
    if axis is None:
        a, axis = np.ravel(a), 0
    rows = list(np.moveaxis(a, axis, 0))
    for last in range(len(rows) - 1, 0, -1):
        for i in range(last):
            first, second = rows[i], rows[i + 1]
            wrong = np.greater(first, second)
            rows[i], rows[i + 1] = np.where(wrong, second, first), np.where(wrong, first, second)
    return np.stack(rows, axis)


@composed(np.median)
def _median(a: Any, axis: Any = None, out: Any = None, overwrite_input: bool = False, keepdims: bool = False) -> Any:
    rows = np.stack(_rows(a, axis))
    ordered = np.sort(rows, 0)
    middle = 0.5 * (ordered[(len(rows) - 1) // 2] + ordered[len(rows) // 2])
    return _kept(middle, a, axis) if keepdims else middle


@composed(np.diff)
def _diff(a: Any, n: int = 1, axis: int = -1, prepend: Any = np._NoValue, append: Any = np._NoValue) -> Any:
    one = [1 if i == axis % a.ndim else count for i, count in enumerate(np.shape(a))]
    ends = [x if x is np._NoValue or np.ndim(x) else np.broadcast_to(x, one) for x in (prepend, append)]
    a = np.concatenate([x for x in (ends[0], a, ends[1]) if x is not np._NoValue], axis)
    for _ in range(n):
        a = np.moveaxis(a, axis, 0)
        a = np.moveaxis(a[1:] - a[:-1], 0, axis)
    return a


@composed(np.polyval)
def _polyval(p: Any, x: Any) -> Any:
    result = 0.0
    for coefficient in p:
        result = result * x + coefficient
    return result


@composed(np.linspace)
def _linspace(start: Any, stop: Any, num: int = 50, endpoint: bool = True, *args: Any, **kwargs: Any) -> Any:
    if args or kwargs:
        refuse(f"np.linspace(..., {next(iter(kwargs), 'retstep')}=...) has no derivative", "write it with np.arange")
    part = np.arange(num) / max(num - 1 if endpoint else num, 1)
    part = np.reshape(part, (num, *[1] * max(np.ndim(start), np.ndim(stop))))
    return start + part * (stop - start)


@composed(np.linalg.norm)
def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    if ord not in (None, 2, "fro") or (ord == 2 and axis is None and np.ndim(x) > 1):
        refuse(f"np.linalg.norm(..., ord={ord!r}) has no derivative", "write it with np.sum, np.abs or np.max")
    return np.sqrt(np.sum(x * x, axis, keepdims=keepdims))
