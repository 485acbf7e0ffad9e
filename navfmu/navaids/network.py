"""Stations as the table of a receiver that chooses among more than it has places for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from navfmu.files.numbers_as_text import text
from navfmu.navaids.station import Station

MOST = 32
COLUMNS = {
    "latitude (rad)": "latitude",
    "longitude (rad)": "longitude",
    "altitude (m)": "elevation",
    "range (m)": "range",
}
"""Column -> what it holds of a station."""


def document(stations: Sequence[Station]) -> str:
    """The table as CSV, the stations numbered from 1."""
    columns = {"number (1)": np.arange(1.0, len(stations) + 1.0)}
    return text(columns | {name: np.array([getattr(one, of) for one in stations]) for name, of in COLUMNS.items()})
