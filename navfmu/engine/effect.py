"""What faults do to single variables: each fault becomes one or more effects, each on one scalar variable.

An effect acts at the communication points t_k at which its trigger does (trigger.py), and is in force until the next.
Effects on the same variable act in the order of the fault file. Kinds, with v the value so far (at first: the true one)
and `start` the beginning of the present window:

======  ===========================================================================================
ADD     v + amount
RAMP    v + amount * (t_k - start)
SET     amount
HOLD    the v of the last communication point at which it did not act (of the first, if it does at t = 0)
NOISE   v + amount * z_j, z_j the j-th normal number of the effect's stream, j = floor(t_k / period)
======  ===========================================================================================

An effect is *seen* when a bit is different because of it where somebody looks: a component takes the value, or it is
recorded. The engines compare, at each point, what left with what would have left without the effect, until it is seen.
"""

from __future__ import annotations

import dataclasses
import math
import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from navfmu.engine.clock import Clock, exact
from navfmu.engine.component import Component
from navfmu.errors import NavfmuError, nearest
from navfmu.faults.fault import Fault
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.fmi.values import check_range, quantity, rate, spread, typed

KINDS = ("ADD", "RAMP", "SET", "HOLD", "NOISE")
ADD, RAMP, SET, HOLD, NOISE = range(len(KINDS))
NOW, NEXT, AHEAD, RECORDED, OBSERVED = 1, 2, 4, 8, 16  # who sees a signal, see enum Reader in source/master.h
STREAM_BASE = 2**32  # streams of faults begin above every stream that an FMU's Integer parameter can name

# One row of the fault table, laid out as struct Effect in source/master.h.
EFFECT = np.dtype(
    [
        ("kind", np.int32),
        ("slot", np.int32),  # the signal it changes
        ("trigger", np.int32),
        ("amount", np.float64),
        ("seed", np.uint64),  # random numbers: key of the stream
        ("stream", np.uint64),
        ("lane", np.uint64),  # element of an array
        ("multiplier", np.int64),  # number of a period: k * multiplier // divisor, in integers
        ("divisor", np.int64),
        ("memory", np.int32),  # what it remembers: place and length among the memories
        ("size", np.int32),
        ("first_reach", np.int32),  # the signals that can be different because of it
        ("reaches", np.int32),
        ("before", np.int32),  # these before it, now: place among the memories
        ("first_echo", np.int32),  # rows of the table of echoes
        ("echoes", np.int32),
        ("followed", np.int32),
        ("seen", np.int64),  # when it is seen first, as in struct Effect; -1: not yet
    ],
    align=True,
)
# A later effect on the same signals, and where that is which it would remember without the earlier one; struct Echo.
ECHO = np.dtype([("effect", np.int32), ("memory", np.int32)], align=True)
MEMORY = {HOLD: (0.0,), NOISE: (-1.0, 0.0)}  # what each kind remembers before the run: a value; number and value


@dataclass(frozen=True)
class Effect:
    """An effect on ``component.variable``; ``driven`` when the engine sets the variable instead of reading it."""

    fault: Fault
    component: str
    variable: str
    kind: int
    amount: float = 0.0
    lane: int = 0
    driven: bool = False
    trigger: int = 0


def effects_of(
    faults: Iterable[Fault], components: Mapping[str, Component], connected: Collection[tuple[str, str]]
) -> list[Effect]:
    """The effects of faults, in order, each with the number of its fault as trigger.

    ``connected`` holds (component, input) of every connected input.
    """
    return [
        dataclasses.replace(effect, trigger=number)
        for number, fault in enumerate(faults)
        for effect in _effects(fault, components, connected)
    ]


def _effects(fault: Fault, components: Mapping[str, Component], connected: Collection[tuple[str, str]]) -> list[Effect]:
    if fault.type == "dropout":
        return [effect for target in fault.targets for effect in _dropout(fault, *_split(fault, target, components))]
    elements = [element for target in fault.targets for element in _elements(fault, target, components, connected)]
    signals = [(component.name, variable.name) for component, variable in elements]
    for signal in signals:
        if signals.count(signal) > 1:
            raise fault.error(f"'target' names '{'.'.join(signal)}' twice", "target")
    if fault.type == "stuck" and "value" not in fault.parameters:
        return [Effect(fault, *signal, HOLD) for signal in signals]
    kind, parameter = {
        "bias": (ADD, "value"),
        "drift": (RAMP, "rate"),
        "stuck": (SET, "value"),
        "noise": (NOISE, "sigma"),
        "input": (SET, "value"),
        "parameter": (SET, "value"),
    }[fault.type]
    driven = fault.type in ("input", "parameter")
    amounts = _amounts(fault, elements, parameter)
    return [
        Effect(fault, *signal, kind, amount, lane, driven)
        for lane, (signal, amount) in enumerate(zip(signals, amounts, strict=True))
    ]


def _split(fault: Fault, target: str, components: Mapping[str, Component]) -> tuple[Component, str]:
    name, signal = names.split(target)
    if name not in components:
        hint = nearest(name, components)
        raise fault.error(f"target '{target}': there is no component '{name}'{hint}", "target")
    return components[name], signal


def _elements(
    fault: Fault, target: str, components: Mapping[str, Component], connected: Collection[tuple[str, str]]
) -> list[tuple[Component, Variable]]:
    """The variables that a target stands for, which all support the fault."""
    component, signal = _split(fault, target, components)
    variables = names.elements(component.description, signal)
    if not variables:
        hint = nearest(signal, names.short(v.name for v in _targets(fault, component, connected)))
        what = f"component '{component.name}' has no variable '{signal}'"
        raise fault.error(f"target '{target}': {what}{hint}", "target")
    for variable in variables:
        _check_target(fault, component, variable, connected)
    return [(component, variable) for variable in variables]


def _dropout(fault: Fault, component: Component, bundle: str) -> list[Effect]:
    known = names.bundles(component.description)
    if bundle not in known:
        have = ", ".join(f"'{name}'" for name in known) or "none"
        raise fault.error(
            f"target '{component.name}.{bundle}' is not an output bundle (values with 'valid' and 'sequence')"
            f"{nearest(bundle, known)}; bundles of '{component.name}': {have}",
            "target",
        )
    outputs = [v.name for v in component.description.with_causality("output") if v.name.startswith(f"{bundle}.")]
    return [Effect(fault, component.name, name, SET if name == f"{bundle}.valid" else HOLD) for name in outputs]


def _targets(fault: Fault, component: Component, connected: Collection[tuple[str, str]]) -> list[Variable]:
    """Variables of a component that this type of fault may act on."""
    if fault.type == "input":
        return [v for v in component.description.with_causality("input") if (component.name, v.name) not in connected]
    if fault.type == "parameter":
        return [v for v in component.description.with_causality("parameter") if v.variability == "tunable"]
    return [v for v in component.description.with_causality("output") if fault.type == "stuck" or v.type == "Real"]


def _check_target(
    fault: Fault, component: Component, variable: Variable, connected: Collection[tuple[str, str]]
) -> None:
    """Raise the sentence that says why this variable does not support this fault."""
    target = f"'{component.name}.{variable.name}'"
    if fault.type in ("input", "parameter"):
        if variable.causality != fault.type:
            raise fault.error(f"{target} is not an {_what(fault)} but {_article(variable.causality)}", "target")
        if fault.type == "input" and (component.name, variable.name) in connected:
            raise fault.error(f"input {target} is connected; only an unconnected input can be driven", "target")
        if fault.type == "parameter" and variable.variability != "tunable":
            raise fault.error(f"parameter {target} is {variable.variability}; only a tunable one can change", "target")
    elif variable.causality != "output":
        physical = variable.causality == "input" and (component.name, variable.name) not in connected
        hint = "; to drive an unconnected input use type 'input'" if physical else ""
        raise fault.error(
            f"type '{fault.type}' acts on outputs, but {target} is {_article(variable.causality)}{hint}", "target"
        )
    elif fault.type != "stuck" and variable.type != "Real":
        raise fault.error(
            f"type '{fault.type}' acts on Real outputs, but {target} is {_article(variable.type)} (use 'stuck')", "type"
        )
    if variable.type not in ("Real", "Integer", "Boolean"):
        raise fault.error(f"{target} is a {variable.type}; faults act on Real, Integer and Boolean variables", "target")


def _what(fault: Fault) -> str:
    return "input" if fault.type == "input" else "adjustable (tunable) parameter"


def _article(word: str) -> str:
    return f"an {word}" if word[0] in "aeiouI" else f"a {word}"


def _amounts(fault: Fault, elements: Sequence[tuple[Component, Variable]], parameter: str) -> list[float]:
    """A fault's parameter for each element of its targets, in the element's unit, checked against type and range."""
    value = fault.parameters.get(parameter)
    if value is None and any(variable.type != "Boolean" for _, variable in elements):
        raise fault.error(f"type '{fault.type}' needs the parameter '{parameter}' for a Real or Integer target", "type")
    try:
        values = spread(True if value is None else value, len(elements), f"'{parameter}'")
        return [_amount(fault, c, v, parameter, given) for (c, v), given in zip(elements, values, strict=True)]
    except NavfmuError as problem:
        raise fault.error(str(problem), parameter) from None


def _amount(fault: Fault, component: Component, variable: Variable, parameter: str, value: Any) -> float:
    what = f"'{parameter}' = {value} for '{component.name}.{variable.name}'"
    if fault.type == "drift":
        number = rate(component.description, variable, value, what)
    elif fault.type in ("bias", "noise"):
        number = quantity(component.description, variable, value, what, difference=True)
    else:
        number = typed(component.description, variable, value, what)
    if parameter == "sigma" and number < 0:
        raise NavfmuError(f"{what}: expected a number that is not negative")
    if fault.type in ("input", "parameter"):
        check_range(component.description, variable, number, f"'{parameter}'")
    elif not math.isfinite(number):
        raise NavfmuError(f"{what}: expected a finite number")
    return float(number)


Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Tables:
    """The effects as the engines take them."""

    effects: np.ndarray  # EFFECT
    echoes: np.ndarray  # ECHO
    reach: np.ndarray  # int32, signals
    memory: np.ndarray  # float64


def tables(effects: Sequence[Effect], slots: Mapping[Key, int], clock: Clock, seed: int) -> Tables:
    """The effects as rows of ``EFFECT``, in their order; ``slots`` is by (component, variable)."""
    rows = np.zeros(len(effects), EFFECT)
    reach: list[int] = []
    memory: list[float] = []
    echoes: list[tuple[int, int]] = []
    for row, effect in zip(rows, effects, strict=True):
        row["kind"], row["slot"], row["trigger"] = effect.kind, slots[effect.component, effect.variable], effect.trigger
        row["amount"], row["lane"], row["divisor"], row["seen"] = effect.amount, effect.lane, 1, -1
        if effect.kind == NOISE:
            row["seed"], row["stream"] = seed, STREAM_BASE + fault_stream(effect.fault)
            row["multiplier"], row["divisor"] = _draws(effect.fault, clock)
        row["memory"], row["size"] = _room(memory, MEMORY.get(effect.kind, ()))
        row["first_reach"], row["reaches"] = _room(reach, [row["slot"]])
        row["before"], _ = _room(memory, [0.0] * int(row["reaches"]))
    on: dict[int, list[int]] = {}  # signal -> numbers of its effects
    for number, slot in enumerate(rows["slot"].tolist()):
        on.setdefault(slot, []).append(number)
    for numbers in on.values():
        for place, number in enumerate(numbers):
            later = [(other, _room(memory, [0.0] * int(rows["size"][other]))[0]) for other in numbers[place + 1 :]]
            rows["first_echo"][number], rows["echoes"][number] = _room(echoes, later)
    return Tables(rows, np.array(echoes, ECHO), np.array(reach, np.int32), np.array(memory, np.float64))


def _room(table: list[Any], more: Sequence[Any]) -> tuple[int, int]:
    """Where more rows begin in a table, and how many they are; they are added."""
    place = len(table)
    table += more
    return place, len(more)


def fault_stream(fault: Fault) -> int:
    """The noise stream of a fault: its own parameter, or a number made from its id."""
    return fault.parameters.get("stream", zlib.crc32(fault.id.encode()) & 0x7FFFFFFF)


def _draws(fault: Fault, clock: Clock) -> tuple[int, int]:
    """Integers m, d with floor(t_k / period) = k * m // d."""
    ratio: Fraction = clock.ratio / exact(fault.parameters["period"])
    if ratio.numerator * clock.steps >= 2**62 or ratio.denominator >= 2**62:
        raise fault.error(f"'period' {fault.parameters['period']!r} s and the step have no common ratio", "period")
    return ratio.numerator, ratio.denominator
