"""The layout of a component: where its variables lie in the vector of all variables, and what else it declares."""

from __future__ import annotations

import inspect
import math
import re
import string
import zlib
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import Any, NoReturn

from navfmu.errors import NavfmuError, nearest
from navfmu.export.declaration.bundle import Bundle
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.declaration.requirement import Requirement
from navfmu.export.declaration.task import MARKS, TaskDeclaration
from navfmu.export.declaration.variable import TYPES, Input, Output, Parameter, Variable
from navfmu.export.place import check_text
from navfmu.export.record import ir
from navfmu.fmi.names import hint

RESERVED = {"name", "needs", "tick", "time", "period", "noise", "seed", "stream", "layout", "parameter_sets"}


def _held(member: Any) -> Variable | Bundle | Numbers | None:
    """Return a declaration that a list, tuple, set or dictionary holds, at any depth."""
    items = member.values() if isinstance(member, dict) else member if isinstance(member, list | tuple | set) else ()
    for item in items:
        found = item if isinstance(item, Variable | Bundle | Numbers) else _held(item)
        if found:
            return found
    return None


class Layout:
    """Everything a component class declares, in order."""

    def __init__(self, component: type, place: str) -> None:
        self.place, self.component = place, component
        self.fields: dict[str, ir.Variable] = {}
        self.size = 0  # of the vector of all variables
        self.tasks: list[TaskDeclaration] = []
        self.requirements: list[Requirement] = []
        self.tables: list[Numbers] = []
        self.bundles: dict[str, Bundle] = {}
        self.enumerations: dict[str, ir.Enumeration] = {}
        members: dict[str, Any] = {}
        for base in reversed(component.__mro__):
            own = {k: v for k, v in vars(base).items() if not k.startswith("__")}
            for name in own.keys() & members.keys():
                self._check_override(name, members[name], own[name])
            members.update(own)
        for name, member in members.items():
            self._member(name, member)
        if "__init__" in vars(component):
            self.fail(
                "has an __init__; a component keeps nothing of its own but States, constants are class attributes"
            )
        self.name = vars(component).get("name") or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", component.__name__).lower()
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", self.name):
            self.fail(f"name {self.name!r} must be a C identifier")
        text = inspect.cleandoc(component.__doc__ or "")
        check_text(place, f"component {component.__name__}", text)
        self.description, _, self.text = (part.strip() for part in text.partition("\n"))
        self.tasks = [replace(task, stream=i) for i, task in enumerate(t for s in self.tasks for t in self._each(s))]
        self.uses_noise = any(t.uses_noise for t in self.tasks)
        if self.uses_noise:
            stream = zlib.crc32(self.name.encode()) & 0x7FFFFFFF
            number = {"kind": "integer", "min": 0}
            self._add("seed", Parameter(**number, start=1, description="seed of the random numbers"))
            self._add("stream", Parameter(**number, start=stream, description="which stream of random numbers"))
        self._check_tasks(component)
        for named in self.enumerations.keys() & self.fields.keys():
            self.fail(f"'{named}' is the name of a variable and that of an enumeration; FMI 2.0 wants two names")

    def fail(self, what: str, place: str | None = None) -> NoReturn:
        """Raise the error for this component."""
        raise NavfmuError(f"{place or self.place}: component {self.component.__name__}: {what}")

    def _check_override(self, name: str, before: Any, member: Any) -> None:
        """Refuse a method that replaces a task or a requirement and would silently be none."""
        if MARKS & set(dir(before)) and callable(member) and not MARKS & set(dir(member)):
            code = member.__code__
            self.fail(
                f"'{name}' replaces a task or requirement and has no decorator; repeat it, or write {name} = None",
                f"{code.co_filename}, line {code.co_firstlineno}",
            )

    def _member(self, name: str, member: Any) -> None:
        if isinstance(member, Variable | Bundle | Numbers):
            if name in RESERVED:
                self.fail(f"the name '{name}' is taken in every component", member.place)
            if member.name != name:
                self.fail(f"'{name}' and '{member.name}' are one declaration; declare each by itself", member.place)
        elif held := _held(member):
            self.fail(
                f"'{name}' is a {type(member).__name__} of declarations; declare each as an attribute, or an array: "
                'State(3, "m"), Bundle(3, ...)',
                held.place,
            )
        if isinstance(member, Variable):
            self._add(name, member)
        elif isinstance(member, Bundle):
            self._add_bundle(name, member)
        elif isinstance(member, Numbers):
            self.tables.append(member)
        elif hasattr(member, "_navfmu_task"):
            kind, argument, offset, place = member._navfmu_task
            check_text(place, f"task '{name}'", member.__doc__ or "")
            noisy = [*inspect.signature(member).parameters][-1:] == ["noise"]
            self.tasks.append(TaskDeclaration(name, kind, member, argument, offset, noisy, 0, place))
        elif hasattr(member, "_navfmu_requirement"):
            message, place = member._navfmu_requirement
            check_text(place, f"requirement '{name}'", message)
            if set("{}") & set(re.sub(r"\{[^{}]*\}", "", message)):
                self.fail("a sentence has no braces but those around the name of a parameter: {name}", place)
            shown = [field[1:] for field in string.Formatter().parse(message) if field[1] is not None]
            if any(not name or form or conversion for name, form, conversion in shown):
                self.fail("a sentence shows a parameter as {name}, with a name and without a format", place)
            names = tuple(name for name, _, _ in shown)
            self.requirements.append(Requirement(message, member, names, place))

    def _add(self, name: str, declared: Variable, bundle: str | None = None, bundles: tuple[int, ...] = ()) -> None:
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)?", name):
            what = f"'{name}' cannot be the name of a variable of FMI 2.0: expected letters from A to Z, digits and '_'"
            self.fail(what, declared.place)

        def of_each(numbers: tuple[float, ...] | None) -> tuple[float, ...] | None:
            return numbers and numbers * math.prod(bundles)

        causality = declared.causality
        if causality == "parameter":
            variability = "tunable" if declared.tunable else "fixed"
        else:
            smooth = declared.kind == "real" and bundle is None and causality != "local"
            variability = "continuous" if smooth else "discrete"
        self.fields[name] = variable = ir.Variable(
            index=self.size,
            name=name,
            type=TYPES[declared.kind],
            causality=causality,
            variability=variability,
            initial=None if causality == "input" else "exact",
            start=of_each(tuple(map(float, self._text_numbers(declared) if declared.texts else declared.start))),
            shape=bundles + declared.shape,
            unit=declared.unit if declared.kind == "real" else None,
            display_unit=declared.display_unit,
            min=of_each(declared.bound("min")),
            max=of_each(declared.bound("max")),
            nominal=declared.nominal,
            description=declared.description,
            bundle=bundle,
            bundles=bundles,
            fault=declared.fault,
            difference=declared.difference,
            enumeration=self._enumeration(declared),
            texts=tuple(declared.texts),
            longest=declared.longest,
        )
        self.size += variable.size

    def _text_numbers(self, declared: Variable) -> range:
        first = sum(len(variable.texts) for variable in self.fields.values())
        return range(first, first + len(declared.texts))

    def _enumeration(self, declared: Variable) -> ir.Enumeration | None:
        """Return the type of an enumeration: the class of its items, or one that is named after the variable."""
        if not declared.items:
            return None
        named = declared.enumeration or "".join(w[:1].upper() + w[1:] for w in declared.name.split("_"))
        found = ir.Enumeration(named, tuple(declared.items.items()))
        if self.enumerations.setdefault(named, found) != found:
            declared.fail(f"its items are another '{named}' than those of another variable; give it another name")
        return found

    def _add_bundle(self, name: str, bundle: Bundle) -> None:
        self.bundles[name] = bundle
        make = Input if bundle.causality == "input" else Output
        what = bundle.description or name
        members = bundle.members | {
            "valid": make(kind="boolean", description=f"{what}: the values can be used"),
            "sequence": make(kind="integer", min=0, description=f"{what}: number of the sample, changes with new data"),
            "time_of_validity": make("s", description=f"{what}: time the values hold for"),
        }
        for key, member in members.items():
            self._add(f"{name}.{key}", member, name, bundle.shape)

    def _each(self, task: TaskDeclaration) -> Iterable[TaskDeclaration]:
        """Yield a task for each bundle of the array of bundles that one waits for, or the task itself."""
        bundle = self.bundles.get(task.argument or "") if task.kind == "on_new" else None
        shape = bundle.shape if bundle else ()
        if len(inspect.signature(task.function).parameters) != 1 + len(shape) + task.uses_noise:
            which = f" and which bundle of the array '{task.argument}', from 0," if shape else ""
            self.fail(f"task '{task.name}' takes self{which} and, if it needs random numbers, noise", task.place)
        for place in product(*map(range, shape)):
            at = ir.subscript(place)
            yield replace(task, name=task.name + at, argument=task.argument and task.argument + at, element=place)

    def _check_tasks(self, component: type) -> None:
        tick = getattr(component, "tick", None)
        clocks = [(t.argument, t.offset) for t in self.tasks if t.kind == "every"]
        for task in self.tasks:
            if task.kind == "on_new" and not any(task.element):
                name = task.argument.removesuffix(ir.subscript(task.element))
                bundle = self.bundles.get(name)
                if bundle is None or bundle.causality != "input":
                    known = [b for b, d in self.bundles.items() if d.causality == "input"]
                    self.fail(f"task '{task.name}': '{name}' is no input Bundle{nearest(name, known)}", task.place)
                if not tick and not clocks:
                    self.fail(
                        'a component with on_new and no every needs a clock: tick = "<name of a Parameter in s>"',
                        task.place,
                    )
                if f"{name}.lost" in self.fields:
                    self.fail(f"two tasks wait for bundle '{name}'", task.place)
                lost = Output(kind="integer", min=0, description=f"samples of {name} that were never seen")
                self._add(f"{name}.lost", lost, name, bundle.shape)
        self.tick = self._tick(tick, clocks)
        for task in self.tasks:
            if clock := self._named_clock(task):
                self._check_time("period", clock[0])
                self._check_time("offset", clock[1])
        for table in self.tables:
            self._check_file(table)
        for requirement in self.requirements:
            for name in requirement.names:
                if self.index(name) is None:
                    self.fail(f"the sentence names '{name}', unknown{hint(name, self.named)}", requirement.place)
                if self.elements[self.index(name)].variable.type == "String":
                    self.fail(f"the sentence names '{name}', which is a string; it shows numbers", requirement.place)

    def _check_file(self, table: Numbers) -> None:
        """Refuse the name of a file that no host can set."""
        field = self.fields.get(table.file) if table.file else None
        if table.file and (field is None or (field.type, field.shape) != ("String", ())):
            known = [n for n, f in self.fields.items() if f.type == "String"]
            hint = nearest(str(table.file), known)
            self.fail(
                f"the file of '{table.name}' is named by '{table.file}', which is no string Parameter{hint}",
                table.place,
            )

    def text_of_file(self, table: Numbers) -> int | None:
        """Return which of the component's texts names the file of a table."""
        return int(self.fields[table.file].start[0]) if table.file else None

    def _check_time(self, what: str, name: str | None) -> None:
        """Refuse a period or an offset that is no time which the user sets."""
        if name is None:
            return
        field = self.fields.get(name)
        if field is None or (field.causality, field.type, field.shape) != ("parameter", "Real", ()):
            known = [n for n, f in self.fields.items() if f.causality == "parameter" and f.unit == "s" and not f.shape]
            self.fail(f"the {what} '{name}' is no scalar Parameter in s{nearest(str(name), known)}")
        if field.unit != "s":
            self.fail(f"the {what} '{name}' is in {field.unit}, expected a Parameter in s")
        if what == "offset" and field.variability != "fixed":
            self.fail(f"the offset '{name}' must not be tunable: it says when the first tick comes")

    @staticmethod
    def _tick(named: str | None, clocks: list[tuple[str, str | None]]) -> tuple[str, str | None] | None:
        """Return period and offset of the clock of tasks that wait for data: the one that is named, or the first."""
        if named:
            return next((clock for clock in clocks if clock[0] == named), (named, None))
        return clocks[0] if clocks else None

    def _named_clock(self, task: TaskDeclaration) -> tuple[str, str | None] | None:
        return {"start": None, "every": (task.argument, task.offset), "on_new": self.tick}[task.kind]

    def clock(self, task: TaskDeclaration) -> ir.Clock | None:
        """Return the clock of a task; None for a start task."""
        named = self._named_clock(task)
        if named is None:
            return None
        period, offset = named
        return ir.Clock(self.fields[period].index, None if offset is None else self.fields[offset].index)

    @property
    def variables(self) -> tuple[ir.Variable, ...]:
        """The declared variables, in order."""
        return tuple(self.fields.values())

    @cached_property
    def elements(self) -> tuple[ir.Element, ...]:
        """Their numbers one by one, by value reference."""
        return ir.elements(self.variables)

    @cached_property
    def named(self) -> dict[str, tuple[range, tuple[int, ...]]]:
        """What each name of FMI stands for: value references, and the shape of their values."""
        return ir.named(self.variables)

    def index(self, name: str) -> int | None:
        """Return the value reference of an FMI name (an array's name gives its first element), None if unknown."""
        return self.named[name][0][0] if name in self.named else None
