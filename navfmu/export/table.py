"""Tables: rows of data over time that a component carries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.place import check_text, place


class Table:
    """Rows searched by time: ``self.<name>.row`` and ``.next_row`` are the rows around ``self.time``.

    ``columns`` are (name, unit) pairs, the first is the time in s, increasing. Before the first row the first two
    rows are found, after the last row the last two: interpolation must clip its fraction to stay at the ends.
    """

    def __init__(self, *, columns: tuple[tuple[str, str], ...], rows: Any) -> None:
        self.place = place()
        self.name = ""
        self.columns = tuple((str(name), str(unit)) for name, unit in columns)
        check_text(self.place, "Table: columns", "".join(name + unit for name, unit in self.columns))
        self.rows = np.array(rows, float)
        if not self.columns or self.rows.ndim != 2 or self.rows.shape[1] != len(self.columns) or len(self.rows) < 2:
            raise NavfmuError(
                f"{self.place}: Table rows have shape {self.rows.shape}, expected at least 2 rows of "
                f"{len(self.columns)} columns"
            )
        if not np.all(np.isfinite(self.rows)) or not np.all(np.diff(self.rows[:, 0]) > 0):
            raise NavfmuError(f"{self.place}: Table rows must be finite and their first column must increase")
        self.rows.setflags(write=False)

        name, unit = self.columns[0]
        if unit != "s":
            raise NavfmuError(
                f"{self.place}: the first column of a Table is the time in s, by which it is searched; '{name}' is in "
                f"'{unit}' (np.interp searches by other quantities)"
            )

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def find(self, time: float) -> int:
        """Return the index of the row at or before ``time``, so that the next row exists."""
        return int(np.clip(np.searchsorted(self.rows[:, 0], time, side="right") - 1, 0, len(self.rows) - 2))

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else TableView(*component._frame.rows(self))

    def __set__(self, component: Any, value: Any) -> None:
        component._frame.fail(f"table '{self.name}' cannot be assigned")


@dataclass(frozen=True)
class TableView:
    """The two rows of a table around the time of the task."""

    row: Any
    next_row: Any
