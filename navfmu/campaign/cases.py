"""The cases of a campaign file: their faults together, one by one, or in pairs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.schema import CaseEntry
from navfmu.errors import NavfmuError
from navfmu.faults import Fault, load_faults
from navfmu.files.reading import what_is
from navfmu.files.toml import Document
from navfmu.system.system import System

AT_A_TIME = {"each": 1, "pairs": 2}  # faults of the files of such an entry, beside those of ``faults``


class Cases:
    """Makes the cases of the tables [[case]]; ``beside`` is a path seen from the campaign file."""

    def __init__(
        self,
        document: Document,
        system: System,
        beside: Callable[[str], Path],
        parameters: Callable[..., dict[str, Any]],
        limit: int,
    ) -> None:
        self.document, self.system, self.beside, self.parameters = document, system, beside, parameters
        self.limit = limit  # of their number

    def of(self, entries: Sequence[CaseEntry]) -> tuple[Case, ...]:
        """All of them, in the order of the file."""
        cases: list[Case] = []
        for number, entry in enumerate(entries):
            if entry.name in (case.written for case in cases):
                raise self.document.error(f"there are two cases named '{entry.name}'", "case", number, "name")
            cases += self._cases(entry, number)
        return tuple(cases)

    def _cases(self, entry: CaseEntry, number: int) -> Iterator[Case]:
        case = Case(
            entry.name,
            entry.description,
            self.faults(entry.faults, number, "faults"),
            self.parameters(entry.parameters, "case", number, "parameters"),
        )
        keys = [key for key in AT_A_TIME if getattr(entry, key) is not None]
        if not keys:
            yield case
            return
        if len(keys) > 1:
            raise self.document.error("'each' and 'pairs' exclude each other", "case", number, "pairs")
        key, many = keys[0], AT_A_TIME[keys[0]]
        among = self.faults(getattr(entry, key), number, key, case.faults)
        if len(among) < many:
            raise self.document.error(f"'{key}' has one fault only, and a pair takes two", "case", number, key)
        if math.comb(len(among), many) > self.limit:
            count = f"{math.comb(len(among), many):,} pairs of {len(among):,} faults".replace(",", " ")
            raise self.document.error(f"'{key}' makes {count}, more than a campaign can have", "case", number, key)
        for faults in combinations(among, many):
            name = f"{entry.name}: {' + '.join(fault.id for fault in faults)}"
            yield replace(case, name=name, faults=self.together([*case.faults, *faults], number, key))

    def faults(
        self, names: str | Sequence[str] | None, number: int, key: str, common: Sequence[Fault] | None = None
    ) -> tuple[Fault, ...]:
        """The faults of the files of an entry; each knows the file that it is from.

        Those that are ``common`` already are left out, and then files may share what is alike in them.
        """
        found: list[Fault] = []
        for place, name in enumerate([names] if isinstance(names, str) else names or []):
            where = "case", number, key, place
            try:
                beside = self.beside(name)
                here = what_is(beside) not in (None, "a folder")
                path = beside if here else self.system.own_attachment("faults", name)
            except NavfmuError as error:
                raise self.document.error(str(error), *where) from None
            if not here and path == Path(name):  # not in the system either; the current folder does not matter
                raise self.document.error(f"there is no fault file '{name}'", *where)
            faults = load_faults(path, str(path) if here else self.system.called(path))
            found += [replace(fault, file=str(path if here else name)) for fault in faults]
        if common is not None:
            alike = [_acts(fault) for fault in (*common, *found)]
            found = [fault for n, fault in enumerate(found, len(common)) if alike.index(alike[n]) == n]
        return self.together(found, number, key)

    def together(self, faults: Sequence[Fault], number: int, key: str) -> tuple[Fault, ...]:
        """Faults of one run."""
        try:
            return self.system.faults(faults)
        except NavfmuError as error:
            raise self.document.error(str(error), "case", number, key) from None


def _acts(fault: Fault) -> dict[str, Any]:
    """What a fault does, whatever is said of it and wherever that stands."""
    return {key: value for key, value in fault.describe().items() if key not in ("file", "fmea", "description")}
