"""Faults become effects: what each type does to each variable of its targets, in numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from navfmu.engine.component import Component
from navfmu.engine.effect import (
    ADD,
    AFFINE,
    CLIP,
    DELAY,
    GARBAGE,
    HOLD,
    NOISE,
    QUANTISE,
    RAMP,
    SCALE,
    SET,
    SLOW,
    SPIKE,
    SWAP,
    Effect,
)
from navfmu.engine.target import Element, Key, elements
from navfmu.errors import NavfmuError, nearest
from navfmu.faults.checks import NOT_FINITE
from navfmu.faults.fault import Fault
from navfmu.faults.types import TYPES
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import COMMON, alike, conversion
from navfmu.fmi.values import check_range, quantity, rate, spread, typed

Recipe = Callable[[Fault, Sequence[Element]], list[Effect]]


def effects_of(
    faults: Iterable[Fault], components: Mapping[str, Component], connected: Collection[Key]
) -> list[Effect]:
    """The effects of faults, in order, each with the number of its fault as trigger.

    ``connected`` holds (component, input) of every connected input.
    """
    return [
        replace(effect, trigger=number)
        for number, fault in enumerate(faults)
        if fault.type in RECIPES
        for effect in RECIPES[fault.type](fault, elements(fault, components, connected))
    ]


# ---- recipes ---------------------------------------------------------------------------------------------------------


def _effect(fault: Fault, element: Element, kind: int, amount: float = 0.0, other: float = 0.0, **more: Any) -> Effect:
    return Effect(fault, *element.key, kind, amount, other, **more)


def _each(kind: int, *parameters: str, driven: bool = False) -> Recipe:
    """One or two numbers for each element."""

    def recipe(fault: Fault, found: Sequence[Element]) -> list[Effect]:
        columns = [_numbers(fault, found, name) for name in parameters]
        rows = zip(*columns, strict=True)
        return [
            _effect(fault, element, kind, *row, lane=lane, driven=driven)
            for lane, (element, row) in enumerate(zip(found, rows, strict=True))
        ]

    return recipe


def _same(kind: int, *numbers: float) -> Recipe:
    """The same for each element."""
    return lambda fault, found: [_effect(fault, element, kind, *numbers) for element in found]


def _stuck(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    recipe = _each(SET, "value") if "value" in fault.parameters else _same(HOLD)
    return recipe(fault, found)


def _dropout(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    return [_effect(fault, e, SET if e.variable.name.endswith(".valid") else HOLD) for e in found]


def _nan(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    return _same(SET, NOT_FINITE[fault.parameters.get("value", "nan")])(fault, found)


def _unit(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    """v in its own unit is ``amount * v + other`` in the wrong one."""
    name, effects = fault.parameters["unit"], []
    for element in found:
        what, variable = f"'unit' = {name} for '{'.'.join(element.key)}'", element.variable
        units = element.component.description.units
        own, given = units.get(variable.unit or ""), units.get(name) or COMMON.get(name)
        fitting = alike(own) if own is not None and own.exponents is not None else []
        if own is None:
            raise fault.error(f"{what}: the variable has no unit that is known", "target")
        if given is None:
            near = nearest(name, fitting)
            raise fault.error(f"{what}: unit '{name}' is not known here; expected {' or '.join(fitting)}{near}", "unit")
        try:
            numbers = conversion(own, given, what, difference=variable.relative)
        except NavfmuError as problem:
            raise fault.error(str(problem), "unit") from None
        effects.append(_effect(fault, element, AFFINE, *numbers))
    return effects


def _saturate(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    if not {"low", "high"} & fault.parameters.keys():
        raise fault.error("type 'saturate' needs the parameter 'low' or 'high'", "type")
    return _ordered(fault, _each(CLIP, "low", "high")(fault, found))


def _garbage(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    return _ordered(fault, _each(GARBAGE, "low", "high")(fault, found))


def _ordered(fault: Fault, effects: list[Effect]) -> list[Effect]:
    for effect in effects:
        if not effect.amount <= effect.other:
            name = f"{effect.component}.{effect.variable}"
            raise fault.error(f"'low' is {effect.amount:.9g} and 'high' {effect.other:.9g} for '{name}'", "low")
    return effects


def _swap(fault: Fault, found: Sequence[Element]) -> list[Effect]:
    order = fault.parameters["order"]
    if len(found) == 1:
        name = ".".join(found[0].key)
        raise fault.error(f"'{name}' is one element, which has nothing to change places with", "target")
    if len(order) != len(found):
        raise fault.error(f"'order' has {len(order)} places, the target has {len(found)} elements", "order")
    units = {element.variable.unit or "" for element in found}
    if len(units) > 1:
        raise fault.error(f"elements with different units cannot change places: {', '.join(sorted(units))}", "target")
    turned = tuple((element.key, found[place - 1].key) for element, place in zip(found, order, strict=True))
    return [_effect(fault, found[0], SWAP, pairs=turned)]


RECIPES: dict[str, Recipe] = {
    "bias": _each(ADD, "value"),
    "scale": _each(SCALE, "factor"),
    "flip": _same(SCALE, -1.0),
    "drift": _each(RAMP, "rate"),
    "unit": _unit,
    "saturate": _saturate,
    "quantise": _each(QUANTISE, "step"),
    "stuck": _stuck,
    "delay": _same(DELAY),
    "slow": _same(SLOW),
    "dropout": _dropout,
    "noise": _each(NOISE, "sigma"),
    "spike": _each(SPIKE, "value"),
    "garbage": _garbage,
    "nan": _nan,
    "swap": _swap,
    "input": _each(SET, "value", driven=True),
    "parameter": _each(SET, "value", driven=True),
}


# ---- numbers ---------------------------------------------------------------------------------------------------------


def _numbers(fault: Fault, found: Sequence[Element], parameter: str) -> list[float]:
    """A fault's parameter for each element of its targets, in the element's unit, checked against type and range."""
    value, number_of = fault.parameters.get(parameter), NUMBERS[TYPES[fault.type].parameter(parameter).sort]
    if value is None and parameter in DEFAULTS:
        return [DEFAULTS[parameter]] * len(found)
    if value is None and any(element.variable.type != "Boolean" for element in found):
        raise fault.error(f"type '{fault.type}' needs the parameter '{parameter}' for a Real or Integer target", "type")
    try:
        values = spread(True if value is None else value, len(found), f"'{parameter}'")
        return [_number(element, number_of, parameter, given) for element, given in zip(found, values, strict=True)]
    except NavfmuError as problem:
        raise fault.error(str(problem), parameter) from None


def _number(element: Element, number_of: Callable[..., float], parameter: str, value: Any) -> float:
    given = str(value).lower() if isinstance(value, bool) else value
    what = f"'{parameter}' = {given} for '{'.'.join(element.key)}'"
    number = float(number_of(element.component.description, element.variable, value, what, parameter))
    if not math.isfinite(number):
        raise NavfmuError(f"{what}: expected a finite number")
    return number


def _value(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    return typed(about, variable, value, what)  # type: ignore[return-value]


def _setting(about: Description, variable: Variable, value: Any, what: str, parameter: str) -> float:
    number = typed(about, variable, value, what)
    check_range(about, variable, number, f"'{parameter}'")  # type: ignore[arg-type]
    return number  # type: ignore[return-value]


def _difference(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    return quantity(about, variable, value, what, difference=True)


def _spread(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    number = quantity(about, variable, value, what, difference=True)
    if number < 0:
        raise NavfmuError(f"{what}: expected a number that is not negative")
    return number


def _resolution(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    number = quantity(about, variable, value, what, difference=True)
    if not number > 0:
        raise NavfmuError(f"{what}: expected a positive number")
    return number


def _rate(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    return rate(about, variable, value, what)


def _factor(about: Description, variable: Variable, value: Any, what: str, _: str) -> float:
    return quantity(about, replace(variable, unit="1", display_unit=None), value, what, difference=True)


#: By the sort of a parameter: the number in the unit of a variable.
NUMBERS: dict[str, Callable[..., float]] = {
    "value": _value,
    "setting": _setting,
    "difference": _difference,
    "spread": _spread,
    "resolution": _resolution,
    "rate": _rate,
    "factor": _factor,
}
DEFAULTS = {"low": -math.inf, "high": math.inf}
