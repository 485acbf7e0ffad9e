"""The single runs of a campaign: which there are, the plan of each, its file, and the command that repeats it."""

from __future__ import annotations

import hashlib
import json
import math
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.campaign.definition import Campaign, Case
from navfmu.campaign.requirement import MAIN
from navfmu.engine.library import source_hash
from navfmu.engine.plan import Plan
from navfmu.system.system import describe_fault

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
    stop, step = (f"{float(value)!r}".removesuffix(".0") for value in (campaign.stop, campaign.step))
    words += ["--stop", stop, "--step", step, "--algorithm", campaign.algorithm]
    return shlex.join([*words, "--seed", str(run.seed)])


def _keys(campaign: Campaign, variant: str, case: Case) -> list[tuple[int, str]]:
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
