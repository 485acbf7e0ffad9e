"""Tables: rows of numbers that a component carries, searched by a column that increases."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from navfmu.errors import nearest
from navfmu.export.declaration import interpolation
from navfmu.export.declaration.numbers import Numbers


class Table(Numbers):
    """Rows of numbers: ``self.<name>.around(distance=d)`` gives the rows around a value of its column ``distance``.

    ``columns`` are (name, unit) pairs, ``rows`` an array (rows, columns). ``key`` names the column that is searched, or
    several; it is the first one if nothing is said. A key increases from row to row. Where the first column is a time
    in s, ``self.<name>.row`` and ``.next_row`` are the rows around ``self.time``.

    ``file`` names a string Parameter that has the name of a file in the resources, which is read instead of these rows
    when initialisation ends; where the text is empty the rows are these.

    Below the first row the first two rows are found; above the last row, and for NaN, the last two: interpolation must
    clip its fraction to stay at the ends, as :meth:`Around.linear` does.
    """

    def __init__(
        self,
        *,
        columns: tuple[tuple[str, str], ...],
        rows: Any,
        key: str | tuple[str, ...] | None = None,
        file: str | None = None,
    ) -> None:
        super().__init__(file)
        pairs = self.parts("a column", columns, ("name", "unit"))
        self.columns = tuple((str(name), str(unit)) for name, unit in pairs)
        rows = self.real("rows", rows)
        if not self.columns or rows.ndim != 2 or rows.shape[1] != len(self.columns) or len(rows) < 2:
            self.refuse(f"rows have shape {rows.shape}, expected at least 2 rows of {len(self.columns)} columns")
        names = [name for name, _ in self.columns]
        keys = names[:1] if key is None else list(key) if isinstance(key, list | tuple) else [key]
        if wrong := next((str(name) for name in keys if name not in names), None):
            self.refuse(f"has no column '{wrong}' to be searched by{nearest(wrong, names)}")
        if not keys:
            self.refuse("is searched by nothing; expected a column")
        self.keys = tuple(names.index(name) for name in keys)
        self.hold(tuple(rows.T))

    def hold(self, numbers: tuple[np.ndarray, ...]) -> None:
        """Have these numbers, an array for each column."""
        super().hold(numbers)
        self.rows = np.stack(numbers, -1)
        self.rows.setflags(write=False)

    def routine(self, key: int) -> tuple[Any, ...]:
        """Return the C function that copies two rows, and the numbers that it is given."""
        return "table_rows", self.keys[key], len(self.columns)

    @property
    def width(self) -> int:
        """A row and the next one."""
        return 2 * len(self.columns)

    def look_up(self, key: int, *values: Any) -> np.ndarray:
        """Return the row at or below each value of a key and the row that follows: (..., 2 columns)."""
        row = self.find(key, values[0])
        return np.concatenate([self.rows[row], self.rows[row + 1]], -1)

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else TableView(self, component._frame)


@dataclass(frozen=True)
class Around:
    """Two rows of a table around a value: (columns,), or (..., columns) for values in an array."""

    row: Any
    next_row: Any
    part: Any  #: of the way from one row to the other, 0 to 1; at the ends it stays there, for NaN it is NaN

    def linear(self) -> Any:
        """Return all columns, interpolated between the two rows; what lies outside of the table has its first or last
        row."""
        return interpolation.linear(np.expand_dims(self.part, -1), self.row, self.next_row)


class TableView:
    """A table as a task sees it."""

    def __init__(self, table: Table, frame: Any) -> None:
        self._table, self._frame = table, frame

    def around(self, *values: Any, **key: Any) -> Around:
        """Return the rows around a value of a key: ``around(distance=d)``."""
        table, known = self._table, self._table.key_names()
        table.check_named(self._frame, values)
        if len(key) != 1 or not set(key) <= set(known):
            table.not_a_key(self._frame, tuple(key))
        ((name, value),) = key.items()
        row, next_row = self._rows(known.index(name), value)
        column = table.keys[known.index(name)]
        return Around(row, next_row, interpolation.fraction(value, row[..., column], next_row[..., column]))

    @property
    def row(self) -> Any:
        """The row at or before the time of the task."""
        return self._now()[0]

    @property
    def next_row(self) -> Any:
        """The row after that."""
        return self._now()[1]

    def _now(self) -> tuple[Any, Any]:
        (_, unit), *_ = self._table.columns
        if unit != "s" or 0 not in self._table.keys:
            self._table.not_a_key(self._frame, ("time",))
        return self._rows(self._table.keys.index(0), self._frame.time)

    def _rows(self, key: int, value: Any) -> tuple[Any, Any]:
        both = self._frame.look_up(self._table, key, (value,))
        count = len(self._table.columns)
        return both[..., :count], both[..., count:]
