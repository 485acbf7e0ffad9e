"""A recorded flight as it stands in its file: columns checked by name, row and range, then converted to SI."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from navfmu.constants import FOOT, KNOT
from navfmu.errors import NavfmuError, nearest
from navfmu.files.reading import regular, unreadable

REQUIRED = ("time_s", "latitude_deg", "longitude_deg", "altitude_ft")
OPTIONAL = ("groundspeed_kt", "track_deg", "vertical_rate_ft_min")
TO_SI = {
    "time_s": 1.0,
    "latitude_deg": np.pi / 180.0,
    "longitude_deg": np.pi / 180.0,
    "altitude_ft": FOOT,
    "groundspeed_kt": KNOT,
    "track_deg": np.pi / 180.0,
    "vertical_rate_ft_min": FOOT / 60.0,
}
RANGE = {
    "latitude_deg": (-89.0, 89.0),  # the local north and east directions that the smoothing uses end at the poles
    "longitude_deg": (-180.0, 360.0),
    "altitude_ft": (-2000.0, 150000.0),
    "groundspeed_kt": (0.0, 3000.0),
    "track_deg": (-360.0, 720.0),
}
FEWEST_ROWS = 10


@dataclass(frozen=True)
class Recording:
    """Rows of a recorded track in SI units; a column that the file lacks is None.

    ``time`` s, ``latitude`` and ``longitude`` rad (longitude without jumps), ``altitude`` m, ``speed`` over ground m/s,
    ``track`` over ground rad clockwise from north, ``climb`` m/s.
    """

    name: str
    time: np.ndarray
    latitude: np.ndarray
    longitude: np.ndarray
    altitude: np.ndarray
    speed: np.ndarray | None = None
    track: np.ndarray | None = None
    climb: np.ndarray | None = None
    unused_columns: tuple[str, ...] = ()
    skipped_rows: int = 0

    def __len__(self) -> int:
        return len(self.time)

    def rows(self, keep: np.ndarray) -> Recording:
        """The same recording with only the rows of the mask or slice ``keep``."""

        def pick(column):
            return None if column is None else column[keep]

        return Recording(
            self.name,
            *(pick(c) for c in (self.time, self.latitude, self.longitude, self.altitude)),
            *(pick(c) for c in (self.speed, self.track, self.climb)),
            self.unused_columns,
            self.skipped_rows,
        )


def read(path: str | Path, skip_incomplete: bool = False) -> Recording:
    """Read a CSV file with the columns of ``REQUIRED`` and any of ``OPTIONAL``.

    Every complaint names the file, and the line where there is one (the header is line 1).
    """
    path = regular(path, "a recorded track as CSV")
    try:
        # skip_blank_lines off: the row number then gives the line number
        frame = pd.read_csv(path, comment=None, skipinitialspace=True, skip_blank_lines=False)
    except ValueError as problem:
        raise NavfmuError(
            f"{path}: this is not a CSV table with a header line ({' '.join(str(problem).split())})"
        ) from problem
    except OSError as problem:
        raise unreadable(path, problem) from None
    frame.columns = [str(c).strip() for c in frame.columns]
    unused = _check_columns(path, list(frame.columns))
    known = [c for c in (*REQUIRED, *OPTIONAL) if c in frame.columns]
    values = {c: _numbers(path, frame[c]) for c in known}

    incomplete = np.any([np.isnan(values[c]) for c in REQUIRED], axis=0) if len(frame) else np.zeros(0, bool)
    if incomplete.any() and not skip_incomplete:
        row = int(np.argmax(incomplete))
        column = next(c for c in REQUIRED if np.isnan(values[c][row]))
        raise NavfmuError(
            f"{path}, line {row + 2}: '{column}' is empty, and {int(incomplete.sum())} row(s) in all lack a required "
            "value; delete these rows, or pass --skip-incomplete to leave them out"
        )
    line = np.flatnonzero(~incomplete) + 2
    values = {c: v[~incomplete] for c, v in values.items()}
    if len(line) < FEWEST_ROWS:
        raise NavfmuError(f"{path}: the track has {len(line)} complete row(s); at least {FEWEST_ROWS} are needed")
    for column, (low, high) in RANGE.items():
        if column in values:
            bad = (values[column] < low) | (values[column] > high)
            if bad.any():
                at = int(np.argmax(bad))
                raise NavfmuError(
                    f"{path}, line {line[at]}: {column} is {values[column][at]:g}; expected {low:g} to {high:g}"
                )
    backwards = np.diff(values["time_s"]) <= 0
    if backwards.any():
        at = int(np.argmax(backwards)) + 1
        raise NavfmuError(
            f"{path}, line {line[at]}: time_s is {values['time_s'][at]:g} after {values['time_s'][at - 1]:g}; "
            "expected times that increase from row to row"
        )
    si = {c: v * TO_SI[c] for c, v in values.items()}
    return Recording(
        name=path.name,
        time=si["time_s"],
        latitude=si["latitude_deg"],
        longitude=np.unwrap(si["longitude_deg"]),
        altitude=si["altitude_ft"],
        speed=si.get("groundspeed_kt"),
        track=si.get("track_deg"),
        climb=si.get("vertical_rate_ft_min"),
        unused_columns=tuple(unused),
        skipped_rows=int(incomplete.sum()),
    )


def _check_columns(path: Path, columns: list[str]) -> list[str]:
    """Complain about a missing column or a misspelt one; return the columns that are not used."""
    unknown = [c for c in columns if c not in TO_SI]
    for column in REQUIRED:
        if column not in columns:
            raise NavfmuError(
                f"{path}: there is no column '{column}'{nearest(column, unknown)} "
                f"(a track needs {', '.join(REQUIRED)}, and may have {', '.join(OPTIONAL)})"
            )
    for column in unknown:
        suggestion = nearest(column, [c for c in OPTIONAL if c not in columns])
        if suggestion:
            raise NavfmuError(f"{path}: column '{column}' is not known{suggestion}")
    return unknown


def _numbers(path: Path, column: pd.Series) -> np.ndarray:
    """The column as floats; text that is not a number is an error with its line, an empty cell is NaN."""
    numbers = pd.to_numeric(column, errors="coerce")
    wrong = numbers.isna() & column.notna()
    if wrong.any():
        row = int(np.argmax(wrong.to_numpy()))
        raise NavfmuError(f"{path}, line {row + 2}: {column.name} is '{column.iloc[row]}'; expected a number")
    values = numbers.to_numpy(dtype=float)
    infinite = np.isinf(values)
    if infinite.any():
        raise NavfmuError(f"{path}, line {int(np.argmax(infinite)) + 2}: {column.name} is infinite")
    return values
