"""The three standard streams, some of which may be closed: as a service starts us, or ``navfmu ... 2>&-``."""

from __future__ import annotations

import os
import sys

STREAMS = {"stdin": "r", "stdout": "w", "stderr": "w"}  # in the order of their numbers


def complete() -> None:
    """Let those that are closed lead nowhere.

    Else there is nothing to print to, and the next file that is opened takes the number of the stream: what an FMU
    writes to the standard error stream would go into a recording.
    """
    for number, (name, mode) in enumerate(STREAMS.items()):
        if getattr(sys, name) is None:
            nowhere = open(os.devnull, mode, encoding="utf-8")
            if not _taken(number):
                os.dup2(nowhere.fileno(), number)
            setattr(sys, name, nowhere)


def _taken(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True
