"""Tasks: which of a component's methods run, and when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import update_wrapper
from types import FunctionType

from navfmu.errors import NavfmuError
from navfmu.export.place import place

#: Attributes of methods that are tasks or requirements.
MARKS = {"_navfmu_task", "_navfmu_requirement"}


@dataclass(frozen=True)
class TaskDeclaration:
    """One task of a component."""

    name: str
    kind: str  # "start", "every", "on_new"
    function: Callable
    argument: str | None  # "every": the parameter with the period; "on_new": the input bundle, "station[2]"
    offset: str | None  # "every": the parameter with the time of the first tick, if there is one
    uses_noise: bool
    stream: int  # third word of the noise counter
    place: str
    element: tuple[int, ...] = ()  # "on_new": which bundle of an array, from 0; the method is told


def start(function: Callable) -> Callable:
    """Mark the method that runs once, on leaving initialisation, at t = 0."""
    return _task("start", function)


def every(period: str, *, offset: str | None = None) -> Callable:
    """Mark a method that runs at ``offset + k * period``; both name parameters in s, counted from the start.

    The ticks are k = 0, 1, 2, ... where there is an offset above 0, and k = 1, 2, ... where it is 0 or not there: at
    t = 0 itself nothing ticks. ``k`` is also the number of the tick's noise. A period may be ``tunable``: the next tick
    then comes one new period after the last one, at once if that has passed, and k goes on.
    """
    for name, value in (("period", period), ("offset", offset)):
        if not isinstance(value, str) and not (name == "offset" and value is None):
            told = f"{value!r}" if name == "period" else f"..., offset={value!r}"
            raise NavfmuError(f'{place()}: every({told}) needs the name of a Parameter in s, for example "{name}"')
    return lambda function: _task("every", function, period, offset)


def on_new(bundle: str) -> Callable:
    """Mark a method that runs at the first tick that sees new data in the input bundle.

    For an array of bundles it runs for each that has new data, and is told which: ``def take(self, i)``, from 0.
    """
    if not isinstance(bundle, str):
        raise NavfmuError(f"{place()}: on_new({bundle!r}) needs the name of an input Bundle")
    return lambda function: _task("on_new", function, bundle)


def mark(function: Callable, attribute: str, *values: str | None) -> Callable:
    """Return the method with a note of what it is and where it stands; a method is one thing only."""
    if not isinstance(function, FunctionType):
        raise NavfmuError(f"{place()}: {function!r} is not a plain method; decorate the function itself")
    where = f"{function.__code__.co_filename}, line {function.__code__.co_firstlineno}"
    if MARKS & set(vars(function)):
        raise NavfmuError(
            f"{where}: '{function.__name__}' has two decorators of @start, @every, @on_new and @require, and a method "
            "is one task or requirement; write a second method for the other, and what both do as a function"
        )
    parts = (function.__code__, function.__globals__, function.__name__, function.__defaults__, function.__closure__)
    marked = update_wrapper(FunctionType(*parts), function)  # a copy: another component may use the same function
    setattr(marked, attribute, (*values, where))
    return marked


def _task(kind: str, function: Callable, argument: str | None = None, offset: str | None = None) -> Callable:
    return mark(function, "_navfmu_task", kind, argument, offset)
