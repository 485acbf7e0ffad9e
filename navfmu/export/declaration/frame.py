"""The frame of a running task: what ``self`` reads from and writes to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.declaration.layout import Layout
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.place import place
from navfmu.export.record import ir
from navfmu.repetition import outside


class Frame:
    """What ``self`` reads from and writes to while one task runs; the modes (floats, symbols) are subclasses."""

    def __init__(self, layout: Layout, time: Any, period: Any) -> None:
        self.layout, self.time, self.period = layout, time, period
        self.current: dict[str, Any] = {}
        self.assigned: set[str] = set()
        self.task = ""

    @property
    def kept(self) -> dict[str, Any]:
        """What the instance keeps beside its variables."""
        self.fail("'kept' is for what comes from a Python package; name that in 'needs', or declare a State")

    def load(self, variable: ir.Variable) -> Any:
        """Return the stored value of a variable as a read-only array."""
        raise NotImplementedError

    def convert(self, variable: ir.Variable, value: Any) -> Any:
        """Return an assigned value, of the right shape, as a read-only array of the variable's kind."""
        raise NotImplementedError

    def look_up(self, table: Numbers, key: int, values: Sequence[Any]) -> Any:
        """Search a table or a grid by values of a key, or of both axes; return an array (..., width)."""
        raise NotImplementedError

    def fail(self, what: str) -> NoReturn:
        """Raise the error for what the task tried to do."""
        raise NavfmuError(f"{place()}: component {self.layout.component.__name__}: {what}")

    def read(self, name: str, place: tuple[int, ...] = ()) -> Any:
        """Return the value a variable has now in this task, of an array of bundles those of the bundle at ``place``."""
        if self.layout.fields[name].type == "String":
            self.fail(
                f"'{name}' is a string, which names something for hosts and tables; a task calculates with numbers"
            )
        if name not in self.current:
            self.current[name] = self.load(self.layout.fields[name])
        return self.current[name][place] if place else self.current[name]

    def check_shape(self, name: str, value: Any, place: tuple[int, ...] = ()) -> None:
        """Refuse a value of the wrong shape."""
        variable = self.layout.fields[name]
        expected = variable.shape[len(place) :]
        if np.shape(value) != expected:
            self.fail(f"'{variable.at(place)}' is assigned shape {np.shape(value)}, expected {expected}")

    def write(self, name: str, value: Any, place: tuple[int, ...] = ()) -> None:
        """Assign an output or a state, of an array of bundles that of the bundle at ``place``."""
        outside(f"'{name}' is assigned")
        variable = self.layout.fields[name]
        if variable.causality not in ("output", "local"):
            self.fail(f"'{name}' is of causality {variable.causality} and cannot be assigned")
        if isinstance(value, str):
            items = dict(variable.enumeration.items) if variable.enumeration else {}
            numbers = ", ".join(f"{number} for '{item}'" for item, number in items.items())
            expected = f"the number of an item: {numbers}" if items else "a number"
            self.fail(f"'{variable.at(place)}' is assigned the text '{value}', expected {expected}")
        self.check_shape(name, value, place)
        self.current[name] = self.convert(variable, _replaced(self.read(name), place, value) if place else value)
        self.assigned.add(name)


def _replaced(array: Any, place: tuple[int, ...], value: Any) -> Any:
    """Return the array with another value at a place."""
    if not place:
        return value
    rows = [array[i] for i in range(len(array))]
    rows[place[0]] = _replaced(rows[place[0]], place[1:], value)
    return np.stack(rows)
