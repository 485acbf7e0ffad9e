"""``y[mask]`` for a traced mask: nobody knows how many that are, but ``x[mask] = 2.0 * y[mask] + 1.0`` can be said.

It is calculated with at all places, and chosen where it is assigned.
"""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from navfmu.errors import NavfmuError
from navfmu.export.place import place
from navfmu.export.tracing.extent import current
from navfmu.export.tracing.rules import expression


class Selected(NDArrayOperatorsMixin):
    """The elements of ``values`` where ``mask`` holds, which has the first axes of it."""

    def __init__(self, mask: Any, values: Any) -> None:
        self._mask, self._values, self._place = mask, values, place()

    def at(self, mask: Any) -> Any:
        """Return the values at all places, for the same mask."""
        if self._nodes(mask) != self._nodes(self._mask):
            raise NavfmuError(
                f"{place()}: what one mask selects meets another mask; select with one, or choose with "
                "np.where(mask, values, others)"
            )
        return self._values

    @staticmethod
    def _nodes(mask: Any) -> list:
        return [current().alike.first(expression(e)) for e in mask.ravel().tolist()]

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:
        if method != "__call__" or options or ufunc is np.matmul or not (out is None or out[0] is self):
            self._refuse()
        return Selected(self._mask, ufunc(*map(self._at_all_places, inputs)))

    def _at_all_places(self, x: Any) -> Any:
        if isinstance(x, Selected):
            return x.at(self._mask)
        if np.ndim(x) > self._values.ndim - self._mask.ndim:
            self._refuse()
        return x

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise NavfmuError(
            f"{self._place}: how many elements a traced mask selects is not known; choose with "
            "np.where(mask, values, others), or assign to x[mask] what is calculated from y[mask] element by element"
        )

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        self._refuse()

    __array__ = __array_function__ = __float__ = __int__ = __index__ = __bool__ = __len__ = __iter__ = _refuse
    __getitem__ = __setitem__ = __contains__ = __hash__ = _refuse
