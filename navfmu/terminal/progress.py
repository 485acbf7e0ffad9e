"""Progress on the standard error stream, shown only when something takes longer than two seconds."""

from __future__ import annotations

import sys
import time
from typing import Any

PATIENCE = 2.0  # s


class Progress:
    """A bar that appears when it is needed; call it with what is done and what there is to do."""

    def __init__(self, what: str) -> None:
        self.what = what
        self._started = time.monotonic()
        self._bar: Any = None
        self._task: Any = None
        self._last_line = self._phase = self._started
        self._done = 0

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, done: int, total: int, note: str = "") -> None:
        """Show that ``done`` of ``total`` is finished."""
        now = time.monotonic()
        if done < self._done:  # something else has begun
            self._phase = now
            if self._bar is not None:
                self._bar.reset(self._task, total=total)
        self._done = done
        if now - self._started < PATIENCE:
            return
        if not sys.stderr.isatty():
            self._line(done, total, note, now)
            return
        if self._bar is None:
            self._start()
        self._bar.update(self._task, completed=done, total=total, note=note)

    def _start(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        columns = ("{task.description}", BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        self._bar = Progress(*columns, TextColumn("{task.fields[note]}"), console=Console(stderr=True), transient=True)
        self._task = self._bar.add_task(self.what, total=None, note="")
        self._bar.start()

    def _line(self, done: int, total: int, note: str, now: float) -> None:
        """Without a terminal: one line every five seconds."""
        if now - self._last_line < 5.0:
            return
        self._last_line = now
        remaining = (now - self._phase) * (total - done) / done if done else 0.0
        rest = f", about {remaining:.0f} s left" if done else ""
        tail = f", {note}" if note else ""
        print(f"{self.what}: {100.0 * done / total:.0f} %{rest}{tail}", file=sys.stderr, flush=True)
