"""Which points of its axes a campaign takes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.campaign.axis import Axis, Value
from navfmu.errors import NavfmuError

Point = tuple[Value, ...]  # a value for each axis


@dataclass(frozen=True)
class Design:
    """How points are taken; ``count`` and ``seed`` are those of kinds that draw them."""

    kind: str = "factorial"
    count: int = 1
    seed: int = 1

    @property
    def draws(self) -> bool:
        """Whether points are drawn from the whole of the axes, and not made of their levels."""
        return self.kind in _SAMPLERS

    def size(self, axes: Sequence[Axis]) -> int:
        """How many points it takes of these axes; without any there is one."""
        if not axes:
            return 1
        if self.draws:
            return self.count
        levels = [axis.values.number for axis in axes]
        return math.prod(levels) if self.kind == "factorial" else levels[0]

    def points(self, axes: Sequence[Axis]) -> Iterator[Point]:
        """The points, in an order that depends on nothing else."""
        if self.draws and axes:
            for place in _SAMPLERS[self.kind](self.count, len(axes), np.random.default_rng(self.seed)):
                yield tuple(axis.values.at(float(u)) for axis, u in zip(axes, place, strict=True))
        elif self.kind == "list" and axes:
            yield from zip(*(axis.values.levels for axis in axes), strict=True)
        else:
            yield from itertools.product(*(axis.values.levels for axis in axes))

    def check(self, axes: Sequence[Axis]) -> None:
        """Refuse axes of one case that it cannot go along together."""
        if self.kind != "list" or not axes:
            return
        first, *others = ((axis.name, axis.values.number) for axis in axes)
        for name, count in others:
            if count != first[1]:
                raise NavfmuError(
                    f"a list takes the first value of every axis, then the second: '{first[0]}' has {first[1]} values, "
                    f"'{name}' {count}"
                )


def _latin_hypercube(count: int, axes: int, random: np.random.Generator) -> np.ndarray:
    from scipy.stats import qmc

    return qmc.LatinHypercube(axes, seed=random).random(count)


def _sobol(count: int, axes: int, random: np.random.Generator) -> np.ndarray:
    from scipy.stats import qmc

    return qmc.Sobol(axes, seed=random).random(count)


_SAMPLERS: dict[str, Callable[[int, int, np.random.Generator], np.ndarray]] = {  # places in [0, 1), (count, axes)
    "latin_hypercube": _latin_hypercube,
    "sobol": _sobol,
}
KINDS = ("factorial", "list", *_SAMPLERS)
