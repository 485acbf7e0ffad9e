"""Requirements: what must be true of a component's parameters when initialisation ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from navfmu.errors import NavfmuError
from navfmu.export.declaration.task import mark
from navfmu.export.place import place


@dataclass(frozen=True)
class Requirement:
    """A sentence, and the method over parameters that must be true."""

    message: str
    function: Callable
    names: tuple[str, ...]
    place: str


def require(message: str) -> Callable:
    """Mark a method over parameters that must be true when initialisation ends; ``{name}`` shows a parameter."""
    if not isinstance(message, str):
        raise NavfmuError(
            f'{place()}: require needs a sentence, for example require("gain is {{gain}}, expected below 2")'
        )
    return lambda function: mark(function, "_navfmu_requirement", message)
