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
from navfmu.export.place import place
from navfmu.export.record.graph import Node
from navfmu.export.record.graph import number as constant
from navfmu.export.tracing.extent import current

_LARGEST = float(np.finfo(float).max)


#: What is written instead of a function that has no traced form and no remedy of its own.
OTHERS = "write it with the functions that can (docs/what_traces.md lists them)"


class NoRoom(NavfmuError):
    """A traced value is wanted as a number: perhaps it is stored in an array of numbers."""


def refuse(what: str, remedy: str, kind: type[NavfmuError] = NavfmuError) -> NoReturn:
    """Raise the error for a construct that has no traced form."""
    raise kind(f"{place()}: {what}; {remedy}")


class Scalar:
    """One traced number, and its kind as NumPy's types have it: ``"b"`` truth value, ``"i"`` whole or ``"f"`` real."""

    __slots__ = ("kind", "node")
    __array_priority__ = 1000.0
    shape, ndim, size = (), 0, 1

    def __init__(self, node: Node, kind: str = "f") -> None:
        self.node = node
        self.kind = kind

    def __bool__(self) -> bool:
        refuse(
            "the truth of a traced value is not known while tracing (if, while, and, or, not, min, max; or a list of "
            "values where NumPy expects an array)",
            "choose with np.where, np.logical_and, np.logical_or, np.logical_not, np.minimum or np.maximum, and write "
            "np.array([...]) for a list",
        )

    def __float__(self) -> float:
        refuse(
            "a traced value has no float value (float(), math.*, or storing it in a float array)",
            "use NumPy functions instead of float() and math.*, and store in arrays that the function makes itself: "
            "np.zeros(...), np.array([...]), a copy of another one",
            NoRoom,
        )

    def __format__(self, how: str) -> str:
        if how:
            refuse("a traced value has no digits to be printed", "print it where the component runs with floats")
        return repr(self)

    def __int__(self) -> int:
        refuse("a traced value has no int value", "use np.floor or np.rint, or compare it with np.where")

    def __index__(self) -> int:
        refuse(
            "a traced value cannot be an index or a count",
            "select with np.where, index with constants, or loop with navfmu.repetition.repeat",
        )

    def __hash__(self) -> int:
        refuse("a traced value cannot be a key of a dict or set", "select with np.where")

    def __complex__(self) -> complex:
        refuse("complex numbers are not traced", "write real and imaginary part as two real numbers")

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
    if isinstance(x, str):
        refuse(
            f"a value meets the text '{x}', and values are numbers",
            "compare an enumeration with the member of an IntEnum, which may be its items",
        )
    return x.node if type(x) is Scalar else constant(x)


def _operation(op: str, *elements: Any, kind: str = "f") -> Scalar:
    current().count()
    return Scalar(Node(op, *(expression(e) for e in elements)), kind)


def _constant(x: Any, value: float) -> bool:
    """Whether an element is this constant, the sign of zero included."""
    return type(x) is not Scalar and x == value and math.copysign(1.0, x) == math.copysign(1.0, value)


def is_boolean(x: Any) -> bool:
    """Whether an element is a truth value."""
    return x.kind == "b" if type(x) is Scalar else isinstance(x, bool)


def is_whole(x: Any) -> bool:
    """Whether an element is a whole number or a truth value."""
    return x.kind != "f" if type(x) is Scalar else isinstance(x, int)


def _traced(*elements: Any) -> bool:
    return any(type(e) is Scalar for e in elements)


def _kind(*elements: Any) -> str:
    """Return the kind of what is calculated from elements that are not all truth values."""
    return "i" if all(is_whole(e) for e in elements) else "f"


def add(a: Any, b: Any) -> Any:
    """Sum of two elements."""
    if not _traced(a, b):
        return a + b
    if _constant(a, -0.0):  # x + 0.0 is not x when x is -0.0
        return number(b)
    return number(a) if _constant(b, -0.0) else _operation("add", a, b, kind=_kind(a, b))


def _subtract(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return a - b
    if _constant(a, -0.0):
        return _negative(number(b))
    if _constant(b, 0.0):
        return whole(a) if _kind(a, b) == "i" else number(a)
    return _operation("subtract", a, b, kind=_kind(a, b))


def _multiply(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return a * b
    if type(a) is not Scalar:
        a, b = b, a
    if is_boolean(a) and is_boolean(b):
        return _and(a, b)
    if _kind(a, b) == "i":
        positive = type(b) is not Scalar and b > 0
        return whole(a) if _constant(b, 1) else _unsigned(_operation("multiply", a, b, kind="i"), positive)
    if _constant(b, 1):
        return number(a)
    return _negative(number(a)) if _constant(b, -1) else _operation("multiply", a, b)


def _unsigned(a: Any, known: bool = False) -> Any:
    """Return a whole number without -0.0, which whole numbers do not have; ``known`` not to be it already."""
    return a if known or type(a) is not Scalar else _operation("add", a, 0.0, kind="i")


def _divide(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return fold(np.true_divide, a, b)
    return number(a) if _constant(b, 1) else _operation("divide", a, b)


def _negative(a: Any) -> Any:
    if type(a) is not Scalar:
        return -a
    return _operation("subtract", 0.0, a, kind="i") if is_whole(a) else _operation("negative", a)


def _power(a: Any, b: Any) -> Any:
    both = is_whole(a) and is_whole(b)
    if both and (type(b) is Scalar or b < 0):
        refuse("NumPy has no negative powers of whole numbers", "convert them, x.astype(float)")
    convert = whole if both else number
    if type(b) is not Scalar:
        known = {0: lambda: 1 if both else 1.0, 1: lambda: convert(a), 2: lambda: _multiply(convert(a), convert(a))}
        known |= {0.5: lambda: RULES[np.sqrt](a), -1: lambda: _divide(1.0, a)}
        if b in known:
            return known[b]()
    return _operation("pow", a, b, kind="i" if both else "f")


def scalar_power(a: Any, b: Any) -> Any:
    """``a ** b`` of NumPy's scalars, which is C's ``pow`` where that of arrays takes a square root."""
    if type(a) is Scalar and _constant(b, 0.5):
        return where(_equal(a, -math.inf), math.inf, RULES[np.fabs](RULES[np.sqrt](a)))
    return _power(a, b)


def _fmod(a: Any, b: Any) -> Any:
    if not _traced(a, b):
        return fold(np.fmod, a, b)
    return _whole_division(_operation("fmod", a, b), a, b)


def _whole_division(result: Any, a: Any, b: Any) -> Any:
    """Return the result of a division or its remainder; of whole numbers it is 0 where they are divided by 0."""
    if is_boolean(a) and is_boolean(b):
        refuse("NumPy divides truth values as numbers of 8 bits", "convert them, x.astype(float)")
    if _kind(a, b) == "f":
        return result
    result = _unsigned(Scalar(expression(result), "i"))
    return where(_equal(b, 0), 0, result) if type(b) is Scalar or b == 0 else result


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
    return _whole_division(where(_equal(b, 0.0), m, result), a, b)


def _floor_divide(a: Any, b: Any) -> Any:
    m, _, other_sign = _remainder(a, b)
    exact = _divide(_subtract(a, m), b)
    exact = where(other_sign, _subtract(exact, 1.0), exact)
    low = _operation("floor", exact)
    near = where(_less(0.5, _subtract(exact, low)), add(low, 1.0), low)
    quotient = _divide(a, b)
    near = where(_not_equal(exact, 0.0), near, _copysign(0.0, quotient))
    return _whole_division(where(_equal(b, 0.0), quotient, near), a, b)


def _sign(a: Any) -> Any:
    if is_whole(a):
        return where(_less(0.0, a), 1, where(_less(a, 0.0), -1, 0))
    return where(_less(0.0, a), 1.0, where(_less(a, 0.0), -1.0, where(_equal(a, 0.0), 0.0, a)))


def _comparison(op: str, ufunc: np.ufunc) -> Callable:
    return lambda a, b: _operation(op, a, b, kind="b") if _traced(a, b) else fold(ufunc, a, b)


_less = _comparison("less", np.less)
_less_equal = _comparison("less_equal", np.less_equal)
_equal = _comparison("equal", np.equal)
_not_equal = _comparison("not_equal", np.not_equal)


def _and(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return truth(a) if b else False
    return _operation("and", a, b, kind="b")


def _or(a: Any, b: Any) -> Any:
    if type(a) is not Scalar:
        a, b = b, a
    if type(b) is not Scalar:
        return True if b else truth(a)
    return _operation("or", a, b, kind="b")


def _not(a: Any) -> Any:
    return _operation("not", a, kind="b") if type(a) is Scalar else not a


def truth(a: Any) -> Any:
    """Whether an element is not zero."""
    if type(a) is not Scalar:
        return bool(a)
    return a if a.kind == "b" else _not_equal(a, 0.0)


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
    return _operation("where", c, a, b, kind="b" if both else _kind(a, b))


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


def _same_if_whole(op: str) -> Callable:
    """Return the rule for a function of C that gives back a whole number, or a truth value, as it is."""
    return lambda a: a if is_whole(a) else _operation(op, a)


def _absolute(a: Any) -> Any:
    return a if is_boolean(a) else _operation("fabs", a, kind=_kind(a))


def _larger_or_smaller(op: str) -> Callable:
    return lambda a, b: _operation(op, a, b, kind=_kind(a, b))


def _reciprocal(a: Any) -> Any:
    if is_whole(a):
        refuse("NumPy's reciprocal of a whole number is a whole number", "write 1.0 / x")
    return _divide(1.0, a)


def _number_only(rule: Callable, name: str) -> Callable:
    """Return a rule that truth values have not."""

    def checked(a: Any) -> Any:
        if is_boolean(a):
            refuse(f"NumPy has no {name} of truth values", "convert them, x.astype(float)")
        return rule(a)

    return checked


def _swapped(rule: Callable) -> Callable:
    return lambda a, b: rule(b, a)


RULES: dict[np.ufunc, Callable] = {
    np.add: add,
    np.subtract: _subtract,
    np.multiply: _multiply,
    np.true_divide: _divide,
    np.negative: _negative,
    np.positive: _number_only(lambda a: a, "+"),
    np.power: _power,
    np.float_power: lambda a, b: _operation("pow", a, b),
    np.square: lambda a: _power(a, 2),
    np.reciprocal: _reciprocal,
    np.fmod: _fmod,
    np.remainder: _mod,
    np.floor_divide: _floor_divide,
    np.absolute: _absolute,
    np.sign: _number_only(_sign, "sign"),
    np.floor: _same_if_whole("floor"),
    np.ceil: _same_if_whole("ceil"),
    np.trunc: _same_if_whole("trunc"),
    np.deg2rad: lambda a: _multiply(a, np.pi / 180.0),
    np.radians: lambda a: _multiply(a, np.pi / 180.0),
    np.rad2deg: lambda a: _multiply(a, 180.0 / np.pi),
    np.degrees: lambda a: _multiply(a, 180.0 / np.pi),
    np.fmax: _larger_or_smaller("fmax"),
    np.fmin: _larger_or_smaller("fmin"),
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
Scalar.__pos__ = RULES[np.positive]
Scalar.__abs__ = RULES[np.absolute]
Scalar.__invert__ = RULES[np.invert]


def fold(ufunc: np.ufunc, *constants: Any) -> Any:
    """Apply a ufunc to constants."""
    with np.errstate(all="ignore"):
        return ufunc(*constants).item()


def number(e: Any) -> Any:
    """Return an element as a real number: a truth value is 0.0 or 1.0."""
    if type(e) is not Scalar:
        return float(e)
    return e if e.kind == "f" else Scalar(e.node)


def whole(e: Any) -> Any:
    """Return an element, which has no fraction, as a whole number: a truth value is 0 or 1."""
    if type(e) is not Scalar:
        return int(e)
    if e.kind == "f":
        return _unsigned(Scalar(e.node, "i"))
    return e if e.kind == "i" else Scalar(e.node, "i")
