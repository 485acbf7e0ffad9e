"""Functions that move elements about: where each one goes, NumPy itself says, asked with numbers of places."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy import zeros

from navfmu.derivatives.dual import RULES, SHOWING, Dual, dual, duals, shown, values
from navfmu.derivatives.slopes import Slopes

_OF_ONE = """
reshape ravel transpose moveaxis swapaxes rollaxis squeeze expand_dims matrix_transpose diagonal broadcast_to flip
fliplr flipud rot90 copy tile repeat roll take split array_split hsplit vsplit dsplit delete diag diagflat triu tril pad
atleast_1d atleast_2d atleast_3d linalg.diagonal linalg.matrix_transpose unstack trim_zeros resize
"""
_OF_MANY = """
concatenate stack vstack hstack dstack column_stack block append insert broadcast_arrays meshgrid
"""
_VALUES = {np.append: (0, 1), np.insert: (0, 2)}  # which arguments hold elements; of the others it is the first, or all


def _named(names: str) -> list[Callable]:
    found = []
    for name in names.split():
        owner: Any = np
        for part in name.split("."):
            owner = getattr(owner, part, None)
        found += [owner] if owner else []
    return found


def _of_one(call: Callable, level: int, array: Dual, *args: Any, **kwargs: Any) -> Any:
    value, places = call(array.value, *args, **kwargs), call(array.places, *args, **kwargs)
    if isinstance(places, list | tuple):
        return type(places)([shown(array, v, p) for v, p in zip(value, places, strict=True)])
    return shown(array, value, places)


def _of_many(elements: tuple[int, ...] | None, call: Callable, level: int, *args: Any, **kwargs: Any) -> Any:
    sources = [one for one in duals(args) if one.level == level]
    pool = Slopes.joined([one.slopes for one in sources])
    firsts = np.cumsum([1, *(one.size for one in sources)]).tolist()
    waiting = iter(zip(sources, firsts, strict=False))

    def numbered(x: Any) -> Any:
        if isinstance(x, list | tuple):
            return type(x)([numbered(one) for one in x])
        if isinstance(x, Dual) and x.level == level:
            source, first = next(waiting)
            return np.arange(first, first + source.size).reshape(source.shape)
        return zeros(np.shape(x), int)

    carrying = range(len(args)) if elements is None else elements
    numbers = [numbered(x) if i in carrying else x for i, x in enumerate(args)]
    value, places = call(*values(args, level), **kwargs), call(*numbers, **kwargs)
    if isinstance(places, list | tuple):
        return type(places)([dual(v, pool.moved(p.ravel()), level) for v, p in zip(value, places, strict=True)])
    return dual(value, pool.moved(places.ravel()), level)


for _function in _named(_OF_ONE):
    RULES[_function] = _of_one
    SHOWING.add(_function)
for _function in _named(_OF_MANY):
    joins = _function not in (np.broadcast_arrays, np.meshgrid)
    RULES[_function] = partial(_of_many, _VALUES.get(_function, (0,) if joins else None))


def _fill_diagonal(call: Callable, level: int, array: Any, filling: Any, wrap: bool = False) -> None:
    places = zeros(np.shape(array), np.int8)
    call(places, 1, wrap)
    indices, elements = np.nonzero(places), np.ravel(filling)
    array[indices] = elements[np.arange(len(indices[0])) % len(elements)]


RULES[np.fill_diagonal] = _fill_diagonal
SHOWING.add(np.fill_diagonal)  # an array that depends on nothing is not its values here: it is assigned to
