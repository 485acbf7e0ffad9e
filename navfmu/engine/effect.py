"""What faults do to single variables: each fault becomes one or more effects, each on one scalar variable.

An effect acts at the communication points t_k with first <= k < end. Effects on the same variable act in the order of
the fault file. Kinds, with v the value so far (at first: the true one):

======  ===========================================================================================
ADD     v + amount
RAMP    v + amount * (t_k - start)
SET     amount
HOLD    the v of the last communication point before the first (of the first itself, if that is t = 0)
NOISE   v + amount * z_j, z_j the j-th normal number of the effect's stream, j = floor(t_k / period)
======  ===========================================================================================

An effect is *seen* when a bit is different because of it where somebody looks: a component takes the value, or it is
recorded. The engines compare, at each point, what left with what would have left without the effect, until it is seen.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import takewhile
from typing import Any

import numpy as np

from navfmu.engine.clock import FOREVER, Clock, exact
from navfmu.engine.component import Component
from navfmu.errors import NavfmuError, nearest
from navfmu.faults.fault import Fault
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.fmi.values import check_range, quantity, rate, spread, typed

ADD, RAMP, SET, HOLD, NOISE = range(5)
NOW, NEXT, AHEAD, RECORDED, OBSERVED = 1, 2, 4, 8, 16  # who sees a signal, see enum Reader in source/master.h
STREAM_BASE = 2**32  # streams of faults begin above every stream that an FMU's Integer parameter can name

# One row of the fault table, laid out as struct Effect in source/master.h.
EFFECT = np.dtype(
    [
        ("kind", np.int32),
        ("slot", np.int32),  # the signal it changes
        ("first", np.int64),  # communication points, first <= k < end
        ("end", np.int64),
        ("amount", np.float64),
        ("start", np.float64),  # s, origin of a RAMP
        ("seed", np.uint64),  # NOISE: key of the stream
        ("stream", np.uint64),
        ("lane", np.uint64),  # NOISE: element of an array
        ("multiplier", np.int64),  # NOISE: j = k * multiplier / divisor, in integers
        ("divisor", np.int64),
        ("memory", np.float64),  # HOLD: the value; NOISE: amount * z_j
        ("drawn", np.int64),  # NOISE: j of the memory, -1 before the first
        ("readers", np.int32),  # who sees the signal: a sum of NOW, NEXT, AHEAD, RECORDED, OBSERVED
        ("first_echo", np.int32),  # rows of the table of echoes
        ("echoes", np.int32),
        ("until", np.int64),  # from this communication point on nothing can be seen of it any more
        ("seen", np.int64),  # when it is seen first, as in struct Effect; -1: not yet
        ("before", np.float64),  # the signal before it, now
    ],
    align=True,
)
# A later effect on the same signal, as it would be without an earlier one; struct Echo in source/master.h.
ECHO = np.dtype([("effect", np.int32), ("memory", np.float64), ("drawn", np.int64)], align=True)


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


def effects_of(
    faults: Iterable[Fault], components: Mapping[str, Component], connected: Collection[tuple[str, str]]
) -> list[Effect]:
    """The effects of faults, in order; ``connected`` holds (component, input) of every connected input."""
    return [effect for fault in faults for effect in _effects(fault, components, connected)]


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


def table(
    effects: list[Effect], slots: Mapping[Key, int], readers: Mapping[Key, int], clock: Clock, seed: int
) -> np.ndarray:
    """The effects as rows of ``EFFECT``, in their order; ``slots`` and ``readers`` are by (component, variable)."""
    rows = np.zeros(len(effects), EFFECT)
    for row, effect in zip(rows, effects, strict=True):
        fault = effect.fault
        row["kind"], row["slot"] = effect.kind, slots[effect.component, effect.variable]
        row["first"], row["end"] = window(fault, clock)
        row["amount"], row["start"], row["lane"] = effect.amount, fault.start, effect.lane
        row["divisor"], row["drawn"], row["seen"] = 1, -1, -1
        row["readers"] = readers.get((effect.component, effect.variable), 0) | (NEXT if effect.driven else 0)
        if effect.kind == NOISE:
            row["seed"], row["stream"] = seed, STREAM_BASE + fault_stream(fault)
            row["multiplier"], row["divisor"] = _draws(fault, clock)
    return rows


def echoes(rows: np.ndarray) -> np.ndarray:
    """For each effect, in a row, those that act on the same signal after it; enters their places into ``rows``."""
    on: dict[int, list[int]] = {}  # signal -> numbers of its effects
    for number, slot in enumerate(rows["slot"].tolist()):
        on.setdefault(slot, []).append(number)
    kinds, firsts, ends = (rows[name].tolist() for name in ("kind", "first", "end"))
    found: list[int] = []
    for numbers in on.values():
        for place, number in enumerate(numbers):
            later = [other for other in numbers[place + 1 :] if ends[other] > firsts[number]]
            until = max([ends[number], *(ends[other] for other in later if kinds[other] == HOLD)])  # it remembers
            later = [other for other in later if firsts[other] < until]
            rows["until"][number] = until
            rows["first_echo"][number], rows["echoes"][number] = len(found), len(later)
            found += later
    table = np.zeros(len(found), ECHO)
    table["effect"] = found
    return table


def window(fault: Fault, clock: Clock) -> tuple[int, int]:
    """Communication points at which a fault acts: first <= k < end."""
    first, end = clock.index(fault.start), clock.index(fault.start + fault.duration)
    if end <= first:
        raise fault.error(
            f"no communication point lies between its start {fault.start:.9g} s and its end "
            f"{fault.start + fault.duration:.9g} s at the step {clock.step:.9g} s",
            "duration",
        )
    return first, min(end, FOREVER)


def idle(
    effects: Sequence[Effect], rows: np.ndarray, clock: Clock, every: int, undisturbed: Mapping[Key, float]
) -> dict[str, str]:
    """Faults that cannot change anything in a run, by id, with the reason: "starts at 300 s, the run ends at 60 s".

    What depends on values is seen only by running (``unseen``). ``rows`` is the ``table`` of the effects, in which
    ``echoes`` has entered how long each is remembered; ``every`` the steps between recorded points; ``undisturbed`` has
    the value of each driven variable without faults.
    """
    on: dict[tuple[str, str], list[int]] = {}  # variable -> numbers of its effects
    for number, effect in enumerate(effects):
        on.setdefault((effect.component, effect.variable), []).append(number)
    reasons: dict[str, list[str]] = {}
    for key, numbers in on.items():
        for number in numbers:
            own = undisturbed.get(key) if len(numbers) == 1 else None
            later = [rows[other] for other in numbers if other > number]
            reason = _idle(effects[number], rows[number], clock, every, own, later)
            reasons.setdefault(effects[number].fault.id, []).append(reason)
    return {fault: found[0] for fault, found in reasons.items() if all(found)}


def _idle(effect: Effect, row: np.void, clock: Clock, every: int, own: float | None, later: Sequence[np.void]) -> str:
    """Why an effect changes nothing, or an empty text; ``own`` is the value that a driven variable has anyway."""
    if row["first"] > clock.steps:
        return f"starts at {effect.fault.start:.9g} s, the run ends at {clock.time(clock.steps):.9g} s"
    name, first, end = f"{effect.component}.{effect.variable}", int(row["first"]), min(row["end"], clock.steps + 1)
    if not row["readers"]:
        return f"acts on '{name}', which goes nowhere: it is neither connected nor recorded nor asked for"
    if row["readers"] == RECORDED and -(-first // every) * every >= min(row["until"], clock.steps + 1):
        return f"acts on '{name}', which is not connected, and at no point at which it is recorded"
    still = effect.kind == RAMP and clock.time(clock.steps) <= effect.fault.start
    looking = NOW | OBSERVED | (RECORDED if first % every == 0 else 0)
    if first == clock.steps and (still or not row["readers"] & looking):
        return f"starts at {effect.fault.start:.9g} s, the last communication point"
    if effect.kind in (ADD, RAMP, NOISE) and effect.amount == 0.0:
        return "adds 0"
    if effect.driven and effect.amount == own:
        return f"sets '{name}' to {effect.amount:.9g}, which it is anyway"
    before = takewhile(lambda other: other["kind"] != HOLD, later)  # which would remember it
    if any(other["kind"] == SET and other["first"] <= first and end <= other["end"] for other in before):
        return f"is hidden: all the time another fault sets '{name}'"
    return ""


def unseen(faults: Sequence[Fault], seen: Sequence[bool], clock: Clock, k: int) -> dict[str, str]:
    """Faults that have changed nothing in a run that came to point ``k``, by id, with the reason.

    ``faults`` and ``seen``, whether something was seen of it, are by effect.
    """
    acted = {fault.id for fault, was_seen in zip(faults, seen, strict=True) if was_seen}
    reasons = {}
    for fault in faults:
        if fault.id not in acted:
            late = clock.index(fault.start) > k
            reasons[fault.id] = (
                f"starts at {fault.start:.9g} s, but the run ended at {clock.time(k):.9g} s"
                if late
                else "changed nothing: without it every value that was recorded, or went to a component, would have "
                "been the same"
            )
    return reasons


def fault_stream(fault: Fault) -> int:
    """The noise stream of a fault: its own parameter, or a number made from its id."""
    return fault.parameters.get("stream", zlib.crc32(fault.id.encode()) & 0x7FFFFFFF)


def _draws(fault: Fault, clock: Clock) -> tuple[int, int]:
    """Integers m, d with floor(t_k / period) = k * m // d."""
    ratio: Fraction = clock.ratio / exact(fault.parameters["period"])
    if ratio.numerator * clock.steps >= 2**62 or ratio.denominator >= 2**62:
        raise fault.error(f"'period' {fault.parameters['period']!r} s and the step have no common ratio", "period")
    return ratio.numerator, ratio.denominator
