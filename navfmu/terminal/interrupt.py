"""Ctrl-C ends a command with one sentence and exit code 130, also while an FMU that never returns is being called."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from navfmu.errors import Interrupted

PATIENCE = 2.0  # s until a command that does not hear is ended from outside
LAST = 5.0  # s until one that has heard is


@contextmanager
def as_a_sentence() -> Iterator[None]:
    """What happens inside may be interrupted at any time."""
    try:
        with _watched():
            yield
    except KeyboardInterrupt:
        raise Interrupted("interrupted") from None


def _end(sentence: str) -> None:
    """End the process at once; what Python itself is printing may be half done."""
    os.write(2, f"navfmu: {sentence}\n".encode())
    os._exit(Interrupted.exit_code)


def _importing(frame: FrameType | None) -> bool:
    """Whether a module is being imported, which happens before anything is written."""
    while frame is not None and not frame.f_code.co_filename.startswith("<frozen importlib"):
        frame = frame.f_back
    return frame is not None


@contextmanager
def _watched() -> Iterator[None]:
    """Python hears a signal between two of its instructions: not before the call of an FMU returns. A thread does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, over = threading.Event(), threading.Event()
    reader, writer = os.pipe()
    os.set_blocking(writer, False)

    def hear(number: int, frame: FrameType | None) -> None:
        heard.set()
        if _importing(frame):  # which may drop an exception, or make another one of it
            _end("interrupted")
        raise KeyboardInterrupt

    def watch() -> None:
        with suppress(OSError):
            while data := os.read(reader, 1):
                if data[0] != signal.SIGINT:
                    continue
                heard.wait(PATIENCE)
                if not over.wait(LAST if heard.is_set() else 0.0):  # it may wait for threads that wait for an FMU
                    _end("interrupted while an FMU did not return")

    before = signal.signal(signal.SIGINT, hear)
    old = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(old)
        signal.signal(signal.SIGINT, before)
        os.close(writer)
