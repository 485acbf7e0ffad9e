"""Where the model's code is: its file and line, for messages."""

from __future__ import annotations

import os
import sys

import numpy as np

_PACKAGE = os.path.dirname(__file__)
_SKIPPED = (
    *(os.path.join(_PACKAGE, room) + os.sep for room in ("export", "derivatives", "repetition")),
    os.path.dirname(np.__file__),
    os.path.join(os.path.dirname(os.path.dirname(np.__file__)), "scipy"),  # which models may call, too
    "<__array_function__",
    "<stringsource>",  # as functions of Cython call their file
    "scipy" + os.sep,
    __file__,
)


def is_foreign(filename: str) -> bool:
    """Whether a frame of this file belongs to these rooms or to NumPy, and not to the model."""
    return filename.startswith(_SKIPPED)


def place() -> str:
    """Return ``"file, line n"`` of the model's code that is running."""
    frame = sys._getframe(1)
    while frame.f_back is not None and is_foreign(frame.f_code.co_filename):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}, line {frame.f_lineno}"
