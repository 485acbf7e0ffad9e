"""An axis of a campaign: something that varies from case to case, and the values that it takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from navfmu.campaign.case import Case
from navfmu.campaign.varied import Varied
from navfmu.errors import NavfmuError

Value = float | int | str | bool


@dataclass(frozen=True)
class Listed:
    """Values one by one."""

    values: tuple[Value, ...]

    @property
    def number(self) -> int:
        """How many levels it has."""
        return len(self.values)

    @property
    def levels(self) -> tuple[Value, ...]:
        """All of them."""
        return self.values

    def at(self, place: float) -> Value:
        """The value at a place from 0 to below 1: each has the same share of it."""
        return self.values[min(int(place * len(self.values)), len(self.values) - 1)]


@dataclass(frozen=True)
class Span:
    """All numbers from ``low`` to ``high``; ``count`` of them, the ends included, are its levels."""

    low: float
    high: float
    logarithmic: bool = False
    count: int | None = None

    @property
    def number(self) -> int:
        """How many levels it has; without ``count`` none."""
        return self.count or 0

    @property
    def levels(self) -> tuple[float, ...]:
        """Equal steps, or equal ratios."""
        spaced = np.geomspace if self.logarithmic else np.linspace
        return tuple(spaced(self.low, self.high, self.number).tolist())

    def at(self, place: float) -> float:
        """The number at a place from 0 to 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** place
        return self.low + place * (self.high - self.low)

    def middle(self, one: float, other: float) -> float:
        """The number half-way between two of them."""
        return float(np.sqrt(one) * np.sqrt(other)) if self.logarithmic else 0.5 * one + 0.5 * other


@dataclass(frozen=True)
class Goal:
    """What a search along an axis looks for: where a requirement begins to be violated, to within ``tolerance``."""

    requirement: str
    tolerance: float


@dataclass(frozen=True)
class Axis:
    """What varies, in which cases of the file (None: in all that have it), and its values, all in ``unit``."""

    name: str
    varied: tuple[Varied, ...]  # several get the same value
    values: Listed | Span
    unit: str = ""
    cases: tuple[str, ...] | None = None
    goal: Goal | None = None  # an axis with one makes no points
    where: str = ""  # "campaign.toml, line 12", for messages

    @property
    def heading(self) -> str:
        """Over a column of its values."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def applies(self, case: Case) -> bool:
        """Whether it varies something in the case."""
        return self.is_asked_of(case) and any(varied.is_in(case) for varied in self.varied)

    def is_asked_of(self, case: Case) -> bool:
        """Whether it is for the case of the file that the case is from."""
        return self.cases is None or case.written in self.cases

    def laid(self, case: Case, value: Value) -> Case:
        """The case with a value, under the name that it had."""
        given: Any = f"{value!r}".removesuffix(".0") + f" {self.unit}" if self.unit else value
        try:
            for varied in self.varied:
                if varied.is_in(case):
                    case = varied.laid(case, given)
        except NavfmuError as error:
            raise NavfmuError(f"{self.where}: axis '{self.name}' at {given}: {error}") from None
        return replace(case, values=case.values | {self.name: value})

    def text(self, value: Value, digits: int = 17) -> str:
        """A value with its unit."""
        short = f"{value:.{digits}g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value)
        return f"{short} {self.unit}" if self.unit else short


def texts(axis: Axis, values: Sequence[Value], least: int = 4) -> list[str]:
    """Values as one writes them: in as few digits as it takes to tell them apart, ``least`` or more."""
    for digits in range(least, 18):
        found = [axis.text(value, digits) for value in values]
        if len(set(found)) == len(set(values)):
            break
    return found
