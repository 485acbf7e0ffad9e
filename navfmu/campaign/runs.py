"""The single runs of a campaign: which there are, the experiment of each, and the files it leaves behind."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from navfmu.campaign.definition import Campaign, Case
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.system.experiment import Experiment
from navfmu.system.result import check


@dataclass(frozen=True)
class Run:
    """One run of a campaign."""

    variant: str
    case: Case
    experiment: Experiment
    key: str

    @property
    def seed(self) -> int:
        """The seed of the run."""
        return self.experiment.seed

    def file(self, folder: Path) -> Path:
        """Its recording."""
        return folder / "runs" / f"{self.key}.parquet"

    def failure(self, folder: Path) -> Path:
        """Why it has none."""
        return folder / "runs" / f"{self.key}.error.json"

    def partial(self, folder: Path) -> Path:
        """What was recorded before it failed."""
        return folder / "runs" / f"{self.key}.partial.parquet"

    def failed(self, folder: Path) -> dict[str, Any] | None:
        """Why it failed, or None; a damaged file is no answer."""
        try:
            about = json.loads(self.failure(folder).read_bytes())
        except (OSError, ValueError):
            return None
        fits = isinstance(about, dict) and about.get("key") == self.key and isinstance(about.get("error"), str)
        return about if fits else None

    def fail(self, folder: Path, about: Mapping[str, Any]) -> None:
        """Keep the reason: ``error``, and where it is known ``component``, ``call`` and ``time`` (s)."""
        head = {"key": self.key, "variant": self.variant, "case": self.case.name, "seed": self.seed}
        write_file(self.failure(folder), json.dumps(head | dict(about), indent=2) + "\n")

    def missing(self, folder: Path) -> str | None:
        """Why it has to be run: "" when there is nothing, or what is wrong with what there is; None if it is done."""
        if self.failed(folder) is not None:
            return None
        if self.file(folder).is_file():
            try:
                check(self.file(folder), self.key)
            except NavfmuError as error:
                return str(error)
            return None
        return f"{self.failure(folder)}: is damaged" if self.failure(folder).is_file() else ""


def runs_of(campaign: Campaign) -> list[Run]:
    """All runs, in the order of the file."""
    runs = []
    for variant in campaign.systems:
        for case in campaign.cases:
            common = experiment_of(campaign, variant, case)
            for seed in campaign.seeds:
                experiment = replace(common, seed=seed)
                runs.append(Run(variant, case, experiment, experiment.key))
    return runs


def experiment_of(campaign: Campaign, variant: str, case: Case) -> Experiment:
    """The experiment of a variant in a case, with the first seed."""
    return Experiment(
        campaign.systems[variant],
        stop=campaign.stop,
        step=campaign.step,
        algorithm=campaign.algorithm,
        seed=campaign.seeds[0],
        faults=case.faults,
        record=record_of(campaign, variant, case.name),
        record_period=_record_period(campaign),
        parameters=campaign.parameters | case.parameters,
    )


def record_of(campaign: Campaign, variant: str, case: str) -> list[str]:
    """The signals that are recorded in the runs of a variant in a case."""
    system = campaign.systems[variant]
    wanted = [r.signal for r in campaign.requirements if r.applies(variant, case)]
    wanted += system.signals(campaign.record) if campaign.record else []
    wanted += system.report.signals(system.fmus) if system.report else []
    return list(dict.fromkeys(wanted)) or system.signals()


def _record_period(campaign: Campaign) -> float | None:
    """That of the file, or 1 s where it fits the step and the run is longer than 100 s."""
    if campaign.record_period is not None:
        return campaign.record_period
    count = round(1.0 / campaign.step) if campaign.step > 0 else 0
    fits = count >= 1 and math.isclose(count * campaign.step, 1.0, rel_tol=1e-9)
    return 1.0 if fits and campaign.stop >= 100.0 else None
