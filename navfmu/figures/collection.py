"""Collections of rows, each a package in the namespace ``navfmu_figures``: whoever installs one there has it found."""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from navfmu.errors import NavfmuError, nearest
from navfmu.figures.row import Row

SPACE = "navfmu_figures"


@dataclass(frozen=True)
class Collection:
    """The rows of one source, in the order of their names, and what the source is."""

    name: str
    source: str
    rows: tuple[Row, ...]
    folder: Path

    def chosen(self, names: tuple[str, ...]) -> tuple[Row, ...]:
        """The rows of these names, all if there are none."""
        known = {row.name: row for row in self.rows}
        for name in names:
            if name not in known:
                raise NavfmuError(
                    f"'{self.name}' has no row '{name}'{nearest(name.upper(), known)} (it has: {', '.join(known)})"
                )
        return tuple(row for row in self.rows if not names or row.name in names)


def names() -> list[str]:
    """The collections that are installed."""
    return sorted(info.name for info in pkgutil.iter_modules(places()) if info.ispkg)


def places() -> list[str]:
    """Where the namespace is found."""
    try:
        found = importlib.import_module(SPACE).__path__
    except ModuleNotFoundError:
        return []
    return [place for place in found if Path(place).is_dir()]  # an editable installation has one that is none


def collection(name: str) -> Collection:
    """A collection by its name."""
    known = names()
    if name not in known:
        have = f"there are {', '.join(known)}" if known else f"no package of the namespace {SPACE} is installed"
        raise NavfmuError(f"there is no collection of figures '{name}'{nearest(name, known)} ({have})")
    package = _imported(f"{SPACE}.{name}")
    rows: dict[str, Row] = {}
    for info in pkgutil.iter_modules(package.__path__):
        for row in _rows(_imported(f"{SPACE}.{name}.{info.name}")):
            if row.name in rows:
                raise NavfmuError(f"the collection '{name}' has two rows '{row.name}'; expected one of each name")
            rows[row.name] = row
    if not rows:
        raise NavfmuError(f"the collection '{name}' has no row; expected modules with a function that is a row")
    source = " ".join((package.__doc__ or name).split())
    return Collection(name, source, tuple(sorted(rows.values(), key=lambda row: row.order)), Path(package.__path__[0]))


def _rows(module: ModuleType) -> list[Row]:
    return [one for one in vars(module).values() if isinstance(one, Row) and one.find.__module__ == module.__name__]


def _imported(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except Exception as error:
        raise NavfmuError(f"{name}: cannot be imported: {type(error).__name__}: {error}") from error
