"""Columns of a recording by the names of what they hold, in the units that are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.recorded.replay import px4
from navfmu.recorded.replay.asked import scale
from navfmu.recorded.replay.file import File, read

LARGEST = 1e20
"""Of a measured number, in any unit: nanoseconds since 1970 are 2e18."""


def opened(path: str | Path, column: str) -> File:
    """Read a table, or what has a column of a log of PX4."""
    if not str(path).lower().endswith(".ulg"):
        return read(path)
    return px4.read(path, next(name for name, choices in px4.topics().items() if column in choices[0][0].fields))


@dataclass(frozen=True)
class Columns:
    """What of a ``file`` is called what. ``quantities`` are those that a command knows, each with its number of columns
    (1, or 3 for x, y, z) and its unit; ``columns`` and ``units`` name those of the file that are not the usual ones.
    """

    file: File
    quantities: Mapping[str, tuple[int, str]]
    columns: Mapping[str, tuple[str, ...]]
    units: Mapping[str, str]

    def __post_init__(self) -> None:
        for option, given in (("--column", self.columns), ("--unit", self.units)):
            for name in given:
                if name not in self.quantities:
                    known = list(self.quantities)
                    raise NavfmuError(
                        f"{option} {name}: there is no such quantity; expected {', '.join(known)}{nearest(name, known)}"
                    )

    def has(self, name: str) -> bool:
        """Whether a quantity is named, or one of its usual columns is there."""
        return name in self.columns or any(column in self.file.names for column in self._usual(name))

    def values(self, name: str) -> np.ndarray:
        """Return a quantity (rows,), or (rows, 3), in its unit."""
        count, unit = self.quantities[name]
        named = self.columns.get(name, self._usual(name))
        if len(named) != count:
            raise NavfmuError(f"--column {name}: {len(named)} columns are named; expected {count}")
        for column in named:
            if named.count(column) > 1:
                raise NavfmuError(f"--column {name}: '{column}' is named twice; expected a column for each axis")
            if column not in self.file.names:
                raise NavfmuError(
                    f"{self.file.path}: has no column '{column}' for {name}; it has {', '.join(self.file.names[:20])}"
                    f"{nearest(column, self.file.names)}"
                )
        columns = [self._column(column, name, unit) for column in named]
        return columns[0] if count == 1 else np.stack(columns, axis=1)

    def _usual(self, name: str) -> tuple[str, ...]:
        return (name,) if self.quantities[name][0] == 1 else tuple(f"{name}_{axis}" for axis in "xyz")

    def _column(self, column: str, name: str, unit: str) -> np.ndarray:
        file, values = self.file, self.file.numbers(column)
        if not np.all(np.isfinite(values)):
            at = int(np.argmin(np.isfinite(values)))
            raise NavfmuError(f"{file.path}, {file.row(at)}: '{column}' has no number; expected one in every row")
        if not np.all(np.abs(values) <= LARGEST):
            at = int(np.argmax(np.abs(values)))
            raise NavfmuError(f"{file.path}, {file.row(at)}: '{column}' is {values[at]:g}; expected what was measured")
        asked = self.units.get(name, file.units.get(column, unit))
        factor, offset = scale(asked, unit, f"{file.path}: {name}")
        return factor * values + offset
