"""A system as its documents say it: components, connections and values, before any FMU is opened."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from navfmu.fmi.units import Unit


@dataclass(frozen=True)
class Setting:
    """A value for one variable of a component; ``unit`` is None where the file gives none.

    The variable becomes ``factor * value + offset``, after conversion of the value to the variable's unit. The value of
    an enumeration is the name of an item; ``items`` has their numbers, or is None where the document leaves them to the
    FMU.
    """

    name: str
    type: str
    value: float | int | bool | str
    unit: Unit | None
    where: str  # "imu.ssv, line 7"
    factor: float = 1.0
    offset: float = 0.0
    items: Mapping[str, int] | None = None


@dataclass(frozen=True)
class Connector:
    """A connector of a component; type, unit and items are None where the document leaves them to the FMU."""

    name: str
    kind: str
    type: str | None
    unit: Unit | None
    items: Mapping[str, int] | None = None  # of an enumeration: their values


@dataclass(frozen=True)
class Connection:
    """From ``start`` to ``end``, each (component, variable): end = factor * start + offset, after unit conversion."""

    start: tuple[str, str]
    end: tuple[str, str]
    factor: float
    offset: float
    convert_units: bool
    where: str

    def __str__(self) -> str:
        return f"'{'.'.join(self.start)}' -> '{'.'.join(self.end)}'"


@dataclass
class Component:
    """An instance of an FMU, with its values in the order in which they apply (a later one wins)."""

    name: str
    source: Path
    connectors: dict[str, Connector]
    settings: list[Setting]
    where: str
    description: str = ""


@dataclass
class Structure:
    """One variant of a system."""

    name: str
    description: str
    file: Path  # the SSD
    origin: Path  # what the user named: the SSP, the folder or the SSD
    components: dict[str, Component]
    connections: list[Connection]
    stop_time: float | None
    step: float | None
    ignored: list[str] = field(default_factory=list)  # what stands in the documents and has no effect here
    notes: list[str] = field(default_factory=list)
    lenient: list[str] = field(default_factory=list)  # what is not as SSP has it, and was read all the same
