"""What faults do to single variables: each fault becomes one or more effects, each on one scalar variable.

An effect acts at the communication points t_k at which its trigger does (trigger.py), and is in force until the next.
Effects on the same variable act in the order of the fault file. Kinds, with v the value so far (at first: the true one)
and t_s the beginning of the present window, whose first communication point is s:

========  ============================================================================================
ADD       v + amount
RAMP      v + amount * (t_k - t_s)
SET       amount
HOLD      the v of the last communication point at which it did not act (of the first, if it acts at t = 0)
NOISE     v + amount * z_j, z_j the j-th normal number of the effect's stream, j = floor(t_k / period)
SCALE     v * amount
AFFINE    v * amount + other
CLIP      v, but not below amount and not above other
QUANTISE  rint(v / amount) * amount
SPIKE     v + amount, if a period begins: n = floor((t_k - t_s) / period) is another than at t_{k-1}, or k = s
GARBAGE   amount + (other - amount) * u_j, u_j the j-th uniform number of the effect's stream
DELAY     the v of d communication points before, or of t = 0; d = ceil(amount + other * u_j), both in steps
SLOW      the v of the last communication point at which a period began, counted like those of SPIKE
SWAP      for each pair of its own the v of one variable becomes that of the other, all at the same time
TAKE      (v of the output to which the input is connected) * amount + other; its bits, if that changes nothing
========  ============================================================================================

An effect is *seen* when a bit is different because of it where somebody looks: a component takes the value, or it is
recorded. The engines compare, at each point, what left with what would have left without the effect, until it is seen.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from navfmu.engine.clock import Clock, exact
from navfmu.engine.philox import STREAM_BASE, stream_of
from navfmu.faults.fault import Fault

KINDS = (
    *("ADD", "RAMP", "SET", "HOLD", "NOISE", "SCALE", "AFFINE", "CLIP", "QUANTISE", "SPIKE", "GARBAGE", "DELAY"),
    *("SLOW", "SWAP", "TAKE"),
)
ADD, RAMP, SET, HOLD, NOISE, SCALE, AFFINE, CLIP, QUANTISE, SPIKE, GARBAGE, DELAY, SLOW, SWAP, TAKE = range(len(KINDS))
NOW, NEXT, AHEAD, RECORDED, OBSERVED = 1, 2, 4, 8, 16  # who sees a signal, see enum Reader in source/master.h

# One row of the fault table, laid out as struct Effect in source/master.h.
EFFECT = np.dtype(
    [
        ("kind", np.int32),
        ("slot", np.int32),  # the signal it changes
        ("trigger", np.int32),
        ("foreseen", np.int32),  # whether somebody takes one of these as it is just before the next point
        ("amount", np.float64),
        ("other", np.float64),
        ("memory", np.int32),  # what it remembers: place and length among the memories
        ("size", np.int32),
        ("first_pair", np.int32),  # SWAP, TAKE: the signals that change, and behind them those whose value they get
        ("pairs", np.int32),
        ("multiplier", np.int64),  # number of a period: k * multiplier // divisor, in integers
        ("divisor", np.int64),
        ("seed", np.uint64),  # random numbers: key of the stream
        ("stream", np.uint64),
        ("lane", np.uint64),  # element of an array
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
RANDOM = (NOISE, GARBAGE, DELAY)  # kinds that have a stream of random numbers
MEMORY = {  # before the run
    HOLD: (0.0,),
    NOISE: (0.0, 0.0),
    SPIKE: (0.0, -1.0, 0.0),
    GARBAGE: (0.0, 0.0),
    SLOW: (0.0, -1.0, 0.0),
}
LARGEST = 2**24  # values that one delay may keep

Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Effect:
    """An effect on ``component.variable``; ``driven`` when the engine sets the variable instead of reading it.

    What an input takes from its source, so that faults find it there in the input's unit, belongs to no fault.
    """

    fault: Fault | None
    component: str
    variable: str
    kind: int
    amount: float = 0.0
    other: float = 0.0
    lane: int = 0
    driven: bool = False
    trigger: int = 0
    pairs: tuple[tuple[Key, Key], ...] = ()  # SWAP, TAKE: variable, and the one whose value it gets

    @property
    def key(self) -> Key:
        """Names of component and variable."""
        return self.component, self.variable

    @property
    def keys(self) -> tuple[Key, ...]:
        """All variables that it changes."""
        return tuple(to for to, _ in self.pairs) or (self.key,)


def clusters(effects: Iterable[Effect]) -> dict[Key, tuple[Key, ...]]:
    """For each variable all that can be different because of an effect on it, or that effects on them can change it."""
    together: dict[Key, tuple[Key, ...]] = {}
    for effect in effects:
        keys = (effect.key, *(key for pair in effect.pairs for key in pair))
        joined = tuple(dict.fromkeys(other for key in keys for other in together.get(key, (key,))))
        together |= dict.fromkeys(joined, joined)
    return together


@dataclass(frozen=True)
class Tables:
    """The effects as the engines take them."""

    effects: np.ndarray  # EFFECT
    echoes: np.ndarray  # ECHO
    reach: np.ndarray  # int32, signals
    memory: np.ndarray  # float64


def tables(
    effects: Sequence[Effect], slots: Mapping[Key, int], readers: Mapping[Key, int], clock: Clock, seed: int
) -> Tables:
    """The effects as rows of ``EFFECT``, in their order; ``slots`` and ``readers`` are by (component, variable)."""
    rows = np.zeros(len(effects), EFFECT)
    reach: list[int] = []
    memory: list[float] = []
    echoes: list[tuple[int, int]] = []
    together = clusters(effects)
    for row, effect in zip(rows, effects, strict=True):
        row["kind"], row["slot"], row["trigger"] = effect.kind, slots[effect.key], effect.trigger
        row["amount"], row["other"], row["lane"] = effect.amount, effect.other, effect.lane
        row["divisor"], row["seen"] = 1, -1 if effect.fault else 0
        if effect.kind in RANDOM:
            row["seed"], row["stream"] = seed, STREAM_BASE + fault_stream(effect.fault)
        if effect.kind in PERIOD:
            row["multiplier"], row["divisor"] = _periods(effect, clock)
        before = MEMORY.get(effect.kind, ())
        if effect.kind == DELAY:
            row["amount"], row["other"], kept = _late(effect.fault, clock)
            before = (0.0, min(math.ceil(row["amount"]), kept - 1), *([0.0] * kept))
        row["memory"], row["size"] = _room(memory, before)
        row["pairs"] = len(effect.pairs)
        row["first_pair"], _ = _room(reach, [slots[pair[end]] for end in (0, 1) for pair in effect.pairs])
        row["first_reach"], row["reaches"] = _room(reach, [slots[key] for key in together[effect.key]])
        row["foreseen"] = any(readers.get(key, 0) & AHEAD for key in together[effect.key])
        row["before"], _ = _room(memory, [0.0] * int(row["reaches"]))
    on: dict[tuple[Key, ...], list[int]] = {}  # variables -> numbers of their effects
    for number, effect in enumerate(effects):
        on.setdefault(together[effect.key], []).append(number)
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


def _late(fault: Fault, clock: Clock) -> tuple[float, float, int]:
    """Delay and jitter in steps, and how many values must be kept for that."""
    delay = exact(fault.parameters["delay"]) / clock.ratio
    jitter = exact(fault.parameters.get("jitter", 0.0)) / clock.ratio
    if not jitter:
        delay = Fraction(clock.index(fault.parameters["delay"]))
    longest = min(math.ceil(delay + jitter), clock.steps)
    if longest >= LARGEST:
        raise fault.error(f"'delay' and 'jitter' are {longest} steps long; at most {LARGEST - 1} can be kept", "delay")
    kept = 2 ** longest.bit_length()  # more than the longest, and a power of 2, by which the engine divides quickly
    return min(float(delay), 2.0**52), min(float(jitter), 2.0**52), kept


def fault_stream(fault: Fault) -> int:
    """The random stream of a fault: its own parameter, or a number made from its id."""
    return fault.parameters.get("stream", stream_of(fault.id))


#: By kind, the parameter that is the length of its periods; without it each communication point begins one, or none.
PERIOD = {NOISE: "period", GARBAGE: "period", DELAY: "period", SPIKE: "every", SLOW: "period"}


def _periods(effect: Effect, clock: Clock) -> tuple[int, int]:
    """Integers m, d with floor(t_k / period) = k * m // d."""
    name, fault = PERIOD[effect.kind], effect.fault
    if name not in fault.parameters:
        return (0, 1) if effect.kind == SPIKE else (1, 1)
    ratio: Fraction = clock.ratio / exact(fault.parameters[name])
    product = ratio.numerator * clock.steps
    if product >= 2**62 or ratio.denominator >= 2**62 or product // ratio.denominator >= 2**53:
        raise fault.error(f"'{name}' {fault.parameters[name]!r} s and the step have no common ratio", name)
    return ratio.numerator, ratio.denominator
