"""FMUs that allow one instance in a process only: who has it. Whoever instantiates such an FMU takes it here first."""

from __future__ import annotations

from pathlib import Path
from threading import Lock

from navfmu.engine.component import Component
from navfmu.errors import NavfmuError

_taken: set[Path] = set()  # libraries
_lock = Lock()


def take(component: Component) -> None:
    """Take the only instance of a component's FMU, where there may be one only."""
    if not component.description.only_one_instance:
        return
    library = component.fmu.library.resolve()
    with _lock:
        if library in _taken:
            raise NavfmuError(
                f"component '{component.name}': the FMU '{component.description.model_identifier}' allows one instance "
                "in a process only, and another run in this process has it; do one run after the other, or each in a "
                "process of its own"
            )
        _taken.add(library)


def give_back(component: Component) -> None:
    """The instance has been freed, or was never made."""
    if component.description.only_one_instance:
        with _lock:
            _taken.discard(component.fmu.library.resolve())
