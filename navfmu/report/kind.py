"""Kinds of pictures and statistics that a system's report file may ask for.

Each kind is one file in ``report/pictures`` or ``report/statistics`` of that name, with one class ``Picture``
or ``Statistic``: its fields may stand in the report file, its methods make the thing from plain numbers.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any, ClassVar

from navfmu.errors import NavfmuError
from navfmu.files.schema import Field, Table
from navfmu.report.panel import Panel
from navfmu.report.scene import Bound, Drawn, Recorded, Scene


class Kind(Table):
    """What the entries of a report file have in common."""

    @property
    def called(self) -> str:
        """What a sentence calls it: its kind."""
        return self.kind  # type: ignore[attr-defined]

    def needs(self) -> list[str]:
        """The recorded signals that it is made from."""
        raise NotImplementedError

    def constants(self) -> list[str]:
        """Parameters whose values it needs; the name of an array stands for all its elements."""
        return []

    def check(self, units: Mapping[str, str]) -> None:
        """Refuse (``NavfmuError``) units of signals and constants that do not go together."""


class Picture(Kind):
    """A picture of one scene."""

    many: ClassVar[bool] = False  # whether it shows all runs, or one

    def draw(self, scene: Scene) -> Drawn:
        """The picture; the scene has all its signals and constants."""
        raise NotImplementedError

    def panels(self, scene: Scene) -> list[Panel]:
        """The shown run as a browser draws it on demand."""
        raise NotImplementedError


class Statistic(Kind):
    """A row of numbers for each variant and case."""

    name: str | None = Field(None, min_length=1, description="tells several statistics apart: statistics_NAME.csv")

    def asked(self) -> str:
        """The signal whose bounds it is asked with."""
        raise NotImplementedError

    def heading(self) -> str:
        """Over the table."""
        raise NotImplementedError

    def explanation(self) -> str:
        """What the columns mean."""
        raise NotImplementedError

    def row(self, runs: Sequence[Recorded], bounds: Sequence[Bound]) -> dict[str, Any] | None:
        """The numbers, by column, of the same runs that the bounds are asked of; None where it needs a bound."""
        raise NotImplementedError

    def remark(self, runs: Sequence[Recorded], bounds: Sequence[Bound]) -> str:
        """What to say about points that are not finite, or ""."""
        raise NotImplementedError

    def table(self, rows: Sequence[Mapping[str, Any]], unit: str) -> tuple[list[str], list[list[str]]]:
        """Headings and cells for people, from the rows and the unit of the signal."""
        raise NotImplementedError


def kinds(package: ModuleType, name: str) -> dict[str, Any]:
    """The classes ``name`` of all modules in a package, by module."""
    found = sorted(module.name for module in pkgutil.iter_modules(package.__path__))
    return {kind: getattr(importlib.import_module(f"{package.__name__}.{kind}"), name) for kind in found}


def pair(entries: list[Any]) -> list[Any]:
    """A validator for entries that come in twos."""
    if len(entries) != 2:
        raise ValueError(f"holds {len(entries)}, expected two")
    return entries


def same_unit(units: Mapping[str, str], *names: str) -> None:
    """Refuse signals with different units."""
    first, *others = names
    for other in others:
        if (units.get(first) or "1") != (units.get(other) or "1"):
            raise NavfmuError(
                f"'{first}' is in {units.get(first) or '1'}, '{other}' in {units.get(other) or '1'}; "
                "they are compared and need the same unit"
            )
