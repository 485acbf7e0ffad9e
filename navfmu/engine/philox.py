"""Random numbers of faults: functions of (seed, stream, lane, number) and nothing else, from NumPy's Philox4x64-10."""

from __future__ import annotations

import math
import zlib

import numpy as np

STREAM_BASE = 2**32  # streams of faults begin above every stream that an FMU's Integer parameter can name
VALUES, TIMES = range(2)  # what numbers of a stream are for


def words(seed: int, stream: int, lane: int, j: int, purpose: int = VALUES) -> list[int]:
    """The first two of the four words of number ``j``."""
    counter = (j << 64) | (lane << 128) | (purpose << 192)  # words: block 0, j, lane, purpose
    generator = np.random.Philox(key=(stream << 64) | seed, counter=(counter - 1) % 2**256)  # it counts before it draws
    return [int(word) for word in generator.random_raw(2)]


def stream_of(name: str) -> int:
    """The number of a stream, made from a name."""
    return zlib.crc32(name.encode()) & 0x7FFFFFFF


def uniform(word: int) -> float:
    """A number between 0 and 1, from the upper 53 bits of a word."""
    return ((word >> 11) + 0.5) * 2.0**-53


def normal(seed: int, stream: int, lane: int, j: int) -> float:
    """Normal number ``j`` of a fault's stream, by Box-Muller."""
    first, second = map(uniform, words(seed, stream, lane, j))
    return math.sqrt(-2.0 * math.log(first)) * math.cos(6.283185307179586 * second)
