"""Runs a campaign in threads: the compiled loop leaves the interpreter free, so each core gets its run.

Each run is kept in a file named by the hash of everything that determines it. A campaign that was interrupted, or
whose requirements changed, runs only what is missing; the files of 1 and of many jobs are the same, to the byte.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from pathlib import Path
from threading import Lock

from navfmu.campaign.definition import Campaign
from navfmu.campaign.outcome import Outcome, evaluate
from navfmu.campaign.runs import Run, command_of, plan_of, runs_of
from navfmu.engine.recording import RunError
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.system import result

Report = Callable[[int, int, str], None]  # steps made, all steps, a note


def run_campaign(
    campaign: Campaign, folder: str | Path, jobs: int | None = None, progress: Report | None = None
) -> Outcome:
    """Run what is missing, then judge everything and write the report into ``folder``."""
    from navfmu.campaign.report import write_report

    folder = Path(folder)
    runs = runs_of(campaign)
    missing = [run for run in runs if not run.done(folder)]
    board = _Board(campaign, len(missing), progress)
    try:
        _execute(campaign, missing, folder, jobs or os.cpu_count() or 1, board)
    except KeyboardInterrupt:
        kept = sum(run.done(folder) for run in runs)
        raise Interrupted(
            f"interrupted: {kept} of {len(runs)} runs are finished and kept in {folder}; the same command continues"
        ) from None
    outcome = evaluate(campaign, runs, folder)
    write_report(outcome, folder, None if progress is None else lambda n, of: progress(n, of, "drawing the report"))
    return outcome


class Interrupted(NavfmuError):
    """The user stopped a campaign."""

    exit_code = 130  # as shells have it for Ctrl-C


def _execute(campaign: Campaign, missing: list[Run], folder: Path, jobs: int, board: _Board) -> None:
    """Run in threads, a few more submitted than there are threads, so that memory does not grow with the runs."""
    waiting = iter(missing)
    with ThreadPoolExecutor(jobs) as pool:
        active: set[Future] = set()
        try:
            while True:
                for run in islice(waiting, 2 * jobs - len(active)):
                    active.add(pool.submit(_one, campaign, run, folder, board))
                if not active:
                    return
                finished, active = wait(active, return_when=FIRST_COMPLETED)
                for future in finished:
                    future.result()
        except BaseException:
            board.stopped = True
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _one(campaign: Campaign, run: Run, folder: Path, board: _Board) -> None:
    """One run; an FMU's refusal is kept as its result."""
    system = campaign.systems[run.variant]
    parameters = campaign.parameters | run.case.parameters
    try:
        plan = plan_of(campaign, run.variant, run.case, run.seed)
        frame = system.execute(plan, run.seed, parameters, run.case.faults, progress=board.of(run.key))
    except RunError as error:
        about = {"variant": run.variant, "case": run.case.name, "seed": run.seed, "error": str(error)}
        write_file(run.failure(folder), json.dumps(about, indent=2) + "\n")
    else:
        frame.attrs["provenance"]["command"] = command_of(campaign, run)
        result.write(frame, run.file(folder))
    board.finished(run.key)


class _Board:
    """Progress of all runs together."""

    def __init__(self, campaign: Campaign, runs: int, progress: Report | None) -> None:
        self.steps = round(campaign.stop / campaign.step)
        self.runs, self.progress, self.lock = runs, progress, Lock()
        self.active: dict[str, int] = {}
        self.done = 0
        self.stopped = False

    def of(self, key: str) -> Callable[[int, int], None]:
        def report(steps: int, _: int) -> None:
            if self.stopped:
                raise KeyboardInterrupt
            with self.lock:
                self.active[key] = steps
                self._show()

        return report

    def finished(self, key: str) -> None:
        with self.lock:
            self.active.pop(key, None)
            self.done += 1
            self._show()

    def _show(self) -> None:
        if self.progress is not None:
            made = self.done * self.steps + sum(self.active.values())
            self.progress(made, self.runs * self.steps, f"{self.done} of {self.runs} runs")
