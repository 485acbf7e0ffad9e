"""Declaring a component: its variables, its tasks, what it requires of its parameters.

A component is a class; its variables are class attributes, its tasks are methods in plain NumPy over ``self.<name>``::

    class Lag(Component):
        \"\"\"First-order lag.\"\"\"

        u = Input("1", description="input")
        time_constant = Parameter("s", start=1.0, min=1e-3, description="time constant")
        sample_period = Parameter("s", start=0.01, min=1e-4, description="sampling period")
        y = Output("1", description="output")

        @every("sample_period")
        def step(self):
            a = np.exp(-self.period / self.time_constant)
            self.y = a * self.y + (1 - a) * self.u

This module needs NumPy alone: the same declaration is traced to C (``lower.py``) and run with floats
(``interpreter.py``, and through it the PythonFMU twin).
"""

from __future__ import annotations

import inspect
import math
import re
import string
import sys
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export import ir

TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
RESERVED = {"name", "tick", "time", "period", "noise", "seed", "stream", "layout"}
BUNDLE_SIGNALS = ("valid", "sequence", "time_of_validity")


def _place() -> str:
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    return f"{frame.f_code.co_filename}, line {frame.f_lineno}"


class Variable:
    """One declared variable, scalar, vector or matrix; use the subclasses."""

    causality = ""

    def __init__(
        self,
        *shape_and_unit: int | tuple[int, ...] | str,
        start: Any = None,
        min: Any = None,
        max: Any = None,
        nominal: float | None = None,
        display_unit: str | None = None,
        description: str = "",
        kind: str = "real",
        fault: bool = False,
        tunable: bool = False,
    ) -> None:
        self.place = _place()
        self.name = ""
        self.unit: str | None = None
        self.shape: tuple[int, ...] = ()
        for item in shape_and_unit:
            if isinstance(item, str):
                self.unit = item
            else:
                self.shape = (int(item),) if isinstance(item, int | np.integer) else tuple(int(n) for n in item)
        if kind not in TYPES:
            self.fail(f"kind is {kind!r}, expected real, integer or boolean{nearest(kind, TYPES)}")
        if kind == "real" and self.unit is None:
            self.fail('a real variable needs its unit, for example Input("m/s2"), or "1" if it has none')
        if any(n < 1 for n in self.shape) or len(self.shape) > 2:
            self.fail(f"shape {self.shape} is neither scalar, vector nor matrix")
        if tunable and not isinstance(self, Parameter):
            self.fail("tunable is for parameters")
        if fault and not isinstance(self, Input):
            self.fail("fault=True is for inputs")
        self.kind, self.min, self.max, self.nominal = kind, min, max, nominal
        self.display_unit, self.description, self.fault, self.tunable = display_unit, description, fault, tunable
        start = 0 if start is None else start
        try:
            self.start = np.broadcast_to(np.asarray(start, float), self.shape).ravel()
        except ValueError:
            self.fail(f"start has shape {np.shape(start)}, expected {self.shape}")
        for bound in (min, max):
            if bound is not None and np.shape(bound) not in ((), self.shape):
                self.fail(f"a bound has shape {np.shape(bound)}, expected a number or {self.shape}")

    def fail(self, what: str) -> NoReturn:
        """Raise the error for this declaration."""
        name = f" '{self.name}'" if self.name else ""
        raise NavfmuError(f"{self.place}: {type(self).__name__}{name}: {what}")

    def bound(self, which: str, i: int) -> float | None:
        """Return ``min`` or ``max`` of element ``i``."""
        value = getattr(self, which)
        return None if value is None else float(np.broadcast_to(value, self.shape).ravel()[i])

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Component | None, owner: type) -> Any:
        return self if component is None else component._frame.read(self.name)

    def __set__(self, component: Component, value: Any) -> None:
        component._frame.write(self.name, value)


class Input(Variable):
    """A variable that others drive; ``fault=True`` marks one that exists to inject a physical fault."""

    causality = "input"


class Output(Variable):
    """A variable that others read."""

    causality = "output"


class Parameter(Variable):
    """A variable that is set before the run, or while it runs if ``tunable=True``."""

    causality = "parameter"


class State(Variable):
    """A variable that the component keeps for itself from one task to the next."""

    causality = "local"


class Bundle:
    """Values that belong together in time, with ``valid``, ``sequence`` and ``time_of_validity``.

    Its members are all inputs or all outputs. New data is announced by the sequence number.
    """

    def __init__(self, *, description: str = "", **members: Variable) -> None:
        self.place = _place()
        self.name, self.description, self.members = "", description, members
        kinds = {type(m) for m in members.values()}
        if kinds not in ({Input}, {Output}):
            raise NavfmuError(f"{self.place}: the members of a Bundle are all Input or all Output")
        self.causality = kinds.pop().causality
        for name, member in members.items():
            if name in BUNDLE_SIGNALS or name == "lost" or name == "publish":
                raise NavfmuError(f"{self.place}: the name '{name}' is taken in every Bundle")
            member.name = name

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Component | None, owner: type) -> Any:
        return self if component is None else BundleView(component, self)

    def __set__(self, component: Component, value: Any) -> None:
        component._frame.fail(f"bundle '{self.name}' cannot be assigned; use self.{self.name}.publish(...)")


class BundleView:
    """A bundle as a task sees it: its members are read as attributes; an output bundle is published."""

    def __init__(self, component: Component, bundle: Bundle) -> None:
        object.__setattr__(self, "_component", component)
        object.__setattr__(self, "_bundle", bundle)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in self._bundle.members and name not in BUNDLE_SIGNALS:
            known = [*self._bundle.members, *BUNDLE_SIGNALS]
            self._component._frame.fail(f"bundle '{self._bundle.name}' has no member '{name}'{nearest(name, known)}")
        return self._component._frame.read(f"{self._bundle.name}.{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        bundle = self._bundle.name
        self._component._frame.fail(f"'{bundle}.{name}' cannot be assigned; use self.{bundle}.publish({name}=...)")

    def publish(self, *, valid: Any = True, time_of_validity: Any = None, when: Any = None, **values: Any) -> None:
        """Announce new values: ``sequence`` counts up, ``time_of_validity`` is now unless given.

        Members that are not given keep their value. With ``when``, everything is kept where that is false.
        """
        frame, bundle = self._component._frame, self._bundle
        if bundle.causality != "output":
            frame.fail(f"bundle '{bundle.name}' is an input and cannot be published")
        for name in values:
            if name not in bundle.members:
                frame.fail(f"bundle '{bundle.name}' has no member '{name}'{nearest(name, bundle.members)}")
        values["valid"] = valid
        values["time_of_validity"] = frame.time if time_of_validity is None else time_of_validity
        values["sequence"] = self.sequence + 1
        for name, value in values.items():
            path = f"{bundle.name}.{name}"
            if when is not None:
                frame.check_shape(path, value)
                value = np.where(when, value, frame.read(path))
            frame.write(path, value)


class Table:
    """Rows searched by time: ``self.<name>.row`` and ``.next_row`` are the rows around ``self.time``.

    ``columns`` are (name, unit) pairs, the first is the time in s, increasing. Before the first row the first two
    rows are found, after the last row the last two: interpolation must clip its fraction to stay at the ends.
    """

    def __init__(self, *, columns: tuple[tuple[str, str], ...], rows: Any) -> None:
        self.place = _place()
        self.name = ""
        self.columns = tuple((str(name), str(unit)) for name, unit in columns)
        self.rows = np.array(rows, float)
        if self.rows.ndim != 2 or self.rows.shape[1] != len(self.columns) or len(self.rows) < 2:
            raise NavfmuError(
                f"{self.place}: Table rows have shape {self.rows.shape}, expected at least 2 rows of "
                f"{len(self.columns)} columns"
            )
        if not np.all(np.isfinite(self.rows)) or not np.all(np.diff(self.rows[:, 0]) > 0):
            raise NavfmuError(f"{self.place}: Table rows must be finite and their first column must increase")
        self.rows.setflags(write=False)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def find(self, time: float) -> int:
        """Return the index of the row at or before ``time``, so that the next row exists."""
        return int(np.clip(np.searchsorted(self.rows[:, 0], time, side="right") - 1, 0, len(self.rows) - 2))

    def __get__(self, component: Component | None, owner: type) -> Any:
        return self if component is None else TableView(*component._frame.rows(self))

    def __set__(self, component: Component, value: Any) -> None:
        component._frame.fail(f"table '{self.name}' cannot be assigned")


@dataclass(frozen=True)
class Example:
    """Class attribute ``example``: the run shown in the documentation, and what to see in it.

    ``Example({"latitude": 0.66}, steps={"heading": 1.5}, text="...")``: parameters and inputs by name (an array for a
    vector), in their units. Without ``steps`` and ``inputs`` all Real inputs step, at a fifth of the ``duration``.
    """

    values: Mapping[str, Any] = field(default_factory=dict)
    steps: Mapping[str, Any] | None = None
    text: str = ""  # what the picture shows
    duration: float = 60.0  # s
    step: float | None = None  # communication step, s
    mark: float | None = None  # time of a dotted line, s; where inputs step unless given
    inputs: Callable[[np.ndarray], Mapping[str, Any]] | None = field(default=None, repr=False)
    """Inputs over time instead of steps: from the times (s) to arrays whose first axis is time, by name."""
    periods: Mapping[str, float] = field(default_factory=dict)
    """How often new data comes in each input bundle, s; at every communication point unless given."""
    shows: Sequence[str] | None = None  # outputs in the picture, all Real ones unless given
    panels: Callable[[Mapping[str, np.ndarray]], Mapping[str, Mapping[str, np.ndarray]]] | None = field(
        default=None, repr=False
    )
    """Further curves: from "time" and all outputs by name to title -> label -> curve; a label that begins with "~" is
    dashed."""


@dataclass(frozen=True)
class TableView:
    """The two rows of a table around the time of the task."""

    row: Any
    next_row: Any


@dataclass(frozen=True)
class TaskDeclaration:
    """One task of a component."""

    name: str
    kind: str  # "start", "every", "on_new"
    function: Callable
    argument: str | None  # "every": the parameter with the period; "on_new": the input bundle
    uses_noise: bool
    stream: int  # third word of the noise counter
    place: str


@dataclass(frozen=True)
class Requirement:
    """A sentence, and the method over parameters that must be true."""

    message: str
    function: Callable
    names: tuple[str, ...]
    place: str


def _task(kind: str, function: Callable, argument: str | None) -> Callable:
    code = function.__code__
    function._navfmu_task = (kind, argument, f"{code.co_filename}, line {code.co_firstlineno}")
    return function


def start(function: Callable) -> Callable:
    """Mark the method that runs once, on leaving initialisation, at t = 0."""
    return _task("start", function, None)


def every(period: str) -> Callable:
    """Mark a method that runs at ``k * period``, k = 1, 2, ...; ``period`` names a parameter in s."""
    if not isinstance(period, str):
        raise NavfmuError(f'{_place()}: every({period!r}) needs the name of a Parameter in s, for example "period"')
    return lambda function: _task("every", function, period)


def on_new(bundle: str) -> Callable:
    """Mark a method that runs at the first tick that sees new data in the input bundle."""
    if not isinstance(bundle, str):
        raise NavfmuError(f"{_place()}: on_new({bundle!r}) needs the name of an input Bundle")
    return lambda function: _task("on_new", function, bundle)


def require(message: str) -> Callable:
    """Mark a method over parameters that must be true when initialisation ends; ``{name}`` shows a parameter."""

    def mark(function: Callable) -> Callable:
        code = function.__code__
        function._navfmu_requirement = (message, f"{code.co_filename}, line {code.co_firstlineno}")
        return function

    return mark


@dataclass(frozen=True)
class Field:
    """Where a declared variable lies in the vector of all variables."""

    name: str  # "reading.rate"
    index: int
    shape: tuple[int, ...]
    size: int
    kind: str
    causality: str


def element_name(name: str, shape: tuple[int, ...], i: int) -> str:
    """Return the FMI name of element ``i`` (C order) of a variable: ``x``, ``x[1]``, ``x[1,2]``."""
    if not shape:
        return name
    return f"{name}[{','.join(str(k + 1) for k in np.unravel_index(i, shape))}]"


class Layout:
    """Everything a component class declares, in order."""

    def __init__(self, component: type[Component], place: str) -> None:
        self.place, self.component = place, component
        self.fields: dict[str, Field] = {}
        self.variables: list[ir.Variable] = []
        self.tasks: list[TaskDeclaration] = []
        self.requirements: list[Requirement] = []
        self.tables: list[Table] = []
        self.bundles: dict[str, Bundle] = {}
        members: dict[str, Any] = {}
        for base in reversed(component.__mro__):
            members.update({k: v for k, v in vars(base).items() if not k.startswith("__")})
        for name, member in members.items():
            self._member(name, member)
        self.name = vars(component).get("name") or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", component.__name__).lower()
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", self.name):
            self.fail(f"name {self.name!r} must be a C identifier")
        text = inspect.cleandoc(component.__doc__ or "")
        self.description, _, self.text = (part.strip() for part in text.partition("\n"))
        self.uses_noise = any(t.uses_noise for t in self.tasks)
        if self.uses_noise:
            stream = zlib.crc32(self.name.encode()) & 0x7FFFFFFF
            number = {"kind": "integer", "min": 0}
            self._add("seed", Parameter(**number, start=1, description="seed of the random numbers"))
            self._add("stream", Parameter(**number, start=stream, description="which stream of random numbers"))
        self._check_tasks(component)

    def fail(self, what: str, place: str | None = None) -> NoReturn:
        """Raise the error for this component."""
        raise NavfmuError(f"{place or self.place}: component {self.component.__name__}: {what}")

    def _member(self, name: str, member: Any) -> None:
        if isinstance(member, Variable | Bundle | Table) and name in RESERVED:
            self.fail(f"the name '{name}' is taken in every component", member.place)
        if isinstance(member, Variable):
            self._add(name, member)
        elif isinstance(member, Bundle):
            self._add_bundle(name, member)
        elif isinstance(member, Table):
            self.tables.append(member)
        elif hasattr(member, "_navfmu_task"):
            kind, argument, place = member._navfmu_task
            parameters = list(inspect.signature(member).parameters)
            if parameters[1:] not in ([], ["noise"]):
                self.fail(f"task '{name}' takes self and, if it needs random numbers, noise", place)
            stream = len(self.tasks)
            self.tasks.append(TaskDeclaration(name, kind, member, argument, len(parameters) == 2, stream, place))
        elif hasattr(member, "_navfmu_requirement"):
            message, place = member._navfmu_requirement
            shown = [field[1:] for field in string.Formatter().parse(message) if field[1] is not None]
            if any(not name or form or conversion for name, form, conversion in shown):
                self.fail("a sentence shows a parameter as {name}, with a name and without a format", place)
            names = tuple(name for name, _, _ in shown)
            self.requirements.append(Requirement(message, member, names, place))

    def _add(self, name: str, declared: Variable, bundle: str | None = None) -> None:
        field = Field(
            name, len(self.variables), declared.shape, math.prod(declared.shape), declared.kind, declared.causality
        )
        self.fields[name] = field
        causality = declared.causality
        if causality == "parameter":
            variability = "tunable" if declared.tunable else "fixed"
        else:
            smooth = declared.kind == "real" and bundle is None and causality != "local"
            variability = "continuous" if smooth else "discrete"
        for i in range(field.size):
            self.variables.append(
                ir.Variable(
                    index=field.index + i,
                    name=element_name(name, declared.shape, i),
                    type=TYPES[declared.kind],
                    causality=causality,
                    variability=variability,
                    initial=None if causality == "input" else "exact",
                    start=float(declared.start[i]),
                    unit=declared.unit if declared.kind == "real" else None,
                    display_unit=declared.display_unit,
                    min=declared.bound("min", i),
                    max=declared.bound("max", i),
                    nominal=declared.nominal,
                    description=declared.description,
                    bundle=bundle,
                    fault=declared.fault,
                )
            )

    def _add_bundle(self, name: str, bundle: Bundle) -> None:
        self.bundles[name] = bundle
        for key, member in bundle.members.items():
            self._add(f"{name}.{key}", member, name)
        make = Input if bundle.causality == "input" else Output
        what = bundle.description or name
        self._add(f"{name}.valid", make(kind="boolean", description=f"{what}: the values can be used"), name)
        sequence = make(kind="integer", min=0, description=f"{what}: number of the sample, changes with new data")
        self._add(f"{name}.sequence", sequence, name)
        self._add(f"{name}.time_of_validity", make("s", description=f"{what}: time the values hold for"), name)

    def _check_tasks(self, component: type[Component]) -> None:
        tick = getattr(component, "tick", None)
        clocks = [t.argument for t in self.tasks if t.kind == "every"]
        for task in self.tasks:
            if task.kind == "on_new":
                bundle = self.bundles.get(task.argument)
                if bundle is None or bundle.causality != "input":
                    known = [b for b, d in self.bundles.items() if d.causality == "input"]
                    self.fail(
                        f"task '{task.name}': '{task.argument}' is no input Bundle{nearest(task.argument, known)}",
                        task.place,
                    )
                if not tick and not clocks:
                    self.fail(
                        'a component with on_new and no every needs a clock: tick = "<name of a Parameter in s>"',
                        task.place,
                    )
                lost = Output(kind="integer", min=0, description=f"samples of {task.argument} that were never seen")
                if f"{task.argument}.lost" in self.fields:
                    self.fail(f"two tasks wait for bundle '{task.argument}'", task.place)
                self._add(f"{task.argument}.lost", lost, task.argument)
        for period in [*clocks, *([tick] if tick else [])]:
            field = self.fields.get(period)
            if field is None or (field.causality, field.kind, field.shape) != ("parameter", "real", ()):
                known = [n for n, f in self.fields.items() if f.causality == "parameter"]
                self.fail(f"the period '{period}' is no scalar Parameter in s{nearest(str(period), known)}")
            if self.variables[field.index].variability != "fixed":
                self.fail(f"the period '{period}' must not be tunable")
        for requirement in self.requirements:
            for name in requirement.names:
                if self.index(name) is None:
                    known = [v.name for v in self.variables]
                    self.fail(f"the sentence names '{name}', unknown{nearest(name, known)}", requirement.place)
        self.tick: str | None = tick or (clocks[0] if clocks else None)

    def index(self, name: str) -> int | None:
        """Return the value reference of an FMI name (an array's name gives its first element), None if unknown."""
        if name in self.fields:
            return self.fields[name].index
        return next((v.index for v in self.variables if v.name == name), None)


class Frame:
    """What ``self`` reads from and writes to while one task runs; the modes (floats, symbols) are subclasses."""

    def __init__(self, layout: Layout, time: Any, period: Any) -> None:
        self.layout, self.time, self.period = layout, time, period
        self.current: dict[str, Any] = {}
        self.assigned: set[str] = set()
        self.task = ""

    def load(self, field: Field) -> Any:
        """Return the stored value of a variable as a read-only array."""
        raise NotImplementedError

    def convert(self, field: Field, value: Any) -> Any:
        """Return an assigned value, of the right shape, as a read-only array of the variable's kind."""
        raise NotImplementedError

    def rows(self, table: Table) -> tuple[Any, Any]:
        """Return the two rows of a table around the time of the task."""
        raise NotImplementedError

    def where(self) -> str:
        """Return ``"file, line n"`` of the model's code that is running."""
        return _place()

    def fail(self, what: str) -> NoReturn:
        """Raise the error for what the task tried to do."""
        raise NavfmuError(f"{self.where()}: component {self.layout.component.__name__}: {what}")

    def read(self, name: str) -> Any:
        """Return the value a variable has now in this task."""
        if name not in self.current:
            self.current[name] = self.load(self.layout.fields[name])
        return self.current[name]

    def check_shape(self, name: str, value: Any) -> None:
        """Refuse a value of the wrong shape."""
        expected = self.layout.fields[name].shape
        if np.shape(value) != expected:
            self.fail(f"'{name}' is assigned shape {np.shape(value)}, expected {expected}")

    def write(self, name: str, value: Any) -> None:
        """Assign an output or a state."""
        field = self.layout.fields[name]
        if field.causality not in ("output", "local"):
            self.fail(f"'{name}' is of causality {field.causality} and cannot be assigned")
        self.check_shape(name, value)
        self.current[name] = self.convert(field, value)
        self.assigned.add(name)


class Component:
    """Base class of all components; see the module's first lines."""

    layout: Layout
    tick: str | None = None

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls.layout = Layout(cls, _place())

    def __init__(self, frame: Frame) -> None:
        object.__setattr__(self, "_frame", frame)

    @property
    def time(self) -> Any:
        """Time of the tick in s."""
        return self._frame.time

    @property
    def period(self) -> Any:
        """Period of the task's clock in s."""
        return self._frame.period

    def __setattr__(self, name: str, value: Any) -> None:
        if isinstance(getattr(type(self), name, None), Variable | Bundle | Table):
            object.__setattr__(self, name, value)
        elif name in ("time", "period"):
            self._frame.fail(f"'{name}' cannot be assigned")
        else:
            known = [*self.layout.fields]
            self._frame.fail(f"'{name}' is not declared{nearest(name, known) or '; declare it as State or Output'}")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        self._frame.fail(f"'{name}' is not declared{nearest(name, self.layout.fields)}")
