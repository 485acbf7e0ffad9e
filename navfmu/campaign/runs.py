"""The single runs of a campaign: which there are, the experiment of each, and the files it leaves behind."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.definition import Campaign
from navfmu.errors import NavfmuError
from navfmu.files.digest import content_hash
from navfmu.files.reading import read_bytes, what_is
from navfmu.system.experiment import Experiment


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

    @property
    def steps(self) -> int:
        """How many macro steps it takes."""
        return round(self.experiment.stop / self.experiment.step)

    def recording(self, folder: Path, whole: bool = True) -> Path:
        """The file of its recording, or of what was recorded before it failed."""
        return folder / "runs" / f"{self.key}{'' if whole else '.partial'}.parquet"

    def answer(self, folder: Path) -> Path:
        """The file that says how it ended; it is written last."""
        return folder / "runs" / f"{self.key}.json"

    def files(self, folder: Path) -> tuple[Path, ...]:
        """All that it may leave behind."""
        return self.answer(folder), self.recording(folder), self.recording(folder, whole=False)


@dataclass(frozen=True)
class Answer:
    """How a run ended, as kept in ``runs/KEY.json``."""

    key: str
    variant: str
    case: str
    seed: int
    error: str | None  # why it failed
    place: dict[str, str | float]  # and where it is known: component, call, time (s)
    recording: str | None  # name of the file
    sha256: str | None  # of the recording
    notes: tuple[str, ...]
    not_finite: dict[str, int]  # signal -> recorded points at which it is NaN or infinite
    idle: dict[str, str]  # faults that changed nothing, and why
    acted: dict[str, list[list[float]]]  # from when to when each fault acted (s)
    observed: dict[str, dict[str, Any]]  # what was seen of each requirement (engine.monitor.Observed)

    def text(self) -> str:
        """The content of its file, which ends with a hash of the rest."""
        content = asdict(self)
        return json.dumps(content | {"hash": _hash(content)}, indent=2) + "\n"

    @classmethod
    def read(cls, run: Run, folder: Path) -> Answer | None:
        """The answer that is kept for a run; None if there is none. What is damaged is a ``NavfmuError``."""
        file = run.answer(folder)
        if what_is(file) is None:
            return None
        text = read_bytes(file, "the answer of a run").decode("utf-8", "replace")
        try:
            content = json.loads(text)
            content.pop("hash")
            answer = cls(**content | {"notes": tuple(content["notes"])})
        except (ValueError, KeyError, TypeError, AttributeError):
            answer = None
        if answer is None or answer.text() != text:
            raise NavfmuError(f"{file}: is damaged: it is not what was written")
        if answer.key != run.key:
            raise NavfmuError(f"{file}: is the answer of another run, {answer.variant}, {answer.case}, {answer.seed}")
        if answer.recording is not None:
            kept = file.with_name(answer.recording)
            if content_hash(kept, "a recording") != answer.sha256:
                raise NavfmuError(f"{kept}: is damaged, or the recording of another run")
        return answer


def _hash(content: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def runs_of(campaign: Campaign) -> list[Run]:
    """All runs but those of searches, in the order of the file."""
    return [
        run
        for variant in campaign.systems
        for case in campaign.cases
        for run in runs_with(campaign, variant, case, campaign.seeds)
    ]


def runs_with(campaign: Campaign, variant: str, case: Case, seeds: Sequence[int]) -> Iterator[Run]:
    """The runs of a variant in a case with these seeds."""
    common = experiment_of(campaign, variant, case)
    for seed in seeds:
        experiment = replace(common, seed=seed)
        yield Run(variant, case, experiment, experiment.key)


def experiment_of(campaign: Campaign, variant: str, case: Case) -> Experiment:
    """The experiment of a variant in a case, with the first seed."""
    step = campaign.step if case.step is None else case.step
    return Experiment(
        campaign.systems[variant],
        stop=campaign.stop,
        step=step,
        algorithm=campaign.algorithm,
        seed=campaign.seeds[0],
        faults=case.faults,
        record=record_of(campaign, variant, case),
        record_period=_record_period(campaign, step),
        parameters=_laid_over(campaign.parameters, case.parameters),
        monitors=[r.monitor for r in campaign.requirements if r.applies(variant, case)],
    )


def _laid_over(common: dict[str, Any], special: dict[str, Any]) -> dict[str, Any]:
    """The parameters of a case come last: they win, also over elements of an array."""
    return {name: value for name, value in common.items() if name not in special} | special


def record_of(campaign: Campaign, variant: str, case: Case) -> list[str]:
    """The signals that are recorded in the runs of a variant in a case."""
    system = campaign.systems[variant]
    asked = [r for r in campaign.requirements if r.applies(variant, case)]
    wanted = [signal for requirement in asked for signal in requirement.signals]
    wanted += system.signals(campaign.record) if campaign.record else []
    wanted += system.report.signals(system.fmus) if system.report else []
    return list(dict.fromkeys(wanted)) or system.signals()


def _record_period(campaign: Campaign, step: float) -> float | None:
    """That of the file, or 1 s where it fits the step and the run is longer than 100 s."""
    if campaign.record_period is not None:
        return campaign.record_period
    count = round(1.0 / step) if step > 0 else 0
    fits = count >= 1 and math.isclose(count * step, 1.0, rel_tol=1e-9)
    return 1.0 if fits and campaign.stop >= 100.0 else None
