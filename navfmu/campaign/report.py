"""The files that a campaign leaves behind beside its recordings: tables, provenance, the report."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.definition import Campaign
from navfmu.campaign.drawn import drawn
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.page import page
from navfmu.campaign.pictured import chosen, sections
from navfmu.campaign.seeds import seeds_text
from navfmu.campaign.statistics import statistics
from navfmu.campaign.story import story
from navfmu.campaign.tested import tested
from navfmu.files.writing import replacing, write_file
from navfmu.report.rows import as_csv

Note = Callable[[int, int], None]  # things drawn, things to draw
FILES = ("runs.csv", "runs.parquet", "verdicts.csv", "thresholds.csv", "campaign.json", "report.html")


def write_report(outcome: Outcome, folder: Path, note: Note | None = None) -> Path:
    """Write runs, verdicts, statistics, what is needed to repeat the campaign, and ``report.html``; return its path."""
    about = provenance(outcome)
    rows = outcome.table()
    write_file(folder / "runs.csv", as_csv(rows))
    _write_parquet(rows, folder / "runs.parquet", about)
    write_file(folder / "verdicts.csv", as_csv(_verdicts(outcome)))
    if outcome.thresholds:
        write_file(folder / "thresholds.csv", as_csv([threshold.row() for threshold in outcome.thresholds]))
    else:  # those of an earlier start, with searches
        (folder / "thresholds.csv").unlink(missing_ok=True)
    numbers = list(statistics(outcome))
    for found in numbers:
        write_file(folder / found.file, as_csv(found.rows))
    write_file(folder / "campaign.json", json.dumps(about, indent=2) + "\n")
    total = len(outcome.every) + len(chosen(outcome))

    def at(count: int) -> None:
        if note is not None:
            note(count, total)

    told = story(outcome, lambda order: drawn(outcome, order, at))
    pictures = sections(outcome, lambda count: at(len(outcome.every) + count))
    return write_file(folder / "report.html", page(told, tested(outcome, about), about, numbers, pictures).html())


def provenance(outcome: Outcome) -> dict[str, Any]:
    """What is needed to repeat the campaign. Nothing in it depends on how it was run."""
    from navfmu.system.provenance import environment

    campaign = outcome.campaign
    seeds = ["--seeds", seeds_text(campaign.seeds)]
    return {
        "campaign": str(campaign.path),
        "system": str(campaign.system),
        "digests": {name: system.digest for name, system in campaign.systems.items()},
        "fmus": {name: system.hashes() for name, system in campaign.systems.items()},
        "cases": {case.name: _described(campaign, case) for case in campaign.cases},
        "searches": [
            _described(campaign, search.case)
            | {
                "case": search.case.name,
                "axis": search.axis.heading,
                "low": search.span.low,
                "high": search.span.high,
                "requirement": search.requirement,
                "tolerance": search.axis.goal.tolerance,
            }
            for search in campaign.searches
        ],
        "requirements": {requirement.id: requirement.sentence for requirement in campaign.requirements},
        "seeds": list(campaign.seeds),
        "stop": campaign.stop,
        "step": campaign.step,
        "algorithm": campaign.algorithm,
        "parameters": campaign.parameters,
        "versions": environment(),
        "command": shlex.join(["navfmu", "campaign", str(campaign.path), *seeds]),
    }


def _described(campaign: Campaign, case: Case) -> dict[str, Any]:
    """What a case does, as plain data."""
    found = {"faults": [fault.describe() for fault in case.faults], "parameters": case.parameters}
    values = {name: value for name, value in campaign.columns(case).items() if value is not None}
    return found | ({"axes": values} if values else {}) | ({} if case.step is None else {"step": case.step})


def _verdicts(outcome: Outcome) -> list[dict[str, Any]]:
    columns = {case.name: outcome.campaign.columns(case) for case in outcome.campaign.cases}
    return [
        {
            "requirement": cell.requirement.id,
            "sentence": cell.requirement.sentence,
            "variant": cell.variant,
            "case": cell.case,
            **columns[cell.case],
            "verdict": cell.verdict,
            "runs_held": cell.held,
            "runs": cell.total,
            "interval_low_percent": round(cell.interval[0], 2),
            "interval_high_percent": round(cell.interval[1], 2),
            "seen": cell.sentence,
        }
        for cell in outcome.cells
    ]


def _write_parquet(rows: list[dict[str, Any]], path: Path, about: dict[str, Any]) -> None:
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.Table.from_pylist(rows).replace_schema_metadata({"navfmu": json.dumps(about)})
    with replacing(path) as temporary:
        parquet.write_table(table, temporary, compression="zstd")
