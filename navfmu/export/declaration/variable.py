"""Variables of a component: its inputs, outputs, parameters and states, scalars or arrays of any dimensions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.declaration.items import extremes, numbered, numbers
from navfmu.export.declaration.text import LONGEST, texts
from navfmu.export.place import check_text, place

#: By kind: the type that a variable has for everybody who sets, connects or calculates with it.
TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "enumeration": "Integer", "string": "String"}


def shape_of(fail: Callable[[str], NoReturn], shape: Any) -> tuple[int, ...]:
    """Return a shape, given as a whole number or several, or ``fail``."""
    items = shape if isinstance(shape, tuple | list) else (shape,)
    if not all(isinstance(n, int | np.integer) and not isinstance(n, bool) and n >= 1 for n in items):
        fail(f"shape {shape!r} is none; expected a whole number from 1 on, or several in a tuple")
    return tuple(int(n) for n in items)


class Variable:
    """One declared variable, a scalar or an array: ``Input("m")``, ``State(4, 15, "m")``; use the subclasses.

    A ``difference`` between two values has no origin: 10 degC of it are 10 K.

    An enumeration has ``items``: names, which are numbered from 1, or an ``IntEnum`` without gaps. Its value is the
    number of an item, and it starts with the first one; ``start`` takes a name, too.

    A string is a fixed parameter that names something, a station or a file in resources; it has at most ``longest``
    bytes in UTF-8. Tasks do not see it.
    """

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
        items: type[IntEnum] | Sequence[str] | None = None,
        longest: int = LONGEST,
        fault: bool = False,
        tunable: bool = False,
        difference: bool = False,
    ) -> None:
        self.place = place()
        self.name = ""
        self.unit: str | None = None
        self.shape: tuple[int, ...] = ()
        for item in shape_and_unit:
            if not isinstance(item, str):
                self.shape += shape_of(self.fail, item)
            elif self.unit is None:
                self.unit = item
            else:
                self.fail(f"two units are given, {self.unit!r} and {item!r}")
        if kind not in TYPES:
            known = list(TYPES)
            self.fail(f"kind is {kind!r}, expected {', '.join(known[:-1])} or {known[-1]}{nearest(str(kind), known)}")
        if kind == "real" and self.unit is None:
            self.fail('a real variable needs its unit, for example Input("m/s2"), or "1" if it has none')
        if tunable and not isinstance(self, Parameter):
            self.fail("tunable is for parameters")
        if fault and not isinstance(self, Input):
            self.fail("fault=True is for inputs")
        if difference and kind != "real":
            self.fail("difference=True is for real variables, which have a unit")
        if (kind == "enumeration") != (items is not None):
            self.fail('items and kind="enumeration" go together, for example items=("search", "track")')
        self.items = {} if items is None else numbered(items, self.place, self.fail)
        self.enumeration = items.__name__ if isinstance(items, type) else None  # the name of its type
        if self.items:
            if not min is max is nominal is None:
                self.fail("an enumeration has no min, no max and no nominal: it has its items")
            kind, start = "integer", numbers(self.items, start, self.fail)
            min, max = extremes(self.items)
        self.texts: list[str] = []  # start values of a string
        self.longest = longest if kind == "string" else 0
        if kind == "string":
            if not isinstance(self, Parameter) or tunable:
                self.fail("a string is a fixed Parameter: it names something, and no task calculates it")
            if self.unit is not None or not min is max is nominal is None:
                self.fail("a string has no unit, no min, no max and no nominal")
            self.texts, start = texts(start, self.shape, longest, self.place, self.fail), 0
        elif longest != LONGEST:
            self.fail('longest is for strings, kind="string"')
        self.kind, self.min, self.max, self.nominal = kind, min, max, nominal
        self.display_unit, self.description, self.fault, self.tunable = display_unit, description, fault, tunable
        self.difference = difference
        check_text(self.place, f"{type(self).__name__}: description", description)
        self.start = self._numbers("start", 0 if start is None else start)
        self._check_range()
        if nominal is not None and not np.all(self._numbers("nominal", nominal) > 0):
            self.fail(f"nominal is {nominal}, expected a positive number")

    def _numbers(self, what: str, value: Any) -> np.ndarray:
        """Return one number for each element, flat: finite, and such as a variable of this kind can hold."""
        try:
            numbers = np.asarray(value, float)
        except (TypeError, ValueError):
            self.fail(f"{what} is {value!r}, expected a number, or numbers of shape {self.shape}")
        try:
            numbers = np.broadcast_to(numbers, self.shape).ravel()
        except ValueError:
            self.fail(f"{what} has shape {numbers.shape}, expected a number or {self.shape}")
        if not np.all(np.isfinite(numbers)):
            self.fail(f"{what} is {value}, expected a finite number; leave out a bound that there is not")
        if self.kind == "integer" and not np.all((numbers == np.floor(numbers)) & (np.abs(numbers + 0.5) < 2**31)):
            self.fail(f"{what} is {value}, expected a whole number of 32 bits")
        if self.kind == "boolean" and not np.all((numbers == 0) | (numbers == 1)):
            self.fail(f"{what} is {value}, expected True or False")
        return numbers

    def _check_range(self) -> None:
        """Refuse a range that is none, and start values outside it."""
        if self.kind == "boolean" and not self.min is self.max is None:
            self.fail("a boolean has no min and no max")
        low = -np.inf if self.min is None else self._numbers("min", self.min)
        high = np.inf if self.max is None else self._numbers("max", self.max)
        if np.any(low > high):
            self.fail(f"min is {self.min} and max is {self.max}, expected a max of at least min")
        for which, wrong in (("below its min", self.start < low), ("above its max", self.start > high)):
            if np.any(wrong):
                bound = self.min if which == "below its min" else self.max
                self.fail(f"start is {self.start[wrong][0]:g}, which is {which}, {bound}")

    def fail(self, what: str) -> NoReturn:
        """Raise the error for this declaration."""
        name = f" '{self.name}'" if self.name else ""
        raise NavfmuError(f"{self.place}: {type(self).__name__}{name}: {what}")

    def bound(self, which: str) -> tuple[float, ...] | None:
        """Return ``min`` or ``max`` of each element, flat; None if there is none."""
        value = getattr(self, which)
        return None if value is None else tuple(self._numbers(which, value).tolist())

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else component._frame.read(self.name)

    def __set__(self, component: Any, value: Any) -> None:
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
