"""Traced numbers: :class:`Scalar`, and for each NumPy ufunc the rule that applies it to elements.

An element of a traced array is a Python number (a constant) or a Scalar. A rule takes elements, at least one of them a
Scalar, and returns an element; what it computes is what NumPy computes, to the last bit where the C library allows,
for finite numbers. (A product with a constant 0, and 0 divided by something, are 0 whatever the other number is: else
the zeros of constant matrices would be carried into the code.)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

import casadi as ca
import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.place import place

_LARGEST = float(np.finfo(float).max)


def refuse(what: str, remedy: str) -> NoReturn:
    """Raise the error for a construct that has no traced form."""
    raise NavfmuError(f"{place()}: {what}; {remedy}")


class Scalar:
    """One traced number, and whether it is a truth value."""

    __slots__ = ("boolean", "sx")
    __array_priority__ = 1000.0
    shape, ndim, size = (), 0, 1

    def __init__(self, sx: ca.SX, boolean: bool = False) -> None:
        self.sx = sx
        self.boolean = boolean

    def __bool__(self) -> bool:
        refuse(
            "the truth of a traced value is not known while tracing (if, while, and, or, not, min, max)",
            "choose with np.where, np.logical_and, np.logical_or, np.logical_not, np.minimum or np.maximum",
        )

    def __float__(self) -> float:
        refuse(
            "a traced value has no float value (float(), math.*, or storing it in a float array)",
            "use NumPy functions instead of float() and math.*, and build arrays with np.array([...]), np.stack, "
            "np.concatenate or np.where instead of filling them",
        )

    def __int__(self) -> int:
        refuse("a traced value has no int value", "use np.floor or np.rint, or compare it with np.where")

    def __index__(self) -> int:
        refuse("a traced value cannot be an index or a count", "select with np.where, or index with constants")

    def __hash__(self) -> int:
        refuse("a traced value cannot be a key of a dict or set", "select with np.where")

    def __complex__(self) -> complex:
        refuse("complex numbers are not traced", "write real and imaginary part as two real numbers")

    def __round__(self, digits: int = 0) -> Any:
        return _rint(self) if not digits else self.__int__()

    def __repr__(self) -> str:
        return f"Scalar({self.sx})"


def _binary(rule: Callable, reflected: bool = False) -> Callable:
    def method(self: Scalar, other: Any) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented
        if isinstance(other, np.generic):
            other = other.item()
        if not isinstance(other, Scalar | bool | int | float):
            return NotImplemented
        return rule(other, self) if reflected else rule(self, other)

    return method


# --- rules: elements (numbers or Scalars, at least one Scalar) to element -------------------------------------------


def expression(x: Any) -> Any:
    """Return a Scalar's CasADi expression, a constant as float."""
    return x.sx if type(x) is Scalar else float(x)


def _constant(x: Any, value: float) -> bool:
    return type(x) is not Scalar and x == value


def is_boolean(x: Any) -> bool:
    """Whether an element is a truth value."""
    return x.boolean if type(x) is Scalar else isinstance(x, bool)


def add(a: Any, b: Any) -> Any:
    """Sum of two elements."""
    if type(a) is not Scalar:
        if type(b) is not Scalar:
            return a + b
        if a == 0 and not b.boolean:
            return b
    elif _constant(b, 0) and not a.boolean:
        return a
    return Scalar(expression(a) + expression(b))


def _subtract(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        if type(b) is not Scalar:
            return a - b
        if a == 0:
            return _negative(b)
    elif _constant(b, 0) and not a.boolean:
        return a
    return Scalar(expression(a) - expression(b))


def _multiply(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        if type(b) is not Scalar:
            return a * b
        a, b = b, a
    if type(b) is not Scalar:
        if b == 0:
            return False if a.boolean and isinstance(b, bool) else 0.0
        if b == 1 and (not a.boolean or isinstance(b, bool)):
            return a
        if b == -1:
            return _negative(a)
    return Scalar(expression(a) * expression(b), is_boolean(a) and is_boolean(b))


def _divide(a: Any, b: Any) -> Any:
    if type(a) is not Scalar and type(b) is not Scalar:
        return fold(np.true_divide, a, b)
    if _constant(a, 0):
        return 0.0
    if _constant(b, 1) and not a.boolean:
        return a
    return Scalar(expression(a) / expression(b))


def _negative(a: Any) -> Any:
    return Scalar(-a.sx) if type(a) is Scalar else -a


def _power(a: Any, b: Any) -> Any:
    if type(b) is not Scalar:
        known = {0: lambda: 1.0, 1: lambda: add(a, 0.0), 2: lambda: _multiply(a, a)}
        known |= {0.5: lambda: Scalar(ca.sqrt(expression(a))), -1: lambda: _divide(1.0, a)}
        if b in known:
            return known[b]()
    return Scalar(ca.power(expression(a), expression(b)))


def _fmod(a: Any, b: Any) -> Scalar:
    return Scalar(ca.fmod(expression(a), expression(b)))


def _mod(a: Any, b: Any) -> Any:
    """Remainder with the sign of the divisor, as ``np.mod`` and Python's ``%``."""
    m = _fmod(a, b)
    other_sign = _not_equal(_less(m, 0.0), _compare(np.less, _less, b, 0.0))
    return where(_and(_not_equal(m, 0.0), other_sign), add(m, b), m)


def _floor_divide(a: Any, b: Any) -> Any:
    m = _fmod(a, b)
    quotient = _divide(_subtract(a, m), b)
    other_sign = _not_equal(_less(m, 0.0), _compare(np.less, _less, b, 0.0))
    quotient = where(_and(_not_equal(m, 0.0), other_sign), _subtract(quotient, 1.0), quotient)
    low = Scalar(ca.floor(expression(quotient)))
    return where(_less(0.5, _subtract(quotient, low)), add(low, 1.0), low)


def _rint(a: Any) -> Any:
    low = Scalar(ca.floor(a.sx))
    part = _subtract(a, low)
    even = _equal(_fmod(low, 2.0), 0.0)
    down = _or(_less(part, 0.5), _and(_equal(part, 0.5), even))
    return where(down, low, add(low, 1.0))


def _less(a: Any, b: Any) -> Scalar:
    return Scalar(ca.lt(expression(a), expression(b)), True)


def _less_equal(a: Any, b: Any) -> Scalar:
    return Scalar(ca.le(expression(a), expression(b)), True)


def _equal(a: Any, b: Any) -> Scalar:
    return Scalar(ca.eq(expression(a), expression(b)), True)


def _not_equal(a: Any, b: Any) -> Scalar:
    return Scalar(ca.ne(expression(a), expression(b)), True)


def _compare(ufunc: np.ufunc, rule: Callable, a: Any, b: Any) -> Any:
    return rule(a, b) if Scalar in (type(a), type(b)) else fold(ufunc, a, b)


def _and(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return truth(a) if b else False
    return Scalar(ca.logic_and(a.sx, b.sx), True)


def _or(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return True if b else truth(a)
    return Scalar(ca.logic_or(a.sx, b.sx), True)


def _not(a: Any) -> Any:
    return Scalar(ca.logic_not(a.sx), True) if type(a) is Scalar else not a


def truth(a: Any) -> Any:
    """Whether an element is not zero."""
    if type(a) is not Scalar:
        return bool(a)
    return a if a.boolean else _not_equal(a, 0.0)


def _xor(a: Any, b: Any) -> Any:
    return _not_equal(truth(a), truth(b))


def where(c: Any, a: Any, b: Any) -> Any:
    """Return ``a`` where ``c`` holds, else ``b``."""
    if type(c) is not Scalar:
        return a if c else b
    both = is_boolean(a) and is_boolean(b)
    if a is b or (type(a) is not Scalar and type(b) is not Scalar and a == b):
        return a
    if both and a is True and b is False:
        return truth(c)
    return Scalar(ca.if_else(c.sx, expression(a), expression(b)), both)


def _maximum(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    take = _less(a, b) if type(b) is not Scalar else _or(_less(a, b), _not_equal(b, b))
    return where(take, b, a)


def _minimum(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    take = _less(b, a) if type(b) is not Scalar else _or(_less(b, a), _not_equal(b, b))
    return where(take, b, a)


def _clip(x: Any, low: Any, high: Any) -> Any:
    x = _maximum(x, low) if Scalar in (type(x), type(low)) else max(x, low)
    return _minimum(x, high) if Scalar in (type(x), type(high)) else min(x, high)


def _logical(rule: Callable, name: str) -> Callable:
    def checked(*elements: Any) -> Any:
        if not all(is_boolean(e) for e in elements):
            refuse(f"{name} is traced for truth values only", "compare first, or use np.logical_and, np.logical_or")
        return rule(*elements)

    return checked


def _plain(function: Callable) -> Callable:
    return lambda *elements: Scalar(function(*[expression(e) for e in elements]))


def _swapped(rule: Callable) -> Callable:
    return lambda a, b: rule(b, a)


RULES: dict[np.ufunc, Callable] = {
    np.add: add,
    np.subtract: _subtract,
    np.multiply: _multiply,
    np.true_divide: _divide,
    np.negative: _negative,
    np.positive: lambda a: a,
    np.power: _power,
    np.float_power: _power,
    np.square: lambda a: _multiply(a, a),
    np.reciprocal: lambda a: _divide(1.0, a),
    np.fmod: _fmod,
    np.remainder: _mod,
    np.floor_divide: _floor_divide,
    np.absolute: _plain(ca.fabs),
    np.fabs: _plain(ca.fabs),
    np.sign: _plain(ca.sign),
    np.copysign: _plain(ca.copysign),
    np.floor: _plain(ca.floor),
    np.ceil: _plain(ca.ceil),
    np.trunc: lambda a: where(_less(a, 0.0), Scalar(ca.ceil(a.sx)), Scalar(ca.floor(a.sx))),
    np.rint: _rint,
    np.sqrt: _plain(ca.sqrt),
    np.exp: _plain(ca.exp),
    np.expm1: _plain(ca.expm1),
    np.exp2: lambda a: Scalar(ca.power(2.0, a.sx)),
    np.log: _plain(ca.log),
    np.log1p: _plain(ca.log1p),
    np.log2: lambda a: Scalar(ca.log(a.sx) / float(np.log(2.0))),
    np.log10: _plain(ca.log10),
    np.sin: _plain(ca.sin),
    np.cos: _plain(ca.cos),
    np.tan: _plain(ca.tan),
    np.arcsin: _plain(ca.asin),
    np.arccos: _plain(ca.acos),
    np.arctan: _plain(ca.atan),
    np.arctan2: _plain(ca.atan2),
    np.sinh: _plain(ca.sinh),
    np.cosh: _plain(ca.cosh),
    np.tanh: _plain(ca.tanh),
    np.arcsinh: _plain(ca.asinh),
    np.arccosh: _plain(ca.acosh),
    np.arctanh: _plain(ca.atanh),
    np.hypot: _plain(ca.hypot),
    np.deg2rad: lambda a: _multiply(a, np.pi / 180.0),
    np.radians: lambda a: _multiply(a, np.pi / 180.0),
    np.rad2deg: lambda a: _multiply(a, 180.0 / np.pi),
    np.degrees: lambda a: _multiply(a, 180.0 / np.pi),
    np.maximum: _maximum,
    np.minimum: _minimum,
    np.fmax: _plain(ca.fmax),
    np.fmin: _plain(ca.fmin),
    np._core.umath.clip: _clip,
    np.less: _less,
    np.less_equal: _less_equal,
    np.greater: _swapped(_less),
    np.greater_equal: _swapped(_less_equal),
    np.equal: _equal,
    np.not_equal: _not_equal,
    np.logical_and: _and,
    np.logical_or: _or,
    np.logical_not: _not,
    np.logical_xor: _xor,
    np.bitwise_and: _logical(_and, "&"),
    np.bitwise_or: _logical(_or, "|"),
    np.bitwise_xor: _logical(_xor, "^"),
    np.invert: _logical(_not, "~"),
    np.isfinite: lambda a: Scalar(ca.le(ca.fabs(a.sx), _LARGEST), True),
    np.isinf: lambda a: Scalar(ca.lt(_LARGEST, ca.fabs(a.sx)), True),
    np.isnan: lambda a: Scalar(ca.ne(a.sx, a.sx), True),
}

for _name, _rule in {
    "add": add,
    "sub": _subtract,
    "mul": _multiply,
    "truediv": _divide,
    "pow": _power,
    "mod": _mod,
    "floordiv": _floor_divide,
    "and": RULES[np.bitwise_and],
    "or": RULES[np.bitwise_or],
    "xor": RULES[np.bitwise_xor],
}.items():
    setattr(Scalar, f"__{_name}__", _binary(_rule))
    setattr(Scalar, f"__r{_name}__", _binary(_rule, reflected=True))
for _name, _ufunc_ in {
    "lt": np.less,
    "le": np.less_equal,
    "gt": np.greater,
    "ge": np.greater_equal,
    "eq": np.equal,
    "ne": np.not_equal,
}.items():
    setattr(Scalar, f"__{_name}__", _binary(RULES[_ufunc_]))
Scalar.__neg__ = _negative
Scalar.__pos__ = lambda self: self
Scalar.__abs__ = RULES[np.absolute]
Scalar.__invert__ = RULES[np.invert]


def fold(ufunc: np.ufunc, *constants: Any) -> Any:
    """Apply a ufunc to constants."""
    with np.errstate(all="ignore"):
        return ufunc(*constants).item()


def number(e: Any) -> Any:
    """Return an element as a number: a truth value is 0 or 1."""
    return e if not is_boolean(e) else Scalar(e.sx) if type(e) is Scalar else float(e)
