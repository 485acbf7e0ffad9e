"""What a run returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.engine.plan import Plan
from navfmu.errors import NavfmuError


def room(plan: Plan) -> np.ndarray:
    """Room for every recorded point of a plan, shape (rows, columns), filled with NaN."""
    shape = plan.rows, len(plan.recorded)
    try:
        return np.full(shape, np.nan)
    except (MemoryError, ValueError):  # more than there is, more than an array can count
        raise too_large(plan) from None


def too_large(plan: Plan) -> NavfmuError:
    """The sentence for a recording that there is no room for."""
    rows, columns = plan.rows, len(plan.recorded)
    return NavfmuError(
        f"the recording of {columns} signals at {rows} points in time would take {rows * columns * 8 / 1e9:.0f} GB of "
        "memory; record fewer signals or take a longer recording period"
    )


@dataclass(frozen=True)
class Recording:
    """Recorded signals: ``values[row, column]`` at ``time[row]`` (s). Booleans are 0 and 1."""

    names: tuple[str, ...]
    units: tuple[str | None, ...]
    types: tuple[str, ...]
    time: np.ndarray
    values: np.ndarray
    warnings: tuple[str, ...] = ()  # sentences

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by name."""
        return self.values[:, self.names.index(name)]


class RunError(NavfmuError):
    """An FMU refused a call. ``recording`` holds what was recorded before; ``place``: component, call, time (s)."""

    def __init__(self, sentence: str, recording: Recording | None = None, **place: str | float) -> None:
        super().__init__(sentence)
        self.recording, self.place = recording, place


STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")


def refusal(component: str, call: str, status: int, time: float, message: str) -> str:
    """The sentence for a call that an FMU did not answer with OK."""
    name = STATUS[status] if 0 <= status < len(STATUS) else f"status {status}"
    said = message.strip() or "it gave no reason"
    if name == "Pending":
        said = "asynchronous steps are not supported"
    return f"component '{component}': {said} ({call} returned {name} at t = {time:.9g} s)"


def recording(plan: Plan, rows: np.ndarray, warnings: tuple[str, ...] = ()) -> Recording:
    """A recording of the plan's columns from the rows of raw signals; scales what is scaled."""
    for number, column in enumerate(plan.recorded):
        if (column.factor, column.offset) != (1.0, 0.0):
            rows[:, number] = column.factor * rows[:, number] + column.offset
    return Recording(
        names=tuple(column.name for column in plan.recorded),
        units=tuple(column.unit for column in plan.recorded),
        types=tuple(column.type for column in plan.recorded),
        time=np.array([plan.clock.time(row * plan.record_every) for row in range(len(rows))]),
        values=rows,
        warnings=warnings,
    )
