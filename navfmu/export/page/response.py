"""An example run of a freshly built FMU: its inputs step or follow the example, its outputs are recorded."""

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
from navfmu.export.declaration.example import Example
from navfmu.export.description import display
from navfmu.export.printing import codegen
from navfmu.export.record import ir
from navfmu.fmi.names import hint

#: Height of the step of an input, by its unit.
_STEPS = {"m": 100.0, "m/s": 10.0, "m/s2": 1.0, "rad": 0.1, "rad/s": 0.02, "T": 1e-5, "Pa": 1000.0, "K": 5.0}
#: Places on the earth step by a minute of arc.
_PLACES = ("latitude", "longitude")
_MINUTE = 0.0002908882086657216


@dataclass(frozen=True)
class Response:
    """Outputs over time. ``values[i, j]`` is variable ``indices[j]`` at ``time[i]`` (s), NaN before its first data."""

    time: np.ndarray
    indices: list[int]
    values: np.ndarray
    onset: float | None  # when inputs step, or another moment worth a line
    stepped: dict[int, float]  # index of an input -> height of its step
    fed: list[str]  # bundles that were fed
    example: Example
    panels: Mapping[str, Mapping[str, np.ndarray]]  # title -> label -> curve


def step_response(model: ir.Model, guid: str, library: Path, example: Example | None = None) -> Response:
    """Run the built library of this machine: inputs step or follow the example, bundles come at their periods.

    ``example`` gives values other than the start values, and what the inputs do; without it all Real inputs step by
    something that suits their unit at a fifth of the time.
    """
    example = example or Example()
    base = _values(model, example.values)
    stop = example.duration
    periods = [model.elements[clock.period].start for clock in codegen.clocks(model)]
    count = int(min(3000, max(200, round(stop / min(periods, default=stop / 200)))))
    if example.step:
        count = round(stop / example.step)
    time = np.arange(count + 1) * (stop / count)
    stepped = _stepped(model, example)
    onset = example.mark if example.mark is not None else stop / 5 if stepped else None
    feed = _feed(model, example, time, base, stepped, stop / 5)
    fed = sorted({v.bundle for v in model.variables if v.bundle and v.causality == "input"})
    outputs = [i for v in model.variables if v.causality == "output" for i in v.indices]
    values = np.empty((count + 1, len(outputs)))
    with _Run(model, guid, library) as run:
        run.set(base | {i: column[0] for i, column in feed.items() if not model.elements[i].variable.bundle})
        run.initialise()
        values[0] = run.get(outputs)
        for k in range(count):
            run.set({index: column[k] for index, column in feed.items() if k == 0 or column[k] != column[k - 1]})
            run.step(time[k], stop / count)
            values[k + 1] = run.get(outputs)
    column = {index: values[:, j] for j, index in enumerate(outputs)}
    panels = example.panels({"time": time, **_arrays(model, column)}) if example.panels else {}
    shown = _shown(model, example)
    sequences = {e.bundle: e.index for e in model.elements if e.variable.name == f"{e.variable.bundle}.sequence"}
    table = np.empty((count + 1, len(shown)))
    for j, index in enumerate(shown):
        table[:, j] = column[index]
        if bundle := model.elements[index].bundle:
            table[column[sequences[bundle]] == 0, j] = np.nan
    return Response(time, shown, table, onset, stepped, fed, example, panels)


def _stepped(model: ir.Model, example: Example) -> dict[int, float]:
    """Return the inputs that step, and by how much."""
    if example.steps is not None or example.inputs is not None:
        return _values(model, example.steps or {})
    inputs = [v for v in model.variables if v.causality == "input" and v.type == "Real" and not v.fault]
    return {i: _height(v) for v in inputs if not _is_time_of_validity(v) for i in v.indices}


def _is_time_of_validity(variable: ir.Variable) -> bool:
    return variable.name == f"{variable.bundle}.time_of_validity"


def _feed(
    model: ir.Model,
    example: Example,
    time: np.ndarray,
    base: Mapping[int, Any],
    stepped: Mapping[int, float],
    onset: float,
) -> dict[int, np.ndarray]:
    """Return what is set at each communication point: index of an input to its values over time."""
    feed = {}
    for index, height in stepped.items():
        feed[index] = base.get(index, model.elements[index].start) + np.where(time >= onset, height, 0.0)
    for variable in model.variables:
        if variable.causality != "input" or not variable.bundle:
            continue
        period = example.periods.get(variable.bundle, 0.0)
        number = np.floor(time / period + 1e-9) + 1 if period else np.arange(len(time)) + 1.0
        if variable.name == f"{variable.bundle}.valid":
            feed |= dict.fromkeys(variable.indices, np.ones(len(time)))
        elif variable.name == f"{variable.bundle}.sequence":
            feed |= dict.fromkeys(variable.indices, number)
        elif _is_time_of_validity(variable):
            feed |= dict.fromkeys(variable.indices, (number - 1) * period if period else time)
    for name, array in (example.inputs(time) if example.inputs else {}).items():
        rows = np.asarray(array, dtype=float)
        columns = rows.reshape(len(time), -1).T
        for index, column in zip(_values(model, {name: rows[0]}), columns, strict=True):
            # a value that is not data of a bundle is that of the step's end, when the component looks at it
            feed[index] = column if model.elements[index].bundle else np.append(column[1:], column[-1])
    return feed


def _arrays(model: ir.Model, column: Mapping[int, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the outputs over time by name, the numbers of an array along the second axis."""
    outputs = [v for v in model.variables if v.causality == "output"]
    return {v.name: np.stack([column[i] for i in v.indices], axis=1) if v.shape else column[v.index] for v in outputs}


def _shown(model: ir.Model, example: Example) -> list[int]:
    """Return the outputs in the picture, in the order of the example."""
    outputs = [v for v in model.variables if v.causality == "output"]
    if example.shows is None:
        return [i for v in outputs if v.type == "Real" and not _is_time_of_validity(v) for i in v.indices]
    known = ir.named(outputs)
    for name in example.shows:
        if name not in known:
            raise NavfmuError(
                f"component '{model.name}': its example shows '{name}', which is no output{hint(name, known)}"
            )
    return [index for name in example.shows for index in known[name][0]]


def _values(model: ir.Model, example: Mapping[str, Any]) -> dict[int, Any]:
    """Return values given by name (an array for an array) by index."""
    known = ir.named(v for v in model.variables if v.causality in ("input", "parameter"))
    values: dict[int, Any] = {}
    for name, value in example.items():
        where = f"component '{model.name}': its example sets '{name}'"
        if name not in known:
            raise NavfmuError(f"{where}, which is no input or parameter{hint(name, known)}")
        indices, shape = known[name]
        if np.shape(value) != shape:
            raise NavfmuError(f"{where} to values of shape {np.shape(value)}, expected {shape}")
        for index, given in zip(indices, np.ravel(value).tolist(), strict=True):
            values[index] = _value(model.elements[index].variable, given, where)
    return values


def _value(variable: ir.Variable, given: Any, where: str) -> Any:
    """Return a value as it is set: an item of an enumeration by its number, the text of a string as a text."""
    items = dict(variable.enumeration.items) if variable.enumeration else {}
    if isinstance(given, str) and items:
        if given not in items:
            raise NavfmuError(f"{where} to '{given}', expected one of {', '.join(items)}{nearest(given, items)}")
        return items[given]
    if isinstance(given, str) != (variable.type == "String"):
        raise NavfmuError(f"{where} to {given!r}, expected a {'text' if variable.type == 'String' else 'number'}")
    return given


def _height(variable: ir.Variable) -> float:
    """Return a step that suits the unit, a round number in the display unit."""
    leaf = variable.name.removeprefix(f"{variable.bundle}.")
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
            (Path(self.resources.name) / table.file).write_bytes(table.content)
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

    def set(self, values: Mapping[int, Any]) -> None:
        for kind, setter, ctype, convert in (
            ("Real", self.fmi.fmi2SetReal, ctypes.c_double, float),
            ("Integer", self.fmi.fmi2SetInteger, ctypes.c_int, round),
            ("Boolean", self.fmi.fmi2SetBoolean, ctypes.c_int, round),
            ("String", self.fmi.fmi2SetString, ctypes.c_char_p, str.encode),
        ):
            chosen = [(i, value) for i, value in values.items() if self.model.elements[i].variable.type == kind]
            if not chosen:
                continue
            count = len(chosen)
            numbers = (ctype * count)(*(convert(value) for _, value in chosen))
            references = (ctypes.c_uint * count)(*(i for i, _ in chosen))
            self._check(setter(self.component, references, ctypes.c_size_t(count), numbers))

    def get(self, indices: list[int]) -> list[float]:
        found: dict[int, float] = {}
        for kind, getter, ctype in (
            ("Real", self.fmi.fmi2GetReal, ctypes.c_double),
            ("Integer", self.fmi.fmi2GetInteger, ctypes.c_int),
            ("Boolean", self.fmi.fmi2GetBoolean, ctypes.c_int),
        ):
            chosen = [i for i in indices if self.model.elements[i].variable.type == kind]
            numbers = (ctype * len(chosen))()
            if chosen:
                references = (ctypes.c_uint * len(chosen))(*chosen)
                self._check(getter(self.component, references, ctypes.c_size_t(len(chosen)), numbers))
            found.update(zip(chosen, numbers, strict=True))
        return [found[i] for i in indices]
