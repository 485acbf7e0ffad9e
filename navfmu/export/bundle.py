"""Bundles: values that belong to one instant, and the signals that announce them."""

from __future__ import annotations

from typing import Any

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.place import check_text, place
from navfmu.export.variable import Input, Output, Variable

SIGNALS = ("valid", "sequence", "time_of_validity")
TAKEN = (*SIGNALS, "lost", "publish", "when")  # by what every bundle has: signals, a counter, a method and its option


class Bundle:
    """Values that belong together in time, with ``valid``, ``sequence`` and ``time_of_validity``.

    Its members are all inputs or all outputs. New data is announced by the sequence number.
    """

    def __init__(self, /, *, description: str = "", **members: Variable) -> None:
        self.place = place()
        self.name, self.description, self.members = "", description, members
        check_text(self.place, "Bundle: description", description)
        kinds = {type(m) for m in members.values()}
        if kinds not in ({Input}, {Output}):
            raise NavfmuError(f"{self.place}: the members of a Bundle are all Input or all Output")
        self.causality = kinds.pop().causality
        for name, member in members.items():
            if name in TAKEN or name.startswith("__") or hasattr(BundleView, name):
                raise NavfmuError(f"{self.place}: the name '{name}' is taken in every Bundle")
            member.name = name

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else BundleView(component, self)

    def __set__(self, component: Any, value: Any) -> None:
        component._frame.fail(f"bundle '{self.name}' cannot be assigned; use self.{self.name}.publish(...)")


class BundleView:
    """A bundle as a task sees it: its members are read as attributes; an output bundle is published."""

    __slots__ = ("_bundle", "_component")

    def __init__(self, component: Any, bundle: Bundle) -> None:
        object.__setattr__(self, "_component", component)
        object.__setattr__(self, "_bundle", bundle)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in self._bundle.members and name not in SIGNALS:
            known = [*self._bundle.members, *SIGNALS]
            self._component._frame.fail(f"bundle '{self._bundle.name}' has no member '{name}'{nearest(name, known)}")
        return self._component._frame.read(f"{self._bundle.name}.{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        bundle = self._bundle.name
        self._component._frame.fail(f"'{bundle}.{name}' cannot be assigned; use self.{bundle}.publish({name}=...)")

    def publish(self, /, *, valid: Any = True, time_of_validity: Any = None, when: Any = None, **values: Any) -> None:
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
