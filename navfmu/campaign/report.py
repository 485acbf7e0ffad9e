"""Report of a campaign: verdict matrix, pictures, worst cases first, and how to repeat each run."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.definition import Campaign
from navfmu.campaign.outcome import Judged, Outcome
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.scenes import pictures_of, scene
from navfmu.campaign.seeds import seeds_text
from navfmu.campaign.statistics import Found, statistics
from navfmu.campaign.threshold import Threshold
from navfmu.files.writing import replacing, write_file
from navfmu.report import faults
from navfmu.report.page import Page
from navfmu.report.repeat import section
from navfmu.report.rows import as_csv
from navfmu.system.report_file import missing

Note = Callable[[int, int], None]  # sections drawn, sections to draw
PICTURED = 12  # cells of the matrix with pictures; the tables have all of them
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
    return write_file(folder / "report.html", page(outcome, about, numbers, note).html())


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
            "verdict": "holds" if cell.passed else "violated",
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


# ---- the page --------------------------------------------------------------------------------------------------------


def pictured(outcome: Outcome) -> list[tuple[str, Case]]:
    """The cells that get pictures: every variant in the first case, then the worst ones, in the order of the file."""
    campaign = outcome.campaign
    every = [(variant, case) for case in campaign.cases for variant in campaign.systems]

    bad: dict[tuple[str, str], float] = {}
    for cell in outcome.cells:
        place = cell.variant, cell.case
        bad[place] = bad.get(place, 0.0) + (not cell.passed) + (1.0 - cell.held / max(cell.total, 1))

    def badness(pair: tuple[str, Case]) -> float:
        return bad.get((pair[0], pair[1].name), 0.0)

    first = len(campaign.systems)
    chosen = every[:first] + sorted(every[first:], key=badness, reverse=True)
    return [pair for pair in every if pair in chosen[:PICTURED]]


def page(outcome: Outcome, about: dict[str, Any], numbers: list[Found], note: Note | None = None) -> Page:
    """The whole report."""
    campaign = outcome.campaign
    sizes = f"{len(campaign.systems)} variants x {len(campaign.cases)} cases x {len(campaign.seeds)} seeds"
    steps = " to ".join(f"{step:g}" for step in dict.fromkeys((campaign.steps[0], campaign.steps[-1])))
    searches = f", {len(outcome.every) - len(outcome.runs)} runs of searches" if outcome.thresholds else ""
    result = Page(
        f"Campaign {campaign.name}",
        f"{campaign.description + '. ' if campaign.description else ''}{len(outcome.runs)} runs ({sizes}){searches} of "
        f"{campaign.stop:g} s in steps of {steps} s, {campaign.algorithm}",
    )
    _verdict_section(result, outcome)
    _threshold_section(result, outcome)
    _statistics_section(result, numbers)
    _case_section(result, outcome)
    _failures(result, outcome)
    _notes(result, outcome)
    chosen, count = pictured(outcome), len(campaign.systems) * len(campaign.cases)
    if count > len(chosen):
        result.text(
            f"Pictures follow for {len(chosen)} of {count} combinations: those of the first case, then the worst."
        )
    for number, (variant, case) in enumerate(chosen):
        if note is not None:
            note(number, len(chosen))
        _cell_section(result, outcome, variant, case)
    _runs_section(result, outcome)
    section(result, about)
    return result


def _verdict_section(result: Page, outcome: Outcome) -> None:
    result.heading("Verdicts")
    campaign = outcome.campaign
    if not outcome.cells:
        asked = "Every case is searched." if campaign.requirements and not campaign.cases else ""
        result.text(asked or "The campaign has no requirements.")
        return
    ids = [requirement.id for requirement in campaign.requirements]
    cells = {(cell.variant, cell.case, cell.requirement.id): cell for cell in outcome.cells}
    groups = [(variant, case.name) for variant in campaign.systems for case in campaign.cases]

    def text(key: tuple[str, str, str]) -> str:
        cell = cells.get(key)
        if cell is None:
            return "not asked"
        return f"{'holds' if cell.passed else 'VIOLATED'} {cell.held}/{cell.total}"

    def style(row: int, column: int) -> str | None:
        if column < 2:
            return None
        cell = cells.get((*groups[row], ids[column - 2]))
        return "none" if cell is None else "good" if cell.passed else "bad"

    rows = [[*group, *(text((*group, name)) for name in ids)] for group in groups]
    result.table(["variant", "case", *ids], rows, style)
    result.items(_in_words(requirement) for requirement in campaign.requirements)
    result.heading("What was seen, worst first")
    ordered = sorted(outcome.cells, key=lambda cell: cell.rank)
    result.table(
        ["requirement", "variant", "case", "verdict", "95 % interval of the share of runs", "seen"],
        [
            [
                cell.requirement.id,
                cell.variant,
                cell.case,
                "holds" if cell.passed else "VIOLATED",
                "" if cell.requirement.quantile is not None else f"{cell.interval[0]:.0f} to {cell.interval[1]:.0f} %",
                cell.sentence,
            ]
            for cell in ordered
        ],
        lambda row, column: ("good" if ordered[row].passed else "bad") if column == 3 else None,
    )


def _in_words(requirement: Requirement) -> str:
    severity = f" ({requirement.severity})" if requirement.severity else ""
    more = f". {requirement.description}" if requirement.description else ""
    return f"{requirement.id}{severity}: {requirement.sentence}{more}"


def _threshold_section(result: Page, outcome: Outcome) -> None:
    """Where requirements begin to be violated: over all seeds, and of each."""
    if not outcome.thresholds:
        return
    result.heading("Where requirements begin to be violated")
    result.text(
        "Found by bisection: of two values that are as near to one another as was asked, one holds and the other "
        "violates. Where it holds, is violated and holds again in between, one of these changes was found."
    )
    summary: dict[tuple[str, str, str, str], list[Threshold]] = {}
    for threshold in outcome.thresholds:
        sought = threshold.sought
        place = sought.variant, sought.search.case.name, threshold.requirement.id, sought.search.axis.heading
        summary.setdefault(place, []).append(threshold)
    headings = ["variant", "case", "requirement", "varied", "seeds", "with a bracket", "violated at", "holds at"]
    result.table(headings, [[*place, *_over_seeds(found)] for place, found in summary.items()])
    inner, rows = Page(""), []
    for threshold in outcome.thresholds:
        sought = threshold.sought
        runs, seed = str(len(threshold.probes)), str(sought.seed)
        place = [sought.variant, sought.search.case.name, seed, threshold.requirement.id]
        rows.append([*place, runs, threshold.sentence])
    inner.table(["variant", "case", "seed", "requirement", "runs", "seen"], rows)
    result.folded(f"{len(rows)} searches, one for each seed", inner)
    if not outcome.cells:
        result.items(_in_words(requirement) for requirement in outcome.campaign.requirements)


def _over_seeds(found: list[Threshold]) -> list[str]:
    """How many seeds, how many of them with a bracket, the values that violate, the values that hold."""
    both = sum(None not in (t.bracket.holds_at, t.bracket.violated_at) for t in found)
    violated, holds = [t.bracket.violated_at for t in found], [t.bracket.holds_at for t in found]
    return [str(len(found)), str(both), _range(violated), _range(holds)]


def _range(values: Iterable[float | None]) -> str:
    """From the least to the greatest of values, some of which may be missing."""
    there = sorted(value for value in values if value is not None)
    return " to ".join(f"{value:.9g}" for value in dict.fromkeys((*there[:1], *there[-1:]))) or "-"


def _statistics_section(result: Page, found: list[Found]) -> None:
    for one in found:
        result.heading(one.statistic.heading())
        if one.rows:
            result.text(one.statistic.explanation())
            headings, cells = one.statistic.table(one.rows, one.unit)
            heads = [[row["variant"], row["case"]] for row in one.rows]
            rows = [head + row for head, row in zip(heads, cells, strict=True)]
            result.table(["variant", "case", *headings], rows)
        if one.remarks:
            result.items(one.remarks)


def _case_section(result: Page, outcome: Outcome) -> None:
    """What each case does to the system."""
    rows = []
    searched = {search.case.name: search for search in outcome.campaign.searches}
    for case in (*outcome.campaign.cases, *(search.case for search in searched.values())):
        values = ", ".join(f"{name} = {value}" for name, value in case.parameters.items())
        changed = [f"parameters: {values}"] if values else []
        changed += [] if case.step is None else [f"step: {case.step:g} s"]
        changed += [searched[case.name].sentence] if case.name in searched else []
        if changed:
            rows.append([case.name, case.description, "", "", ", ".join(changed), ""])
        elif not case.faults:
            rows.append([case.name, case.description, "", "", "", ""])
        rows += [[case.name, case.description, *faults.cells(fault.describe())] for fault in case.faults]
    result.heading("Cases")
    headings = ["case", "description", *faults.HEADINGS]
    if not any(row[1] for row in rows):
        headings, rows = headings[:1] + headings[2:], [row[:1] + row[2:] for row in rows]
    result.table(headings, rows)


def _failures(result: Page, outcome: Outcome) -> None:
    failed = [judged for judged in outcome.every if judged.error is not None]
    if failed:
        result.heading("Runs that ended with an error")
        result.table(
            ["variant", "case", "seed", "error"],
            [[j.run.variant, j.run.case.name, str(j.run.seed), j.error] for j in failed],
        )


def _notes(result: Page, outcome: Outcome) -> None:
    """What else the reader of a verdict must know: values that are no numbers, and what the runs noted."""
    strange = [judged for judged in outcome.every if judged.answer.not_finite]
    if strange:
        result.heading("Signals that are not finite")
        result.text("NaN and infinity count as outside every bound; a campaign with such a run does not pass.")
        rows = []
        for judged in strange:
            where = [judged.run.variant, judged.run.case.name, str(judged.run.seed)]
            rows += [[*where, name, str(count)] for name, count in judged.answer.not_finite.items()]
        result.table(["variant", "case", "seed", "signal", "recorded points"], rows)
    if outcome.idle:
        result.heading("Faults that changed nothing")
        result.text("What they should have done did not happen: such runs count as not held.")
        rows = [[*where, seeds_text(seeds), why] for (*where, why), seeds in outcome.idle.items()]
        result.table(["variant", "case", "fault", "seeds", "why"], rows)
    if outcome.notes:
        result.heading("Notes")
        result.items(f"{note} (in {count} of {len(outcome.every)} runs)" for note, count in outcome.notes.items())


def _cell_section(result: Page, outcome: Outcome, variant: str, case: Case) -> None:
    """Pictures of one variant in one case."""
    every = outcome.of(variant, case.name)
    runs = [judged for judged in every if judged.error is None]
    if not runs:
        return
    worst = _worst(outcome, variant, case.name)
    shown = worst if worst in runs else runs[0]
    result.heading(f"{variant}, {case.name}")
    if len(runs) < len(every):
        result.text(f"{len(every) - len(runs)} of {len(every)} runs ended with an error and are not in the pictures.")
    if len(every) > 1:
        which = "the worst run" if shown is worst else "the first run"
        result.text(f"Where one run is shown it is {which}, seed {shown.run.seed}: {shown.run.experiment.command()}")
    for picture in pictures_of(outcome, variant, case):
        lacking = missing(picture, outcome.campaign.systems[variant].fmus)
        if lacking:
            result.text(f"The picture '{picture.kind}' is left out: {variant} has no {', '.join(lacking)}.")
            continue
        drawn = picture.draw(scene(outcome, variant, case, picture, runs, shown))
        result.picture(drawn.png, drawn.title, drawn.caption)


def _worst(outcome: Outcome, variant: str, case: str) -> Judged | None:
    cells = [c for c in outcome.cells if (c.variant, c.case) == (variant, case) and c.worst is not None]
    return min(cells, key=lambda cell: (cell.passed, cell.held)).worst if cells else None


def _runs_section(result: Page, outcome: Outcome) -> None:
    inner = Page("")
    rows = []
    for judged in outcome.every:
        verdicts = ", ".join(f"{name} {'holds' if f.held else 'violated'}" for name, f in judged.findings.items())
        command = judged.run.experiment.command()
        rows.append([judged.run.variant, judged.run.case.name, str(judged.run.seed), judged.error or verdicts, command])
    inner.table(["variant", "case", "seed", "findings", "command that repeats it"], rows)
    result.heading("All runs")
    result.text("The recordings are in the folder runs/ beside this report, the findings in runs.csv and runs.parquet.")
    result.folded(f"{len(rows)} runs and their commands", inner)
