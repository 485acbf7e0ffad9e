"""Interpreter: runs a component with floats, in plain NumPy, with the semantics of the C runtime.

It is what tests and a debugger use, and what the PythonFMU twin carries. When what may be called and set, and what is
said about it, stands in ``life.py`` for both; the rest is ``runtime/instance.c`` in Python, function by function.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export import life, needs
from navfmu.export.declaration.component import Component
from navfmu.export.declaration.frame import Frame
from navfmu.export.declaration.layout import Layout
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.declaration.task import TaskDeclaration
from navfmu.export.declaration.text import no_character, size
from navfmu.export.life import State
from navfmu.export.noise import Normals
from navfmu.export.record import ir
from navfmu.fmi.names import hint

_DTYPES = {"Real": float, "Integer": np.int64, "Boolean": bool}
#: The times that belong to the state.
_TIMES = ("time", "start_time", "stop_time", "elapsed", "base", "rest", "step", "alike")
_EPSILON = 2.220446049250313e-16
_OWN: Mapping[str, Numbers] = MappingProxyType({})  # tables are as they were declared


@dataclasses.dataclass
class Clock:
    """When tasks run: tick k comes at ``origin + (k - first) * period`` since the start (s)."""

    ticks: int  # number of the last tick that was made,
    first: int  # of the one whose time is
    origin: float
    period: float  # that holds from there on

    @property
    def due(self) -> float:
        """When the next tick comes (s)."""
        return self.origin + (self.ticks + 1 - self.first) * self.period

    def retime(self, period: float, now: float) -> None:
        """The period has changed: the next tick comes one new period after the last, at once if that has passed."""
        if self.ticks >= self.first:
            last = self.origin + (self.ticks - self.first) * self.period
            late = last + period < now
            self.origin = now if late else last
            self.first = self.ticks + late
        self.period = period


class FloatFrame(Frame):
    """Floats for everything a task can read."""

    def __init__(
        self,
        layout: Layout,
        values: np.ndarray,
        time: float,
        period: float,
        tables: Mapping[str, Numbers] = _OWN,
        kept: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(layout, time, period)
        self.values, self.tables, self._kept = values, tables, kept

    @property
    def kept(self) -> dict[str, Any]:
        return super().kept if self._kept is None else self._kept

    def load(self, variable: ir.Variable) -> Any:
        values = self.values[variable.index : variable.index + variable.size]
        if variable.type == "Real" and not variable.shape:
            return values[0]
        if variable.type == "Integer":
            values = np.array([nearest_int(x) for x in values], np.int64)
        elif variable.type == "Boolean":
            values = values != 0
        if not variable.shape:
            return values[0]
        array = values.reshape(variable.shape)
        array.setflags(write=False)
        return array

    def convert(self, variable: ir.Variable, value: Any) -> Any:
        array = np.array(value)
        if variable.type == "Integer":
            for i, number in zip(variable.indices, array.ravel().tolist(), strict=True):
                element = self.layout.elements[i]
                if not is_whole(number):
                    self.fail(life.sentence("NOT_WHOLE", element.name, number))
                if variable.enumeration and not element.min <= number <= element.max:
                    self.fail(life.sentence("NO_ITEM", element.name, element.min, element.max, number))
        if variable.type == "Boolean":
            array = array != 0
        array = array.astype(_DTYPES[variable.type])
        array.setflags(write=False)
        return array if variable.shape else array[()]

    def look_up(self, table: Numbers, key: int, values: Sequence[Any]) -> Any:
        return self.tables.get(table.name, table).look_up(key, *values)

    def commit(self) -> None:
        """Store what the task assigned."""
        for name in self.assigned:
            variable = self.layout.fields[name]
            value = self.current[name]
            if variable.shape:
                self.values[variable.index : variable.index + variable.size] = value.ravel()
            else:
                self.values[variable.index] = value


def nearest_int(value: float) -> int:
    """Return the nearest 32-bit integer, also for values that none can hold."""
    if math.isnan(value):
        return 0
    value = min(max(value, -2147483648.0), 2147483647.0)
    return int(value - 0.5) if value < 0 else int(value + 0.5)


def is_whole(value: float) -> bool:
    """Return whether an Integer can hold the value."""
    return -2147483648.0 <= value <= 2147483647.0 and value == math.floor(value)


def _run_task(
    component: type[Component],
    task: TaskDeclaration,
    values: np.ndarray,
    k: int,
    time: float,
    period: float,
    tables: Mapping[str, Numbers] = _OWN,
    kept: dict[str, Any] | None = None,
) -> set[str]:
    """Run a task on the values and store what it assigns; return the names of that."""
    layout = component.layout
    frame = FloatFrame(layout, values, time, period, tables, kept if component.needs else None)
    arguments: tuple[Any, ...] = task.element
    if task.uses_noise:
        seed, stream = (nearest_int(values[layout.fields[name].index]) for name in ("seed", "stream"))
        arguments += (Normals(seed, stream, k, task.stream),)
    task.function(component(frame), *arguments)
    frame.commit()
    return frame.assigned


def start_values(layout: Layout) -> np.ndarray:
    """Return the vector of all variables before anything is set."""
    return np.array([number for variable in layout.variables for number in variable.start], float)


@cache
def variables(component: type[Component]) -> tuple[ir.Variable, ...]:
    """Return the variables of a component, those marked as calculated that its start tasks assign.

    Which these are is found by running the start tasks once on the start values. A model that fails on these is
    refused with the sentence of what it did.
    """
    layout = component.layout
    values = start_values(layout)
    kept: dict[str, Any] = {}
    assigned: set[str] = set()
    for task in layout.tasks:
        if task.kind == "start":
            try:
                with np.errstate(all="ignore"):
                    assigned |= _run_task(component, task, values, 0, 0.0, 0.0, kept=kept)
            except NavfmuError:
                raise
            except Exception as error:
                what = f"task '{task.name}' fails on the start values: {type(error).__name__}: {error}"
                raise NavfmuError(f"{task.place}: component {component.__name__}: {what}") from error
    return tuple(dataclasses.replace(v, initial="calculated") if v.name in assigned else v for v in layout.variables)


@cache
def _number(component: type[Component]) -> str:
    """Return a hash of a component's variables, tasks and tables: what a saved state must fit."""
    layout = component.layout
    tasks = [(task.name, task.kind, task.argument, task.offset) for task in layout.tasks]
    digest = hashlib.sha256(repr((variables(component), tasks)).encode())
    for table in layout.tables:
        if table.file is None:
            digest.update(table.digest().encode())
    return digest.hexdigest()[:16]


def _digest(tables: Mapping[str, Numbers]) -> str:
    """Return a hash of tables that strings name, "" for none."""
    return hashlib.sha256(repr([table.digest() for table in tables.values()]).encode()).hexdigest() if tables else ""


class Interpreter:
    """One running instance of a component.

    ``set`` and ``get`` take FMI names (``x``, ``x[2]``, ``fix.valid``; the bare name of an array means all of it) or
    value references. Life: construct, set parameters, ``setup``, set inputs, ``do_step``... A call that is not
    allowed, or a value that is not, is a :class:`NavfmuError` and changes nothing. A saved state fits where variables,
    tasks and tables are the same, and so is ``build``, the name of it for those who know one. ``resources`` is the
    folder of files that strings name.
    """

    def __init__(self, component: type[Component], build: str = "", resources: str | Path = ".") -> None:
        needs.require(component)
        self.component, self.resources = component, Path(resources)
        self.layout = component.layout
        self._build = f"{build} {_number(component)}".strip()
        self.variables = variables(component)
        self.elements = ir.elements(self.variables)
        settable = {v.name: life.settable(v.causality, v.variability, v.initial) for v in self.variables}
        self._settable = [settable[e.variable.name] for e in self.elements]
        smooth = [v for v in self.variables if v.causality == "input" and v.variability == "continuous"]
        self._smooth = {i for v in smooth for i in v.indices}
        self._clock_of = [self.layout.clock(task) for task in self.layout.tasks]
        self._ticking = list(dict.fromkeys(clock for clock in self._clock_of if clock is not None))
        self._calculated = any(v.initial == "calculated" for v in self.variables)
        self.tables: dict[str, Numbers] = {}  # those that strings name
        self.events: list[str] = []  # what was said under logEvents, until somebody clears it
        self.reset()

    # --- life ---

    def reset(self) -> None:
        """Return to the state after construction."""
        self.values = start_values(self.layout)
        self.kept: dict[str, Any] = {}
        self.texts = [text for variable in self.variables for text in variable.texts]
        self.time = self.start_time = 0.0
        self.stop_time = math.inf
        self.elapsed = 0.0  # since the start: the sum of all steps,
        self.base = self.rest = 0.0  # of those before the last run of equal ones and what is too small to show in it,
        self.step = self.alike = 0.0  # and of that run: their size and number
        self.steps = 0
        self.state = State.INSTANTIATED
        self.slopes: dict[int, float] = {}
        self.clocks: dict[ir.Clock, Clock] = {}
        self.last = [0] * len(self.layout.tasks)
        self.named = ""  # what the tables that strings name held when initialisation ended
        self._before: dict | None = None

    def setup(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set the experiment, check the parameters and run the start tasks: all of FMI's initialisation."""
        self.setup_experiment(start, stop)
        self.enter_initialization()
        self.exit_initialization()

    def setup_experiment(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set the interval of time in s."""
        self._allow("fmi2SetupExperiment")
        stop = math.inf if stop is None else float(stop)
        if not math.isfinite(start) or not stop >= start:
            self._refuse("NO_INTERVAL", start, stop)
        self.time = self.start_time = float(start)
        self.stop_time = stop

    def enter_initialization(self) -> None:
        """Begin initialisation; what is calculated from parameters can be read from here on."""
        self._allow("fmi2EnterInitializationMode")
        self.state = State.INITIALIZATION

    def exit_initialization(self) -> None:
        """End initialisation: check the parameters, run the start tasks."""
        self._allow("fmi2ExitInitializationMode")
        self._undo_preview()
        self.tables = self._named_tables(self.texts)
        self._check_parameters()
        self._preview()
        self._before = None  # what was calculated stays
        self.named = _digest(self.tables)
        self.time = self.start_time
        for clock in self._ticking:
            offset = 0.0 if clock.offset is None else float(self.values[clock.offset])
            self.clocks[clock] = Clock(-1 if offset > 0 else 0, 0, offset, float(self.values[clock.period]))
        self.state = State.STEPPING

    def terminate(self) -> None:
        """End the run; values can still be read."""
        self._allow("fmi2Terminate")
        self.state = State.TERMINATED

    def _allow(self, function: str) -> None:
        if self.state not in life.CALLS[function]:
            self._refuse("NOT_ALLOWED", function, life.WHEN[self.state])

    @staticmethod
    def _refuse(message: str, *values: object) -> NoReturn:
        raise NavfmuError(life.sentence(message, *values))

    # --- values ---

    def _references(self, name: str | int) -> tuple[list[int], tuple[int, ...]]:
        """Return the value references that a name stands for, and the shape of their values."""
        if isinstance(name, int | np.integer):
            return [int(name)], ()
        if name not in self.layout.named:
            close = hint(name, self.layout.named)
            raise NavfmuError(f"There is no variable '{name}' in '{self.layout.name}'{close}")
        references, shape = self.layout.named[name]
        return list(references), shape

    def _element(self, reference: int, kind: str | None = None) -> ir.Element:
        """Return what has a value reference, which must be of that type if one is given."""
        if not 0 <= reference < len(self.elements):
            self._refuse("NO_VARIABLE", reference % 2**32, len(self.elements))
        element = self.elements[reference]
        if kind not in (None, element.variable.type):
            self._refuse("OTHER_TYPE", element.name, reference, element.variable.type, kind)
        return element

    def get(self, name: str | int) -> Any:
        """Return a value as float, int, bool or str, or the array that a bare name means."""
        references, shape = self._references(name)
        values = self.get_values(self._element(references[0]).variable.type, references)
        return np.array(values).reshape(shape) if shape else values[0]

    def set(self, name: str | int, value: Any) -> None:
        """Set an input or a parameter, or before initialisation ends the start value of an output or a state.

        An array takes an array, or one value for all of it; an enumeration the name of an item, too.
        """
        references, shape = self._references(name)
        variable = self._element(references[0]).variable
        kind, items = variable.type, dict(variable.enumeration.items) if variable.enumeration else {}
        if np.shape(value) not in ((), shape):
            raise NavfmuError(f"'{name}' is set to values of shape {np.shape(value)}; expected {shape}, or one for all")
        if isinstance(value, str) and kind != "String":
            if value not in items:
                expected = f"one of {', '.join(items)}" if items else "a number"
                raise NavfmuError(f"'{name}' is set to the text '{value}'; expected {expected}{nearest(value, items)}")
            value = items[value]
        values = np.broadcast_to(np.asarray(value, object if kind == "String" else float), shape).ravel().tolist()
        self.set_values(kind, references, values)

    def get_values(self, kind: str, references: Sequence[int]) -> list[Any]:
        """Return the values of variables of one type ("Real", "Integer", "Boolean", "String")."""
        if self._calculated and self.state == State.INITIALIZATION:
            self._preview()
        for reference in references:
            self._element(reference, kind)
        convert = {"Real": float, "Integer": nearest_int, "Boolean": lambda x: bool(x != 0), "String": self._text}[kind]
        return [convert(self.values[reference]) for reference in references]

    def _text(self, number: float) -> str:
        return self.texts[int(number)]

    def set_values(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        """Set variables of one type; the values of Integers are whole, those of Strings have bounds."""
        self._allow(f"fmi2Set{kind}")
        for reference, value in zip(references, values, strict=True):
            element = self._element(reference, kind)
            states = self._settable[reference]
            if self.state not in states:
                self._refuse("NOT_SETTABLE", element.name, life.WHEN[self.state], life.why_not(states))
            if kind == "Integer" and not is_whole(value):
                self._refuse("NOT_WHOLE", element.name, value)
            if kind == "String" and not isinstance(value, str):
                self._refuse("NO_TEXT", element.name)
            if kind == "String" and (wrong := no_character(value)):
                self._refuse("NO_CHARACTER", element.name, wrong)
            if kind == "String" and size(value) > element.variable.longest:
                self._refuse("TOO_LONG", element.name, size(value), element.variable.longest)
            if self.state == State.STEPPING and element.variable.causality == "parameter":
                sentence = self._range_sentence(element, float(value))
                if not sentence and reference in {clock.period for clock in self._ticking}:
                    sentence = self._period_sentence(element, float(value))
                if sentence:
                    raise NavfmuError(sentence)
        self._undo_preview()
        for reference, value in zip(references, values, strict=True):
            if kind == "String":
                self.texts[int(self.values[reference])] = value
            else:
                self.values[reference] = value != 0 if kind == "Boolean" else value

    def set_derivatives(self, references: Sequence[int], orders: Sequence[int], values: Sequence[float]) -> None:
        """Set derivatives of inputs for the coming step; it does not matter whether the values come before or after."""
        self._allow("fmi2SetRealInputDerivatives")
        for reference, order in zip(references, orders, strict=True):
            element = self._element(reference, "Real")
            if reference not in self._smooth or order != 1:
                self._refuse("NO_SLOPE", order, element.name)
        self._undo_preview()
        self.slopes.update(zip(references, (float(value) for value in values), strict=True))

    # --- state ---

    def get_state(self) -> dict[str, Any]:
        """Return everything that the future depends on, as plain data that JSON keeps to the last bit."""
        self._can_be_saved()
        return self._saved()

    def set_state(self, state: dict[str, Any]) -> None:
        """Return to a saved state."""
        self._can_be_saved()
        self._restore(state)

    def _can_be_saved(self) -> None:
        if self.component.needs:
            packages = " and ".join(self.component.needs)
            raise NavfmuError(f"'{self.layout.name}' cannot save or restore its state: part of it is in {packages}")

    def _saved(self) -> dict[str, Any]:
        self._undo_preview()
        return {
            "component": self.layout.name,
            "build": self._build,
            "values": self.values.tolist(),
            "texts": list(self.texts),
            "times": [getattr(self, name) for name in _TIMES],
            "steps": self.steps,
            "state": int(self.state),
            "slopes": [[i, slope] for i, slope in self.slopes.items()],
            "clocks": [dataclasses.astuple(clock) for clock in self.clocks.values()],
            "last": list(self.last),
            "named": self.named,
        }

    def _restore(self, state: dict[str, Any]) -> None:
        if (state.get("component"), state.get("build")) != (self.layout.name, self._build):
            self._refuse("OTHER_STATE", self.layout.name)
        if state["named"]:
            tables = self._named_tables(state["texts"])
            if _digest(tables) != state["named"]:
                self._refuse("OTHER_STATE", self.layout.name)
            self.tables = tables
        self._before, self.named = None, state["named"]
        self.values, self.texts = np.array(state["values"], float), list(state["texts"])
        for name, value in zip(_TIMES, state["times"], strict=True):
            setattr(self, name, value)
        self.steps, self.state = state["steps"], State(state["state"])
        self.slopes = {int(i): slope for i, slope in state["slopes"]}
        self.clocks = {key: Clock(*row) for key, row in zip(self._ticking, state["clocks"], strict=False)}
        self.last = list(state["last"])

    def _named_tables(self, texts: Sequence[str]) -> dict[str, Numbers]:
        """Return the tables whose files these texts name; where a text is empty the one that was declared."""
        found = {}
        for table in self.layout.tables:
            number = self.layout.text_of_file(table)
            if number is not None:
                file = texts[number]
                if file.startswith("/") or re.search(r"[\\:]|\.\.", file):
                    self._refuse("ELSEWHERE", file)
                known = self.tables.get(table.name)
                read = known if known and known.place == str(self.resources / file) else None
                found[table.name] = read or (table.read(self.resources / file) if file else table)
        return found

    def _preview(self) -> None:
        """Calculate what depends on what was set so far; when that fails, nothing has changed."""
        if self._before is not None:
            return
        self._before = self._saved()
        try:
            self.tables = self._named_tables(self.texts)
            for task in self.layout.tasks:
                if task.kind == "start":
                    self._run(task, 0, self.start_time, 0.0)
        except BaseException:
            self._undo_preview()
            raise

    def _undo_preview(self) -> None:
        if self._before is not None:
            self._restore(self._before)

    # --- parameters ---

    @staticmethod
    def _range_sentence(element: ir.Element, value: float) -> str | None:
        low = -math.inf if element.min is None else element.min
        high = math.inf if element.max is None else element.max
        if low <= value <= high:
            return None
        unit = element.variable.unit
        space, unit = (" ", unit) if unit and unit != "1" else ("", "")
        told = (element.name, value, space, unit)
        if math.isfinite(low) and math.isfinite(high):
            return life.sentence("BETWEEN", *told, low, high, space, unit)
        if math.isfinite(low):
            return life.sentence("AT_LEAST", *told, low, space, unit)
        if math.isfinite(high):
            return life.sentence("AT_MOST", *told, high, space, unit)
        return life.sentence("NO_NUMBER", element.name)

    @staticmethod
    def _period_sentence(period: ir.Element, value: float) -> str | None:
        good = math.isfinite(value) and value > 0
        return None if good else life.sentence("NO_PERIOD", period.name, value)

    def _clock_sentences(self) -> Iterable[str | None]:
        for clock in self._ticking:
            yield self._period_sentence(self.elements[clock.period], float(self.values[clock.period]))
            offset = 0.0 if clock.offset is None else float(self.values[clock.offset])
            if not (math.isfinite(offset) and offset >= 0):
                yield life.sentence("NO_OFFSET", self.elements[clock.offset].name, offset)

    def _check_parameters(self) -> None:
        parameters = [e for e in self.elements if e.variable.causality == "parameter"]
        sentences = [s for e in parameters if (s := self._range_sentence(e, float(self.values[e.index])))]
        sentences = sentences or [s for s in self._clock_sentences() if s]
        for requirement in self.layout.requirements if not sentences else ():
            frame = FloatFrame(self.layout, self.values, self.start_time, 0.0, self.tables)
            holds = requirement.function(self.component(frame))
            if not holds or holds != holds:
                values = {n: float(self.values[self.layout.index(n)]) for n in requirement.names}
                show = re.compile(r"\{([^}]*)\}")
                sentences.append(show.sub(lambda m, values=values: f"{values[m[1]]:.9g}", requirement.message))
                break
        if sentences:
            raise NavfmuError(" ".join(sentences))

    # --- stepping ---

    def _run(self, task: TaskDeclaration, k: int, time: float, period: float) -> None:
        _run_task(self.component, task, self.values, k, time, period, self.tables, self.kept)

    def _run_on_new(self, number: int, task: TaskDeclaration, time: float, tolerance: float, period: float) -> None:
        """Run the task if the bundle's number has changed and its time has come."""
        index, bundle = self.layout.index, task.argument
        sequence = nearest_int(self.values[index(f"{bundle}.sequence")])
        jump = sequence - self.last[number]
        valid_from = self.values[index(f"{bundle}.time_of_validity")]
        if jump == 0 or not valid_from <= time + tolerance:
            return
        self.last[number] = sequence
        if jump > 1:
            self.values[index(f"{bundle}.lost")] += jump - 1
            self.events.append(life.sentence("LOST", time, jump - 1, f"{bundle}.sequence"))
        self._run(task, sequence, time, period)

    @staticmethod
    def _tolerance(period: float, start: float, end: float) -> float:
        return 1e-9 * period + 4 * _EPSILON * max(abs(start), abs(end))

    def _move_clock(self, h: float, end: float) -> None:
        """Add the step to the time since the start, within the resolution of the host's clock.

        ``move_clock`` in ``runtime/instance.c`` says how and why.
        """
        before, clock = self.elapsed, end - self.start_time
        if h != self.step:
            run = self.alike * self.step
            total = self.base + run
            part = total - self.base
            self.rest += (self.base - (total - part)) + (run - part)
            self.base, self.step, self.alike = total, h, 0.0
        self.alike += 1.0
        self.steps += 1
        self.elapsed = self.base + (self.rest + self.alike * h)
        resolution = _EPSILON * (max(abs(self.start_time), abs(end)) + (self.steps + 1) * abs(clock))
        ahead = self.elapsed - clock
        if not abs(ahead) <= resolution:
            self.elapsed = self.base = clock + math.copysign(resolution, ahead)
            self.rest = self.alike = 0.0
        self.elapsed = max(self.elapsed, before)

    def _tick(self, elapsed: float, tolerance: float, since: float, held: np.ndarray) -> None:
        """One tick: all clocks that are due at its time, then all tasks in the order of their declaration."""
        time = self.start_time + elapsed
        for i, slope in self.slopes.items():
            if slope != 0:
                self.values[i] = held[i] + slope * since
        due = {key for key, clock in self.clocks.items() if clock.due <= elapsed + tolerance}
        for key in due:
            self.clocks[key].ticks += 1
        for number, (task, key) in enumerate(zip(self.layout.tasks, self._clock_of, strict=True)):
            if task.kind == "on_new":
                self._run_on_new(number, task, time, tolerance, self.clocks[key].period)
            elif task.kind == "every" and key in due:
                self._run(task, self.clocks[key].ticks, time, self.clocks[key].period)

    def do_step(self, t: float, h: float) -> None:
        """Do everything that is due up to and including ``t + h`` (s)."""
        self._allow("fmi2DoStep")
        end = t + h
        rounding = 8 * _EPSILON * max(abs(self.start_time), abs(end))
        slack = 1e-9 * (1.0 + abs(end - self.start_time))
        if not h > 0 or not math.isfinite(end):
            self._refuse("NO_STEP", h, t)
        if abs(t - self.time) > min(slack, 0.5 * h) + rounding:
            self._refuse("OTHER_TIME", t, self.time)
        if end > self.stop_time + slack + rounding:
            self._refuse("PAST_STOP", end, self.stop_time)
        try:
            self._advance(h, end)
        except BaseException:
            self.state = State.FAILED
            raise

    def _advance(self, h: float, end: float) -> None:
        """All ticks up to and including the time ``end`` (s)."""
        origin = self.time - self.start_time
        held = self.values.copy() if self.slopes else self.values
        for key, clock in self.clocks.items():
            if self.values[key.period] != clock.period:
                clock.retime(float(self.values[key.period]), self.elapsed)
        self._move_clock(h, end)
        try:
            while self.clocks:
                first = min(self.clocks.values(), key=lambda clock: clock.due)
                due, tolerance = first.due, self._tolerance(first.period, self.start_time, end)
                if not due <= self.elapsed + tolerance:
                    break
                self._tick(due, tolerance, max(due - origin, 0.0), held)
        finally:
            for i in self.slopes:
                self.values[i] = held[i]
            self.slopes = {}
        self.time = max(self.time, end)
