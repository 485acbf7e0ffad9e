"""A small system for expressions: components with units, an array, a bundle, a truth value, a parameter, a text."""

from __future__ import annotations

import random

from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import COMMON

UNITS = {name: COMMON[name] for name in ("m", "m/s", "rad", "rad/s", "deg", "degC", "s")}


def _description(name: str, *variables: Variable) -> Description:
    numbered = tuple(variable.__class__(**_fields(variable) | {"reference": n}) for n, variable in enumerate(variables))
    return Description(name, "", name, numbered, units=UNITS, display_units={"m": {"nmi": (1 / 1852.0, 0.0)}})


def _fields(variable: Variable) -> dict:
    return {name: getattr(variable, name) for name in Variable.__slots__}


def out(name: str, unit: str | None = None, type: str = "Real", causality: str = "output", **more) -> Variable:
    return Variable(name, 0, type, causality, unit=unit, **more)


SYSTEM = {
    "a": _description(
        "a",
        out("x", "m"),
        out("y", "m"),
        out("v", "m/s"),
        out("bearing", "deg"),
        out("warm", "degC"),
        out("warmer", "degC", relative=True),
        out("bare"),
        out("rate[1]", "rad/s"),
        out("rate[2]", "rad/s"),
        out("rate[3]", "rad/s"),
        out("fix.height", "m"),
        out("fix.valid", type="Boolean"),
        out("mode", type="Integer"),
        out("label", type="String"),
        out("tau", "s", causality="parameter"),
        out("u", "m", causality="input"),
    ),
    "odd name-1": _description("odd", out("x", "m")),
}


def random_text(draw: random.Random, deep: int, boolean: bool) -> str:
    """An expression that is one of Python, too, once its names are."""
    if boolean:
        if deep == 0:
            return draw.choice(["p.t", "p.f", "true", "false"])
        kind = draw.randrange(5)
        if kind == 0:
            return f"not {random_text(draw, deep - 1, True)}"
        if kind < 3:
            words = (random_text(draw, deep - 1, True) for _ in range(draw.randint(2, 3)))
            word = draw.choice([" and ", " or "])
            return f"({word.join(words)})"
        signs = ["<", "<=", ">", ">=", "==", "!="]
        text = random_text(draw, deep - 1, False)
        for _ in range(draw.randint(1, 2)):
            text += f" {draw.choice(signs)} {random_text(draw, deep - 1, False)}"
        return f"({text})"
    if deep == 0:
        return draw.choice(["p.x", "p.y", "p.z", "0.5", "2", "1e3", ".25"])
    kind = draw.randrange(8)
    if kind == 0:
        return f"-{random_text(draw, deep - 1, False)}"
    if kind == 1:
        return f"{draw.choice(['abs', 'sqrt'])}({random_text(draw, deep - 1, False)})"
    if kind == 2:
        words = (random_text(draw, deep - 1, False) for _ in range(draw.randint(1, 3)))
        name = draw.choice(["min", "max", "norm"])
        return f"{name}({', '.join(words)})"
    left, right = (random_text(draw, deep - 1, False) for _ in range(2))
    text = f"{left} {draw.choice('+-*/')} {right}"
    return f"({text})" if draw.random() < 0.5 else text
