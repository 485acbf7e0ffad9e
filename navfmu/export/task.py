"""Tasks: which of a component's methods run, and when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from navfmu.errors import NavfmuError
from navfmu.export.place import place


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


def _task(kind: str, function: Callable, argument: str | None) -> Callable:
    code = function.__code__
    function._navfmu_task = (kind, argument, f"{code.co_filename}, line {code.co_firstlineno}")
    return function
