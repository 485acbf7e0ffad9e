"""Stations in a CSV table: the numbers of a navaid file under names, in units that the names tell."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from navfmu.errors import NavfmuError, nearest, quoted
from navfmu.navaids.station import Station, station

REQUIRED = {
    "latitude_deg": "latitude",
    "longitude_deg": "longitude",
    "elevation_ft": "elevation",
    "frequency_mhz": "frequency",
    "range_nmi": "range",
}
OPTIONAL = {"bias_nmi": "bias"}


def read(text: str, source: str) -> Iterator[Station]:
    """The stations of a table; ``source`` names it in sentences. Other columns than the known ones are not used."""
    rows = _rows(text, source)
    header = [name.strip() for name in next(rows, (0, []))[1]]
    for name in ("ident", *REQUIRED):
        if header.count(name) != 1:
            have = "are two columns" if name in header else "is no column"
            raise NavfmuError(
                f"{source}: there {have} '{name}'{nearest(name, [h for h in header if h != name])} "
                f"(stations need ident, {', '.join(REQUIRED)}, and may have {', '.join(OPTIONAL)} and name; "
                "or a file of X-Plane's layout, which begins with a line I or A and one with its version)"
            )
    for line, words in rows:
        where = f"{source}, line {line}"
        if not any(word.strip() for word in words):
            continue
        if len(words) != len(header):
            raise NavfmuError(f"{where}: has {len(words)} values; expected {len(header)}, one for each column")
        row = dict(zip(header, (word.strip() for word in words), strict=True))
        if not row["ident"]:
            raise NavfmuError(f"{where}: 'ident' is empty; expected the letters of the station")
        numbers = {"bias": 0.0}
        for column, key in (REQUIRED | OPTIONAL).items():
            if column in row:
                numbers[key] = _number(row[column], column, where)
        yield station(row["ident"], row.get("name", ""), numbers, where, line)


def _rows(text: str, source: str) -> Iterator[tuple[int, list[str]]]:
    """Each row behind the number of its line."""
    rows = csv.reader(io.StringIO(text, newline=None), strict=True)
    try:
        for words in rows:
            yield rows.line_num, words
    except csv.Error as error:
        raise NavfmuError(
            f"{source}, line {rows.line_num}: {error}; expected values between commas, and quotes in pairs"
        ) from None


def _number(word: str, column: str, where: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value) or "_" in word:
        raise NavfmuError(f"{where}: '{column}' is '{quoted(word)}'; expected a number")
    return value
