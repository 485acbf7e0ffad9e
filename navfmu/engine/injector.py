"""What faults do to signals, in Python: the reference for ``engine/source/effects.h``."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

from navfmu.engine.clock import Clock
from navfmu.engine.effect import ADD, AHEAD, HOLD, NEXT, NOISE, NOW, OBSERVED, RAMP, RECORDED, SET


def normal(seed: int, stream: int, lane: int, j: int) -> float:
    """Normal number j of a fault's stream, from NumPy's Philox4x64-10 by Box-Muller."""
    counter = (j << 64) | (lane << 128)  # words: block 0, j, lane, 0
    generator = np.random.Philox(key=(stream << 64) | seed, counter=(counter - 1) % 2**256)  # it counts before it draws
    words = generator.random_raw(2)
    first, second = (((int(word) >> 11) + 0.5) * 2.0**-53 for word in words)
    return math.sqrt(-2.0 * math.log(first)) * math.cos(6.283185307179586 * second)


State = tuple[dict[int, float], dict[int, float], list[int], list[Any]]


class Injector:
    """The effects on the signals of one component; ``truth`` maps each of them to its true value.

    ``seen`` has for each effect when a bit is different because of it: 3 k, at communication point k, 3 k + 1, in the
    step after it, or 3 k + 2, in that step as it leaves at its end; -1 before that. It is found by an injector of all
    the others on the same signal. ``every`` is the number of steps between recorded points; without it nothing is
    looked for.
    """

    def __init__(self, effects: Sequence[np.void], clock: Clock, every: int = 0) -> None:
        self._effects = effects
        self._clock = clock
        self._every = every
        self.seen = [-1] * len(effects)
        self._without = [
            Injector([other for other in effects if other["slot"] == effect["slot"] and other is not effect], clock)
            for effect in (effects if every else ())
        ]
        self._held: dict[int, float] = {}  # HOLD: the value before the window
        self._noise: dict[int, float] = {}

    def leave(self, truth: dict[int, float], k: int, only: int | None = None) -> dict[int, float]:
        """The values that leave at communication point ``k``.

        Those of 0 come about one by one: ``only`` this one goes to others, before the rest is known.
        ``ahead`` of the point before is asked for first.
        """
        values = dict(truth)
        for number, effect in enumerate(self._effects):
            slot, value = int(effect["slot"]), values[int(effect["slot"])]
            active = effect["first"] <= k < effect["end"]
            if effect["kind"] == HOLD and (not active or k == 0):
                self._held[number] = value
            if active:
                if effect["kind"] == NOISE:
                    self._noise[number] = self._draw(effect, k)
                values[slot] = self._apply(number, effect, value, k)
        for number, slot, other in self._others(k):
            if only in (None, slot) and _differ(other.leave({slot: truth[slot]}, k)[slot], values[slot]):
                self._see(number, k)
        return values

    def ahead(self, truth: dict[int, float], k: int) -> dict[int, float]:
        """The values just before communication point ``k + 1``, where effects of ``k`` still act on the true ones."""
        values = dict(truth)
        for number, effect in enumerate(self._effects):
            slot = int(effect["slot"])
            if effect["first"] <= k < effect["end"]:
                values[slot] = self._apply(number, effect, values[slot], k + 1)
        for number, slot, other in self._others(k):
            differs = _differ(other.ahead({slot: truth[slot]}, k)[slot], values[slot])
            if differs and self._effects[number]["readers"] & AHEAD:
                self.seen[number] = 3 * k + 1
        return values

    def _others(self, k: int) -> list[tuple[int, int, Injector]]:
        """The effects that were not seen so far: number, signal, and the others on that signal."""
        return [
            (number, int(self._effects[number]["slot"]), other)
            for number, other in enumerate(self._without)
            if self.seen[number] < 0
        ]

    def _see(self, number: int, k: int) -> None:
        """A value that leaves at ``k`` is different because of an effect: who sees it?"""
        readers = int(self._effects[number]["readers"])
        if k == 0 and readers & (NOW | NEXT | AHEAD):
            self.seen[number] = 0
        elif readers & NOW:
            self.seen[number] = 3 * k - 1
        elif readers & OBSERVED or (readers & RECORDED and k % self._every == 0):
            self.seen[number] = 3 * k
        elif readers & NEXT:
            self.seen[number] = 3 * k + 1

    def _apply(self, number: int, effect: np.void, value: float, k: int) -> float:
        kind, amount = effect["kind"], float(effect["amount"])
        if kind == ADD:
            return value + amount
        if kind == RAMP:
            return value + amount * (self._clock.time(k) - float(effect["start"]))
        if kind == SET:
            return amount
        if kind == HOLD:
            return self._held[number]
        return value + self._noise[number]

    @staticmethod
    def _draw(effect: np.void, k: int) -> float:
        j = k * int(effect["multiplier"]) // int(effect["divisor"])
        return float(effect["amount"]) * normal(int(effect["seed"]), int(effect["stream"]), int(effect["lane"]), j)

    def state(self) -> State:
        """What it remembers, for a snapshot."""
        return dict(self._held), dict(self._noise), list(self.seen), [other.state() for other in self._without]

    def set_state(self, state: State) -> None:
        """Back to a snapshot."""
        self._held, self._noise, self.seen = dict(state[0]), dict(state[1]), list(state[2])
        for other, of_other in zip(self._without, state[3], strict=True):
            other.set_state(of_other)


def _differ(a: float, b: float) -> bool:
    """Whether a bit is different."""
    return struct.pack("d", a) != struct.pack("d", b)
