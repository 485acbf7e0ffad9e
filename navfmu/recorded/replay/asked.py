"""What the user says of a recording: which column is what, in which unit and axes, and where its time begins."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.units import conversion
from navfmu.recorded.replay.units import UNITS, alike

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
TIME_UNITS = {"time": "s", "time_of_validity": "s"}
INCOMPLETE = ("refuse", "invalid")


@dataclass(frozen=True)
class Asked:
    """Options by the name of a quantity; those of vectors have three parts, or one for all.

    ``columns`` name -> columns of the file; ``units`` name -> unit of the file, with a factor if need be ("1e-7 deg");
    ``axes`` name, or "" for all vectors in body axes -> the player's axes by those of the file, ("x", "-y", "-z");
    ``add`` and ``values`` name -> what is added, or stands for what was not recorded, as texts with units.
    ``start`` s, of the file's time, is t = 0; ``age`` s, how long before its time a sample was valid;
    ``incomplete`` what becomes of rows that lack a number; ``changes_only`` leaves out samples that repeat the one
    before; ``unchecked`` takes what is not plausible, and says it.
    """

    columns: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    axes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    add: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    values: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    start: float | None = None
    age: float = 0.0
    incomplete: str = "refuse"
    changes_only: bool = False
    unchecked: bool = False

    def check(self, names: Iterable[str], vectors: Iterable[str]) -> None:
        """Refuse options of what there is not, and numbers that are none."""
        names, vectors = list(names), list(vectors)
        times = ["time", "time_of_validity", "valid"]
        known = {
            "--column": ([*times, *names], self.columns),
            "--unit": ([*TIME_UNITS, *names], self.units),
            "--axes": (["", *vectors], self.axes),
            "--add": (names, self.add),
            "--value": (names, self.values),
        }
        for option, (right, given) in known.items():
            for name in given:
                if name not in right:
                    have = ", ".join(filter(None, right)) or "nothing here"
                    raise NavfmuError(
                        f"{option} {name}: there is no such quantity; expected {have}{nearest(name, right)}"
                    )
        for name in times:
            if len(self.columns.get(name, ("one",))) != 1:
                raise NavfmuError(f"--column {name}: {len(self.columns[name])} columns are named; expected one")
        for name, axes in self.axes.items():
            turn(axes, f"--axes {name}".strip())
        for option, value in (("--start", self.start), ("--age", self.age)):
            if value is not None and not math.isfinite(value):
                raise NavfmuError(f"{option} is {value:g}; expected a number of seconds")
        if self.age < 0.0:
            raise NavfmuError(
                f"--age is {self.age:g} s: a sample cannot hold for a time to come; to have samples earlier, begin "
                "later in the recording with --start"
            )
        if self.incomplete not in INCOMPLETE:
            raise NavfmuError(f"--incomplete is '{self.incomplete}'; expected {' or '.join(INCOMPLETE)}")


def named(
    options: Iterable[str], option: str, *, parts: str | None = ",", bare: bool = False
) -> dict[str, tuple[str, ...]]:
    """Return texts such as ``rate=x,-y,-z`` by name; ``bare`` ones without a name are those of ""."""
    found: dict[str, tuple[str, ...]] = {}
    for text in options:
        name, equals, value = text.partition("=")
        if not equals and bare:
            name, value = "", text
        elif not equals:
            raise NavfmuError(f"{option} '{text}': expected NAME={'VALUE' if option != '--column' else 'COLUMN'}")
        name = name.strip()
        if name in found:
            raise NavfmuError(f"{option} {name or text}: is given twice")
        pieces = tuple(piece.strip() for piece in (value.split(parts) if parts else [value]))
        if not all(pieces):
            raise NavfmuError(f"{option} '{text}': a part of it is empty")
        found[name] = pieces
    return found


def turn(axes: tuple[str, ...], what: str) -> np.ndarray:
    """Return the matrix (3, 3) that turns a vector of the file into the player's axes, given as ("x", "-y", "-z")."""
    rows = []
    for axis in axes:
        match = re.fullmatch(r"([-+]?)([xyz])", axis)
        if match is None:
            raise NavfmuError(f"{what}: '{axis}' is no axis; expected x, y or z, with or without '-'")
        rows.append(np.eye(3)["xyz".index(match[2])] * (-1.0 if match[1] == "-" else 1.0))
    told = ",".join(axes)
    if len(rows) != 3 or abs(np.linalg.det(np.array(rows))) < 0.5:
        raise NavfmuError(f"{what}: {told} are no three axes; expected each of x, y and z once, as in x,-y,-z")
    return np.array(rows)


def check_turn(axes: tuple[str, ...], what: str) -> None:
    """Refuse axes of a triad of sensors that are a mirror image; a velocity may well be told as north, east, up."""
    if np.linalg.det(turn(axes, what)) < 0.0:
        raise NavfmuError(
            f"{what}: {','.join(axes)} is a mirror image, no turn: from right-handed axes to others an even number of "
            "swaps and signs leads, as in x,-y,-z or y,x,-z"
        )


def scale(text: str, unit: str, what: str) -> tuple[float, float]:
    """Return factor and offset from a unit, perhaps with a factor ("1e-7 deg"), to the ``unit`` of the player."""
    match = _NUMBER.fullmatch(text)
    factor, name = (float(match[1]), match[2]) if match else (1.0, text.strip())
    if not factor or not math.isfinite(factor):
        raise NavfmuError(f"{what}: the unit '{text}' has the factor {factor:g}; expected another one")
    if unit == "1":
        if name not in ("", "1"):
            raise NavfmuError(f"{what}: the unit is '{text}', and this is a plain number; expected at most a factor")
        return factor, 0.0
    if not name:
        raise NavfmuError(f"{what}: '{text}' has no unit; expected one, as in '1e-3 {unit}'")
    fitting = alike(unit)
    if name not in UNITS:
        expected = f"expected {' or '.join(fitting)}, perhaps with a factor, as in '1e-3 {unit}'"
        raise NavfmuError(f"{what}: the unit '{name}' is not known here; {expected}{nearest(name, fitting)}")
    by, offset = conversion(UNITS[name], UNITS[unit], what)
    return factor * by, offset


def amount(text: str, unit: str, what: str, *, difference: bool = False) -> float:
    """Return a number, or one with a unit ("-27 ft"), in the ``unit`` of the player."""
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise NavfmuError(f"{what}: '{text}' is no number; expected one, or one with a unit as in '1.5 {unit}'")
    number = float(match[1])
    if match[2]:
        factor, offset = scale(match[2], unit, what)
        number = factor * number + (0.0 if difference else offset)
    if not math.isfinite(number):
        raise NavfmuError(f"{what}: '{text}' is too large for a number")
    return number
