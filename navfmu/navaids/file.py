"""A file of stations, whatever its layout."""

from __future__ import annotations

from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.files.reading import read_bytes
from navfmu.navaids import nav_dat, table
from navfmu.navaids.station import Stations

LIMIT = 100_000_000
"""Bytes; the whole world is some megabytes."""


def read(path: str | Path) -> Stations:
    """The stations of a file of X-Plane's layout, or of a CSV table."""
    data = read_bytes(path, "a file of stations: X-Plane's nav.dat or a CSV table", LIMIT)
    if b"\0" in data:
        raise NavfmuError(f"{path}: is no text; expected a file of stations: X-Plane's nav.dat or a CSV table")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:  # as old files have the names of places
        text = data.decode("latin-1")
    layout = nav_dat if nav_dat.is_nav_dat(text) else table
    found = Stations.of(Path(path).name, layout.read(text, str(path)))
    if not found.stations:
        left = f" but {found.biased} with a bias" if found.biased else ""
        raise NavfmuError(f"{path}: holds no station{left}; expected rows 12 or 13 of a nav.dat, or rows of a table")
    return found
