"""Counter-based random numbers: Philox4x64-10 and the Box-Muller transform.

The same numbers as the C runtime (``runtime/noise.c``), one block at a time. Source: Salmon, Moraes, Dror, Shaw,
"Parallel random numbers: as easy as 1, 2, 3", SC11, 2011.
"""

from __future__ import annotations

import math

import numpy as np

from navfmu.repetition import outside

_MASK = 0xFFFFFFFFFFFFFFFF


def philox(counter: tuple[int, int, int, int], key: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return the four 64-bit words that belong to a counter and a key."""
    c0, c1, c2, c3 = counter
    k0, k1 = key
    for _ in range(10):
        p0 = 0xD2E7470EE14C6C93 * c0
        p1 = 0xCA5A826395121157 * c2
        c0, c1, c2, c3 = (p1 >> 64) ^ c1 ^ k0, p1 & _MASK, (p0 >> 64) ^ c3 ^ k1, p0 & _MASK
        k0 = (k0 + 0x9E3779B97F4A7C15) & _MASK
        k1 = (k1 + 0xBB67AE8584CAA73B) & _MASK
    return c0, c1, c2, c3


def uniform(word: int) -> float:
    """Return a number in (0, 1], never 0, from 64 random bits."""
    return ((word >> 11) + 0.5) * 2.0**-53


def _block(key: tuple[int, int], block: int, k: int, task: int) -> list[float]:
    n = philox((block, k & _MASK, task, 0), key)
    normals = []
    for first, second in ((n[0], n[1]), (n[2], n[3])):
        radius = math.sqrt(-2.0 * math.log(uniform(first)))
        angle = 6.283185307179586 * uniform(second)
        normals += [radius * math.cos(angle), radius * math.sin(angle)]
    return normals


class Normals:
    """The standard normal numbers of one run of one task, handed out in order.

    ``k`` counts the samples of the task's clock, ``task`` distinguishes the tasks of a component.
    """

    def __init__(self, seed: int, stream: int, k: int, task: int) -> None:
        self._key = (seed & _MASK, stream & _MASK)
        self._k, self._task = k, task
        self._drawn: list[float] = []
        self._taken = 0

    def __call__(self, count: int) -> np.ndarray:
        """Return ``count`` fresh standard normal numbers, shape (count,)."""
        outside("noise is drawn")
        end = self._taken + count
        while len(self._drawn) < end:
            self._drawn += _block(self._key, len(self._drawn) // 4, self._k, self._task)
        values = np.array(self._drawn[self._taken : end])
        self._taken = end
        return values
