"""A function in plain NumPy on its way through the exporter, and how long each stage takes: seconds of a processor, so
that others on the machine make no difference.
"""

from __future__ import annotations

import ctypes
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from evidence.compiled import source
from navfmu.export import toolchain
from navfmu.export.build import RUNTIME
from navfmu.export.tracing import trace
from navfmu.export.tracing.extent import current, shortest


class Translated:
    """A function that is traced as a task is, printed as C, and compiled for each platform."""

    def __init__(
        self, function: Callable, arguments: Sequence[Any], modules: Sequence[ModuleType], folder: Path
    ) -> None:
        before = time.process_time()
        with trace.tracing(modules):
            nodes, _ = shortest(lambda: _traced(function, arguments), str(function), {})
        self.text = source([nodes])
        self.to_trace = time.process_time() - before
        self.to_compile: dict[str, float] = {}
        place = Path(tempfile.mkdtemp(dir=folder))  # no library is ever loaded from where another one was
        file = place / "translated.c"
        file.write_text(self.text)
        for platform in toolchain.TARGETS:
            output = place / f"{platform}{toolchain.suffix(platform)}"
            before = _spent_by_compilers()
            toolchain.compile_shared([file], output, platform, include=[RUNTIME])
            self.to_compile[platform] = _spent_by_compilers() - before
            if platform == toolchain.host():
                self._library = ctypes.CDLL(str(output))

    @property
    def address(self) -> int:
        """Where the compiled function is."""
        return ctypes.c_void_p.in_dll(self._library, "functions").value


def _traced(function: Callable, arguments: Sequence[Any]) -> list:
    symbols, first = [], 0
    for argument in map(np.asarray, arguments):
        current().meet(argument.size)
        symbols.append(trace.symbols("v", "f" * argument.size, first).reshape(argument.shape))
        first += argument.size
    return trace.expressions(function(*symbols))


def _spent_by_compilers() -> float:
    """Return the processor's time of all processes that this one has started and that have ended (s)."""
    return os.times().children_user + os.times().children_system
