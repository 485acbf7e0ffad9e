"""What the FMUs that replay recorded sensors have in common: the face of the sensor, and the sample of the moment.

Such an FMU has the outputs of the sensor that it replaces and its inputs, so that it takes its place in any system. Of
the inputs only those of faults act, and only those stand in it that can: the recording is what it is. Samples are rows
of a table: when they come, the time that their values hold for, their numbers, whether they are valid, and the values.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from navfmu.export import Bundle, Input, Output, Parameter

TIMES = (("time", "s"), ("time_of_validity", "s"), ("sequence", "1"), ("valid", "1"))
"""Columns that every table of samples begins with."""
ROUNDING = 1e-6
"""Of a tick: a sample that is late by less is not late; times of recordings are decimal."""


def face(component: type) -> type:
    """Return a base class with the bundles of outputs of a component, its other outputs, and its inputs but for those
    of faults. What is not in a bundle does nothing: the descriptions say so."""
    bundles = {name: item for name, item in component.layout.bundles.items() if item.causality == "output"}
    members = {name: getattr(component, name, None) for name in component.layout.fields}
    others = {name: copy.copy(item) for name, item in members.items() if isinstance(item, Output) or _is_truth(item)}
    for item in others.values():
        words = "without effect" if isinstance(item, Input) else "not recorded, stays as it starts"
        item.description = f"{words}: {item.description}"
    return type(f"Face{component.__name__}", (), {**others, **bundles})


def _is_truth(item: Any) -> bool:
    return isinstance(item, Input) and not item.fault


def columns(bundle: Bundle, **others: str) -> tuple[tuple[str, str], ...]:
    """Return the columns of a table of samples: name and unit of times, members of the bundle, and ``others``.

    An array has a column for each number, ``rate[1]`` and so on.
    """
    found = dict(TIMES)
    for name, member in bundle.members.items():
        places = [f"[{i + 1}]" for i in range(*member.shape)] if member.shape else [""]
        found |= {name + place: member.unit or "1" for place in places}
    return tuple((found | others).items())


def known(*names: str) -> dict[str, str]:
    """Return columns that say of others, in each row, whether they were recorded (1) or not (0)."""
    return {f"{name}_known": "1" for name in names}


def silence(columns: tuple[tuple[str, str], ...]) -> np.ndarray:
    """Return the rows of a table without samples."""
    rows = np.zeros((2, len(columns)))
    rows[1, 0] = 1.0
    return rows


def delay() -> Parameter:
    """Return the parameter that makes samples late."""
    return Parameter(
        "s", start=0.0, min=0.0, max=60.0, description="how much later than its time in the table a sample comes"
    )


def tick_period() -> Parameter:
    """Return the parameter with the period at which is looked whether a sample has come."""
    return Parameter(
        "s",
        start=0.01,
        min=1e-4,
        max=1.0,
        description="period at which is looked for a sample: it comes at the first tick that is not before its time",
    )


def latest(component: Any, table: str, delay: Any) -> dict[str, Any]:
    """Return the last sample of a table that has come by now, column by column, arrays in one piece.

    Where none has, its ``sequence`` is 0. A sample that comes although it is late by ROUNDING holds for now: whoever
    takes it waits for the time that it holds for.
    """
    now = component.time - delay + ROUNDING * component.period
    around = getattr(component, table).around(time=now)
    row = np.where(around.next_row[0] <= now, around.next_row, around.row)
    found: dict[str, list[Any]] = {}
    for (name, _), number in zip(getattr(type(component), table).columns, row, strict=True):
        found.setdefault(name.partition("[")[0], []).append(number)
    sample = {name: np.array(numbers) if len(numbers) > 1 else numbers[0] for name, numbers in found.items()}
    return sample | {
        "sequence": np.where(row[0] <= now, sample["sequence"], 0.0),
        "valid": sample["valid"] > 0.0,
        "time_of_validity": np.minimum(sample["time_of_validity"], component.time),
    }


def announcement(sample: dict[str, Any], bundle: Any) -> dict[str, Any]:
    """Return when and as what a bundle publishes a sample: once, by its number, so that lost ones are counted."""
    return {
        "when": sample["sequence"] > bundle.sequence,
        "sequence": sample["sequence"],
        "valid": sample["valid"],
        "time_of_validity": sample["time_of_validity"],
    }


def recorded(sample: dict[str, Any], name: str, otherwise: Any) -> Any:
    """Return what was recorded, or ``otherwise`` where it was not, as :func:`known` columns say."""
    return np.where(sample[f"{name}_known"] > 0.0, sample[name], otherwise)


def values(sample: dict[str, Any], bundle: Bundle) -> dict[str, Any]:
    """Return what was recorded of the members of a bundle."""
    return {name: sample[name] for name in bundle.members}


def made(columns: tuple[tuple[str, str], ...], interval: float, count: int = 600, **values: Any) -> np.ndarray:
    """Return rows of a made recording for a table to begin with: ``values`` of columns, constants or over time (s)."""
    time = interval * np.arange(1.0, count + 1.0)
    given = {"time": time, "time_of_validity": time, "sequence": np.arange(1.0, count + 1.0), "valid": 1.0}
    given |= {name: value(time) if callable(value) else value for name, value in values.items()}
    return np.stack([np.broadcast_to(given.get(name, 0.0), time.shape) for name, _ in columns], axis=1)
