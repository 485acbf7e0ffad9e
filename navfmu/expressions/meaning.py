"""What an expression means in a system: names become signals, units are checked, and operations come out.

* Values are in SI: what is in another unit is converted as it is loaded, except where a signal is all there is.
  A number without a unit is in the unit of the signal on the other side of a sign, or a plain number.
* Sums, comparisons, min and max want values of one dimension; angles are a dimension of their own only beside angles.
* A signal without a unit goes with everything.
* A truth value is no number and a number no truth value: ``navigator.mode != 0``.
* ``abs(x)``, ``sqrt(x)``, ``min(...)``, ``max(...)``, ``norm(...)``: the last three also of arrays. ``active(ID)``:
  whether that fault acts, ``active()``: whether one does. ``time``: the time of the communication point.
* ``where`` has expressions by name, for instance phases of flight; they may be used like signals.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

from navfmu.errors import nearest
from navfmu.expressions.parser import ExpressionError, parse
from navfmu.expressions.program import DEEPEST, Op, Program, Source
from navfmu.expressions.tree import Binary, Call, Name, Node, Quantity, Truth, Unary
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import BASE, COMMON, Unit, dimension

COMPARISONS = {
    "<": Op.LESS,
    "<=": Op.AT_MOST,
    ">": Op.GREATER,
    ">=": Op.AT_LEAST,
    "==": Op.EQUAL,
    "!=": Op.DIFFERENT,
}
SIGNS = {"+": Op.PLUS, "-": Op.MINUS, "*": Op.MULTIPLY, "/": Op.DIVIDE}
FUNCTIONS = ("abs", "active", "max", "min", "norm", "sqrt")
NESTED = 100  # parts of an expression within one another
_NONE = Unit("1", (0,) * len(BASE))
_SECOND = COMMON["s"]

FEW = 6  # names that a sentence tells when none is near
_FACTOR = re.compile(r"([*/]?)([^*/^]+)(?:\^(-?\d+))?")

Row = tuple[Op, float]


@dataclass(frozen=True)
class Value:
    """A part of an expression, compiled."""

    rows: tuple[Row, ...]
    boolean: bool = False
    unit: Unit | None = _NONE  # of the value, which is in SI; None: not known, goes with every other
    own: Unit | None = None  # the unit of the signal that it is, for a number without a unit beside it
    number: bool = False  # a number without a unit
    array: tuple[Value, ...] = ()  # the elements, of what is no single value


def compile_expression(
    text: str,
    system: Mapping[str, Description],
    faults: Collection[str] | None = None,
    named: Mapping[str, str] | None = None,
    *,
    boolean: bool | None = None,
) -> Program:
    """The program of an expression over the signals of a system.

    ``faults`` are the ids that ``active`` may name (None: any); ``named`` are expressions by name. ``boolean`` asks for
    a truth value, or for none. What is wrong is an ``ExpressionError`` with the place in the text.
    """
    compiler = _Compiler(text, system, faults, named or {})
    tree = parse(text)
    value = compiler.value(tree)
    if isinstance(tree, Name) and value.own is not None:
        value = replace(value, rows=value.rows[:1], unit=value.own)
    if boolean is not None and value.boolean is not boolean:
        expected = "a truth value, such as 'x < 1'" if boolean else "a number"
        raise compiler.error(tree, f"expected {expected}, but this is {_kind(value)}")
    program = Program(text, value.rows, tuple(compiler.sources), tuple(compiler.faults), value.boolean, value.unit)
    if program.depth > DEEPEST:
        raise compiler.error(tree, f"it takes {program.depth} values at a time, expected at most {DEEPEST}")
    return program


@dataclass
class _Compiler:
    text: str
    system: Mapping[str, Description]
    known_faults: Collection[str] | None
    named: Mapping[str, str]
    sources: dict[Source, int] = field(default_factory=dict)
    faults: dict[str, int] = field(default_factory=dict)
    inside: tuple[str, ...] = ()  # names that are being looked up
    nested: int = 0

    def error(self, node: Node, sentence: str) -> ExpressionError:
        return ExpressionError(self.text, node.at, sentence)

    def value(self, node: Node) -> Value:
        """A part of the expression, one value."""
        found = self.values(node)
        if found.array:
            raise self.error(node, f"this is an array of {len(found.array)}, expected one value: an element, or norm()")
        return found

    def values(self, node: Node) -> Value:
        """A part of the expression, which may be an array."""
        self.nested += 1
        if self.nested > NESTED:
            raise self.error(node, f"more than {NESTED} parts within one another")
        try:
            return _COMPILE[type(node)](self, node)
        finally:
            self.nested -= 1

    # ---- what has no parts -------------------------------------------------------------------------------------------

    def quantity(self, node: Quantity) -> Value:
        if not isfinite(node.number):
            raise self.error(node, "this number is too large")
        if not node.unit:
            return Value(((Op.CONSTANT, node.number),), number=True)
        unit = self.unit(node)
        return Value(((Op.CONSTANT, unit.factor * node.number + unit.offset),), unit=_si(unit))

    def unit(self, node: Quantity) -> Unit:
        """The unit of a number: one of those that people write, or that an FMU defines."""
        known = dict(COMMON)
        for description in self.system.values():
            known = {unit.name: unit for unit in description.units.values() if unit.exponents is not None} | known
            for own, displayed in description.display_units.items():
                unit = description.units.get(own)
                if unit is not None and unit.exponents is not None:
                    for name, (factor, offset) in displayed.items():  # shown = factor * own + offset
                        shown = Unit(
                            name, unit.exponents, unit.factor / factor, unit.offset - unit.factor * offset / factor
                        )
                        known.setdefault(name, shown)
        if node.unit in known:
            return known[node.unit]
        exponents, factor = [0] * len(BASE), 1.0
        for sign, name, power in _FACTOR.findall(node.unit):  # m^2, kg*m/s^2
            if name not in known or known[name].offset:
                hint = nearest(name, known)
                hint += "; between a unit and a sign belongs a blank" if name != node.unit else ""
                raise self.error(node, f"the unit '{node.unit}' is not known{hint}")
            times = int(power or 1) * (-1 if sign == "/" else 1)
            factor *= known[name].factor ** times
            exponents = [a + times * b for a, b in zip(exponents, known[name].exponents or (), strict=True)]
        return Unit(node.unit, tuple(exponents), factor)

    def truth(self, node: Truth) -> Value:
        return Value(((Op.CONSTANT, float(node.value)),), boolean=True)

    def name(self, node: Name) -> Value:
        if node.text in self.named:
            return self.definition(node)
        if node.text == "time":
            return Value(((Op.TIME, 0.0),), unit=_SECOND)
        name, true = (node.text.removesuffix(names.TRUE), node.text.endswith(names.TRUE))
        component, variable = names.split(name)
        if name in self.system:
            own = [signal for signal in self.everything() if signal.startswith(f"{name}.")]
            example = f", such as '{own[0]}'" if own else ""
            raise self.error(node, f"'{name}' is a component, expected one of its signals{example}")
        if component not in self.system or not variable:
            close = nearest(name, self.everything()) or nearest(component, [*self.system, *self.named, "time"])
            what = f"component '{component}'" if variable else f"signal '{name}'"
            raise self.error(node, f"there is no {what}{close}")
        return self.signal(node, component, variable, true)

    def everything(self) -> list[str]:
        """All names that can be written."""
        outputs = [str(signal) for signal in names.outputs(self.system)]
        return [*names.short(outputs), *self.named, "time"]

    def definition(self, node: Name) -> Value:
        """An expression that has a name."""
        if node.text in self.inside:
            raise self.error(node, f"'{node.text}' is explained by itself")
        text, inside = self.text, self.inside
        self.text, self.inside = self.named[node.text], (*inside, node.text)
        try:
            return self.values(parse(self.text))
        except ExpressionError as problem:
            raise ExpressionError(text, node.at, f"'{node.text}': {problem}") from None
        finally:
            self.text, self.inside = text, inside

    def signal(self, node: Name, component: str, variable: str, true: bool) -> Value:
        description = self.system[component]
        found = names.group(description.by_name, variable)
        if not found:
            known = names.short(v.name for v in description.variables if v.causality in ("input", "output"))
            hint = names.hint(variable, known) or (f" (it has: {', '.join(known)})" if 0 < len(known) <= FEW else "")
            raise self.error(node, f"component '{component}' has no variable '{variable}'{hint}")
        if not all(map(names.is_element, found)):
            members = ", ".join(dict.fromkeys(map(names.array, found.values())))
            raise self.error(node, f"'{component}.{variable}' is a bundle, expected one of its members: {members}")
        values = [self.load(node, component, description.by_name[full], true) for full in found.values()]
        return values[0] if "" in found else Value((), unit=values[0].unit, own=values[0].own, array=tuple(values))

    def load(self, node: Node, component: str, variable: Variable, true: bool) -> Value:
        name = f"'{component}.{variable.name}'"
        if variable.causality not in ("output", "input"):
            raise self.error(node, f"{name} is a {variable.causality}, expected an output or an input")
        if variable.type == "String":
            raise self.error(node, f"{name} is a text, expected a number or a truth value")
        if true and variable.causality != "output":
            raise self.error(node, f"{name} is an input: only outputs have a value without faults beside the other")
        place = self.sources.setdefault(Source(names.Signal(component, variable), true), len(self.sources))
        rows: list[Row] = [(Op.LOAD_SIGNAL, float(place))]
        if variable.type == "Boolean":
            return Value(tuple(rows), boolean=True)
        unit = None if variable.unit is None else self.system[component].units.get(variable.unit, Unit(variable.unit))
        if unit is None or unit.exponents is None:
            return Value(tuple(rows), unit=None)
        offset = 0.0 if variable.relative else unit.offset
        if unit.factor != 1.0:
            rows += [(Op.CONSTANT, unit.factor), (Op.MULTIPLY, 0.0)]
        if offset != 0.0:
            rows += [(Op.CONSTANT, offset), (Op.PLUS, 0.0)]
        return Value(tuple(rows), unit=_si(unit), own=replace(unit, offset=offset))

    # ---- what has parts ----------------------------------------------------------------------------------------------

    def unary(self, node: Unary) -> Value:
        operand = self.value(node.operand)
        if node.sign == "not":
            self.check(node.operand, operand, True)
            return Value((*operand.rows, (Op.NOT, 0.0)), boolean=True)
        self.check(node.operand, operand, False)
        return replace(operand, rows=(*operand.rows, (Op.NEGATE, 0.0)))

    def binary(self, node: Binary) -> Value:
        left, right = self.value(node.left), self.value(node.right)
        if node.sign in ("and", "or"):
            self.check(node.left, left, True)
            self.check(node.right, right, True)
            return Value((*left.rows, *right.rows, (Op.AND if node.sign == "and" else Op.OR, 0.0)), boolean=True)
        if node.sign in ("==", "!=") and left.boolean and right.boolean:
            return Value((*left.rows, *right.rows, (COMPARISONS[node.sign], 0.0)), boolean=True)
        self.check(node.left, left, False)
        self.check(node.right, right, False)
        if node.sign in ("*", "/"):
            rows = (*left.rows, *right.rows, (SIGNS[node.sign], 0.0))
            return Value(
                rows, unit=_product(left, right, 1 if node.sign == "*" else -1), number=left.number and right.number
            )
        left, right = self.alike(node, f"'{node.sign}'", (left, right))
        if node.sign in COMPARISONS:
            return Value((*left.rows, *right.rows, (COMPARISONS[node.sign], 0.0)), boolean=True)
        rows = (*left.rows, *right.rows, (SIGNS[node.sign], 0.0))
        return Value(rows, unit=_common(left, right), number=left.number and right.number)

    def call(self, node: Call) -> Value:
        if node.function not in FUNCTIONS:
            have = f" (functions: {', '.join(FUNCTIONS)})"
            raise self.error(node, f"there is no function '{node.function}'{nearest(node.function, FUNCTIONS)}{have}")
        if node.function == "active":
            return self.active(node)
        if node.function in ("abs", "sqrt"):
            return self.of_one(node)
        return self.of_many(node)

    def active(self, node: Call) -> Value:
        if not node.arguments:
            return Value(((Op.ACTIVE, -1.0),), boolean=True)
        (first, *more) = node.arguments
        if more or not isinstance(first, Name):
            raise self.error(node, "active() takes the id of one fault, or nothing")
        if self.known_faults is not None and first.text not in self.known_faults:
            have = f" (faults: {', '.join(self.known_faults) or 'none'})"
            raise self.error(first, f"there is no fault '{first.text}'{nearest(first.text, self.known_faults)}{have}")
        place = self.faults.setdefault(first.text, len(self.faults))
        return Value(((Op.ACTIVE, float(place)),), boolean=True)

    def of_one(self, node: Call) -> Value:
        if len(node.arguments) != 1:
            raise self.error(node, f"{node.function}() takes one value, not {len(node.arguments)}")
        operand = self.value(node.arguments[0])
        self.check(node.arguments[0], operand, False)
        if node.function == "abs":
            return replace(operand, rows=(*operand.rows, (Op.ABS, 0.0)))
        exponents = operand.unit and operand.unit.exponents
        if exponents and any(power % 2 for power in exponents):
            raise self.error(node, f"sqrt() of {dimension(operand.unit)}, expected even powers of units")
        unit = operand.unit and _si(Unit("", tuple(power // 2 for power in exponents or ())))
        return Value((*operand.rows, (Op.SQRT, 0.0)), unit=unit, number=operand.number)

    def of_many(self, node: Call) -> Value:
        values: list[Value] = []
        for argument in node.arguments:
            found = self.values(argument)
            for value in found.array or (found,):
                self.check(argument, value, False)
                values.append(value)
        if not values:
            raise self.error(node, f"{node.function}() takes at least one value")
        values = self.alike(node, f"{node.function}()", values)
        squared = node.function == "norm"
        join = {"norm": Op.PLUS, "min": Op.MINIMUM, "max": Op.MAXIMUM}[node.function]
        rows: list[Row] = []
        for number, value in enumerate(values):
            rows += value.rows
            rows += [(Op.SQUARE, 0.0)] if squared else []
            rows += [(join, 0.0)] if number else []
        rows += [(Op.SQRT, 0.0)] if squared else []
        unit, own = _common(*values), next((value.own for value in values if value.own), None)
        return Value(tuple(rows), unit=unit, own=own, number=all(value.number for value in values))

    # ---- checks ------------------------------------------------------------------------------------------------------

    def check(self, node: Node, value: Value, boolean: bool) -> None:
        if value.boolean is not boolean:
            expected = "a truth value: compare it, as in 'x > 0'" if boolean else "a number"
            raise self.error(node, f"this is {_kind(value)}, expected {expected}")

    def alike(self, node: Node, what: str, values: Sequence[Value]) -> list[Value]:
        """Values of one dimension; a number without a unit gets that of a signal beside it."""
        own = next((value.own for value in values if value.own is not None), None)
        values = [_with(value, own) if value.number and own else value for value in values]
        known = [value for value in values if value.unit is not None and not value.number]
        for value in known[1:]:
            if not known[0].unit.agrees(value.unit):  # type: ignore[union-attr]
                first, second = (v.unit.name for v in (known[0], value))  # type: ignore[arg-type]
                raise self.error(node, f"{what} joins {first} and {second}, expected one dimension")
        return values


_COMPILE: dict[type, Callable[..., Value]] = {
    Quantity: _Compiler.quantity,
    Truth: _Compiler.truth,
    Name: _Compiler.name,
    Unary: _Compiler.unary,
    Binary: _Compiler.binary,
    Call: _Compiler.call,
}


def _kind(value: Value) -> str:
    return "a truth value" if value.boolean else "a number"


def _si(unit: Unit) -> Unit:
    """The SI unit of that dimension, by the name that people write."""
    if unit.exponents is not None and not any(unit.exponents):
        return _NONE
    common = (u for u in COMMON.values() if u.exponents == unit.exponents and (u.factor, u.offset) == (1.0, 0.0))
    return next(common, Unit(dimension(unit), unit.exponents))


def _with(value: Value, own: Unit) -> Value:
    """A number without a unit, which is in ``own``, in SI."""
    rows = list(value.rows)
    if own.factor != 1.0:
        rows += [(Op.CONSTANT, own.factor), (Op.MULTIPLY, 0.0)]
    if own.offset != 0.0:
        rows += [(Op.CONSTANT, own.offset), (Op.PLUS, 0.0)]
    return Value(tuple(rows), unit=_si(own))


def _common(*values: Value) -> Unit | None:
    """The unit of values that are alike."""
    known = [value.unit for value in values if value.unit is not None and not value.number]
    return known[0] if known else None if any(value.unit is None for value in values) else _NONE


def _product(left: Value, right: Value, sign: int) -> Unit | None:
    if left.unit is None or right.unit is None:
        return None
    pairs = zip(left.unit.exponents or (), right.unit.exponents or (), strict=True)
    return _si(Unit("", tuple(a + sign * b for a, b in pairs)))
