"""The runs of one test: what is told of them, and what is kept, when it fails."""

from __future__ import annotations

import hashlib
import re
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

from navfmu.files.writing import write_file
from navfmu.system.result import write
from navfmu.testing.flown import Flown

KEPT = 3  # runs of a test whose recordings are held until it ends


class Logbook:
    """The last runs of a test."""

    def __init__(self, folder: Callable[[], Path], test: str) -> None:
        self.failed = False
        self.flown = 0
        self._folder, self._test = folder, test
        self._runs: deque[Flown] = deque(maxlen=KEPT)

    def enter(self, flown: Flown) -> None:
        """A run has been made."""
        self.flown += 1
        self._runs.append(flown)

    def clear(self) -> None:
        """The test is over: recordings take memory."""
        self._runs.clear()

    def keep(self, run: Flown, signals: Sequence[str] = ()) -> None:
        """Write plot and recording of a run, once; ``signals`` are drawn first. What cannot be written is said."""
        if run.files or run.frame is None or not len(run.frame):
            return
        folder = self._folder() / path_of(self._test)
        more = "" if run.number == 1 else f"-{run.number}"
        try:
            from navfmu.testing.plot import plot

            recording = write(run.frame, folder / f"recording{more}.parquet")
            run.files.append(("recording", str(recording)))
            picture = write_file(folder / f"plot{more}.png", plot(run, signals))
            run.files.insert(0, ("plot", str(picture)))
        except Exception as error:  # whatever it is: the test's own failure must be seen
            run.files.append(("not kept", " ".join(f"{type(error).__name__}: {error}".split())))

    def story(self, texts: Sequence[str]) -> str:
        """What a failed test says of its last runs; ``texts`` stand in its code, and may be names of signals."""
        parts = []
        if self.flown > len(self._runs):
            parts.append(f"The last {len(self._runs)} of {self.flown} runs:")
        for run in self._runs:
            columns = () if run.frame is None else run.frame.columns
            self.keep(run, [text for text in dict.fromkeys(texts) if text in columns])
            parts.append("\n".join(f"{word:<10} {text}" for word, text in run.told()))
        return "\n\n".join(parts)


def path_of(test: str) -> Path:
    """The folder of a test in that of the artefacts: "tests/test_gps.py/test_gps-seed7".

    Whatever else stands in a test's name than letters and digits is replaced, and its hash tells it from others.
    """
    names, bracket, parameters = test.partition("[")
    file, *classes, name = names.split("::")
    parts = [*file.split("/"), *classes, name + bracket + parameters]
    return Path(*(_word(part) for part in parts if part not in ("", ".", "..")))


def _word(part: str) -> str:
    plain = re.fullmatch(r"([\w.+-]{1,60})(?:\[([\w.+-]{1,60})\])?", part)
    if plain and part.isascii():
        return "-".join(filter(None, plain.groups()))
    return f"{re.sub(r'[^a-zA-Z0-9_.+-]+', '-', part)[:80]}-{hashlib.sha256(part.encode()).hexdigest()[:6]}"
