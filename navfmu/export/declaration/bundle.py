"""Bundles: values that belong to one instant, and the signals that announce them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.declaration.variable import Input, Output, Variable, shape_of
from navfmu.export.place import check_text, place
from navfmu.export.record import ir

SIGNALS = ("valid", "sequence", "time_of_validity")
TAKEN = (*SIGNALS, "lost", "publish", "when")  # by what every bundle has: signals, a counter, a method and its option


class Bundle:
    """Values that belong together in time, with ``valid``, ``sequence`` and ``time_of_validity``.

    Its members are all inputs or all outputs. New data is announced by the sequence number. With a shape it is an array
    of bundles, each of which is announced by itself: ``station = Bundle(5, range=Input("m"))`` has the variables
    ``station[1].range``, ``station[1].valid`` ... of FMI; tasks say ``self.station[0].range`` for one of them and
    ``self.station.range`` for those of all bundles, an array.
    """

    def __init__(self, /, *shape: int | tuple[int, ...], description: str = "", **members: Variable) -> None:
        self.place = place()
        self.name, self.description, self.members = "", description, members
        self.shape = sum((shape_of(self.fail, item) for item in shape), ())
        check_text(self.place, "Bundle: description", description)
        kinds = {type(m) for m in members.values()}
        if kinds not in ({Input}, {Output}):
            self.fail("the members of a Bundle are all Input or all Output")
        self.causality = kinds.pop().causality
        for name, member in members.items():
            if name in TAKEN or name.startswith("__") or hasattr(BundleView, name):
                self.fail(f"the name '{name}' is taken in every Bundle")
            member.name = name

    def fail(self, what: str) -> NoReturn:
        """Raise the error for this declaration."""
        raise NavfmuError(f"{self.place}: {what}")

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else BundleView(component, self)

    def __set__(self, component: Any, value: Any) -> None:
        component._frame.fail(f"bundle '{self.name}' cannot be assigned; use self.{self.name}.publish(...)")


class BundleView:
    """A bundle, or an array of bundles, as a task sees it: members are read as attributes; outputs are published.

    ``view[i]`` is one bundle of an array, from 0; a loop over the view gives them in order.
    """

    __slots__ = ("_bundle", "_component", "_place")

    def __init__(self, component: Any, bundle: Bundle, at: tuple[int, ...] = ()) -> None:
        object.__setattr__(self, "_component", component)
        object.__setattr__(self, "_bundle", bundle)
        object.__setattr__(self, "_place", at)  # its indices in the array

    @property
    def _shape(self) -> tuple[int, ...]:
        """Of the array of bundles that it is."""
        return self._bundle.shape[len(self._place) :]

    @property
    def _name(self) -> str:
        return self._bundle.name + ir.subscript(self._place)

    def __len__(self) -> int:
        if not self._shape:
            self._component._frame.fail(f"'{self._name}' is one bundle and has no length; declare Bundle(n, ...)")
        return self._shape[0]

    def __getitem__(self, index: int | tuple[int, ...]) -> BundleView:
        indices = index if isinstance(index, tuple) else (index,)
        view = self
        for i in indices:
            view = view._one(i)
        return view

    def _one(self, i: Any) -> BundleView:
        count, frame = len(self), self._component._frame
        if not isinstance(i, int | np.integer):
            frame.fail(
                f"bundles '{self._name}' are indexed with something else than a whole number that no value changes; "
                "take them in a loop, or a member of all, which is an array, and select with np.where"
            )
        if not -count <= i < count:
            frame.fail(f"bundles '{self._name}' have no index {i}; expected one from 0 to {count - 1}")
        return BundleView(self._component, self._bundle, (*self._place, int(i) % count))

    def __iter__(self) -> Iterator[BundleView]:
        return (self[i] for i in range(len(self)))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in self._bundle.members and name not in SIGNALS:
            known = [*self._bundle.members, *SIGNALS]
            self._component._frame.fail(f"bundle '{self._name}' has no member '{name}'{nearest(name, known)}")
        return self._component._frame.read(f"{self._bundle.name}.{name}", self._place)

    def __setattr__(self, name: str, value: Any) -> None:
        what, at = f"{self._name}.{name}", "".join(f"[{i}]" for i in self._place)
        self._component._frame.fail(
            f"'{what}' cannot be assigned; use self.{self._bundle.name}{at}.publish({name}=...)"
        )

    def publish(
        self,
        /,
        *,
        valid: Any = True,
        sequence: Any = None,
        time_of_validity: Any = None,
        when: Any = None,
        **values: Any,
    ) -> None:
        """Announce new values: ``sequence`` counts up by one and ``time_of_validity`` is now unless given.

        Members that are not given keep their value. With ``when``, everything is kept where that is false. Of an array
        of bundles all are announced, by arrays of values; ``when``, ``valid`` and ``time_of_validity`` may be one for
        all or one for each.
        """
        frame, bundle = self._component._frame, self._bundle
        if bundle.causality != "output":
            frame.fail(f"bundle '{self._name}' is an input and cannot be published")
        for name in values:
            if name not in bundle.members:
                frame.fail(f"bundle '{self._name}' has no member '{name}'{nearest(name, bundle.members)}")
        values["valid"] = self._for_each(valid)
        values["time_of_validity"] = self._for_each(frame.time if time_of_validity is None else time_of_validity)
        values["sequence"] = self.sequence + 1 if sequence is None else self._for_each(sequence)
        if np.shape(when) not in ((), self._shape):
            frame.fail(
                f"bundles '{self._name}': when has shape {np.shape(when)}, expected {self._shape} or one for all"
            )
        for name, value in values.items():
            path = f"{bundle.name}.{name}"
            if when is not None:
                frame.check_shape(path, value, self._place)
                own = np.ndim(value) - len(self._shape)  # dimensions of the member
                each = np.reshape(when, np.shape(when) + (1,) * own) if np.shape(when) else when
                value = np.where(each, value, frame.read(path, self._place))
            frame.write(path, value, self._place)

    def _for_each(self, value: Any) -> Any:
        """One value for all bundles of an array, as one for each."""
        return np.broadcast_to(value, self._shape) if self._shape and np.shape(value) == () else value
