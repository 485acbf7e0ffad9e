"""Expressions drawn over all that a model may contain, from inputs among NaN, infinities, -0.0 and denormals."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import CodeType
from typing import Any

import numpy as np

from evidence.compiled import Compiled, traced
from evidence.functions import FUNCTIONS, NAMES, Function

#: Shapes of the inputs of an expression.
INPUTS = {"x": (4,), "y": (4,), "m": (2, 2), "s": ()}
_SHAPES = ((), (4,), (2, 2))
_FIXED = {"v": (4,), "m": (2, 2), "s": ()}  # the shape of an operand
SPECIAL = np.array(
    "0.0 -0.0 1 -1 inf -inf nan 5e-324 -5e-324 2.2e-308 1.7976931348623157e308 -1e308 0.5 -0.5 1.5 2.5 -2.5 2 3 -3 "
    "4503599627370496.5 9007199254740993 -9.3e18 3.141592653589793 0.1".split(),
    float,
)
_CONSTANTS = "0.0 -0.0 1 -1.0 0 2 -3 0.5 -0.3 3.7 inf -inf nan 5e-324 1e308 1e-9".split()


@dataclass(frozen=True)
class Step:
    """One function applied to operands that have names."""

    function: Function
    text: str
    operands: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: type  # of its numbers: bool, int or float
    code: CodeType = field(repr=False)
    repeated: CodeType = field(repr=False)


class Expression:
    """Steps ``a0``, ``a1``, ... over the inputs; each uses inputs, constants and results of steps before it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.steps: list[Step] = []

    def __call__(self, **inputs: Any) -> Any:
        """Return the results of all steps in one vector of real numbers; ``inputs`` may be traced."""
        known = NAMES | inputs
        for i, step in enumerate(self.steps):
            known[f"a{i}"] = eval(step.code, known)
        return np.concatenate([np.ravel(known[f"a{i}"]) * 1.0 for i in range(len(self.steps))])

    def traced(self) -> Compiled:
        """Return the traced expression, a function of the inputs in their order."""

        def function(*values: Any) -> Any:
            return self(**dict(zip(INPUTS, values, strict=True)))

        with np.errstate(all="ignore"):  # constants are calculated while tracing
            return traced(function, [np.zeros(shape) for shape in INPUTS.values()])

    def source(self, last: int | None = None) -> str:
        """Return the lines of the steps, up to the ``last``."""
        steps = self.steps[: None if last is None else last + 1]
        return "\n".join([f"# {self.name}", *(f"a{i} = {step.text}" for i, step in enumerate(steps))])


def numbers(rng: np.random.Generator, size: int) -> np.ndarray:
    """Draw numbers: of everyday size, special ones, any bits at all, and some that are equal to others."""
    drawn = rng.normal(size=size) * 10.0 ** rng.integers(-3, 4, size)
    drawn = np.where(rng.random(size) < 0.4, rng.choice(SPECIAL, size), drawn)
    drawn = np.where(rng.random(size) < 0.05, rng.integers(2**64, size=size, dtype=np.uint64).view(float), drawn)
    return np.where(rng.random(size) < 0.2, np.roll(drawn, 1), drawn)


def inputs(rng: np.random.Generator, count: int) -> list[dict[str, Any]]:
    """Draw the inputs of an expression, so many times."""
    sizes = [math.prod(shape) for shape in INPUTS.values()]
    rows = numbers(rng, count * sum(sizes)).reshape(count, -1)
    return [
        {name: part.reshape(INPUTS[name])[()] for name, part in zip(INPUTS, parts, strict=True)}
        for parts in (np.split(row, np.cumsum(sizes)[:-1]) for row in rows)
    ]


def draw(seed: Sequence[int], functions: Sequence[Function] = FUNCTIONS, length: int = 6) -> Expression:
    """Draw an expression of so many steps; the same seed gives the same expression."""
    rng = np.random.default_rng(seed)
    expression = Expression(f"draw({list(seed)})")
    (known,) = inputs(rng, 1)
    _add(expression, known, Function("{v} > {v}"), ["x", "y"])
    while len(expression.steps) < length:
        function = functions[rng.integers(len(functions))]
        operands = _operands(rng, function, known)
        if _names(operands, known):
            _add(expression, known, function, operands)
    return expression


def _add(expression: Expression, known: dict[str, Any], function: Function, operands: list[str]) -> None:
    """Add a step; its shape and kind are found by doing it once."""
    text = function.written(operands)
    code = compile(text, "<expression>", "eval")
    with np.errstate(all="ignore"):
        result = np.asarray(eval(code, NAMES | known))
    repeated = compile(function.written(operands, reference=True), "<expression>", "eval")
    dtype = {"b": bool, "i": int}.get(result.dtype.kind, float)
    step = Step(function, text, _names(operands, known), result.shape, dtype, code, repeated)
    known[f"a{len(expression.steps)}"] = result[()]
    expression.steps.append(step)


def _names(operands: list[str], known: dict[str, Any]) -> tuple[str, ...]:
    """Return the known names in the source of operands."""
    return tuple(dict.fromkeys(name for text in operands for name in re.findall(r"[a-z]\w*", text) if name in known))


def _operands(rng: np.random.Generator, function: Function, known: dict[str, Any]) -> list[str]:
    """Return names of known values, or constants, that suit a function; arrays of one shape where it is free."""
    shape = _SHAPES[rng.integers(len(_SHAPES))]
    constant = "}." not in function.template  # else an operand has a method

    def among(shapes: tuple[tuple[int, ...], ...], kinds: str) -> str:
        found = [n for n, v in known.items() if np.shape(v) in shapes and np.asarray(v).dtype.kind in kinds]
        return found[rng.integers(len(found))] if found else ""

    names = []
    for letter in function.operands:
        name, chance = "", rng.random()
        if letter == "b":
            name = among((shape, ()), "b") or f"({among((shape,), 'f')} > 0)"
        elif letter in _FIXED:
            name = among((_FIXED[letter],), "fi")
        elif letter != "c" and (chance < 0.85 or not constant):
            name = among(((),) if chance < 0.15 else (shape,), "f" if letter == "r" else "fi")
        names.append(name or f"({_constant(rng, real=letter == 'r')})")
    return names


def _constant(rng: np.random.Generator, real: bool) -> str:
    text = _CONSTANTS[rng.integers(len(_CONSTANTS))]
    return f"{text}.0" if real and text.lstrip("-").isdigit() else text
