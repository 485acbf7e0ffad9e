"""The worker processes of a campaign. An FMU that crashes, exits or hangs ends its worker and its own run, no more."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any

from navfmu.campaign.flight import fail
from navfmu.campaign.runs import Run
from navfmu.engine.blackbox import BlackBox, steps_made
from navfmu.errors import NavfmuError, quoted

Progress = Callable[[int, int], None]
_PACKAGE = Path(__file__).resolve().parents[2]
_LOOK = 0.1  # s between looks at a run under way
_CHANCES = 3  # workers that may go before a run begins
_LAST = 2.0  # s that a process has to end after its last word


class _Gone(Exception):
    """A worker ended before it began with a run."""


class Crew:
    """Workers, started when they are needed and used again; to be called from several threads."""

    def __init__(self, timeout: float | None = None) -> None:
        self._timeout = timeout
        with _writing("the folder for temporary files"):
            self._folder = tempfile.TemporaryDirectory(prefix="navfmu-campaign-", ignore_cleanup_errors=True)
        self._idle: SimpleQueue[Worker] = SimpleQueue()

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        while not self._idle.empty():
            self._idle.get().end()
        self._folder.cleanup()

    def fly(self, run: Run, folder: Path, progress: Progress) -> None:
        """Have the run flown; whatever becomes of it is kept in the folder."""
        for chances in range(_CHANCES, 0, -1):
            worker = self._worker()
            try:
                worker.fly(run, folder, progress, self._timeout)
            except _Gone as gone:  # before the run began, so the run is not to blame
                if chances == 1:
                    raise NavfmuError(f"worker processes do not stay: the last one {gone}") from None
                continue
            except BaseException:
                worker.end()
                raise
            if worker.alive:
                self._idle.put(worker)
            return

    def _worker(self) -> Worker:
        """One that is idle and still there, or a new one."""
        with suppress(Empty):
            while True:
                worker = self._idle.get_nowait()
                if worker.alive:
                    return worker
        with _writing(self._folder.name):
            return Worker(Path(tempfile.mkdtemp(prefix="worker-", dir=self._folder.name)))


@contextmanager
def _writing(place: str) -> Iterator[None]:
    """While something is written that is needed only for now."""
    try:
        yield
    except OSError as error:
        raise NavfmuError(
            f"{place}: cannot be written: {error.strerror or error}; set TMPDIR to a folder that can"
        ) from None


class Worker:
    """One worker process."""

    def __init__(self, folder: Path) -> None:
        self._box, self._log = folder / "box", folder / "log"
        apart: dict[str, Any] = {"start_new_session": True}  # Ctrl-C is for the campaign, which then ends its workers
        if os.name == "nt":
            apart = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
        paths = [str(_PACKAGE), os.environ.get("PYTHONPATH", "")]
        with open(self._log, "wb") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "navfmu.campaign.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                encoding="utf-8",
                env=os.environ | {"PYTHONPATH": os.pathsep.join(path for path in paths if path)},
                **apart,
            )
        self._answers: SimpleQueue[dict[str, Any] | None] = SimpleQueue()
        Thread(target=self._listen, daemon=True).start()
        self._ready = False
        self._said = 0  # bytes printed before this run

    @property
    def alive(self) -> bool:
        """Whether it can fly another run."""
        return self._process.poll() is None

    def end(self) -> None:
        """End it, whatever it does, and with it what its FMUs have started."""
        with suppress(OSError):
            if os.name == "nt":
                self._process.kill()
            else:
                os.killpg(self._process.pid, signal.SIGKILL)  # it has a session of its own
        self._process.wait()

    def fly(self, run: Run, folder: Path, progress: Progress, timeout: float | None) -> None:
        """Have it fly a run, and keep the reason where it does not come back."""
        while not self._ready:  # imports take a moment
            answer = self._answer(None, lambda: progress(0, 1))
            if answer is None:
                raise NavfmuError(f"a worker process could not start: {self._last_words() or self._ending()}")
            self._ready = "ready" in answer
        self._box.unlink(missing_ok=True)
        self._said = self._log.stat().st_size  # what was printed before is of another run
        about = {"experiment": run.experiment.describe(), "variant": run.variant, "case": run.case.name, "key": run.key}
        self._send(about | {"folder": str(folder.resolve()), "box": str(self._box), "cwd": os.getcwd()})
        steps = round(run.experiment.stop / run.experiment.step)

        def look() -> None:
            progress(min(steps_made(self._box), steps - 1), steps)  # the last one counts when the recording is written

        end, answer = None, {"sent": True}
        try:
            while answer is not None and not answer.keys() & {"done", "refused", "broken"}:
                answer = self._answer(end, look)
                if answer is not None:  # the time that its FMUs take, and not that of loading and writing
                    end = time.monotonic() + timeout if timeout is not None and "begun" in answer else None
        except TimeoutError:
            self.end()
            return self._lost(run, folder, f"took longer than the timeout of {timeout:g} s")
        if answer is None:
            how = self._ending()
            self.end()
            if not self._box.is_file():
                raise _Gone(how)
            return self._lost(run, folder, how)
        if "refused" in answer:
            raise NavfmuError(answer["refused"])
        if "broken" in answer:
            raise RuntimeError(f"a worker process failed:\n{answer['broken']}")
        if answer.get("last"):
            self.end()
        return progress(steps, steps)

    def _answer(self, end: float | None, look: Callable[[], None]) -> dict[str, Any] | None:
        """The next message; None when the process has ended."""
        while True:
            look()
            try:
                return self._answers.get(timeout=_LOOK)
            except Empty:
                if end is not None and time.monotonic() > end:
                    raise TimeoutError from None
                if self._process.poll() is not None:  # a process that its FMU has started may keep the line open
                    with suppress(Empty):
                        return self._answers.get(timeout=_LOOK)
                    return None

    def _listen(self) -> None:
        for line in self._process.stdout:
            self._answers.put(json.loads(line))
        self._answers.put(None)

    def _send(self, message: dict[str, Any]) -> None:
        with suppress(OSError):  # it has ended: there will be no answer, which tells why
            self._process.stdin.write(json.dumps(message) + "\n")
            self._process.stdin.flush()

    def _ending(self) -> str:
        """How the process ended, in words."""
        try:
            code = self._process.wait(_LAST)
        except subprocess.TimeoutExpired:
            return "cut the line to its campaign"
        if code < 0:
            name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
            more = {"SIGSEGV": ", a wrong access to memory", "SIGKILL": ", perhaps for lack of memory"}.get(name, "")
            return f"crashed ({name}{more})"
        if code > 0xFF:
            return f"crashed (exception {code:#010x})"
        return f"ended the process with exit code {code}"

    def _lost(self, run: Run, folder: Path, what: str) -> None:
        """Keep why a run did not come back, and the rows that it left."""
        error, place, recording = f"the run {what}", {}, None
        if self._box.is_file():
            with BlackBox.open(self._box, run.experiment.plan()) as box:
                said = box.said() or self._last_words()
                error = f"{box.whereabouts()}: the run {what}" + (f": {said}" if said else "")
                place, recording = box.culprit(), box.recording()
        fail(run, folder, error, place, recording)

    def _last_words(self) -> str:
        """The last line that the process, or an FMU in it, has printed."""
        with open(self._log, "rb") as log:
            log.seek(max(self._said, self._log.stat().st_size - 4096))
            lines = log.read().decode("utf-8", "replace").split("\n")
        return next((quoted(line) for line in reversed(lines) if line.strip()), "")
