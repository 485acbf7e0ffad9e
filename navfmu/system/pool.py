"""Many runs at a time: threads that each take the next one, one progress for all, and an end when the user wants it."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from threading import Lock
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import pandas

    from navfmu.system.experiment import Experiment

Report = Callable[[int, int, str], None]  # steps made, all steps, a note
Task = TypeVar("Task")
Answer = TypeVar("Answer")
Key = TypeVar("Key", bound=Hashable)


class Stopped(BaseException):
    """The user, or a run that failed, has stopped the others."""


class Board:
    """Progress of all runs together, counted in steps. ``stop`` ends them at their next report."""

    def __init__(self, total: int, report: Report | None, runs: int = 0) -> None:
        self.total, self.runs = total, runs
        self.stopped = False
        self._report, self._lock = report, Lock()
        self._made: dict[object, int] = {}
        self._finished = 0

    def of(self, task: object, steps: int) -> Callable[[int, int], None]:
        """What a run calls with the steps made and its steps."""

        def report(made: int, _: int) -> None:
            if self.stopped:
                raise Stopped
            with self._lock:
                self._finished += made >= steps > self._made.get(task, 0)
                self._made[task] = made
                if self._report is not None:
                    note = f"{self._finished} of {self.runs} runs" if self.runs else ""
                    self._report(sum(self._made.values()), self.total, note)

        return report

    def stop(self) -> None:
        """End the runs under way."""
        self.stopped = True


def in_threads(
    tasks: Iterable[Task], do: Callable[[Task], Answer], jobs: int | None, board: Board
) -> Iterator[tuple[Task, Answer]]:
    """Each task with its answer, in the order in which they finish.

    At most a few more are submitted than there are threads, so that memory does not grow with the tasks. Whatever ends
    the iteration early, an exception or Ctrl-C, stops the others first.
    """
    jobs = jobs or os.cpu_count() or 1
    waiting = iter(tasks)
    with ThreadPoolExecutor(jobs) as pool:
        active: dict[Future[Answer], Task] = {}
        try:
            while True:
                for task in islice(waiting, 2 * jobs - len(active)):
                    active[pool.submit(do, task)] = task
                if not active:
                    return
                for future in wait(active, return_when=FIRST_COMPLETED).done:
                    yield active.pop(future), future.result()
        except BaseException:
            board.stop()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def fly_all(
    runs: Mapping[Key, Experiment],
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    keep: Callable[[pandas.DataFrame], Answer] = lambda frame: frame,
) -> dict[Key, Answer]:
    """What is to be ``keep``-ed of the recording of each of these runs of one system, in their order.

    They run in threads, the longest first; the compiled loop leaves the interpreter free.
    """
    steps = {key: round(run.stop / run.step) for key, run in runs.items()}
    board = Board(sum(steps.values()), None if progress is None else lambda done, all_, _: progress(done, all_))
    system = next(iter(runs.values())).system
    if any(about.only_one_instance for about in system.descriptions.values()):
        jobs = 1  # one process, one instance
    order = sorted(runs, key=lambda key: -steps[key])
    kept = dict(in_threads(order, lambda key: keep(runs[key].run(board.of(key, steps[key]))), jobs, board))
    return {key: kept[key] for key in runs}
