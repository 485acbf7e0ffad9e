"""Grids: surfaces over two axes that a component carries, such as terrain or the coefficients of a wing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from navfmu.export.declaration import interpolation
from navfmu.export.declaration.numbers import Numbers


class Grid(Numbers):
    """Surfaces over two axes: ``self.<name>.around(north=x, east=y)`` gives the four corners around a point.

    ``axes`` are two of (name, unit, numbers), which increase; ``surfaces`` are (name, unit, heights), heights an array
    (numbers of the first axis, numbers of the second). Outside of the grid, and for NaN, the nearest cell is found as
    in a :class:`~navfmu.export.declaration.table.Table`, where ``file`` is explained, too.
    """

    between_keys = "and"

    def __init__(
        self,
        *,
        axes: tuple[tuple[str, str, Any], ...],
        surfaces: tuple[tuple[str, str, Any], ...],
        file: str | None = None,
    ) -> None:
        super().__init__(file)
        if len(axes) != 2 or not surfaces:
            self.refuse(f"has {len(axes)} axes and {len(surfaces)} surfaces; expected 2 axes and a surface or more")
        axes = self.parts("an axis", axes, ("name", "unit", "numbers"))
        surfaces = self.parts("a surface", surfaces, ("name", "unit", "heights"))
        self.columns = tuple((str(name), str(unit)) for name, unit, _ in (*axes, *surfaces))
        self.keys = (0, 1)
        self.hold(tuple(self.real(f"numbers of '{name}'", numbers) for name, _, numbers in (*axes, *surfaces)))

    def hold(self, numbers: tuple[np.ndarray, ...]) -> None:
        """Have these numbers: two axes (n,) and (m,), and surfaces (n, m)."""
        expected = (numbers[0].size, numbers[1].size)
        dimensions = (1, 1, *(2 for _ in numbers[2:]))
        for (name, _), column, dimension in zip(self.columns, numbers, dimensions, strict=True):
            if column.ndim != dimension or (dimension == 2 and column.shape != expected):
                wanted = f"expected {expected}" if dimension == 2 else "expected a list of numbers"
                self.refuse(f"has '{name}' of shape {column.shape}, {wanted}")
        super().hold(numbers)
        self.heights = np.stack(numbers[2:], -1)  # (n, m, surfaces)

    def routine(self, key: int) -> tuple[Any, ...]:
        """Return the C function that copies a cell, and the number that it is given."""
        return "table_corners", len(self.columns) - 2

    @property
    def width(self) -> int:
        """The ends of the cell on both axes, then its corners."""
        return 4 + 4 * (len(self.columns) - 2)

    def look_up(self, key: int, *values: Any) -> np.ndarray:
        """Return the ends of the cells on both axes and their corners, (2, 2, surfaces): (..., width)."""
        values = np.broadcast_arrays(*values)
        places = [np.stack([found, found + 1], -1) for found in (self.find(axis, values[axis]) for axis in (0, 1))]
        ends = [self.numbers[axis][places[axis]] for axis in (0, 1)]
        corners = self.heights[places[0][..., :, None], places[1][..., None, :]]
        return np.concatenate([*ends, corners.reshape(*corners.shape[:-3], -1)], -1)

    def __get__(self, component: Any, owner: type) -> Any:
        return self if component is None else GridView(self, component._frame)


@dataclass(frozen=True)
class Corners:
    """The corners of a cell around a point: (2, 2, surfaces), or (..., 2, 2, surfaces) for points in arrays."""

    corners: Any  #: [..., i, j, k]: surface k at end i of the first axis, end j of the second
    ends: tuple[Any, Any]  #: of the cell on the first and on the second axis, (..., 2)
    parts: tuple[Any, Any]  #: of the way along both axes, 0 to 1; outside it stays at the edge, for NaN it is NaN

    def bilinear(self) -> Any:
        """Return all surfaces at the point, (..., surfaces): exact at corners, linear along both axes. What lies
        outside of the grid has the values of the nearest edge."""
        return interpolation.bilinear(*self.parts, self.corners)


class GridView:
    """A grid as a task sees it."""

    def __init__(self, grid: Grid, frame: Any) -> None:
        self._grid, self._frame = grid, frame

    def around(self, *values: Any, **point: Any) -> Corners:
        """Return the corners around a point that is given by both axes: ``around(north=x, east=y)``."""
        names = self._grid.key_names()
        self._grid.check_named(self._frame, values)
        if set(point) != set(names):
            self._grid.not_a_key(self._frame, tuple(point))
        values = [point[name] for name in names]
        found = self._frame.look_up(self._grid, 0, values)
        ends = found[..., 0:2], found[..., 2:4]
        parts = [interpolation.fraction(x, end[..., 0], end[..., 1]) for x, end in zip(values, ends, strict=True)]
        return Corners(found[..., 4:].reshape(*np.shape(found)[:-1], 2, 2, -1), ends, (parts[0], parts[1]))
