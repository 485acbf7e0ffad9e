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
    argument: str | None  # "every": the parameter with the period; "on_new": the input bundle
    uses_noise: bool
    stream: int  # third word of the noise counter
    place: str


def start(function: Callable) -> Callable:
    """Mark the method that runs once, on leaving initialisation, at t = 0."""
    return _task("start", function, None)


def every(period: str) -> Callable:
    """Mark a method that runs at ``k * period``, k = 1, 2, ...; ``period`` names a parameter in s."""
    if not isinstance(period, str):
        raise NavfmuError(f'{place()}: every({period!r}) needs the name of a Parameter in s, for example "period"')
    return lambda function: _task("every", function, period)


def on_new(bundle: str) -> Callable:
    """Mark a method that runs at the first tick that sees new data in the input bundle."""
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


def _task(kind: str, function: Callable, argument: str | None) -> Callable:
    return mark(function, "_navfmu_task", kind, argument)
