"""What a player wants to know: the quantities of its table of samples, and the columns in which they lie."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from navfmu.errors import NavfmuError

TIMES = ("time", "time_of_validity", "sequence", "valid")
"""Columns that every table of samples begins with."""
AXES = {"n": ("north", "east", "down")}
"""How recordings call the axes of a frame, and the columns of vectors in it; those of others are x, y, z."""
ONE_OF = (
    ("static_pressure", "pressure_altitude"),
    ("impact_pressure", "calibrated_airspeed", "true_airspeed"),
)
"""Of each of these a player needs at least one, where it has them all."""
_LABEL = re.compile(r"(\w+)(\[\d+\])? \((.+)\)")


@dataclass(frozen=True)
class Quantity:
    """A number or a vector of a sample, in the unit and the axes of the player."""

    name: str
    unit: str
    labels: tuple[str, ...]  # its columns in the player's table
    vector: bool
    optional: bool  # worked out by the player where it was not recorded

    @property
    def frame(self) -> str:
        """Letter of the axes of a vector: that of its name, else b."""
        return self.name[-1] if re.search(r"_[a-z]$", self.name) else "b"

    @property
    def usual(self) -> list[tuple[str, ...]]:
        """Names of columns under which it is found without being told."""
        if not self.vector:
            return [(self.name,)]
        axes = AXES.get(self.frame, ("x", "y", "z"))
        stems = dict.fromkeys((self.name, re.sub(r"_[a-z]$", "", self.name)))
        numbered = tuple(f"{self.name}[{i + 1}]" for i in range(len(self.labels)))
        return [numbered, *(tuple(f"{stem}_{axis}" for axis in axes) for stem in stems)]


@dataclass(frozen=True)
class Wanted:
    """The quantities of one table of samples."""

    table: str
    labels: tuple[str, ...]
    quantities: tuple[Quantity, ...]

    @property
    def one_of(self) -> list[tuple[str, ...]]:
        """Groups of optional quantities of which one must be there."""
        names = {quantity.name for quantity in self.quantities if quantity.optional}
        return [group for group in ONE_OF if names.issuperset(group)]


def wanted(table: str, labels: Iterable[str], what: str) -> Wanted:
    """Return what the table of a player wants; ``what`` it is begins the sentence if it is none of samples."""
    labels = tuple(labels)
    parts = [_LABEL.fullmatch(label) for label in labels]
    names = [part[1] if part else "" for part in parts]
    if tuple(names[: len(TIMES)]) != TIMES:
        raise NavfmuError(f"{what}: its table '{table}' is none of samples; expected the columns {', '.join(TIMES)}")
    quantities = []
    for name in dict.fromkeys(names[len(TIMES) :]):
        if name.endswith("_known"):
            continue
        own = [part for part in parts if part[1] == name]
        quantities.append(
            Quantity(name, own[0][3], tuple(part[0] for part in own), len(own) > 1, f"{name}_known" in names)
        )
    return Wanted(table, labels, tuple(quantities))
