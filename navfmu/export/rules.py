"""Traced numbers: :class:`Scalar`, and for each NumPy ufunc the rule that applies it to elements.

An element of a traced array is a Python number (a constant) or a Scalar. A rule takes elements, at least one of them a
Scalar, and returns an element; what it computes is what NumPy computes, to the last bit where the C library allows,
for every number: NaN, infinities and ``-0.0`` too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.graph import Node
from navfmu.export.graph import number as constant
from navfmu.export.place import place

_LARGEST = float(np.finfo(float).max)


def refuse(what: str, remedy: str) -> NoReturn:
    """Raise the error for a construct that has no traced form."""
    raise NavfmuError(f"{place()}: {what}; {remedy}")


class Scalar:
    """One traced number, and whether it is a truth value."""

    __slots__ = ("boolean", "node")
    __array_priority__ = 1000.0
    shape, ndim, size = (), 0, 1

    def __init__(self, node: Node, boolean: bool = False) -> None:
        self.node = node
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
        return RULES[np.rint](self) if not digits else self.__int__()

    def __repr__(self) -> str:
        return f"Scalar({self.node.op})"


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


def expression(x: Any) -> Node:
    """Return a Scalar's node, that of a constant as float."""
    return x.node if type(x) is Scalar else constant(x)


def _operation(op: str, *elements: Any, boolean: bool = False) -> Scalar:
    return Scalar(Node(op, *(expression(e) for e in elements)), boolean)


def _constant(x: Any, value: float) -> bool:
    """Whether an element is this constant, the sign of zero included."""
    return type(x) is not Scalar and x == value and math.copysign(1.0, x) == math.copysign(1.0, value)


def is_boolean(x: Any) -> bool:
    """Whether an element is a truth value."""
    return x.boolean if type(x) is Scalar else isinstance(x, bool)


def _traced(*elements: Any) -> bool:
    return any(type(e) is Scalar for e in elements)


def add(a: Any, b: Any) -> Any:
    """Sum of two elements."""
    if not _traced(a, b):
        return a + b
    if _constant(a, -0.0):  # x + 0.0 is not x when x is -0.0
        return number(b)
    return number(a) if _constant(b, -0.0) else _operation("add", a, b)


def _subtract(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return a - b
    if _constant(a, -0.0):
        return _negative(b)
    return number(a) if _constant(b, 0.0) else _operation("subtract", a, b)


def _multiply(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return a * b
    if type(a) is not Scalar:
        a, b = b, a
    if is_boolean(a) and is_boolean(b):
        return _and(a, b)
    if _constant(b, 1):
        return number(a)
    return _negative(a) if _constant(b, -1) else _operation("multiply", a, b)


def _divide(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return fold(np.true_divide, a, b)
    return number(a) if _constant(b, 1) else _operation("divide", a, b)


def _negative(a: Any) -> Any:
    return _operation("negative", a) if type(a) is Scalar else -a


def _power(a: Any, b: Any) -> Any:
    if type(b) is not Scalar:
        known = {0: lambda: 1.0, 1: lambda: number(a), 2: lambda: _multiply(number(a), number(a))}
        known |= {0.5: lambda: RULES[np.sqrt](a), -1: lambda: _divide(1.0, a)}
        if b in known:
            return known[b]()
    return _operation("pow", a, b)


def scalar_power(a: Any, b: Any) -> Any:
    """``a ** b`` of NumPy's scalars, which is C's ``pow`` where that of arrays takes a square root."""
    if type(a) is Scalar and _constant(b, 0.5):
        return where(_equal(a, -math.inf), math.inf, RULES[np.fabs](RULES[np.sqrt](a)))
    return _power(a, b)


def _fmod(a: Any, b: Any) -> Any:
    return _operation("fmod", a, b) if _traced(a, b) else fold(np.fmod, a, b)


def _copysign(a: Any, b: Any) -> Any:
    return _operation("copysign", a, b) if _traced(a, b) else fold(np.copysign, a, b)


def _remainder(a: Any, b: Any) -> tuple[Any, Any, Any]:
    """Return fmod(a, b), where it is not 0, and where it has not the sign of the divisor besides."""
    m = _fmod(a, b)
    some = _not_equal(m, 0.0)
    return m, some, _and(some, _not_equal(_less(m, 0.0), _less(b, 0.0)))


def _mod(a: Any, b: Any) -> Any:
    """Remainder with the sign of the divisor, as ``np.mod`` and Python's ``%``."""
    m, some, other_sign = _remainder(a, b)
    result = where(some, where(other_sign, add(m, b), m), _copysign(0.0, b))
    return where(_equal(b, 0.0), m, result)


def _floor_divide(a: Any, b: Any) -> Any:
    m, _, other_sign = _remainder(a, b)
    quotient = _divide(_subtract(a, m), b)
    quotient = where(other_sign, _subtract(quotient, 1.0), quotient)
    low = _operation("floor", quotient)
    near = where(_less(0.5, _subtract(quotient, low)), add(low, 1.0), low)
    whole = _divide(a, b)
    near = where(_not_equal(quotient, 0.0), near, _copysign(0.0, whole))
    return where(_equal(b, 0.0), whole, near)


def _sign(a: Any) -> Any:
    return where(_less(0.0, a), 1.0, where(_less(a, 0.0), -1.0, where(_equal(a, 0.0), 0.0, a)))


def _comparison(op: str, ufunc: np.ufunc) -> Callable:
    return lambda a, b: _operation(op, a, b, boolean=True) if _traced(a, b) else fold(ufunc, a, b)


_less = _comparison("less", np.less)
_less_equal = _comparison("less_equal", np.less_equal)
_equal = _comparison("equal", np.equal)
_not_equal = _comparison("not_equal", np.not_equal)


def _and(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return truth(a) if b else False
    return _operation("and", a, b, boolean=True)


def _or(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return True if b else truth(a)
    return _operation("or", a, b, boolean=True)


def _not(a: Any) -> Any:
    return _operation("not", a, boolean=True) if type(a) is Scalar else not a


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
    if a is b or (type(b) is not Scalar and _constant(a, b)):
        return a
    both = is_boolean(a) and is_boolean(b)
    if both and a is True and b is False:
        return truth(c)
    return _operation("where", c, a, b, boolean=both)


def is_nan(a: Any) -> Any:
    """Whether an element is no number."""
    return _not_equal(a, a)


# Which of two zeros of different sign is returned is not specified by NumPy; this is what it does on x86.


def _maximum(a: Any, b: Any) -> Any:
    return where(_or(_less(b, a), is_nan(a)), a, b)


def _minimum(a: Any, b: Any) -> Any:
    return where(_or(_less(a, b), is_nan(a)), a, b)


def _clip(x: Any, low: Any, high: Any) -> Any:
    x = where(_or(_less(x, low), is_nan(low)), low, x)
    return where(_or(_less(high, x), is_nan(high)), high, x)


def _logical(rule: Callable, name: str) -> Callable:
    def checked(*elements: Any) -> Any:
        if not all(is_boolean(e) for e in elements):
            refuse(f"{name} is traced for truth values only", "compare first, or use np.logical_and, np.logical_or")
        return rule(*elements)

    return checked


def _plain(op: str) -> Callable:
    """Return the rule for a function of C."""

    def rule(*elements: Any) -> Any:
        if all(is_boolean(e) for e in elements):
            refuse(f"NumPy computes {op} of truth values with 16 bits", "convert them, x.astype(float)")
        return _operation(op, *elements)

    return rule


def _same_if_truth(rule: Callable) -> Callable:
    """Return the rule for a function that gives back a truth value as it is."""
    return lambda a: a if is_boolean(a) else rule(a)


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
    np.square: lambda a: _multiply(number(a), number(a)),
    np.reciprocal: lambda a: _divide(1.0, a),
    np.fmod: _fmod,
    np.remainder: _mod,
    np.floor_divide: _floor_divide,
    np.absolute: _same_if_truth(_plain("fabs")),
    np.sign: _sign,
    np.floor: _same_if_truth(_plain("floor")),
    np.ceil: _same_if_truth(_plain("ceil")),
    np.trunc: _same_if_truth(_plain("trunc")),
    np.deg2rad: lambda a: _multiply(a, np.pi / 180.0),
    np.radians: lambda a: _multiply(a, np.pi / 180.0),
    np.rad2deg: lambda a: _multiply(a, 180.0 / np.pi),
    np.degrees: lambda a: _multiply(a, 180.0 / np.pi),
    np.maximum: _maximum,
    np.minimum: _minimum,
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
    np.isfinite: lambda a: _less_equal(RULES[np.absolute](a), _LARGEST),
    np.isinf: lambda a: _less(_LARGEST, RULES[np.absolute](a)),
    np.isnan: is_nan,
}
for _ufunc_, _op in {
    np.fabs: "fabs",
    np.copysign: "copysign",
    np.rint: "rint",
    np.sqrt: "sqrt",
    np.exp: "exp",
    np.expm1: "expm1",
    np.exp2: "exp2",
    np.log: "log",
    np.log1p: "log1p",
    np.log2: "log2",
    np.log10: "log10",
    np.sin: "sin",
    np.cos: "cos",
    np.tan: "tan",
    np.arcsin: "asin",
    np.arccos: "acos",
    np.arctan: "atan",
    np.arctan2: "atan2",
    np.sinh: "sinh",
    np.cosh: "cosh",
    np.tanh: "tanh",
    np.arcsinh: "asinh",
    np.arccosh: "acosh",
    np.arctanh: "atanh",
    np.hypot: "hypot",
    np.fmax: "fmax",
    np.fmin: "fmin",
}.items():
    RULES[_ufunc_] = _plain(_op)

for _name, _rule in {
    "add": add,
    "sub": _subtract,
    "mul": _multiply,
    "truediv": _divide,
    "pow": scalar_power,
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
    return e if not is_boolean(e) else Scalar(e.node) if type(e) is Scalar else float(e)
