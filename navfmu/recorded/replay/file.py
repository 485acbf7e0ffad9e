"""A file of recorded samples: named columns, looked at one by one, with the line or row of each number."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from navfmu.errors import NavfmuError, quoted
from navfmu.files.reading import regular, unreadable

KINDS = (".csv", ".parquet", ".ulg")
_WITH_UNIT = re.compile(r"(.*\S)\s*[\[(]([^\[\]()]+)[\])]")
_INDEX = re.compile(r"\d+")


@dataclass(frozen=True)
class File:
    """Columns by name; ``units`` are those that stand in the header, as in ``time (ms)``; ``told`` is what there is to
    say of the file as a whole."""

    path: str
    frame: pd.DataFrame = field(repr=False)
    first_line: int | None = None  # of the rows in a text
    units: dict[str, str] = field(default_factory=dict)
    told: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """The columns."""
        return list(self.frame.columns)

    def row(self, number: int) -> str:
        """Return where a row stands, counted from 0, for a sentence."""
        return f"row {number + 1}" if self.first_line is None else f"line {number + self.first_line}"

    def numbers(self, name: str) -> np.ndarray:
        """Return a column (rows,) as floats; an empty cell is NaN, and what is no number a sentence."""
        column = self.frame[name]
        if column.dtype.kind not in "biuf":
            given = _numbers(column) if column.dtype.kind != "M" else column.astype(object)
            wrong = given.isna() & column.notna() if column.dtype.kind != "M" else column.notna()
            if wrong.any():
                at = int(np.argmax(wrong.to_numpy()))
                raise NavfmuError(
                    f"{self.path}, {self.row(at)}: '{name}' is '{quoted(str(column.iloc[at]))}'; expected a number"
                )
            column = given
        return column.to_numpy(dtype=float, na_value=np.nan)


def read(path: str | Path) -> File:
    """Read a table, CSV with a header or Parquet by the name of its file."""
    path = regular(path, "recorded samples")
    kind = path.suffix.lower()
    if kind not in KINDS[:2]:
        raise NavfmuError(f"{path}: cannot tell the format from the name; expected {', '.join(KINDS)} at its end")
    try:
        frame = _text(path) if kind == ".csv" else _parquet(path)
    except OSError as problem:
        if problem.errno is not None:
            raise unreadable(path, problem) from None
        raise _other_format(path, kind, problem) from None
    except NavfmuError:
        raise
    except pd.errors.ParserWarning:
        raise NavfmuError(
            f"{path}: rows have more fields than the header has names; expected as many, separated by commas, and "
            "points in numbers"
        ) from None
    except Exception as problem:  # of pandas, of Arrow, of what they are built on
        raise _other_format(path, kind, problem) from None
    return of(path, frame, 2 if kind == ".csv" else None)


def _text(path: Path) -> pd.DataFrame:
    """Read CSV with the header as it stands: two columns of one name have it both."""
    # skip_blank_lines off: the row number then gives the line number
    options = {"skipinitialspace": True, "skip_blank_lines": False, "index_col": False}
    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)  # rows longer than the header
        first = pd.read_csv(path, header=None, nrows=1, dtype=str, keep_default_na=False, **options)
        header = first.iloc[0].to_list()
        if len(header) == 1 and (mark := next((mark for mark in ";\t| " if mark in header[0].strip()), None)):
            raise NavfmuError(f"{path}: the columns are separated by {mark!r}; expected commas, and points in numbers")
        frame = pd.read_csv(path, low_memory=False, **options)
    return frame.set_axis(header, axis=1)


def _numbers(column: pd.Series) -> pd.Series:
    try:
        return pd.to_numeric(column, errors="coerce")
    except OverflowError:  # a whole number of hundreds of digits
        return column.map(_number)


def _number(text: object) -> float:
    try:
        return float(text)
    except OverflowError:
        return math.inf
    except (TypeError, ValueError):
        return math.nan


def _parquet(path: Path) -> pd.DataFrame:
    """Read a Parquet file; an index that has a name is a column like others."""
    frame = pd.read_parquet(path)
    return frame.reset_index() if any(frame.index.names) else frame


def _other_format(path: Path, kind: str, problem: Exception) -> NavfmuError:
    expected = "CSV table with a header line" if kind == ".csv" else "Parquet file"
    return NavfmuError(f"{path}: this is no {expected} ({quoted(' '.join(str(problem).split()))})")


def of(path: str | Path, frame: pd.DataFrame, first_line: int | None = None) -> File:
    """Return the file of a frame, whose columns may have units in their names."""
    names, units = [], {}
    full = np.flatnonzero(frame.notna().any(axis=1).to_numpy())
    frame = frame.iloc[: full[-1] + 1 if len(full) else 0]  # a text may end in empty lines
    for column in frame.columns:
        name = str(column).strip()
        with_unit = _WITH_UNIT.fullmatch(name)
        if with_unit and not _INDEX.fullmatch(with_unit[2]):  # rate[1] is one of three
            name = with_unit[1]
            units[name] = with_unit[2].strip()
        if name in names:
            raise NavfmuError(f"{path}: has two columns '{name}'; expected names of their own")
        names.append(name)
    if not len(frame):
        raise NavfmuError(f"{path}: has no rows; expected recorded samples")
    return File(str(path), frame.set_axis(names, axis=1), first_line, units)
