"""The loops of loops.c for a number of states, and a stopwatch for these and for what the exporter makes."""

from __future__ import annotations

import ctypes
import time
from pathlib import Path

import numpy as np

from navfmu.export import toolchain

SOURCE = Path(__file__).parent / "loops.c"
_LEAST = 1e-3  # s that are worth measuring


class Loops:
    """The functions of loops.c, compiled into a folder."""

    def __init__(self, states: int, driven: int, folder: Path) -> None:
        output = folder / f"loops_{states}{toolchain.suffix('host')}"
        flags = [f"-DN={states}", f"-DM={driven}"]
        self._library = ctypes.CDLL(str(toolchain.compile_shared([SOURCE], output, flags=flags)))
        self._library.repeat.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_long]
        self._library.repeat.restype = None

    def address(self, name: str) -> int:
        """Return where a function is."""
        return ctypes.cast(getattr(self._library, name), ctypes.c_void_p).value

    def stopwatch(self, address: int, given: np.ndarray, size: int) -> Stopwatch:
        """Return the stopwatch for a function ``void f(const double *v, double *r)``."""
        return Stopwatch(self._library.repeat, address, given, size)


class Stopwatch:
    """Calls a function over and over; ``result`` is what it gave."""

    def __init__(self, repeat: ctypes._CFuncPtr, address: int, given: np.ndarray, size: int) -> None:
        self._repeat, self._address, self._given = repeat, address, given
        self.result, self._count = np.full(size, np.nan), 1
        while self() * self._count < _LEAST:
            self._count *= 2

    def __call__(self) -> float:
        """Return the seconds of one call, the fastest of three times many."""
        return min(self._once() for _ in range(3))

    def _once(self) -> float:
        before = time.perf_counter()
        self._repeat(self._address, self._given.ctypes.data, self.result.ctypes.data, self._count)
        return (time.perf_counter() - before) / self._count
