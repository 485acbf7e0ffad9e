"""Texts of string parameters: names of stations, of files in resources."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np

from navfmu.export.place import check_text

#: Bytes that a string may have unless its declaration says otherwise.
LONGEST = 100


def texts(start: Any, shape: tuple[int, ...], longest: int, place: str, fail: Callable[[str], NoReturn]) -> list[str]:
    """Return one start text for each element, in C order; ``fail`` raises the error for the declaration."""
    if isinstance(longest, bool) or not isinstance(longest, int) or not 1 <= longest < 2**16:
        fail(f"longest is {longest!r}, expected a number of bytes from 1 to 65535")
    array = np.array("" if start is None else start, object)
    try:
        found = np.broadcast_to(array, shape).ravel().tolist()
    except ValueError:
        fail(f"start has shape {array.shape}, expected a text or {shape}")
    for text in found:
        if not isinstance(text, str):
            fail(f"start is {text!r}, expected a text")
        check_text(place, "start of a string", text)
        if size(text) > longest:
            fail(f"start is {text!r}, which has {size(text)} bytes in UTF-8; expected at most {longest}")
    return found


def size(text: str) -> int:
    """Return how many bytes a text has in UTF-8."""
    return len(text.encode())


def no_character(text: str) -> int | None:
    """Return which byte begins no character of a C string in UTF-8, counted from 1; None if each does."""
    place = next((i for i, c in enumerate(text) if c == "\0" or "\ud800" <= c <= "\udfff"), None)
    return None if place is None else size(text[:place]) + 1
