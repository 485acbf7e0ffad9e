"""Lowering: a component class is traced, task by task, into the :class:`navfmu.export.record.ir.Model`."""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from navfmu.derivatives.dual import Dual
from navfmu.errors import NavfmuError
from navfmu.export import fingerprint, needs
from navfmu.export.declaration.component import Component
from navfmu.export.declaration.frame import Frame
from navfmu.export.declaration.layout import Layout
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.declaration.task import TaskDeclaration
from navfmu.export.interpreter import variables
from navfmu.export.place import is_foreign
from navfmu.export.record import ir
from navfmu.export.record.graph import Node, elements_used, vectors_read
from navfmu.export.tracing import trace
from navfmu.export.tracing.extent import MOST, current, shortest
from navfmu.repetition import outside

_KINDS = {"Real": "f", "Integer": "i", "Boolean": "b", "String": "i"}


class TraceFrame(Frame):
    """Symbols for everything a task can read."""

    def __init__(self, layout: Layout, period: int | None = None) -> None:
        self.symbols = trace.symbols("v", "".join(_KINDS[v.type] * v.size for v in layout.variables))
        super().__init__(layout, trace.symbols("time", "f")[0], 0.0 if period is None else self.symbols[period])
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
        normals = trace.symbols("noise", "f" * int(count), self.normals)
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


def _task(layout: Layout, task: TaskDeclaration, functions: dict) -> ir.Task:
    what = f"{task.place}: component {layout.component.__name__}, task '{task.name}'"
    alike = sum(other.function is task.function for other in layout.tasks)  # one for each bundle of an array
    return shortest(lambda: _traced(layout, task), what, functions, MOST // alike)[0]


def _called(layout: Layout, task: TaskDeclaration) -> ir.Task:
    """Return a task that only Python runs: when, not what."""
    return ir.Task(task.name, task.kind, (), (), stream=task.stream, clock=layout.clock(task))


def _traced(layout: Layout, task: TaskDeclaration) -> ir.Task:
    index = layout.index
    on_new = task.kind == "on_new"
    clock = layout.clock(task)
    frame = TraceFrame(layout, None if clock is None else clock.period)
    component = layout.component(frame)
    arguments = (*task.element, *([frame.noise] if task.uses_noise else []))
    _run(layout, f"task '{task.name}'", task.place, task.function, component, *arguments)
    targets, values = frame.changes()
    if vectors_read(values) - {"v", "noise", "time"}:
        layout.fail(
            "a function of the model, or of repeat, leaves what it calculates in an array or a list outside of it; let "
            "it return what it calculates",
            task.place,
        )
    return ir.Task(
        name=task.name,
        kind=task.kind,
        values=values,
        targets=targets,
        normals=frame.normals,
        stream=task.stream,
        clock=clock,
        sequence=index(f"{task.argument}.sequence") if on_new else None,
        time_of_validity=index(f"{task.argument}.time_of_validity") if on_new else None,
        lost=index(f"{task.argument}.lost") if on_new else None,
    )


def _checks(layout: Layout) -> list[ir.Check]:
    checks = []
    for number, requirement in enumerate(layout.requirements):
        frame = TraceFrame(layout)
        frame.period = frame.time  # neither is there when a requirement is looked at
        component = layout.component(frame)
        holds = _run(layout, f"requirement {number + 1}", requirement.place, requirement.function, component)
        wrong = [n for n in frame.current if layout.fields[n].causality != "parameter"]
        if wrong:
            layout.fail(f"a requirement is over parameters, '{wrong[0]}' is none", requirement.place)
        if np.shape(holds) != ():
            layout.fail("a requirement must be one truth value; use np.all", requirement.place)
        names = tuple((name, layout.index(name)) for name in requirement.names)
        (result,) = trace.expressions(holds)
        if any(elements_used((result,), "time")):
            layout.fail("a requirement is over parameters, and this one is over time", requirement.place)
        checks.append(ir.Check(result, requirement.message, names))
    return checks


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
    modules = [component.__module__, *fingerprint.sources(component.__module__)]
    with trace.tracing(sys.modules[name] for name in dict.fromkeys(modules) if name in sys.modules):
        functions: dict = {}
        tasks = tuple(
            _called(layout, task) if component.needs else _task(layout, task, functions) for task in layout.tasks
        )
        checks = tuple(_checks(layout))
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
