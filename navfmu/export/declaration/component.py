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

A declaration needs NumPy alone: it is traced to C (``lower.py``) and run with floats
(``interpreter.py``, and through it the PythonFMU twin).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.export.declaration.bundle import Bundle
from navfmu.export.declaration.frame import Frame
from navfmu.export.declaration.layout import Layout
from navfmu.export.declaration.numbers import Numbers
from navfmu.export.declaration.parameter_set import ParameterSet
from navfmu.export.declaration.variable import Variable
from navfmu.export.place import place


class Component:
    """Base class of all components; see the module's first lines."""

    layout: Layout
    tick: str | None = None
    parameter_sets: Mapping[str, ParameterSet] = MappingProxyType({})
    #: Python packages that the tasks call. What needs one is no C: its FMU is a PythonFMU, and its state, part of which
    #: lies in ``kept``, cannot be saved.
    needs: tuple[str, ...] = ()

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls.layout = Layout(cls, place())

    def __init__(self, frame: Frame | None = None) -> None:
        if frame is None:
            raise NavfmuError(
                f"{place()}: component {type(self).__name__} is made anew for each tick; give the class, as in "
                f"Interpreter({type(self).__name__}) and build([{type(self).__name__}], folder)"
            )
        object.__setattr__(self, "_frame", frame)

    @property
    def time(self) -> Any:
        """Time of the tick in s."""
        return self._frame.time

    @property
    def period(self) -> Any:
        """Period of the task's clock in s."""
        return self._frame.period

    @property
    def kept(self) -> dict[str, Any]:
        """What an instance keeps of the packages that it ``needs``, by names of its own."""
        return self._frame.kept

    def __setattr__(self, name: str, value: Any) -> None:
        if isinstance(getattr(type(self), name, None), Variable | Bundle | Numbers):
            object.__setattr__(self, name, value)
        elif name in ("time", "period", "kept"):
            self._frame.fail(f"'{name}' cannot be assigned")
        else:
            known = [*self.layout.fields]
            self._frame.fail(f"'{name}' is not declared{nearest(name, known) or '; declare it as State or Output'}")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        self._frame.fail(f"'{name}' is not declared{nearest(name, self.layout.fields)}")
