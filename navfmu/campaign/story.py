"""A judged campaign as plain data: the only thing that its report is told from.

Texts, numbers, lists and tables that JSON can hold; what is no number is None. Runs, cases and requirements are named
by their places in their lists.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.definition import Campaign
from navfmu.campaign.drawn import Drawn
from navfmu.campaign.finding import Finding, percent
from navfmu.campaign.judged import Judged
from navfmu.campaign.outcome import Cell, Outcome
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.search import Search
from navfmu.campaign.seeds import seeds_text
from navfmu.report import faults

Story = dict[str, Any]
Draw = Callable[[Sequence[int]], list[Drawn]]  # the runs in the order in which they matter -> each run


def story(outcome: Outcome, draw: Draw) -> Story:
    """What is to be told; ``draw`` makes the pictures of the single runs."""
    campaign = outcome.campaign
    numbers = {id(judged): number for number, judged in enumerate(outcome.every)}
    notes = outcome.notes
    groups = _groups(outcome, numbers)
    order = worst_first(groups, len(outcome.every))
    pictures = draw(order)
    return {
        "name": campaign.name,
        "description": campaign.description,
        "variants": list(campaign.systems),
        "components": {variant: list(system.fmus) for variant, system in campaign.systems.items()},
        "seeds": seeds_text(campaign.seeds),
        "stop": campaign.stop,
        "steps": list(campaign.steps),
        "algorithm": campaign.algorithm,
        "axes": [axis.heading for axis in campaign.axes],
        "requirements": [_requirement(requirement) for requirement in campaign.requirements],
        "cases": [_case(campaign, case) for case in campaign.cases],
        "searched": [_searched(campaign, search) for search in _once(campaign.searches)],
        "groups": groups,
        "order": order,
        "notes": [[sentence, count] for sentence, count in notes.items()],
        "remarks": list(outcome.remarks),
        "idle": [[*where, seeds_text(seeds), why] for (*where, why), seeds in outcome.idle.items()],
        "thresholds": [_plain(threshold.row()) for threshold in outcome.thresholds],
        "passed": outcome.passed,
        "runs": [
            _run(outcome, judged, picture, list(notes)) for judged, picture in zip(outcome.every, pictures, strict=True)
        ],
        "noticing": sorted(
            {notice.label for system in campaign.systems.values() if system.report for notice in system.report.notices}
        ),
    }


def worst_first(groups: Sequence[Mapping[str, Any]], count: int) -> list[int]:
    """All runs: the worst of each violated cell, the worst of every other one, then the runs of violated cells."""
    cells = sorted((cell for group in groups for cell in group["cells"] if cell), key=lambda cell: cell["rank"])
    order = [cell["worst"] for cell in cells if cell["worst"] is not None]
    bad = sorted(groups, key=lambda group: min((cell["rank"] for cell in group["cells"] if cell), default=[2]))
    order += [run for group in bad for run in group["runs"]]
    return list(dict.fromkeys([*order, *range(count)]))


def _groups(outcome: Outcome, numbers: Mapping[int, int]) -> list[dict[str, Any]]:
    """Each variant in each case: its runs, and a cell or None for each requirement."""
    campaign = outcome.campaign
    cells = {(cell.variant, cell.case, cell.requirement.id): cell for cell in outcome.cells}
    return [
        {
            "variant": variant,
            "case": number,
            "runs": [numbers[id(judged)] for judged in outcome.of(variant, case.name)],
            "cells": [
                _cell(cells.get((variant, case.name, requirement.id)), numbers) for requirement in campaign.requirements
            ],
        }
        for variant in campaign.systems
        for number, case in enumerate(campaign.cases)
    ]


def _cell(cell: Cell | None, numbers: Mapping[int, int]) -> dict[str, Any] | None:
    if cell is None:
        return None
    return {
        "passed": cell.passed,
        "verdict": cell.verdict,
        "held": cell.held,
        "total": cell.total,
        "distinct": cell.distinct,
        "interval": None if cell.requirement.quantile is not None else list(cell.interval),
        "sentence": cell.sentence,
        "worst": None if cell.worst is None else numbers[id(cell.worst)],
        "rank": [float(part) for part in cell.rank],
    }


def _requirement(requirement: Requirement) -> dict[str, Any]:
    return {
        "id": requirement.id,
        "severity": requirement.severity,
        "sentence": requirement.sentence,
        "description": requirement.description,
        "signal": requirement.signal,
        "quantity": list(requirement.question.quantity(requirement)),
        "unit": requirement.unit,
        "runs": requirement.runs,
        "quantile": requirement.quantile,
        "bounds": [requirement.least, requirement.most],
    }


def _case(campaign: Campaign, case: Case) -> dict[str, Any]:
    values = ", ".join(f"{name} = {value}" for name, value in case.parameters.items())
    changed = [f"parameters: {values}"] if values else []
    changed += [] if case.step is None else [f"step: {case.step:g} s"]
    return {
        "name": case.name,
        "written": case.written,
        "description": case.description,
        "values": list(campaign.columns(case).values()),
        "changed": ", ".join(changed),
        "faults": [_fault(fault.describe()) for fault in case.faults],
    }


def _searched(campaign: Campaign, search: Search) -> dict[str, Any]:
    """A case that is searched, and its faults at the ends of the search."""
    case = _case(campaign, search.case)
    ends = [fault for end in (search.span.low, search.span.high) for fault in search.at(end).faults]
    return case | {
        "changed": ", ".join(filter(None, [case["changed"], search.sentence])),
        "ends": [_fault(fault.describe()) for fault in ends],
    }


def _once(searches: Sequence[Search]) -> list[Search]:
    """One search of each case."""
    return list({search.case.name: search for search in searches}.values())


def _fault(fault: dict[str, Any]) -> dict[str, Any]:
    targets = [fault["target"]] if isinstance(fault["target"], str) else fault["target"]
    return {
        "id": fault["id"],
        "fmea": fault.get("fmea", ""),
        "description": fault.get("description", ""),
        "components": list(dict.fromkeys(target.partition(".")[0] for target in targets)),
        "start": fault["start"],
        "cells": faults.cells(fault),
    }


def _run(outcome: Outcome, judged: Judged, picture: Drawn, notes: list[str]) -> dict[str, Any]:
    places = {sentence: number for number, sentence in enumerate(notes)}
    campaign, case = outcome.campaign, judged.run.case
    return {
        "variant": judged.run.variant,
        "case": case.name,
        "values": list(campaign.columns(case).values()),
        "seed": judged.run.seed,
        "error": judged.error,
        "findings": [
            _finding(requirement, judged, judged.findings.get(requirement.id)) for requirement in campaign.requirements
        ],
        "notes": [places[note] for note in judged.notes],
        "idle": dict(judged.answer.idle),
        "not_finite": dict(judged.answer.not_finite),
        "command": judged.run.experiment.command(),
        "recording": f"runs/{judged.answer.recording}" if judged.answer.recording else "",
        "faults": [_fault(fault.describe())["cells"] for fault in judged.run.experiment.faults],
        "events": [[event.kind, event.name, event.time] for event in picture.events],
        "curves": picture.curves,
    }


def _finding(requirement: Requirement, judged: Judged, finding: Finding | None) -> dict[str, Any] | None:
    if finding is None:
        return None
    alone = requirement.quantile is None  # a percentile asks nothing of a single run
    return {
        "held": judged.holds(requirement) and not judged.answer.idle if alone else None,
        "inside": finding.percent,
        "share": percent(finding.percent) if requirement.question.share(finding) else "",
        "worst": _number(finding.worst),
        "text": requirement.question.value(requirement, finding),
        "at": _number(finding.worst_time),
        "first": _number(finding.violated_from),
        "missing": finding.missing,
    }


def _plain(row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _number(value) if isinstance(value, float) else value for name, value in row.items()}


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
