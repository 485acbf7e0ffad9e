"""A file of orbits, whichever it is: RINEX navigation, YUMA, SEM."""

from __future__ import annotations

from datetime import date
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.satellite import navigation, sem, yuma
from navfmu.satellite.header import is_rinex
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import Orbits

BROADCAST = "a RINEX navigation file of version 2, 3 or 4"
EXPECTED = f"{BROADCAST}, a YUMA or a SEM almanac"


def read_orbits(path: str | Path, near: date | None = None) -> Orbits:
    """Read orbits and clocks of satellites.

    Parameters
    ----------
    near : a date that an almanac is wanted for. Almanacs count weeks modulo 1024, which is 19.6 years
    """
    lines = Lines(path, EXPECTED)
    if is_rinex(lines):
        return navigation.read(lines)
    if yuma.is_yuma(lines):
        return yuma.read(lines, near)
    if sem.is_sem(lines):
        return sem.read(lines, near)
    raise NavfmuError(f"{path}: begins like no file of orbits; expected {EXPECTED}")


def read_broadcast(path: str | Path) -> Orbits:
    """Read what satellites broadcast, exact to a metre, and refuse almanacs."""
    lines = Lines(path, BROADCAST)
    for kind, is_it in ((yuma.KIND, yuma.is_yuma), (sem.KIND, sem.is_sem)):
        if not is_rinex(lines) and is_it(lines):
            raise NavfmuError(f"{path}: is a {kind}, whose satellites are off by a kilometre; expected {BROADCAST}")
    return navigation.read(lines)
