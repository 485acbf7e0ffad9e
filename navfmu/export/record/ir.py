"""The lowered model: what the tracer hands to the code generator.

A component declaration (``component.py``) is traced (``trace.py``) into a :class:`Model`: a list of variables and a
list of tasks, each a graph of operations on the same four vectors. Everything that follows (C code,
modelDescription.xml, documentation, the archive) is made from this object alone.

Storage: every number of a variable, of any type, is one double in the vector ``v``. Those of an array lie one after the
other, so a :class:`Variable` is also what FMI 3.0 calls one; the scalar variables of FMI 2.0 are a view of it, its
:meth:`~Variable.elements`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from navfmu.export.record.graph import Node
from navfmu.files.numbers import label, packed
from navfmu.fmi.units import Unit


@dataclass(frozen=True)
class Enumeration:
    """The type of a variable whose value is the number of an item; the numbers have no gaps."""

    name: str  # "Mode"
    items: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Variable:
    """One declared variable, a scalar or an array of any number of dimensions.

    ``index`` is the place of its first number in ``v``, and its value reference; the others follow in C order.
    ``start``, ``min`` and ``max`` have a number for each. The texts of all Strings of a model are numbered from 0, and
    the number of a String is that of its text.

    A member of an array of bundles is one variable, too, whose first dimensions, ``bundles``, are those of that array:
    "station.bias" of shape (5, 2) with ``bundles`` (5,) has the elements "station[1].bias[1]", "station[1].bias[2]",
    "station[2].bias[1]" ...
    """

    index: int
    name: str  # "reading.rate"
    type: str  # "Real", "Integer", "Boolean", "String"
    causality: str  # "input", "output", "parameter", "local"
    variability: str  # "fixed", "tunable", "discrete", "continuous"
    initial: str | None  # "exact", "calculated" or None (inputs)
    start: tuple[float, ...]
    shape: tuple[int, ...] = ()
    unit: str | None = None  # SI, as in UNITS
    display_unit: str | None = None
    min: tuple[float, ...] | None = None
    max: tuple[float, ...] | None = None
    nominal: float | None = None
    description: str = ""
    bundle: str | None = None  # name of the bundle it belongs to
    bundles: tuple[int, ...] = ()  # shape of the array of bundles it belongs to
    fault: bool = False  # an input that exists to inject a physical fault
    difference: bool = False  # between two values of its quantity: without an origin
    enumeration: Enumeration | None = None  # of an Integer that is one
    texts: tuple[str, ...] = ()  # of a String: its start values
    longest: int = 0  # and how many bytes of UTF-8 each has at most

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return math.prod(self.shape)

    @property
    def indices(self) -> range:
        """The places of its numbers in ``v``."""
        return range(self.index, self.index + self.size)

    def elements(self) -> tuple[Element, ...]:
        """Return its numbers one by one, in C order."""
        return tuple(Element(self, number) for number in range(self.size))

    def at(self, place: tuple[int, ...], inner: str = "") -> str:
        """Return its name with the indices of one bundle (from 0): "station[2].bias", and what follows that."""
        member = self.name.removeprefix(self.bundle or "")
        return f"{self.bundle}{subscript(place)}{member}{inner}" if self.bundles else f"{self.name}{inner}"


@dataclass(frozen=True)
class Element:
    """One number of a variable: a scalar variable of FMI 2.0."""

    variable: Variable
    number: int  # in C order, from 0

    @property
    def index(self) -> int:
        """Its place in ``v``, and its value reference."""
        return self.variable.index + self.number

    @property
    def place(self) -> tuple[int, ...]:
        """Its indices in the array, from 0; none for a scalar."""
        left, place = self.number, []
        for count in reversed(self.variable.shape):
            left, at = divmod(left, count)
            place.insert(0, at)
        return tuple(place)

    @property
    def subscripts(self) -> tuple[str, str]:
        """How FMI writes its indices, those of its bundle and its own: ("", "[1,2]"); nothing for a scalar."""
        count = len(self.variable.bundles)
        return subscript(self.place[:count]), subscript(self.place[count:])

    @property
    def name(self) -> str:
        """Its name in FMI 2.0: "reading.rate[1]", "station[2].range"."""
        count = len(self.variable.bundles)
        return self.variable.at(self.place[:count], subscript(self.place[count:]))

    @property
    def bundle(self) -> str | None:
        """The bundle it belongs to: "reading", "station[2]"."""
        return self.variable.bundle and self.variable.bundle + self.subscripts[0]

    @property
    def start(self) -> float:
        """Its start value."""
        return self.variable.start[self.number]

    @property
    def min(self) -> float | None:
        """Its least value, if there is one."""
        return None if self.variable.min is None else self.variable.min[self.number]

    @property
    def max(self) -> float | None:
        """Its largest value, if there is one."""
        return None if self.variable.max is None else self.variable.max[self.number]


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of numbers in the file resources/<name>.npy, searched by those that increase: rows, or two axes and
    surfaces over them.
    """

    name: str
    columns: tuple[str, ...]
    units: tuple[str, ...]
    numbers: tuple[np.ndarray, ...]  # of each column: (rows,), or (n,), (m,), (n, m), ...
    keys: tuple[int, ...]  # the columns that increase
    named_by: str | None = None  # the String with the name of another file to read instead

    @property
    def is_grid(self) -> bool:
        """Whether it is two axes and surfaces over them."""
        return self.numbers[-1].ndim == 2

    @property
    def size(self) -> str:
        """How many numbers it has: "3 rows", "40 x 30"."""
        first, second = (len(numbers) for numbers in self.numbers[:2]) if self.is_grid else (len(self.numbers[0]), 0)
        return f"{first} x {second}" if second else f"{first} rows"

    @property
    def labels(self) -> list[str]:
        """The names of the columns with their units, ``time (s)``."""
        return [label(name, unit) for name, unit in zip(self.columns, self.units, strict=True)]

    @property
    def file(self) -> str:
        """The name of its file."""
        return f"{self.name}.npy"

    @property
    def content(self) -> bytes:
        """What is in its file."""
        return packed(dict(zip(self.labels, self.numbers, strict=True)))


@dataclass(frozen=True)
class Clock:
    """Ticks at ``offset + k * period`` since the start; both are indices in v of Real parameters in s."""

    period: int
    offset: int | None = None  # its value is 0 where there is none


@dataclass(frozen=True)
class Task:
    """One piece of behaviour: when it runs, and the function that computes the new values.

    ``values`` are computed from the elements of ``v`` (all variables), ``noise`` (``normals`` standard normal numbers),
    ``time`` (one element) and what routines find in ``tables``; ``values[i]`` is then
    stored in ``v[targets[i]]``.
    """

    name: str
    kind: str  # "start", "every", "on_new"
    values: tuple[Node, ...]
    targets: tuple[int, ...]
    normals: int = 0
    stream: int = 0  # third word of the noise counter, distinct for each task
    clock: Clock | None = None  # which runs it ("every"), and whose period it is told ("every" and "on_new")
    sequence: int | None = None  # "on_new": index in v of the bundle's sequence number
    time_of_validity: int | None = None  # "on_new"
    lost: int | None = None  # "on_new": index in v of the Integer output that counts lost samples


@dataclass(frozen=True)
class Check:
    """A requirement on parameters, the elements of ``v``, tested when initialisation ends."""

    holds: Node
    message: str  # "{name}" is replaced by the parameter's value, printed with %.9g
    names: tuple[tuple[str, int], ...] = ()  # placeholder name and index in v


@dataclass(frozen=True)
class Through:
    """C of its own that calculates outputs from inputs at communication points, which lie one step size apart.

    What leaves at the end of a step comes from what was set before it; where it is ``direct``, whenever an output is
    read, from what was set last. ``unit`` is a file of ``files`` that is compiled beside the runtime and has
    ``void <model>_through(double *v, double *memory, int64_t k)``, as ``model.h`` tells.
    """

    step: float  # s
    direct: bool
    dependencies: Mapping[int, tuple[int, ...]]  # for each output the inputs on which it depends, indices in v
    memory: tuple[float, ...]  # before the start
    unit: str
    files: Mapping[str, str]


@dataclass(frozen=True)
class Model:
    """A component, ready to be turned into an FMU."""

    name: str  # FMI modelName and modelIdentifier, e.g. "imu"
    description: str
    variables: tuple[Variable, ...]
    tasks: tuple[Task, ...]
    checks: tuple[Check, ...] = ()
    tables: tuple[Table, ...] = ()
    seed: int | None = None  # index in v of the fixed Integer parameters that key the noise
    stream: int | None = None
    documentation: dict[str, Any] = field(default_factory=dict)
    through: Through | None = None
    units: Mapping[str, Unit] = field(default_factory=dict)  # that are not made of SI symbols
    needs: tuple[str, ...] = ()  # Python packages that it calls: tasks are without values, and there is no C

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """All numbers of all variables, by their places in ``v``."""
        return elements(self.variables)


def subscript(place: tuple[int, ...]) -> str:
    """Return indices (from 0) as FMI writes them, from 1: "[1,2]"; nothing if there are none."""
    return f"[{','.join(str(at + 1) for at in place)}]" if place else ""


def elements(variables: Iterable[Variable]) -> tuple[Element, ...]:
    """Return the numbers of variables one by one."""
    return tuple(element for variable in variables for element in variable.elements())


def named(variables: Iterable[Variable]) -> dict[str, tuple[range, tuple[int, ...]]]:
    """Return what each name stands for: places in ``v``, and the shape of their values.

    Elements have names, arrays, and those in one bundle of an array of bundles ("station[2].bias").
    """
    found = {}
    for variable in variables:
        found[variable.name] = variable.indices, variable.shape
        inner = variable.shape[len(variable.bundles) :]
        size = math.prod(inner)
        for number, place in enumerate(product(*map(range, variable.bundles))):
            first = variable.index + number * size
            found[variable.at(place)] = range(first, first + size), inner
        found |= {element.name: (range(element.index, element.index + 1), ()) for element in variable.elements()}
    return found
