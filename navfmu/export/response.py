"""An example run of a freshly built FMU: its inputs make a step, its outputs are recorded."""

from __future__ import annotations

import ctypes
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export import codegen, ir
from navfmu.export.declaration import Example
from navfmu.export.description import display

#: Height of the step of an input, by its unit.
_STEPS = {"m": 100.0, "m/s": 10.0, "m/s2": 1.0, "rad": 0.1, "rad/s": 0.02, "T": 1e-5, "Pa": 1000.0, "K": 5.0}
#: Places on the earth step by a minute of arc.
_PLACES = ("latitude", "longitude")
_MINUTE = 0.0002908882086657216


@dataclass(frozen=True)
class Response:
    """Outputs over time. ``values[i, j]`` is variable ``indices[j]`` at ``time[i]`` (s); inputs step at ``onset``."""

    time: np.ndarray
    indices: list[int]
    values: np.ndarray
    onset: float
    stepped: dict[int, float]  # index of an input -> height of its step
    fed: list[str]  # bundles that were fed
    example: Mapping[str, Any]  # values other than the start values


def step_response(
    model: ir.Model,
    guid: str,
    library: Path,
    example: Example | None = None,
    stop: float = 60.0,
) -> Response:
    """Run the built library of this machine: inputs step at a fifth of the time, bundles come at every tick.

    ``example`` gives values other than the start values and the height of steps; without it all Real inputs step by
    something that suits their unit.
    """
    example = example or Example()
    base = _values(model, example.values)
    periods = [model.variables[i].start for i in codegen.clocks(model)]
    count = int(min(3000, max(200, round(stop / min(periods, default=stop / 200)))))
    h, onset = stop / count, stop / 5
    bundles = sorted({v.bundle for v in model.variables if v.bundle and v.causality == "input"})
    inputs = [v for v in model.variables if v.causality == "input" and v.type == "Real" and not v.fault]
    stepped = {v.index: _height(v) for v in inputs if not v.name.endswith(".time_of_validity")}
    if example.steps is not None:
        stepped = _values(model, example.steps)
    reals = [v.index for v in model.variables if v.causality == "output" and v.type == "Real"]
    shown = [i for i in reals if not model.variables[i].name.endswith(".time_of_validity")]
    by_name = {v.name: v.index for v in model.variables}
    time = np.arange(count + 1) * h
    values = np.empty((count + 1, len(shown)))
    with _Run(model, guid, library) as run:
        for bundle in bundles:
            flags = [v.index for v in model.variables if v.bundle == bundle and v.type == "Boolean"]
            run.set(flags, [1] * len(flags), boolean=True)
        for kind in ("Real", "Integer", "Boolean"):
            indices = [i for i in base if model.variables[i].type == kind]
            run.set(indices, [base[i] for i in indices], integer=kind == "Integer", boolean=kind == "Boolean")
        run.initialise()
        values[0] = run.get(shown)
        for k in range(count):
            past = time[k] >= onset
            indices = list(stepped)
            starts = (base.get(i, model.variables[i].start) for i in indices)
            run.set(indices, [s + (stepped[i] if past else 0.0) for i, s in zip(indices, starts, strict=True)])
            for bundle in bundles:
                run.set([by_name[f"{bundle}.sequence"]], [k + 1], integer=True)
                run.set([by_name[f"{bundle}.time_of_validity"]], [time[k]])
            run.step(k * h, h)
            values[k + 1] = run.get(shown)
    return Response(time, shown, values, onset, stepped, bundles, example.values)


def _values(model: ir.Model, example: Mapping[str, Any]) -> dict[int, Any]:
    """Return values given by name (an array for a vector) by index."""
    known = {v.name: v.index for v in model.variables if v.causality in ("input", "parameter")}
    values: dict[int, Any] = {}
    for name, value in example.items():
        array = np.asarray(value)
        for place in np.ndindex(array.shape):
            full = name + (f"[{','.join(str(i + 1) for i in place)}]" if place else "")
            if full not in known:
                raise NavfmuError(
                    f"component '{model.name}': its example sets '{full}', which is no input or parameter"
                    f"{nearest(full, known)}"
                )
            values[known[full]] = array[place].item()
    return values


def _height(variable: ir.Variable) -> float:
    """Return a step that suits the unit, a round number in the display unit."""
    leaf = variable.name.rpartition(".")[2].partition("[")[0]
    height = _MINUTE if leaf in _PLACES else _STEPS.get(variable.unit or "1", 1.0)
    factor = display(variable, 1.0)[0] - display(variable, 0.0)[0]
    return float(f"{height * factor:.0e}") / factor


class _Run:
    """The few FMI calls that an example needs."""

    def __init__(self, model: ir.Model, guid: str, library: Path) -> None:
        self.model, self.guid, self.path = model, guid, library

    def __enter__(self) -> _Run:
        self.resources = tempfile.TemporaryDirectory(prefix="navfmu-")
        for table in self.model.tables:
            (Path(self.resources.name) / f"{table.name}.csv").write_text(codegen.table_text(table))
        self.fmi = ctypes.CDLL(os.fspath(self.path))
        pointer, text = ctypes.c_void_p, ctypes.c_char_p
        logger = ctypes.CFUNCTYPE(None, pointer, text, ctypes.c_int, text, text)
        self.messages: list[str] = []
        self.logger = logger(lambda env, name, status, category, message: self.messages.append(message.decode()))
        self.callbacks = (ctypes.c_void_p * 5)(ctypes.cast(self.logger, pointer))
        self.fmi.fmi2Instantiate.restype = pointer
        component = self.fmi.fmi2Instantiate(
            b"example",
            1,
            self.guid.encode(),
            Path(self.resources.name).as_uri().encode(),
            ctypes.byref(self.callbacks),
            0,
            0,
        )
        self.component = ctypes.c_void_p(component)
        if not component:
            self._check(3)
        return self

    def __exit__(self, *_: object) -> None:
        self.fmi.fmi2FreeInstance(self.component)
        self.resources.cleanup()

    def _check(self, status: int) -> None:
        if status > 1:
            raise NavfmuError(f"component '{self.model.name}': the example run failed: {' '.join(self.messages)}")

    def initialise(self) -> None:
        real = ctypes.c_double
        self._check(self.fmi.fmi2SetupExperiment(self.component, 0, real(0), real(0), 0, real(0)))
        self._check(self.fmi.fmi2EnterInitializationMode(self.component))
        self._check(self.fmi.fmi2ExitInitializationMode(self.component))

    def step(self, time: float, h: float) -> None:
        self._check(self.fmi.fmi2DoStep(self.component, ctypes.c_double(time), ctypes.c_double(h), 1))

    def set(self, indices: list[int], values: list[float], *, integer: bool = False, boolean: bool = False) -> None:
        setter = self.fmi.fmi2SetBoolean if boolean else self.fmi.fmi2SetInteger if integer else self.fmi.fmi2SetReal
        kind = ctypes.c_int if integer or boolean else ctypes.c_double
        count = len(indices)
        status = setter(
            self.component, (ctypes.c_uint * count)(*indices), ctypes.c_size_t(count), (kind * count)(*values)
        )
        self._check(status)

    def get(self, indices: list[int]) -> list[float]:
        count = len(indices)
        values = (ctypes.c_double * count)()
        self._check(
            self.fmi.fmi2GetReal(self.component, (ctypes.c_uint * count)(*indices), ctypes.c_size_t(count), values)
        )
        return list(values)
