"""What a reader of verdicts must know of the campaign itself, beside what its runs have noted."""

from __future__ import annotations

from dataclasses import replace

from navfmu.campaign.definition import Campaign
from navfmu.campaign.runs import Run
from navfmu.system.experiment import Experiment

SAME = "the seed changes nothing: no component takes it and no fault is random; all seeds are one run"


def remarks(campaign: Campaign, runs: list[Run]) -> list[tuple[str, ...]]:
    """For each run the sentences that concern it."""
    matters: dict[tuple[str, str], bool] = {}
    found = []
    for run in runs:
        group = run.variant, run.case.name
        if group not in matters:
            matters[group] = seeds_matter(run.experiment, campaign.seeds)
        late = _judged_no_further(campaign, run, float(run.experiment.points[-1]))
        found.append((*(() if matters[group] else (SAME,)), *((late,) if late else ())))
    return found


def seeds_matter(experiment: Experiment, seeds: tuple[int, ...]) -> bool:
    """Whether runs with these seeds can differ."""
    if len(seeds) < 2 or any(fault.is_random for fault in experiment.faults):
        return True
    first, second = (replace(experiment, seed=seed).start_values() for seed in seeds[:2])
    return first != second


def _judged_no_further(campaign: Campaign, run: Run, last: float) -> str:
    """A sentence on quantiles that ask of the time after the last recorded point (s), or ""."""
    asked = [r for r in campaign.requirements if r.quantile is not None and r.applies(run.variant, run.case)]
    beyond = [r.id for r in asked if min(r.end, campaign.stop) > last * (1.0 + 1e-12)]
    if not beyond:
        return ""
    return (
        f"{', '.join(beyond)}: judged up to t = {last:.9g} s only, the last recorded point before the end at "
        f"{campaign.stop:.9g} s (the recording period is {run.experiment.record_period:.9g} s)"
    )
