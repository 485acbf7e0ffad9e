"""Runs a campaign in threads: the compiled loop leaves the interpreter free, so each core gets its run.

Each run is kept in a file named by the hash of everything that determines it. A campaign that was interrupted, or
whose requirements changed, runs only what is missing; the files of 1 and of many jobs are the same, to the byte.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import shlex
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from threading import Lock
from typing import Any

from navfmu import results
from navfmu.campaign.file import Campaign, Case
from navfmu.campaign.outcome import Outcome, evaluate
from navfmu.campaign.requirement import MAIN
from navfmu.engine.plan import Plan
from navfmu.engine.recording import RunError
from navfmu.errors import NavfmuError
from navfmu.files import write_file
from navfmu.system import describe_fault

FORMAT = 1  # of the kept runs; raise it when their content changes
REPORT_SIGNALS = (  # recorded where the system has them, for the pictures of the report
    "aircraft.latitude",
    "aircraft.longitude",
    "navigator.solution.latitude",
    "navigator.solution.longitude",
    "evaluation.horizontal_error",
    "evaluation.north_error",
    "evaluation.east_error",
    "navigator.north_sigma",
    "navigator.east_sigma",
    "navigator.mode",
    "gps.fix.valid",
)
Report = Callable[[int, int, str], None]  # steps made, all steps, a note


@dataclass(frozen=True)
class Run:
    """One run of a campaign."""

    variant: str
    case: Case
    seed: int
    key: str

    def file(self, folder: Path) -> Path:
        """Its recording."""
        return folder / "runs" / f"{self.key}.parquet"

    def failure(self, folder: Path) -> Path:
        """Why it has none."""
        return folder / "runs" / f"{self.key}.error.json"

    def done(self, folder: Path) -> bool:
        """Whether it need not be run again."""
        return self.file(folder).is_file() or self.failure(folder).is_file()


def runs_of(campaign: Campaign) -> list[Run]:
    """All runs, in the order of the file."""
    return [
        Run(variant, case, seed, key)
        for variant in campaign.systems
        for case in campaign.cases
        for seed, key in _keys(campaign, variant, case)
    ]


def record_of(campaign: Campaign, variant: str) -> list[str]:
    """The signals that are recorded in the runs of a variant."""
    system = campaign.systems[variant]
    wanted = [requirement.signal for requirement in campaign.requirements]
    wanted += system.signals(campaign.record) if campaign.record else []
    for name in REPORT_SIGNALS:
        component, _, variable = name.partition(".")
        if component in system.fmus and variable in system.fmus[component].description.by_name:
            wanted.append(name)
    return list(dict.fromkeys(wanted)) or system.signals()


def plan_of(campaign: Campaign, variant: str, case: Case, seed: int) -> Plan:
    """The plan of one run."""
    return campaign.systems[variant].plan(
        stop=campaign.stop,
        step=campaign.step,
        algorithm=campaign.algorithm,
        seed=seed,
        faults=case.faults,
        record=record_of(campaign, variant),
        record_period=_record_period(campaign),
        parameters=campaign.parameters | case.parameters,
    )


def command_of(campaign: Campaign, run: Run) -> str:
    """The command that repeats one run."""
    words = ["navfmu", "run", str(campaign.system)]
    if run.variant != MAIN:
        words += ["--variant", run.variant]
    for name, value in (campaign.parameters | run.case.parameters).items():
        words += ["--set", f"{name}={value}"]
    for file in run.case.files:
        words += ["--faults", file]
    words += ["--stop", f"{campaign.stop:g}", "--step", f"{campaign.step:g}", "--algorithm", campaign.algorithm]
    return shlex.join([*words, "--seed", str(run.seed)])


def run_campaign(
    campaign: Campaign, folder: str | Path, jobs: int | None = None, progress: Report | None = None
) -> Outcome:
    """Run what is missing, then judge everything and write the report into ``folder``."""
    from navfmu.report.campaign import write_report

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
        results.write(frame, run.file(folder))
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


def _keys(campaign: Campaign, variant: str, case: Case) -> list[tuple[int, str]]:
    from navfmu.engine.library import source_hash

    common: dict[str, Any] = {
        "format": FORMAT,
        "engine": source_hash(),
        "system": campaign.systems[variant].digest,
        "stop": float(campaign.stop),
        "step": float(campaign.step),
        "algorithm": campaign.algorithm,
        "parameters": {name: str(value) for name, value in (campaign.parameters | case.parameters).items()},
        "faults": [describe_fault(fault) for fault in case.faults],
        "record": record_of(campaign, variant),
        "record_period": _record_period(campaign),
    }
    return [
        (seed, hashlib.sha256(json.dumps(common | {"seed": seed}, sort_keys=True).encode()).hexdigest()[:32])
        for seed in campaign.seeds
    ]


def _record_period(campaign: Campaign) -> float | None:
    """That of the file, or 1 s where it fits the step and the run is longer than 100 s."""
    if campaign.record_period is not None:
        return campaign.record_period
    count = round(1.0 / campaign.step) if campaign.step > 0 else 0
    fits = count >= 1 and math.isclose(count * campaign.step, 1.0, rel_tol=1e-9)
    return 1.0 if fits and campaign.stop >= 100.0 else None
