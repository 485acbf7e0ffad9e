"""Variables of a component: its inputs, outputs, parameters and states, scalar, vector or matrix."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.place import place

TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}


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
        self.place = place()
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
