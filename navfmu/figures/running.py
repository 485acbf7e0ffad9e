"""All rows that are asked for, each in a process of its own, some at a time; what is kept is not done again.

An FMU that crashes ends its row and no other. A row's numbers depend on its seed alone, so a table is the same for any
number of jobs.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError, quoted
from navfmu.figures import collection as collections
from navfmu.figures.answer import FAILED, Answer, key
from navfmu.figures.collection import Collection
from navfmu.figures.comparison import DIFFERS
from navfmu.figures.row import Row
from navfmu.system import shipped
from navfmu.system.pool import Board, Report, in_threads

STEPS = 1000
"""In which the progress of a row is counted."""
KEPT = "rows"
"""The folder of answers, in that of the report."""
_LOOK = 0.1  # s between looks at a row under way
_PACKAGE = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Outcome:
    """The answers of the rows, in their order."""

    of: Collection
    seed: int
    answers: tuple[Answer, ...]
    kept: int
    """How many of them were there before."""

    @property
    def passed(self) -> bool:
        """Whether every row was found, and agrees or differs in a way that is explained."""
        return not any(answer.verdict in (FAILED, DIFFERS) for answer in self.answers)


@dataclass(frozen=True, eq=False)
class Asked:
    """A row, and what its answer depends on."""

    row: Row
    fmus: tuple[Path, ...]
    key: str
    lacking: str = ""
    """Why it cannot be done."""

    @classmethod
    def of(cls, row: Row, seed: int, folder: Path) -> Asked:
        try:
            fmus = tuple(shipped.path(f"{name}.fmu") for name in row.fmus)
            return cls(row, fmus, key(row, seed, fmus, folder))
        except NavfmuError as error:
            return cls(row, (), "", f"{error}; build_fmus.py makes the FMUs of a checkout")


def run(
    of: Collection, rows: Sequence[Row], seed: int, folder: Path, jobs: int | None = None, report: Report | None = None
) -> Outcome:
    """Find the figures of these rows; the folder keeps what is finished."""
    home = folder / KEPT
    asked = [Asked.of(row, seed, of.folder) for row in rows]
    found = {one: Answer.failed(one.row, "", one.lacking) for one in asked if one.lacking}
    kept = {one: answer for one in asked if (answer := _kept(one, home)) is not None}
    left = [one for one in asked if one not in found and one not in kept]
    board = Board(STEPS * len(left), report)

    def do(one: Asked) -> Answer:
        return _worked(of, one, seed, home, board.of(one, STEPS))

    answers = kept | found | dict(in_threads(left, do, jobs, board))
    return Outcome(of, seed, tuple(answers[one] for one in asked), len(kept))


def _kept(one: Asked, home: Path) -> Answer | None:
    """What is there already; what has failed is tried again."""
    answer = None if one.lacking else Answer.read(one.row, one.key, home)
    return None if answer is None or answer.error else answer


def _worked(of: Collection, one: Asked, seed: int, home: Path, progress: Callable[[int, int], None]) -> Answer:
    """Have a process find the figures of a row."""
    (home / f"{one.row.name}.json").unlink(missing_ok=True)
    given = [of.name, one.row.name, str(seed), one.key, str(home), *map(str, one.fmus)]
    with tempfile.TemporaryFile("a+b") as said, tempfile.TemporaryFile("a+b") as log:
        process = _started(given, said, log)
        try:
            while (code := _ended(process)) is None:
                progress(_made(said), STEPS)
        except BaseException:
            _end(process)
            raise
        progress(STEPS, STEPS)
        answer = Answer.read(one.row, one.key, home)
        if answer is not None:
            return answer
        answer = Answer.failed(one.row, one.key, f"the process of the row {_how(code)}{_last_words(log)}")
        answer.write(home)
        return answer


def _started(arguments: list[str], said: Any, log: Any) -> subprocess.Popen[bytes]:
    apart: dict[str, Any] = {"start_new_session": True}  # Ctrl-C is for the command, which then ends its rows
    if os.name == "nt":
        apart = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    places = [str(_PACKAGE), *(str(Path(place).parent) for place in collections.places())]
    paths = dict.fromkeys([*places, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))])
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "navfmu.figures.worker", *arguments],
        stdin=subprocess.PIPE,
        stdout=said,
        stderr=log,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        **apart,
    )


def _ended(process: subprocess.Popen[bytes]) -> int | None:
    with suppress(subprocess.TimeoutExpired):
        return process.wait(_LOOK)
    return None


def _end(process: subprocess.Popen[bytes]) -> None:
    """End it, and what it has started."""
    with suppress(OSError):
        if os.name == "nt":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)  # it has a session of its own
    process.wait()


def _made(said: Any) -> int:
    """By the last line of progress that is complete: less than all, which is when the answer is there."""
    size = os.fstat(said.fileno()).st_size
    said.seek(max(0, size - 100))
    lines = said.read(size).split(b"\n")[:-1]
    try:
        done, total = map(float, lines[-1].split())
        return min(STEPS - 1, max(0, int(STEPS * done / total)))
    except (IndexError, ValueError, ZeroDivisionError):  # a row, or an FMU, may print what it likes
        return 0


def _how(code: int) -> str:
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        return f"crashed ({name})"
    return f"ended with exit code {code}"


def _last_words(log: Any) -> str:
    log.seek(max(0, os.fstat(log.fileno()).st_size - 4096))
    lines = [line for line in log.read().decode("utf-8", "replace").split("\n") if line.strip()]
    return f": {quoted(lines[-1])}" if lines else ""
