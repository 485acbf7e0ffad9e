"""Named columns of numbers in one file of NumPy's format (``.npy``, little-endian doubles).

A table, columns of one length, is an array of records; a grid, two axes and surfaces over them, is a single record.
``np.load("track.npy")["time (s)"]`` reads a column of either, ``np.save`` writes such files, too.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.lib import format as npy

from navfmu.errors import NavfmuError

#: In the place of the number of rows, or of the lengths of the two axes.
FIRST, SECOND = "\x01", "\x02"


def label(name: str, unit: str) -> str:
    """Return the name of a column in a file, ``time (s)``."""
    return f"{name} ({unit})"


def packed(columns: Mapping[str, np.ndarray]) -> bytes:
    """Return the file of a table (label -> array (n,)) or a grid (two axes (n,) and (m,), then surfaces (n, m))."""
    if is_grid(columns):
        numbers = np.empty((), [(name, "<f8", column.shape) for name, column in columns.items()])
    else:
        numbers = np.empty(len(next(iter(columns.values()))), [(name, "<f8") for name in columns])
    for name, column in columns.items():
        numbers[name] = column
    file = io.BytesIO()
    npy.write_array(file, numbers, version=(1, 0) if encoding("".join(columns)) == "latin1" else (3, 0))
    return file.getvalue()


def unpacked(data: bytes, what: str, *, as_written: bool = False) -> dict[str, np.ndarray]:
    """Return the columns of a file (label -> array); ``what`` it is begins the sentence of what is wrong.

    Other numbers than doubles are converted, but for those that must be ``as_written`` by :func:`packed`.
    """
    try:
        numbers = npy.read_array(io.BytesIO(data))
    except Exception as error:  # NumPy raises ValueError, EOFError, TokenError, MemoryError, ... on what is none
        raise NavfmuError(f"{what}: {' '.join(str(error).split())}; expected a file of NumPy's format") from None
    if not numbers.dtype.names or numbers.ndim > 1:
        raise NavfmuError(f"{what}: holds numbers without names; expected an array of records with named columns")
    for name in numbers.dtype.names:
        kind = numbers.dtype[name].base
        if kind.kind not in "fiu":
            raise NavfmuError(f"{what}: '{name}' is of type {kind}; expected real numbers")
        if as_written and kind.str != "<f8":
            raise NavfmuError(f"{what}: '{name}' is of type {kind.str}; expected <f8, which is what FMUs read")
    return {name: np.array(numbers[name], float) for name in numbers.dtype.names}


def form(columns: Mapping[str, np.ndarray]) -> str:
    """Return which columns these are, and how each lies, as text."""
    kinds = {0: "a number", 1: "a list", 2: "a surface"}
    told = {name: kinds.get(column.ndim, f"{column.ndim} dimensions") for name, column in columns.items()}
    return ", ".join(f"'{name}' ({kind})" for name, kind in told.items())


def header(labels: Sequence[str], grid: bool) -> bytes:
    """Return the header of a file with such columns, FIRST and SECOND in the place of sizes."""
    sizes = (
        [f", ({FIRST},)", f", ({SECOND},)"] + [f", ({FIRST}, {SECOND})"] * len(labels) if grid else [""] * len(labels)
    )
    fields = ", ".join(f"({name!r}, '<f8'{size})" for name, size in zip(labels, sizes, strict=False))
    text = f"{{'descr': [{fields}], 'fortran_order': False, 'shape': ({'' if grid else FIRST + ','}), }}"
    return text.encode(encoding(text))


def encoding(text: str) -> str:
    """Return how NumPy writes the text of a header."""
    return "latin1" if all(c < "\u0100" for c in text) else "utf8"


def is_grid(columns: Mapping[str, np.ndarray]) -> bool:
    """Return whether these are two axes and surfaces over them."""
    return any(column.ndim == 2 for column in columns.values())
