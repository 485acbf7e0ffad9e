"""What faults do to signals, in Python: the reference for ``engine/source/effects.h``."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from navfmu.engine.clock import Clock
from navfmu.engine.effect import ADD, HOLD, NOISE, RAMP, SET


def normal(seed: int, stream: int, lane: int, j: int) -> float:
    """Normal number j of a fault's stream, from NumPy's Philox4x64-10 by Box-Muller."""
    counter = (j << 64) | (lane << 128)  # words: block 0, j, lane, 0
    generator = np.random.Philox(key=(stream << 64) | seed, counter=(counter - 1) % 2**256)  # it counts before it draws
    words = generator.random_raw(2)
    first, second = (((int(word) >> 11) + 0.5) * 2.0**-53 for word in words)
    return math.sqrt(-2.0 * math.log(first)) * math.cos(6.283185307179586 * second)


class Injector:
    """The effects on the signals of one component; ``truth`` maps each of them to its true value."""

    def __init__(self, effects: Sequence[np.void], clock: Clock) -> None:
        self._effects = effects
        self._clock = clock
        self._held: dict[int, float] = {}  # HOLD: the value before the window
        self._noise: dict[int, float] = {}

    def leave(self, truth: dict[int, float], k: int) -> dict[int, float]:
        """The values that leave at communication point ``k``."""
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
        return values

    def ahead(self, truth: dict[int, float], k: int) -> dict[int, float]:
        """The values just before communication point ``k + 1``, where effects of ``k`` still act on the true ones."""
        values = dict(truth)
        for number, effect in enumerate(self._effects):
            slot = int(effect["slot"])
            if effect["first"] <= k < effect["end"]:
                values[slot] = self._apply(number, effect, values[slot], k + 1)
        return values

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

    def state(self) -> tuple[dict[int, float], dict[int, float]]:
        """What it remembers, for a snapshot."""
        return dict(self._held), dict(self._noise)

    def set_state(self, state: tuple[dict[int, float], dict[int, float]]) -> None:
        """Back to a snapshot."""
        self._held, self._noise = dict(state[0]), dict(state[1])
