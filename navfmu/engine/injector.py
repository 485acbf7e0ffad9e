"""What faults do to signals, in Python: the reference for ``engine/source/effects.h`` and ``act.h``."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

from navfmu.engine.clock import Clock
from navfmu.engine.effect import (
    ADD,
    AFFINE,
    AHEAD,
    CLIP,
    DELAY,
    GARBAGE,
    HOLD,
    NEXT,
    NOISE,
    NOW,
    OBSERVED,
    QUANTISE,
    RAMP,
    RECORDED,
    SCALE,
    SET,
    SLOW,
    SPIKE,
    SWAP,
    TAKE,
)
from navfmu.engine.philox import normal, uniform, words
from navfmu.engine.trigger import Moment, Trigger

State = tuple[list[Any], list[int], list[Any]]


class Injector:
    """The effects on the signals of one component; ``truth`` maps each of them to its true value.

    ``seen`` has for each effect when a bit is different because of it: 3 k, at communication point k, 3 k + 1, in the
    step after it, or 3 k + 2, in that step as it leaves at its end; -1 before that. It is found by an injector of all
    the others on the signals that it reaches. ``readers`` says who sees each signal, ``every`` is the number of steps
    between recorded points; without it nothing is looked for. ``reach`` are the signals that each effect can make
    different, ``pairs`` of signals those of which one gets the value of the other.
    """

    def __init__(
        self,
        effects: Sequence[np.void],
        reach: Sequence[Sequence[int]],
        pairs: Sequence[Sequence[tuple[int, int]]],
        triggers: Sequence[Trigger],
        clock: Clock,
        readers: Sequence[int] = (),
        every: int = 0,
    ) -> None:
        self._effects, self._reach, self._pairs, self._triggers = effects, reach, pairs, triggers
        self._clock, self._readers, self._every = clock, readers, every
        self.seen = [int(effect["seen"]) for effect in effects]
        self._memory: list[Any] = [None] * len(effects)
        self._without: list[Injector] = []
        for one in range(len(effects) if every else 0):
            others = [n for n in range(len(effects)) if n != one and set(reach[n]) & set(reach[one])]
            chosen = ([table[n] for n in others] for table in (effects, reach, pairs))
            self._without.append(Injector(*chosen, triggers, clock))

    def leave(self, truth: dict[int, float], k: int, only: int | None = None) -> dict[int, float]:
        """The values that leave at communication point ``k``.

        Those of 0 come about one by one: ``only`` this one goes to others, before the rest is known.
        ``ahead`` of the point before is asked for first.
        """
        values = dict(truth)
        for number, effect in enumerate(self._effects):
            now = self._triggers[effect["trigger"]].now
            self._remember(number, effect, now, values[int(effect["slot"])], k)
            if now.acts:
                self._change(number, effect, now, values, k)
        for number, other in self._others():
            without = other.leave({slot: truth[slot] for slot in self._reach[number]}, k)
            for slot, value in without.items():
                if only in (None, slot) and self.seen[number] < 0 and _differ(value, values[slot]):
                    self._see(number, slot, k)
        return values

    def ahead(self, truth: dict[int, float], k: int) -> dict[int, float]:
        """The values just before communication point ``k + 1``, where effects of ``k`` still act on the true ones."""
        values = dict(truth)
        for number, effect in enumerate(self._effects):
            before = self._triggers[effect["trigger"]].before
            if before.acts:
                self._change(number, effect, before, values, k + 1)
        for number, other in self._others():
            without = other.ahead({slot: truth[slot] for slot in self._reach[number]}, k)
            if any(self._readers[slot] & AHEAD and _differ(value, values[slot]) for slot, value in without.items()):
                self.seen[number] = 3 * k + 1
        return values

    def _others(self) -> list[tuple[int, Injector]]:
        """The effects that were not seen so far, each with all the others that reach the same signals."""
        return [(number, other) for number, other in enumerate(self._without) if self.seen[number] < 0]

    def _see(self, number: int, slot: int, k: int) -> None:
        """A value that leaves at ``k`` is different because of an effect: who sees it?"""
        readers = self._readers[slot]
        if k == 0 and readers & (NOW | NEXT | AHEAD):
            self.seen[number] = 0
        elif readers & NOW:
            self.seen[number] = 3 * k - 1
        elif readers & OBSERVED or (readers & RECORDED and k % self._every == 0):
            self.seen[number] = 3 * k
        elif readers & NEXT:
            self.seen[number] = 3 * k + 1

    def _remember(self, number: int, effect: np.void, now: Moment, value: float, k: int) -> None:
        """What an effect keeps of communication point ``k``, at which ``value`` came to it."""
        kind, amount, other = effect["kind"], float(effect["amount"]), float(effect["other"])
        if kind == HOLD and (not now.acts or k == 0):
            self._memory[number] = value
        elif kind == NOISE and now.acts:
            self._memory[number] = amount * normal(*_key(effect), _period(effect, k))
        elif kind == GARBAGE and now.acts:
            self._memory[number] = amount + (other - amount) * uniform(words(*_key(effect), _period(effect, k))[0])
        elif kind == SPIKE:
            self._memory[number] = now.acts and _begins(effect, now, k)
        elif kind == SLOW and now.acts and _begins(effect, now, k):
            self._memory[number] = value
        elif kind == DELAY:
            _, history = self._memory[number] or (0, {})
            late = math.ceil(amount + other * uniform(words(*_key(effect), _period(effect, k))[0]) if other else amount)
            self._memory[number] = late, history | {k: value}

    def _change(self, number: int, effect: np.void, at: Moment, values: dict[int, float], k: int) -> None:
        """What an effect makes of its signal as of ``k``, while it acts as it did at the point of ``at``."""
        if effect["kind"] == SWAP:
            pairs = self._pairs[number]
            values |= {to: value for (to, _), value in zip(pairs, [values[source] for _, source in pairs], strict=True)}
            return
        if effect["kind"] == TAKE:
            values[int(effect["slot"])] = values[self._pairs[number][0][1]]
        slot, memory = int(effect["slot"]), self._memory[number]
        value, amount, other = values[slot], float(effect["amount"]), float(effect["other"])
        values[slot] = {
            ADD: lambda: value + amount,
            RAMP: lambda: value + amount * (self._clock.time(k) - at.start),
            SET: lambda: amount,
            HOLD: lambda: memory,
            NOISE: lambda: value + memory,
            SCALE: lambda: value * amount,
            AFFINE: lambda: value * amount + other,
            CLIP: lambda: amount if value < amount else other if value > other else value,
            QUANTISE: lambda: float(np.rint(value / amount)) * amount,
            SPIKE: lambda: value + amount if memory else value,
            GARBAGE: lambda: memory,
            DELAY: lambda: memory[1][max(k - memory[0], 0)] if memory[0] else value,
            SLOW: lambda: memory,
            TAKE: lambda: value if (amount, other) == (1.0, 0.0) else amount * value + other,
        }[int(effect["kind"])]()

    def state(self) -> State:
        """What it remembers, for a snapshot."""
        return list(self._memory), list(self.seen), [other.state() for other in self._without]

    def set_state(self, state: State) -> None:
        """Back to a snapshot."""
        self._memory, self.seen = list(state[0]), list(state[1])
        for other, of_other in zip(self._without, state[2], strict=True):
            other.set_state(of_other)


def _key(effect: np.void) -> tuple[int, int, int]:
    return int(effect["seed"]), int(effect["stream"]), int(effect["lane"])


def _period(effect: np.void, k: int) -> int:
    """The number of the period in which communication point ``k`` lies."""
    return k * int(effect["multiplier"]) // int(effect["divisor"])


def _begins(effect: np.void, now: Moment, k: int) -> bool:
    """Whether one of the periods begins at ``k`` that are counted from the beginning of the window."""
    n = k - now.since
    return n == 0 or _period(effect, n) != _period(effect, n - 1)


def _differ(a: float, b: float) -> bool:
    """Whether a bit is different."""
    return struct.pack("d", a) != struct.pack("d", b)
