"""Derivatives of what NumPy does element by element."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from navfmu.derivatives.dual import RULES, Dual, dual, values
from navfmu.derivatives.slopes import Slopes

_LN2, _LN10 = float(np.log(2.0)), float(np.log(10.0))


def of_shape(x: Any, shape: tuple[int, ...], like: Slopes, level: int) -> Slopes:
    """Return the slopes of ``x``, of this level or not, broadcast to a shape."""
    if not (isinstance(x, Dual) and x.level == level):
        return Slopes.none(like.pattern.shape[0], like.pattern.shape[1])
    if x.shape == shape:
        return x.slopes
    return x.slopes.moved(np.broadcast_to(np.arange(1, x.size + 1).reshape(x.shape), shape).ravel())


def at(x: Any, shape: tuple[int, ...], elements: np.ndarray) -> Any:
    """Return some elements of ``x`` broadcast to a shape; a number stands for all of them."""
    if np.ndim(x) == 0:
        return x
    flat = np.ravel(x if np.shape(x) == shape else np.broadcast_to(x, shape))
    return flat if len(elements) == np.size(flat) else flat[elements]


def _power_by_base(v: Any, a: Any, b: Any) -> Any:
    return b * np.power(np.where(np.equal(b, 0.0), 1.0, a), b - 1.0)


def _power_by_exponent(v: Any, a: Any, b: Any) -> Any:
    return np.where(np.equal(a, 0.0), 0.0, v * np.log(np.where(np.equal(a, 0.0), 1.0, a)))


#: Derivatives by each operand: a number, or a function of the result and the operands.
PARTIALS: dict[Callable, tuple] = {
    np.add: (1.0, 1.0),
    np.subtract: (1.0, -1.0),
    np.multiply: (lambda v, a, b: b, lambda v, a, b: a),
    np.true_divide: (lambda v, a, b: 1.0 / b, lambda v, a, b: -v / b),
    np.negative: (-1.0,),
    np.positive: (1.0,),
    np.power: (_power_by_base, _power_by_exponent),
    np.float_power: (_power_by_base, _power_by_exponent),
    operator.pow: (_power_by_base, _power_by_exponent),
    np.square: (lambda v, a: 2.0 * a,),
    np.reciprocal: (lambda v, a: -v * v,),
    np.remainder: (1.0, lambda v, a, b: -np.floor_divide(a, b)),
    np.fmod: (1.0, lambda v, a, b: -np.trunc(a / b)),
    np.absolute: (lambda v, a: np.sign(a),),
    np.fabs: (lambda v, a: np.sign(a),),
    np.copysign: (lambda v, a, b: np.copysign(1.0, a) * np.copysign(1.0, b), None),
    np.sqrt: (lambda v, a: 0.5 / v,),
    np.cbrt: (lambda v, a: 1.0 / (3.0 * v * v),),
    np.exp: (lambda v, a: v,),
    np.exp2: (lambda v, a: v * _LN2,),
    np.expm1: (lambda v, a: np.exp(a),),
    np.log: (lambda v, a: 1.0 / a,),
    np.log2: (lambda v, a: 1.0 / (a * _LN2),),
    np.log10: (lambda v, a: 1.0 / (a * _LN10),),
    np.log1p: (lambda v, a: 1.0 / (1.0 + a),),
    np.logaddexp: (lambda v, a, b: np.exp(a - v), lambda v, a, b: np.exp(b - v)),
    np.sin: (lambda v, a: np.cos(a),),
    np.cos: (lambda v, a: -np.sin(a),),
    np.tan: (lambda v, a: 1.0 + v * v,),
    np.arcsin: (lambda v, a: 1.0 / np.sqrt((1.0 - a) * (1.0 + a)),),
    np.arccos: (lambda v, a: -1.0 / np.sqrt((1.0 - a) * (1.0 + a)),),
    np.arctan: (lambda v, a: 1.0 / (1.0 + a * a),),
    np.arctan2: (lambda v, a, b: b / (a * a + b * b), lambda v, a, b: -a / (a * a + b * b)),
    np.hypot: (lambda v, a, b: a / v, lambda v, a, b: b / v),
    np.sinh: (lambda v, a: np.cosh(a),),
    np.cosh: (lambda v, a: np.sinh(a),),
    np.tanh: (lambda v, a: 1.0 / (np.cosh(a) * np.cosh(a)),),
    np.arcsinh: (lambda v, a: 1.0 / np.hypot(1.0, a),),
    np.arccosh: (lambda v, a: 1.0 / np.sqrt((a - 1.0) * (a + 1.0)),),
    np.arctanh: (lambda v, a: 1.0 / ((1.0 - a) * (1.0 + a)),),
    np.deg2rad: (lambda v, a: np.pi / 180.0,),
    np.radians: (lambda v, a: np.pi / 180.0,),
    np.rad2deg: (lambda v, a: 180.0 / np.pi,),
    np.degrees: (lambda v, a: 180.0 / np.pi,),
}

#: Truth values, whole numbers and places: their derivatives are zero where they have one.
FLAT = (
    *(np.floor, np.ceil, np.trunc, np.rint, np.sign, np.signbit, np.floor_divide),
    *(np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal),
    *(np.logical_and, np.logical_or, np.logical_not, np.logical_xor, np.isfinite, np.isinf, np.isnan),
    *((ufunc, "reduce") for ufunc in (np.logical_and, np.logical_or)),
    *(np.round, np.around, np.any, np.all, np.count_nonzero, np.isclose, np.allclose, np.array_equal),
    *(np.argmax, np.argmin, np.argsort, np.nonzero, np.searchsorted, np.digitize, np.shape, np.ndim, np.size),
    *(np.result_type, np.iscomplexobj, np.isrealobj),
)


def _elementwise(function: Callable, partials: tuple) -> Callable:
    def rule(call: Callable, level: int, *operands: Any, **kwargs: Any) -> Any:
        operands = tuple(np.array(x) if isinstance(x, list | tuple) else x for x in operands)
        bare = values(operands, level)
        value = call(*bare, **kwargs)
        parts = []
        for x, derivative in zip(operands, partials, strict=True):
            if derivative is None or not (isinstance(x, Dual) and x.level == level):
                continue
            slopes = x.slopes if x.shape == value.shape else of_shape(x, value.shape, x.slopes, level)
            if callable(derivative):
                derivative = derivative(*(at(one, value.shape, slopes.elements) for one in (value, *bare)))
            parts.append(slopes.scaled(derivative))
        return dual(value, sum(parts[1:], parts[0]), level) if parts else value

    return rule


def _flat(call: Callable, level: int, *args: Any, **kwargs: Any) -> Any:
    return call(*values(args, level), **{key: values(value, level) for key, value in kwargs.items()})


def _where(call: Callable, level: int, condition: Any, *branches: Any) -> Any:
    """The derivative of the branch that is taken, whatever that of the other one is."""
    condition = values(condition, level)
    value = call(condition, *values(branches, level))
    parts = [one for one in branches if isinstance(one, Dual) and one.level == level]
    if not parts:
        return value
    count, columns = value.size, parts[0].slopes.pattern.shape[1]
    first, second = (of_shape(one, value.shape, Slopes.none(count, columns), level) for one in branches)
    held = at(condition, value.shape, np.arange(count))
    return dual(value, Slopes.chosen(held, first, second), level)


RULES.update({function: _elementwise(function, partials) for function, partials in PARTIALS.items()})
RULES.update(dict.fromkeys(FLAT, _flat))
RULES[np.where] = _where
