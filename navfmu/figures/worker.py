"""One row in a process of its own: ``python -m navfmu.figures.worker COLLECTION ROW SEED KEY FOLDER FMU...``.

What is done of it goes to standard output, a line "done total" now and then. When the command's own process is gone,
standard input ends, and so does this one.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
import traceback
from pathlib import Path
from threading import Thread

from navfmu.errors import NavfmuError, quoted
from navfmu.figures.answer import Answer
from navfmu.figures.collection import Collection, collection
from navfmu.figures.row import Row
from navfmu.figures.task import Task

EVERY = 0.2
"""s between two lines of progress."""


def main(arguments: list[str]) -> None:
    """Find the figures of a row and keep them."""
    name, row, seed, key, folder, *fmus = arguments
    Thread(target=_ended, daemon=True).start()
    of = collection(name)
    work(of, of.chosen((row,))[0], int(seed), key, Path(folder), [Path(fmu) for fmu in fmus])


def work(of: Collection, row: Row, seed: int, key: str, folder: Path, fmus: list[Path]) -> None:
    """Call the row's function; what it raises is its answer."""
    with tempfile.TemporaryDirectory(prefix="navfmu-figures-", ignore_cleanup_errors=True) as made:
        task = Task(seed, Path(made), {fmu.stem: fmu for fmu in fmus}, Said())
        try:
            answer = Answer.of(row, key, row.find(task))
        except NavfmuError as error:
            answer = Answer.failed(row, key, str(error))
        except Exception as error:
            where = next((at for at in reversed(traceback.extract_tb(error.__traceback__)) if _own(at, of)), None)
            place = f"{Path(where.filename).name}, line {where.lineno}: " if where else ""
            answer = Answer.failed(row, key, f"{place}{type(error).__name__}: {quoted(str(error))}")
    answer.write(folder)


class Said:
    """Progress as lines, not too many of them."""

    def __init__(self) -> None:
        self._last = 0.0

    def __call__(self, done: int, total: int) -> None:
        if time.monotonic() - self._last >= EVERY:
            self._last = time.monotonic()
            print(done, total, flush=True)


def _own(at: traceback.FrameSummary, of: Collection) -> bool:
    return Path(at.filename).is_relative_to(of.folder)


def _ended() -> None:
    sys.stdin.buffer.read()
    os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1:])
