"""Stations in files of X-Plane's layout, ``nav.dat`` and ``earth_nav.dat``, versions 740, 810, 1100, 1150 and 1200.

A line "I" or "A", which may be empty or missing, a line that begins with the version, rows that begin with a code, and
the row 99 at the end. Lines of "#" are remarks. Rows 12 (beside a VOR or ILS) and 13 (alone; not before 810) are
transponders:

    12  latitude longitude elevation frequency range bias ident [terminal region] name ...

in degrees, feet, MHz times 100 and nautical miles; terminal and region from version 1100 on (X-Plane's specifications
XP NAV740, XP NAV810 and XP NAV1100; 1200 has the same rows). Other rows are not used.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator

import numpy as np

from navfmu.errors import NavfmuError, quoted
from navfmu.navaids.station import Station, station

VERSIONS = {"740": 0, "810": 0, "1100": 2, "1150": 2, "1200": 2}
"""Version -> how many words stand between ident and name."""
_VERSION = re.compile(r"\s*\d+\s+version", re.IGNORECASE)
TRANSPONDERS = ("12", "13")
END = "99"
NUMBERS = ("latitude", "longitude", "elevation", "frequency", "range", "bias")
SCALE = {"frequency": 0.01}


def is_nav_dat(text: str) -> bool:
    """Whether a file begins as these do."""
    begin = _lines(text[:200])[:2]
    return (bool(begin) and begin[0].strip() in ("I", "A")) or any(_VERSION.match(line) for line in begin)


def read(text: str, source: str) -> Iterator[Station]:
    """The transponders of a file; ``source`` names it in sentences."""
    lines = _lines(text)
    head = 0 if _VERSION.match(lines[0]) else 1
    between = VERSIONS[_version(lines, head, source)]
    for number, line in enumerate(lines[head + 1 :], head + 2):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == END:
            return
        if not words[0].isascii() or not words[0].isdigit():
            raise NavfmuError(
                f"{source}, line {number}: begins with '{quoted(words[0])}'; expected the code of a row, such as 12"
            )
        if words[0] in TRANSPONDERS:
            yield _transponder(words, between, f"{source}, line {number}", number)
    raise NavfmuError(f"{source}: ends at line {len(lines)} without the row {END}: something of it is missing")


def _lines(text: str) -> list[str]:
    """Lines as files end them; ``str.splitlines`` also breaks names at what is a mark in old letters."""
    return list(io.StringIO(text, newline=None))


def _version(lines: list[str], at: int, source: str) -> str:
    first = lines[at].split()[:1] if len(lines) > at else []
    if not first or first[0] not in VERSIONS:
        found = f"is '{quoted(first[0])}'" if first else "is missing"
        raise NavfmuError(f"{source}, line {at + 1}: the version of the file {found}; expected {' or '.join(VERSIONS)}")
    return first[0]


def _transponder(words: list[str], between: int, where: str, line: int) -> Station:
    needed = len(NUMBERS) + 2 + between
    if len(words) < needed:
        raise NavfmuError(
            f"{where}: the row has {len(words)} words; expected at least {needed}: "
            f"12 or 13, {', '.join(NUMBERS)}, ident{', terminal, region' if between else ''}"
        )
    numbers = {
        name: _number(word, name, where) * SCALE.get(name, 1.0) for name, word in zip(NUMBERS, words[1:7], strict=True)
    }
    return station(words[7], " ".join(words[8 + between :]), numbers, where, line)


def _number(word: str, name: str, where: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value) or "_" in word:
        raise NavfmuError(f"{where}: the {name} is '{quoted(word)}'; expected a number")
    return value
