"""Where the model's code is: its file and line, for messages."""

from __future__ import annotations

import os
import sys

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.files.characters import illegal

_SKIPPED = (os.path.dirname(__file__), os.path.dirname(np.__file__), "<__array_function__")


def is_foreign(filename: str) -> bool:
    """Whether a frame of this file belongs to the exporter or to NumPy, and not to the model."""
    return filename.startswith(_SKIPPED)


def place() -> str:
    """Return ``"file, line n"`` of the model's code that is running."""
    frame = sys._getframe(1)
    while frame.f_back is not None and is_foreign(frame.f_code.co_filename):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}, line {frame.f_lineno}"


def check_text(where: str, what: str, text: str) -> None:
    """Refuse a text that the description of an FMU and its C code cannot hold; ``where`` is its file and line."""
    wrong = illegal(text) or next((repr(c)[1:-1] for c in text if "\x7f" <= c <= "\x9f"), "")
    if wrong:
        raise NavfmuError(f"{where}: {what}: the text has the character {wrong}; expected no control characters")
