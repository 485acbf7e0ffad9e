"""The least that any master must do: C code with the calls and connections of one plan written out, and nothing else.

No names, no faults, no recording, no statuses. It drives FMU instances that the compiled engine has initialised, makes
the same FMI calls as that engine and skips the same ones (inputs of which no bit has changed).
"""

from __future__ import annotations

import ctypes
import tempfile
import time
from pathlib import Path

import numpy as np

from navfmu.engine.compiled import Compiled
from navfmu.engine.library import RUNTIME
from navfmu.engine.plan import Inputs, Part, Plan
from navfmu.engine.structures import LOOP
from navfmu.export import toolchain

C_TYPES = {"Real": "double", "Integer": "int", "Boolean": "int"}


class Bare:
    """The generated loop over the FMUs of an engine that stands at t = 0; ``signals`` are all values at the end."""

    def __init__(self, plan: Plan, engine: Compiled) -> None:
        with tempfile.TemporaryDirectory() as scratch:
            source = Path(scratch) / "bare.c"
            source.write_text(generate(plan))
            path = toolchain.compile_shared([source], Path(scratch) / "bare.so", include=(RUNTIME,))
            self._library = ctypes.CDLL(str(path))
        self.plan = plan
        count = len(plan.parts)
        self._instances = (ctypes.c_void_p * count)(*(c.instance for c in engine._components))
        functions = [getattr(c, field) for c in engine._components for field in LOOP]
        self._functions = (ctypes.c_void_p * len(functions))(*functions)
        self._library.run.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_long, ctypes.c_long, ctypes.c_void_p]
        self._library.run.restype = None
        self.signals = np.zeros(len(plan.signals))

    def run(self, first: int, steps: int) -> float:
        """Make steps from communication point ``first`` on; return the seconds they took."""
        before = time.perf_counter()
        self._library.run(self._instances, self._functions, first, steps, self.signals.ctypes.data)
        return time.perf_counter() - before


def generate(plan: Plan) -> str:
    """The C code: a function ``run`` that reads all outputs, makes steps, and hands back the last outputs."""
    clock = plan.clock
    lines = [
        "#include <string.h>",
        '#include "fmi2FunctionTypes.h"',
        f"#define H {clock.step!r}",
        f"#define TIME(k) ((double)(k) * {clock.numerator!r} / {clock.denominator!r})",
        f"static double s[{max(len(plan.signals), 1)}];  /* every output that is used */",
    ]
    for number, part in enumerate(plan.parts):
        lines += _arrays(number, part)
    lines += [
        "",
        '__attribute__((visibility("default")))',
        "void run(void **instance, void **function, long first, long steps, double *out) {",
    ]
    for number in range(len(plan.parts)):
        lines.append(f"    fmi2Component c{number} = instance[{number}];")
        for place, name in enumerate(LOOP.values()):
            lines.append(
                f"    {name}TYPE *{name}{number} = ({name}TYPE *)function[{number * len(LOOP) + place}];"
                f" (void){name}{number};"
            )
    for number, part in enumerate(plan.parts):
        lines += _read(number, part)
    for number, part in enumerate(plan.parts):
        lines += [f"    u{number}[{i}] = s[{j}];" for i, j in enumerate(part.smooth.source)]
    lines.append("    for (long k = first; k < first + steps; k++) {")
    if plan.algorithm == "jacobi":
        for number, part in enumerate(plan.parts):
            lines += _set_held(number, part)
        for number, part in enumerate(plan.parts):
            lines += [_step(number), *_read(number, part)]
    else:
        for number in plan.order:
            part = plan.parts[number]
            lines += [*_set_smooth(number, part), *_set_held(number, part), _step(number), *_read(number, part)]
    lines += ["    }", "    memcpy(out, s, sizeof s);", "}", ""]
    return "\n".join(lines)


def _held(part: Part) -> list[tuple[str, Inputs]]:
    return [(kind, group) for kind, group in zip(C_TYPES, (part.real, part.integer, part.boolean), strict=True)]


def _value(group: Inputs, i: int) -> str:
    plain = group.factor[i] == 1.0 and group.offset[i] == 0.0
    source = f"s[{group.source[i]}]"
    return source if plain else f"{float(group.factor[i])!r} * {source} + {float(group.offset[i])!r}"


def _arrays(number: int, part: Part) -> list[str]:
    def references(name: str, values) -> str:
        return f"static const fmi2ValueReference {name}[] = {{{', '.join(map(str, values))}}};"

    lines = []
    for kind, values in part.outputs.items():
        if len(values):
            lines.append(references(f"o{kind}{number}", values))
            if kind != "Real":
                lines.append(f"static int y{kind}{number}[{len(values)}];")
    if count := len(part.smooth.references):
        lines.append(references(f"smooth{number}", part.smooth.references))
        lines.append(f"static double u{number}[{count}], d{number}[{count}];")
        lines.append(f"static const int one{number}[] = {{{', '.join('1' * count)}}};")
    for kind, group in _held(part):
        if count := len(group.references):
            lines.append(references(f"i{kind}{number}", group.references))
            lines.append(f"static {C_TYPES[kind]} {kind[0]}{number}[{count}];")
    return lines


def _set_smooth(number: int, part: Part) -> list[str]:
    if not (count := len(part.smooth.references)):
        return []
    lines = [f"        d{number}[{i}] = (s[{j}] - u{number}[{i}]) / H;" for i, j in enumerate(part.smooth.source)]
    lines.append(f"        fmi2SetReal{number}(c{number}, smooth{number}, {count}, u{number});")
    lines.append(
        f"        fmi2SetRealInputDerivatives{number}(c{number}, smooth{number}, {count}, one{number}, d{number});"
    )
    return lines + [f"        u{number}[{i}] = s[{j}];" for i, j in enumerate(part.smooth.source)]


def _set_held(number: int, part: Part) -> list[str]:
    lines = []
    for kind, group in _held(part):
        if not (count := len(group.references)):
            continue
        array, values = f"{kind[0]}{number}", ", ".join(_value(group, i) for i in range(count))
        lines += [
            f"        {{ {C_TYPES[kind]} now[{count}] = {{{values}}};",
            f"          if (k == first || memcmp(now, {array}, sizeof now)) {{ memcpy({array}, now, sizeof now);",
            f"            fmi2Set{kind}{number}(c{number}, i{kind}{number}, {count}, {array}); }} }}",
        ]
    return lines


def _step(number: int) -> str:
    return f"        fmi2DoStep{number}(c{number}, TIME(k), H, fmi2True);"


def _read(number: int, part: Part) -> list[str]:
    lines, slot = [], part.first_signal
    for kind, values in part.outputs.items():
        count = len(values)
        if not count:
            continue
        where = f"s + {slot}" if kind == "Real" else f"y{kind}{number}"
        lines.append(f"        fmi2Get{kind}{number}(c{number}, o{kind}{number}, {count}, {where});")
        if kind != "Real":
            lines += [f"        s[{slot + i}] = y{kind}{number}[{i}];" for i in range(count)]
        slot += count
    return lines
