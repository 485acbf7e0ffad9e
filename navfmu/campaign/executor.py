"""Runs a campaign: what is missing is flown, everything is judged, the report is written.

Each run is kept in a file named by the hash of everything that determines it. A campaign that was interrupted, or
whose requirements changed, runs only what is missing; the files of 1 and of many jobs are the same, to the byte.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from navfmu.campaign.crew import Crew
from navfmu.campaign.definition import Campaign
from navfmu.campaign.flight import fly
from navfmu.campaign.outcome import Outcome, evaluate
from navfmu.campaign.runs import Answer, Run, runs_of
from navfmu.campaign.searching import Hand, Searching
from navfmu.campaign.threshold import sought_in
from navfmu.errors import Interrupted, NavfmuError, check_progress, nearest
from navfmu.files.writing import TEMPORARY
from navfmu.system.pool import Board, Report, in_threads
from navfmu.system.result import check_folder
from navfmu.system.results_folder import check_results

WORKERS = ("process", "thread")


def run_campaign(
    campaign: Campaign,
    folder: str | Path,
    jobs: int | None = None,
    progress: Report | None = None,
    *,
    workers: str = WORKERS[0],
    timeout: float | None = None,
    retry_failed: bool = False,
) -> Outcome:
    """Run what is missing, then judge everything and write the report into ``folder``.

    ``jobs`` runs at a time; in worker ``processes``, so that an FMU that crashes, exits or hangs ends its own run only,
    or in ``threads``. A run that takes longer than ``timeout`` (s, processes only) has failed. Runs that failed stay
    so, unless ``retry_failed``.
    """
    from navfmu.campaign.report import FILES, write_report

    if workers not in WORKERS:
        raise NavfmuError(f"unknown workers '{workers}'{nearest(workers, WORKERS)} (there are {' and '.join(WORKERS)})")
    check_progress(progress)
    if timeout is not None and not timeout > 0:
        raise NavfmuError(f"the timeout is {timeout:g} s, expected a positive number")
    if timeout is not None and workers == "thread":
        raise NavfmuError("a timeout needs worker processes: a thread that hangs cannot be ended")
    folder, runs = check_results(folder, "a campaign", *FILES), runs_of(campaign)
    check_folder(folder / "runs", *(file.name for run in runs for file in run.files(folder)))
    with _alone(folder):
        _tidy(folder)
        answers, mended = _kept(runs, folder)
        wanted = {run.key: run for run in reversed(runs)}  # cases that are alike share their runs
        missing = [
            run
            for run in runs
            if wanted[run.key] is run
            and (run.key not in answers or (retry_failed and answers[run.key].error is not None))
        ]
        board = Board(sum(run.steps for run in missing), progress, len(missing))
        searching = Searching(sought_in(campaign), folder, retry_failed, progress)
        try:
            with _hands(workers, timeout) as hand:
                for _ in in_threads(missing, lambda run: hand(run, folder, board.of(run.key, run.steps)), jobs, board):
                    pass
                thresholds = searching.found(hand, jobs)
        except KeyboardInterrupt:
            raise Interrupted(_interrupted(len(_kept(runs, folder)[0]), len(runs), searching, folder)) from None
        mended = (*mended, *searching.mended)
        outcome = evaluate(campaign, runs, _kept(runs, folder)[0], folder, mended, thresholds)
        write_report(outcome, folder, None if progress is None else lambda n, of: progress(n, of, "drawing the report"))
    return outcome


@contextlib.contextmanager
def _hands(workers: str, timeout: float | None) -> Iterator[Hand]:
    """Who flies a run."""
    if workers == "thread":
        yield fly
        return
    with Crew(timeout) as crew:
        yield crew.fly


def _interrupted(kept: int, of: int, searching: Searching, folder: Path) -> str:
    parts = [f"{kept} of {of} runs"] if of else []
    parts += [f"{len(searching.seen)} runs of searches"] if searching.sought else []
    return f"interrupted: {' and '.join(parts)} are finished and kept in {folder}; the same command continues"


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """One campaign at a time writes into a folder."""
    from filelock import FileLock, Timeout

    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / ".lock", timeout=0)
        lock.acquire()
    except Timeout:
        raise NavfmuError(f"{folder}: another campaign is writing into it; wait, or name another folder") from None
    except OSError as error:
        raise NavfmuError(f"{folder}: cannot be written: {error.strerror or error}") from None
    try:
        yield
    finally:
        lock.release()


def _tidy(folder: Path) -> None:
    """Remove what a killed campaign left half-written; nothing else in the folder is ours."""
    for place in (folder, folder / "runs"):
        for file in place.glob(f"{TEMPORARY}*"):
            file.unlink(missing_ok=True)


def _kept(runs: list[Run], folder: Path) -> tuple[dict[str, Answer], tuple[str, ...]]:
    """The answers that are kept, by key, and what is wrong with those that are damaged."""
    answers: dict[str, Answer] = {}
    damaged = []
    for run in runs:
        try:
            answer = Answer.read(run, folder)
        except NavfmuError as error:
            damaged.append(str(error))
            continue
        if answer is not None:
            answers[run.key] = answer
    return answers, tuple(damaged)
