"""Functions in plain NumPy, traced and compiled into one library: what a component's tasks become, without the FMU."""

from __future__ import annotations

import ctypes
import math
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from navfmu.export import toolchain
from navfmu.export.build import RUNTIME
from navfmu.export.printing.printer import c_function, c_helpers
from navfmu.export.record.graph import Node
from navfmu.export.tracing import trace
from navfmu.export.tracing.extent import Extent, extent
from navfmu.export.tracing.room import with_room

_HEAD = """#include <math.h>
#include "arrays.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
"""


class Compiled:
    """A function that was traced with arguments of certain shapes; called with such arguments it runs the C code."""

    def __init__(self, nodes: Sequence[Node], shape: tuple[int, ...]) -> None:
        self.nodes, self.shape = nodes, shape
        self.evaluate: Any = None

    def __call__(self, *arguments: Any) -> np.ndarray:
        """Return the result as an array of doubles; truth values are 0 and 1."""
        given = np.concatenate([np.zeros(0), *(np.ravel(a).astype(float) for a in arguments)])
        result = np.zeros(len(self.nodes))
        self.evaluate(*(a.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in (given, result)))
        return result.reshape(self.shape)


def traced(
    function: Callable, arguments: Sequence[Any], whole: float = math.inf, functions: dict | None = None
) -> Compiled:
    """Trace a function with elements of a vector in the shapes of its arguments; arrays of at least ``whole`` elements
    are kept whole, and the functions of its module are called; ``functions`` are those that were recorded before.
    """
    of = Extent(whole=whole, calls=whole < math.inf, functions={} if functions is None else functions)
    with trace.tracing([sys.modules[function.__module__]]), extent(of):
        symbols, first = [], 0
        for argument in map(np.asarray, arguments):
            kinds = argument.dtype.kind * argument.size
            symbols.append(trace.symbols("v", kinds, first).reshape(argument.shape))
            first += argument.size
        result = with_room(lambda: function(*symbols))
        return Compiled(trace.expressions(result), np.shape(result))


def compiled(functions: Iterable[tuple[Callable, Sequence[Any]]], whole: float = math.inf) -> list[Compiled]:
    """Trace functions, each with arguments of the shapes that it will get, and compile them in one go."""
    recorded: dict = {}
    return linked([traced(function, arguments, whole, recorded) for function, arguments in functions])


def source(functions: Sequence[Sequence[Node]]) -> str:
    """Return the C code of functions, each the nodes of its results, and of an array ``functions`` of them."""
    text = [_HEAD, *c_helpers([node for nodes in functions for node in nodes])]
    text += [_exported(i, nodes) for i, nodes in enumerate(functions)]
    names = ", ".join(f"f{i}" for i in range(len(functions)))
    return "\n".join([*text, f"EXPORT void (*const functions[])(const double *, double *) = {{{names}}};\n"])


def _exported(i: int, nodes: Sequence[Node]) -> str:
    """Return a function of ``v`` and ``r``, which has memory of its own to work in if it needs some."""
    if not (one := c_function(f"f{i}", ["v"], nodes)).work:
        return one.text
    within = c_function(f"within_f{i}", ["v"], nodes)
    call = f"static double work[{within.work}]; within_f{i}(v, work, r);"
    return f"{within.text}\nstatic void f{i}(const double *v, double *r) {{ {call} }}\n"


def linked(made: list[Compiled]) -> list[Compiled]:
    """Compile functions of the one vector ``v`` into a library, and return them ready to be called."""
    with tempfile.TemporaryDirectory(prefix="navfmu-", ignore_cleanup_errors=True) as scratch:
        file = Path(scratch) / "functions.c"
        file.write_text(source([one.nodes for one in made]))
        compiled = toolchain.compile_shared([file], file.with_suffix(toolchain.suffix("host")), include=[RUNTIME])
        library = ctypes.CDLL(str(compiled))
    kind = ctypes.CFUNCTYPE(None, *[ctypes.POINTER(ctypes.c_double)] * 2)
    for one, address in zip(made, (ctypes.c_void_p * len(made)).in_dll(library, "functions"), strict=True):
        one.evaluate = kind(address)
    return made
