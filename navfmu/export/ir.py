"""The lowered model: what the tracer hands to the code generator.

A component declaration (``component.py``) is traced (``trace.py``) into a :class:`Model`: a flat list of variables
and a list of tasks, each a graph of operations on the same four vectors. Everything that follows (C code,
modelDescription.xml, documentation, the archive) is made from this object alone.

Storage: every variable, of any type, is one double in the vector ``v``; its value reference is its index there.
Arrays are contiguous, so that FMI 3.0 array variables need no other layout.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from navfmu.export.graph import Node
from navfmu.fmi.units import Unit


@dataclass(frozen=True)
class Variable:
    """One scalar FMI variable. ``index`` is both its place in ``v`` and its value reference."""

    index: int
    name: str  # "reading.rate[1]"
    type: str  # "Real", "Integer", "Boolean"
    causality: str  # "input", "output", "parameter", "local"
    variability: str  # "fixed", "tunable", "discrete", "continuous"
    initial: str | None  # "exact", "calculated" or None (inputs)
    start: float
    unit: str | None = None  # SI, as in UNITS
    display_unit: str | None = None
    min: float | None = None
    max: float | None = None
    nominal: float | None = None
    description: str = ""
    bundle: str | None = None  # name of the bundle it belongs to
    fault: bool = False  # an input that exists to inject a physical fault
    difference: bool = False  # between two values of its quantity: without an origin

    @property
    def base(self) -> str:
        """The name without the index of an element: "reading.rate" of "reading.rate[1]"."""
        return re.sub(r"\[[\d,]+\]$", "", self.name)


@dataclass(frozen=True)
class Table:
    """Rows searched by time: before each task ``row`` and ``next_row`` around the task's time are looked up."""

    name: str  # file resources/<name>.csv, first column is the key
    columns: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Clock:
    """Ticks at ``offset + k * period`` since the start; both are indices in v of Real parameters in s."""

    period: int
    offset: int | None = None  # its value is 0 where there is none


@dataclass(frozen=True)
class Task:
    """One piece of behaviour: when it runs, and the function that computes the new values.

    ``values`` are computed from the elements of ``v`` (all variables), ``noise`` (``normals`` standard normal numbers),
    ``time`` (one element) and ``rows`` (for each table its row and next row, concatenated); ``values[i]`` is then
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
    message: str  # "{name}" is replaced by the parameter's value, printed with %.6g
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
