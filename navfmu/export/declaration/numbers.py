"""What tables and grids have in common: numbers that a component carries in a file of its resources."""

from __future__ import annotations

import copy
import hashlib
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.export.place import check_text, place
from navfmu.files.numbers import form, label, unpacked
from navfmu.files.reading import read_bytes


class Numbers:
    """Named columns of numbers, searched by those of them that increase.

    ``columns`` are (name, unit) pairs and ``numbers`` an array for each; ``keys`` are the places of those that
    increase. ``file`` is the name of a string Parameter that names a file to read instead.
    """

    columns: tuple[tuple[str, str], ...]
    numbers: tuple[np.ndarray, ...]
    keys: tuple[int, ...]
    between_keys = "or"  # "and" where a search needs all of them

    def __init__(self, file: str | None) -> None:
        self.place, self.name, self.file = place(), "", file

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __set__(self, component: Any, value: Any) -> None:
        component._frame.fail(f"{type(self).__name__.lower()} '{self.name}' cannot be assigned")

    def parts(self, what: str, given: Any, names: tuple[str, ...]) -> list[tuple[Any, ...]]:
        """Return what is given as ``what``, which are tuples of ``names``."""
        for one in given:
            if not isinstance(one, list | tuple) or len(one) != len(names):
                self.refuse(f"has {what} {one!r}; expected ({', '.join(names)})")
        return [tuple(one) for one in given]

    def real(self, what: str, given: Any) -> np.ndarray:
        """Return numbers that are given as an array of floats."""
        try:
            return np.array(given, float)
        except (TypeError, ValueError) as error:
            self.refuse(f"has {what} that are no array of numbers: {error}; a file is read with np.load")

    def refuse(self, what: str) -> NoReturn:
        """Raise the error for this declaration."""
        raise NavfmuError(f"{self.place}: {type(self).__name__} {what}")

    def hold(self, numbers: tuple[np.ndarray, ...]) -> None:
        """Have these numbers, an array for each column.

        Refused are columns that cannot be told apart, numbers that are not finite and keys that do not increase.
        """
        self.numbers = numbers
        names = [name for name, _ in self.columns]
        check_text(self.place, f"{type(self).__name__}: columns", "".join(name + unit for name, unit in self.columns))
        for place_, (name, column) in enumerate(zip(names, self.numbers, strict=True)):
            if name in names[:place_]:
                self.refuse(f"has two columns '{name}'; expected names of their own")
            if not np.all(np.isfinite(column)):
                self.refuse(f"has a number in '{name}' that is not finite")
            if place_ in self.keys and not (len(column) > 1 and np.all(np.diff(column) > 0)):
                self.refuse(f"is searched by '{name}', which does not increase; expected two or more numbers that do")
            column.setflags(write=False)

    def read(self, path: Path) -> Numbers:
        """Return the same table with the numbers of a file, which has the same columns."""
        found = unpacked(read_bytes(path, "a table"), str(path), as_written=True)
        own = {label(*column): numbers for column, numbers in zip(self.columns, self.numbers, strict=True)}
        if form(found) != form(own):
            raise NavfmuError(f"{path}: has the columns {form(found)}; expected {form(own)}")
        other = copy.copy(self)
        other.place = str(path)
        other.hold(tuple(found.values()))
        return other

    def digest(self) -> str:
        """Return a hash of what it holds, and of what it is searched by."""
        digest = hashlib.sha256(repr((self.columns, self.keys, [column.shape for column in self.numbers])).encode())
        for column in self.numbers:
            digest.update(column.tobytes())
        return digest.hexdigest()

    def key_names(self) -> list[str]:
        """Return the names of the columns by which it is searched."""
        return [self.columns[key][0] for key in self.keys]

    def find(self, key: int, values: Any) -> Any:
        """Return the places of the last numbers of a key (by its place among the keys) that are not above ``values``.

        There is always a next one: below the first number the place is 0; above the last one, and for NaN, it is the
        last but one.
        """
        numbers = self.numbers[self.keys[key]]
        return np.clip(np.searchsorted(numbers, values, side="right") - 1, 0, len(numbers) - 2)

    def check_named(self, frame: Any, values: tuple[Any, ...]) -> None:
        """Refuse a search by values without the names of their columns."""
        if values:
            names = [f"{name}=..." for name in self.key_names()]
            calls = " or ".join(f"around({n})" for n in ([", ".join(names)] if self.between_keys == "and" else names))
            frame.fail(f"{type(self).__name__} '{self.name}' is searched by name, {calls}")

    def not_a_key(self, frame: Any, given: tuple[str, ...]) -> NoReturn:
        """Raise the error for a search by other columns than it has keys."""
        known = self.key_names()
        hint = next((nearest(name, known) for name in given if name not in known), "")
        names = f" {self.between_keys} ".join(f"'{name}'" for name in known)
        asked = " and ".join(f"'{name}'" for name in given) or "nothing"
        frame.fail(f"{type(self).__name__} '{self.name}' is searched by {names}, not by {asked}{hint}")

    def routine(self, key: int) -> tuple[Any, ...]:
        """Return the C function of the runtime that searches by a key, and the numbers that it is given."""
        raise NotImplementedError

    @property
    def width(self) -> int:
        """How many numbers a search gives."""
        raise NotImplementedError

    def look_up(self, key: int, *values: Any) -> np.ndarray:
        """Search with floats or arrays of one shape; return an array (..., width)."""
        raise NotImplementedError
