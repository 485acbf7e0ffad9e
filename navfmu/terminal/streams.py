"""The three standard streams: closed, as a service starts us, or in an encoding that lacks what is to be printed."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

STREAMS = {"stdin": "r", "stdout": "w", "stderr": "w"}  # in the order of their numbers


def complete() -> None:
    """Let those that are closed lead nowhere, and print what there is no character for as Python writes it.

    Else there is nothing to print to, and the next file that is opened takes the number of the stream: what an FMU
    writes to the standard error stream would go into a recording. Python itself writes so to that stream only.
    """
    for number, (name, mode) in enumerate(STREAMS.items()):
        if getattr(sys, name) is None:
            nowhere = open(os.devnull, mode, encoding="utf-8")
            if not _taken(number):
                os.dup2(nowhere.fileno(), number)
            setattr(sys, name, nowhere)
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def _taken(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True
