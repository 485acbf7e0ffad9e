"""Lowering: a component class is traced, task by task, into the :class:`navfmu.export.record.ir.Model`."""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from navfmu.derivatives.dual import Dual
from navfmu.errors import NavfmuError
from navfmu.export import fingerprint, needs
from navfmu.export.declaration.component import Component
from navfmu.export.declaration.frame import Frame
from navfmu.export.declaration.layout import Layout
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.declaration.requirement import Requirement
from navfmu.export.declaration.task import TaskDeclaration
from navfmu.export.interpreter import variables
from navfmu.export.place import is_foreign
from navfmu.export.printing.printer import c_function, c_helpers
from navfmu.export.record import ir
from navfmu.export.record.graph import Node, Vector, elements_used, vectors_read
from navfmu.export.tracing import trace
from navfmu.export.tracing.extent import MOST, current, shortest
from navfmu.export.tracing.kept import Kept, is_traced
from navfmu.export.tracing.room import with_room
from navfmu.repetition import outside

_VECTORS = "v", "noise", "time"
_KINDS = {"Real": "f", "Integer": "i", "Boolean": "b", "String": "i"}


class TraceFrame(Frame):
    """Symbols for everything a task can read."""

    def __init__(self, layout: Layout, period: int | None = None) -> None:
        self.vectors = {name: Vector(name) for name in _VECTORS}
        self.symbols = trace.symbols(self.vectors["v"], "".join(_KINDS[v.type] * v.size for v in layout.variables))
        time = trace.symbols(self.vectors["time"], "f")[0]
        super().__init__(layout, time, 0.0 if period is None else self.symbols[period])
        self.found: dict[tuple, Any] = {}  # a table, a key and the nodes of its values -> what was found there
        self.normals = 0

    def load(self, variable: ir.Variable) -> Any:
        current().meet(variable.size)
        array = self.symbols[variable.index : variable.index + variable.size].reshape(variable.shape)
        array.setflags(write=False)
        return array

    def convert(self, variable: ir.Variable, value: Any) -> Any:
        array = np.array(value)
        if not isinstance(array, trace.Traced):
            array = array.astype(object).view(trace.Traced)
        if variable.type == "Integer":  # that there is no fraction is checked when the task runs
            array = trace.whole_numbers(array)
        else:
            array = array.astype(bool if variable.type == "Boolean" else float)
        array.setflags(write=False)
        return array

    def look_up(self, table: Numbers, key: int, values: Sequence[Any]) -> Any:
        points = np.broadcast_arrays(*(np.asarray(_without_derivatives(value)) for value in values))
        found = [self._look_up(table, key, point) for point in zip(*(p.ravel().tolist() for p in points), strict=True)]
        return np.stack(found).reshape(*points[0].shape, table.width)

    def _look_up(self, table: Numbers, key: int, point: Sequence[Any]) -> Any:
        """Search by one value of a key, or of each axis; the same ones again are no other search."""
        what = (table.name, key, *(getattr(value, "node", value) for value in point))
        if what not in self.found:
            name, *numbers = table.routine(key)
            numbers = (self.layout.tables.index(table), len(self.found), *numbers)
            self.found[what] = trace.routine(name, point, (table.width,), numbers=numbers, before=("tables",))
        return self.found[what]

    def noise(self, count: int) -> Any:
        """Return ``count`` fresh standard normal numbers."""
        outside("noise is drawn")
        normals = trace.symbols(self.vectors["noise"], "f" * int(count), self.normals)
        self.normals += normals.size
        return normals

    def changes(self) -> tuple[tuple[int, ...], tuple[Node, ...]]:
        """Return the indices of the variables that the task changes, and their new values."""
        targets, values = [], []
        before = trace.expressions(self.symbols)
        for name in sorted(self.assigned, key=lambda n: self.layout.fields[n].index):
            field = self.layout.fields[name]
            for i, value in enumerate(trace.expressions(self.current[name])):
                if value is not before[field.index + i]:
                    targets.append(field.index + i)
                    values.append(value)
        return tuple(targets), tuple(values)

    def check_own(self, values: Sequence[Node], what: str, place: str) -> None:
        """Refuse values that depend on others than those of this frame."""
        own = {id(vector) for vector in self.vectors.values()}
        others = [vector for vector in vectors_read(values) if id(vector) not in own]
        if {*others} - {*self.vectors}:
            self.layout.fail(
                "a function of the model, or of repeat, leaves what it calculates in an array or a list outside of it; "
                "let it return what it calculates",
                place,
            )
        if others:
            self.layout.fail(
                f"{what} calculates with values that another one has left outside of the component's variables; "
                "declare a State for them",
                place,
            )


def _without_derivatives(value: Any) -> Any:
    """Return the value alone: between two rows what is found does not change."""
    while isinstance(value, Dual):
        value = value.value
    return value


def _run(layout: Layout, what: str, place: str, function: Callable, *arguments: Any) -> Any:
    """Call a method of the component; any failure becomes a sentence with the model's file and line."""
    try:
        return function(*arguments)
    except NavfmuError:
        raise
    except Exception as error:
        lines = traceback.extract_tb(sys.exc_info()[2])
        line = next((f for f in reversed(lines) if not is_foreign(f.filename)), None)
        where = f"{line.filename}, line {line.lineno}" if line else place
        if isinstance(error, TypeError) and "has no callable" in str(error):
            told = "a NumPy function is given a list of traced values, or an array that was made of one behind its back"
            remedy = "write np.array([...]) for the list, with np.array or array of the module that defines the model"
        else:
            told = f"{type(error).__name__}: {error}"
            remedy = "the code must be plain NumPy on arrays of fixed shape, without indexing by values"
        raise NavfmuError(f"{where}: component {layout.component.__name__}, {what}: {told}; {remedy}") from error


class _Alone:
    """What is traced finds what the model keeps as it was before any task, and must leave it like that.

    What it calculates anew each time, and keeps, is made of constants, or an FMU would not know of it.
    """

    def __init__(self, layout: Layout, modules: Sequence[ModuleType]) -> None:
        self.layout, self.kept = layout, Kept(modules, layout.component)
        self.functions: dict = {}  # that were recorded as calls

    def traced(self, trace: Callable[[], tuple], what: str, place: str, most: int = MOST) -> tuple:
        """Return what is traced; ``trace`` gives it as a tuple that ends with its results."""
        where = f"{place}: component {self.layout.component.__name__}, {what}"

        try:
            found = shortest(lambda: with_room(trace, self.kept.restore), where, self.functions, most)[0]
            first = self.kept.later()
            changes = [*first.added_to(self.kept), *first.replaced_in(self.kept)]
            for name, value in changes:
                if is_traced(value):
                    self._fail(f"{what} leaves what it calculates in {name}, outside of it", place)
            for name, _ in first.replaced_in(self.kept):
                self._fail(f"{what} changes {name}", place)
            if changes:
                again = shortest(lambda: with_room(trace), where, {}, most)[0]
                second = self.kept.later()
                for name, _ in [*second.added_to(first), *second.replaced_in(first)]:
                    self._fail(f"{what} changes {name} each time", place)
                if _printed(again[-1]) != _printed(found[-1]):
                    self._fail(f"{what} does something else where {changes[0][0]} is there already", place)
            return found
        finally:
            self.kept.restore()

    def _fail(self, told: str, place: str) -> NoReturn:
        self.layout.fail(
            f"{told}, and an FMU keeps its variables alone; let functions return what they calculate, and declare what "
            "is needed at the next tick, or in another task, as a State",
            place,
        )


def _printed(values: Sequence[Node]) -> str:
    return "\n".join([*c_helpers(values), c_function("f", [*_VECTORS], values).text])


def _task(alone: _Alone, task: TaskDeclaration) -> ir.Task:
    layout, index = alone.layout, alone.layout.index
    alike = sum(other.function is task.function for other in layout.tasks)  # one for each bundle of an array
    what = f"task '{task.name}'"
    frame, targets, values = alone.traced(lambda: _traced(layout, task), what, task.place, MOST // alike)
    on_new = task.kind == "on_new"
    return ir.Task(
        name=task.name,
        kind=task.kind,
        values=values,
        targets=targets,
        normals=frame.normals,
        stream=task.stream,
        clock=layout.clock(task),
        sequence=index(f"{task.argument}.sequence") if on_new else None,
        time_of_validity=index(f"{task.argument}.time_of_validity") if on_new else None,
        lost=index(f"{task.argument}.lost") if on_new else None,
    )


def _called(layout: Layout, task: TaskDeclaration) -> ir.Task:
    """Return a task that only Python runs: when, not what."""
    return ir.Task(task.name, task.kind, (), (), stream=task.stream, clock=layout.clock(task))


def _traced(layout: Layout, task: TaskDeclaration) -> tuple[TraceFrame, tuple[int, ...], tuple[Node, ...]]:
    clock = layout.clock(task)
    frame = TraceFrame(layout, None if clock is None else clock.period)
    component = layout.component(frame)
    arguments = (*task.element, *([frame.noise] if task.uses_noise else []))
    _run(layout, f"task '{task.name}'", task.place, task.function, component, *arguments)
    targets, values = frame.changes()
    frame.check_own(values, f"task '{task.name}'", task.place)
    return frame, targets, values


def _checks(alone: _Alone) -> list[ir.Check]:
    checks = []
    for number, requirement in enumerate(alone.layout.requirements):
        what = f"requirement {number + 1}"
        ((result,),) = alone.traced(
            lambda r=requirement, w=what: _looked_at(alone.layout, r, w), what, requirement.place
        )
        names = tuple((name, alone.layout.index(name)) for name in requirement.names)
        checks.append(ir.Check(result, requirement.message, names))
    return checks


def _looked_at(layout: Layout, requirement: Requirement, what: str) -> tuple[tuple[Node, ...]]:
    frame = TraceFrame(layout)
    frame.period = frame.time  # neither is there when a requirement is looked at
    component = layout.component(frame)
    holds = _run(layout, what, requirement.place, requirement.function, component)
    wrong = [n for n in frame.current if layout.fields[n].causality != "parameter"]
    if wrong:
        layout.fail(f"a requirement is over parameters, '{wrong[0]}' is none", requirement.place)
    if np.shape(holds) != ():
        layout.fail("a requirement must be one truth value; use np.all", requirement.place)
    results = tuple(trace.expressions(holds))
    if any(elements_used(results, "time")):
        layout.fail("a requirement is over parameters, and this one is over time", requirement.place)
    frame.check_own(results, what, requirement.place)
    return (results,)


def _documentation(layout: Layout) -> dict[str, Any]:
    def source(function: Callable) -> str:
        try:
            return inspect.cleandoc("\n" + inspect.getsource(function))
        except OSError:
            return ""

    tasks = [
        {
            "name": t.name,
            "kind": t.kind,
            "argument": t.argument,
            "text": inspect.cleandoc(t.function.__doc__ or ""),
            "source": source(t.function),
        }
        for t in layout.tasks
    ]
    requirements = [{"message": r.message, "source": source(r.function)} for r in layout.requirements]
    return {
        "text": layout.text,
        "class": layout.component.__name__,
        "module": layout.component.__module__,
        "tasks": tasks,
        "requirements": requirements,
        "bundles": {name: bundle.description for name, bundle in layout.bundles.items()},
    }


def lower(component: type[Component]) -> ir.Model:
    """Trace a component class into the model that the code generator reads."""
    needs.require(component)
    layout = component.layout
    names = dict.fromkeys([component.__module__, *fingerprint.sources(component.__module__)])
    modules = [sys.modules[name] for name in names if name in sys.modules]
    with trace.tracing(modules):
        alone = _Alone(layout, modules)
        tasks = tuple(_called(layout, task) if component.needs else _task(alone, task) for task in layout.tasks)
        checks = tuple(_checks(alone))
    tables = tuple(
        ir.Table(
            name=table.name,
            columns=tuple(name for name, _ in table.columns),
            units=tuple(unit for _, unit in table.columns),
            numbers=table.numbers,
            keys=table.keys,
            named_by=table.file,
        )
        for table in layout.tables
    )
    return ir.Model(
        name=layout.name,
        description=layout.description,
        variables=variables(component),
        tasks=tasks,
        checks=checks,
        tables=tables,
        seed=layout.fields["seed"].index if layout.uses_noise else None,
        stream=layout.fields["stream"].index if layout.uses_noise else None,
        documentation=_documentation(layout),
        needs=component.needs,
    )
