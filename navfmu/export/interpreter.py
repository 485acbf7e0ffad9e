"""Interpreter: runs a component with floats, in plain NumPy, with the semantics of the C runtime.

It is what tests and a debugger use, and what the PythonFMU twin carries. ``runtime/instance.c`` is the same thing in C;
the two are kept alike function by function.
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.component import Component
from navfmu.export.frame import Frame
from navfmu.export.layout import Field
from navfmu.export.noise import Normals
from navfmu.export.table import Table
from navfmu.export.task import TaskDeclaration

INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED = "instantiated", "initialization", "stepping", "terminated"
_PHASES = {
    INSTANTIATED: "before initialisation",
    INITIALIZATION: "in initialisation mode",
    STEPPING: "after initialisation",
    TERMINATED: "after termination",
}
_DTYPES = {"real": float, "integer": np.int64, "boolean": bool}


class FloatFrame(Frame):
    """Floats for everything a task can read."""

    def __init__(self, run: Interpreter, time: float, period: float) -> None:
        super().__init__(run.layout, time, period)
        self.run = run

    def load(self, field: Field) -> Any:
        values = self.run.values[field.index : field.index + field.size]
        if field.kind == "real" and not field.shape:
            return values[0]
        if field.kind == "integer":
            values = np.array([nearest_int(x) for x in values], np.int64)
        elif field.kind == "boolean":
            values = values != 0
        if not field.shape:
            return values[0]
        array = values.reshape(field.shape)
        array.setflags(write=False)
        return array

    def convert(self, field: Field, value: Any) -> Any:
        array = np.array(value)
        if field.kind == "integer" and array.dtype.kind == "f" and np.any(array != np.floor(array)):
            self.fail(f"'{field.name}' is an Integer and is assigned {value}")
        if field.kind == "boolean":
            array = array != 0
        array = array.astype(_DTYPES[field.kind])
        array.setflags(write=False)
        return array if field.shape else array[()]

    def rows(self, table: Table) -> tuple[Any, Any]:
        row = table.find(self.time)
        return table.rows[row], table.rows[row + 1]

    def commit(self) -> None:
        """Store what the task assigned."""
        for name in self.assigned:
            field = self.layout.fields[name]
            value = self.current[name]
            if field.shape:
                self.run.values[field.index : field.index + field.size] = value.ravel()
            else:
                self.run.values[field.index] = value


def nearest_int(value: float) -> int:
    """Return the nearest 32-bit integer, also for values that none can hold."""
    if math.isnan(value):
        return 0
    value = min(max(value, -2147483648.0), 2147483647.0)
    return int(value - 0.5) if value < 0 else int(value + 0.5)


class Interpreter:
    """One running instance of a component.

    ``set`` and ``get`` take FMI names (``x``, ``x[2]``, ``fix.valid``; the bare name of an array means all of it) or
    value references. Life: construct, set parameters, ``setup``, set inputs, ``do_step``...
    """

    def __init__(self, component: type[Component]) -> None:
        self.component = component
        self.layout = component.layout
        self.variables = self.layout.variables
        self._index = {v.name: v.index for v in self.variables}
        self._kinds = {v.index: v.type for v in self.variables}
        self._smooth = [v.index for v in self.variables if v.causality == "input" and v.variability == "continuous"]
        periods = [self._period(task) for task in self.layout.tasks]
        self._clocks = list(dict.fromkeys(p for p in periods if p is not None))
        self._calculated = any(task.kind == "start" for task in self.layout.tasks)
        self.events: list[str] = []
        self.reset()

    # --- life ---

    def reset(self) -> None:
        """Return to the state after construction."""
        self.values = np.array([v.start for v in self.variables], float)
        self.time = self.start_time = 0.0
        self.stop_time = math.inf
        self.phase = INSTANTIATED
        self.slopes: dict[int, float] = {}
        self.counts = [0] * len(self._clocks)
        self.last = [0] * len(self.layout.tasks)
        self._before: dict | None = None

    def setup(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set the experiment, check the parameters and run the start tasks: all of FMI's initialisation."""
        self.setup_experiment(start, stop)
        self.enter_initialization()
        self.exit_initialization()

    def setup_experiment(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set the interval of time in s."""
        if not math.isfinite(start) or (stop is not None and not stop >= start):
            raise NavfmuError(f"The experiment from {start:.9g} s to {stop} s is not an interval of time.")
        self.time = self.start_time = float(start)
        self.stop_time = math.inf if stop is None else float(stop)

    def enter_initialization(self) -> None:
        """Begin initialisation; outputs that are calculated from parameters can be read from here on."""
        self.phase = INITIALIZATION

    def exit_initialization(self) -> None:
        """End initialisation: check the parameters, run the start tasks."""
        self._undo_preview()
        self._check_parameters()
        self.time = self.start_time
        self._run_start_tasks()
        self.phase = STEPPING

    def terminate(self) -> None:
        """End the run; values can still be read."""
        self.phase = TERMINATED

    # --- values ---

    def _indices(self, name: str | int) -> tuple[int, tuple[int, ...]]:
        if isinstance(name, int | np.integer):
            if not 0 <= name < len(self.variables):
                raise NavfmuError(f"There is no variable with value reference {name} in '{self.layout.name}'.")
            return int(name), ()
        if name in self.layout.fields:
            field = self.layout.fields[name]
            return field.index, field.shape
        if name not in self._index:
            known = [*self.layout.fields, *self._index]
            raise NavfmuError(f"There is no variable '{name}' in '{self.layout.name}'{nearest(name, known)}")
        return self._index[name], ()

    def get(self, name: str | int) -> Any:
        """Return a value as float, int or bool, or the array that a bare name means."""
        index, shape = self._indices(name)
        if self._calculated and self.phase == INITIALIZATION:
            self._preview()
        convert = {"Real": float, "Integer": nearest_int, "Boolean": lambda x: bool(x != 0)}[self._kinds[index]]
        if not shape:
            return convert(self.values[index])
        return np.array([convert(x) for x in self.values[index : index + math.prod(shape)]]).reshape(shape)

    def set(self, name: str | int, value: Any) -> None:
        """Set an input or a parameter, or before initialisation ends the start value of an output."""
        index, shape = self._indices(name)
        self._undo_preview()
        numbers = np.broadcast_to(np.asarray(value, float), shape).ravel() if shape else (float(value),)
        for i, number in enumerate(numbers, index):
            self._check_settable(i)
            if self._kinds[i] == "Boolean":
                number = float(number != 0)
            if self.phase == STEPPING and self.variables[i].causality == "parameter":
                sentence = self._range_sentence(i, float(number))
                if sentence:
                    raise NavfmuError(sentence)
            self.values[i] = number
            if i in self.slopes:
                self.slopes[i] = 0.0

    def _check_settable(self, i: int) -> None:
        variable = self.variables[i]
        if self.phase == TERMINATED:
            why = "nothing can be set then"
        elif variable.causality == "local":
            why = "it is calculated"
        elif self.phase == STEPPING and variable.causality != "input" and variable.variability != "tunable":
            why = "it is fixed once initialisation has ended"
        else:
            return
        raise NavfmuError(f"Variable '{variable.name}' cannot be set {_PHASES[self.phase]}: {why}.")

    def set_derivative(self, name: str | int, value: Any) -> None:
        """Set the slope of a continuous Real input over the coming step."""
        index, shape = self._indices(name)
        self._undo_preview()
        for i, number in enumerate(np.ravel(np.broadcast_to(np.asarray(value, float), shape)), index):
            if i not in self._smooth:
                raise NavfmuError(
                    f"A derivative of order 1 was set for '{self.variables[i].name}'; expected order 1 and a "
                    "continuous Real input."
                )
            self.slopes[i] = float(number)

    # --- state ---

    def get_state(self) -> dict[str, Any]:
        """Return everything that the future depends on, as plain data that JSON keeps to the last bit."""
        self._undo_preview()
        return {
            "component": self.layout.name,
            "values": self.values.tolist(),
            "times": [self.time, self.start_time, self.stop_time],
            "phase": self.phase,
            "slopes": [[i, slope] for i, slope in self.slopes.items()],
            "counts": list(self.counts),
            "last": list(self.last),
        }

    def set_state(self, state: dict[str, Any]) -> None:
        """Return to a saved state."""
        if state.get("component") != self.layout.name or len(state["values"]) != len(self.variables):
            raise NavfmuError(f"This is not a saved state of '{self.layout.name}'.")
        self._before = None
        self.values = np.array(state["values"], float)
        self.time, self.start_time, self.stop_time = state["times"]
        self.phase = state["phase"]
        self.slopes = {int(i): slope for i, slope in state["slopes"]}
        self.counts, self.last = list(state["counts"]), list(state["last"])

    def _preview(self) -> None:
        if self._before is None:
            before = copy.deepcopy(self.get_state())
            self._run_start_tasks()
            self._before = before

    def _undo_preview(self) -> None:
        if self._before is not None:
            self.set_state(self._before)

    # --- parameters ---

    def _range_sentence(self, i: int, value: float) -> str | None:
        variable = self.variables[i]
        low = -math.inf if variable.min is None else variable.min
        high = math.inf if variable.max is None else variable.max
        if low <= value <= high:
            return None
        space, unit = (" ", variable.unit) if variable.unit and variable.unit != "1" else ("", "")
        told = f"Parameter '{variable.name}' is {value:.9g}{space}{unit}; expected a value"
        if math.isfinite(low) and math.isfinite(high):
            return f"{told} from {low:.9g} to {high:.9g}{space}{unit}."
        if math.isfinite(low):
            return f"{told} of at least {low:.9g}{space}{unit}."
        if math.isfinite(high):
            return f"{told} of at most {high:.9g}{space}{unit}."
        return f"Parameter '{variable.name}' is not a number."

    def _check_parameters(self) -> None:
        parameters = [v.index for v in self.variables if v.causality == "parameter"]
        sentences = [s for i in parameters if (s := self._range_sentence(i, float(self.values[i])))]
        for clock in self._clocks if not sentences else ():
            period = float(self.values[clock])
            if not (math.isfinite(period) and period > 0):
                name = self.variables[clock].name
                sentences.append(f"Parameter '{name}' is {period:.9g} s; expected a period longer than 0 s.")
        for requirement in self.layout.requirements if not sentences else ():
            if not requirement.function(self.component(FloatFrame(self, self.start_time, 0.0))):
                values = {n: float(self.values[self.layout.index(n)]) for n in requirement.names}
                show = re.compile(r"\{([^}]*)\}")
                sentences.append(show.sub(lambda m, values=values: f"{values[m[1]]:.6g}", requirement.message))
                break
        if sentences:
            raise NavfmuError(" ".join(sentences))

    # --- stepping ---

    def _period(self, task: TaskDeclaration) -> int | None:
        name = {"start": None, "every": task.argument, "on_new": self.layout.tick}[task.kind]
        return None if name is None else self.layout.fields[name].index

    def _run(self, task: TaskDeclaration, k: int, time: float, period: float) -> None:
        frame = FloatFrame(self, time, period)
        arguments: Iterable[Any] = ()
        if task.uses_noise:
            arguments = (Normals(self._whole("seed"), self._whole("stream"), k, task.stream),)
        task.function(self.component(frame), *arguments)
        frame.commit()

    def _whole(self, name: str) -> int:
        return nearest_int(self.values[self.layout.fields[name].index])

    def _run_start_tasks(self) -> None:
        for task in self.layout.tasks:
            if task.kind == "start":
                self._run(task, 0, self.start_time, 0.0)

    def _run_on_new(self, number: int, task: TaskDeclaration, time: float, tolerance: float, period: float) -> None:
        """Run the task if the bundle's number has changed and its time has come."""
        sequence = self._whole(f"{task.argument}.sequence")
        jump = sequence - self.last[number]
        valid_from = self.values[self.layout.fields[f"{task.argument}.time_of_validity"].index]
        if jump == 0 or not valid_from <= time + tolerance:
            return
        self.last[number] = sequence
        if jump > 1:
            self.values[self.layout.fields[f"{task.argument}.lost"].index] += jump - 1
            self.events.append(
                f"At {time:.9g} s {jump - 1} samples of '{task.argument}.sequence' were lost: the communication step "
                "is longer than their period."
            )
        self._run(task, sequence, time, period)

    @staticmethod
    def _tolerance(period: float, start: float, end: float) -> float:
        return 1e-9 * period + 4 * 2.220446049250313e-16 * max(abs(start), abs(end))

    def _due(self, clock: int) -> float:
        return float((self.counts[clock] + 1) * self.values[self._clocks[clock]])

    def _tick(self, elapsed: float, tolerance: float, origin: float, held: np.ndarray) -> None:
        """One tick: all clocks that are due at its time, then all tasks in the order of their declaration."""
        time = self.start_time + elapsed
        for i, slope in self.slopes.items():
            self.values[i] = held[i] + slope * (time - origin)
        due = set()
        for clock, index in enumerate(self._clocks):
            if self._due(clock) <= elapsed + tolerance:
                due.add(index)
                self.counts[clock] += 1
        for number, task in enumerate(self.layout.tasks):
            index = self._period(task)
            if task.kind == "on_new":
                self._run_on_new(number, task, time, tolerance, float(self.values[index]))
            elif task.kind == "every" and index in due:
                self._run(task, self.counts[self._clocks.index(index)], time, float(self.values[index]))

    def do_step(self, t: float, h: float) -> None:
        """Do everything that is due up to and including ``t + h`` (s)."""
        end = t + h
        slack = 1e-9 * (1.0 + abs(end))
        if self.phase != STEPPING:
            raise NavfmuError(f"do_step is not allowed {_PHASES[self.phase]}.")
        if not h >= 0 or not math.isfinite(end):
            raise NavfmuError(f"The communication step size is {h:.9g} s at {t:.9g} s; expected a positive number.")
        if abs(t - self.time) > slack:
            raise NavfmuError(
                f"A step from {t:.9g} s was asked for, but this instance is at {self.time:.9g} s; to go back, restore "
                "a saved state."
            )
        if end > self.stop_time + slack:
            raise NavfmuError(
                f"A step to {end:.9g} s was asked for, but the experiment ends at {self.stop_time:.9g} s."
            )
        self._advance(end)

    def _advance(self, end: float) -> None:
        origin, elapsed_end = self.time, end - self.start_time
        held = self.values.copy() if self.slopes else self.values
        while self._clocks:
            first = min(range(len(self._clocks)), key=self._due)
            due, period = self._due(first), float(self.values[self._clocks[first]])
            tolerance = self._tolerance(period, self.start_time, end)
            if not due <= elapsed_end + tolerance:
                break
            self._tick(due, tolerance, origin, held)
        for i in self.slopes:
            self.values[i] = held[i]
        self.slopes = {}
        self.time = end
