"""Prints the verdicts of a campaign."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from navfmu.campaign.outcome import Cell, Judged, Outcome
from navfmu.campaign.seeds import seeds_text
from navfmu.terminal.console import console, one_line, say
from navfmu.terminal.table import Column, Kind, Table

ROWS = 60  # of the matrix, each for a variant in a case; beyond it the cases of the file have one each
SEEN = 12  # violated cells that are told in words; the report tells all


def show(outcome: Outcome) -> None:
    """The matrix of verdicts, what was seen where something is violated, failed runs, the path of the report."""
    out, campaign = console(), outcome.campaign
    say(out, Text.assemble((campaign.name, "bold"), f": {len(outcome.every)} runs of {campaign.stop:g} s"))
    if outcome.cells:
        _matrix(out, outcome)
        for requirement in campaign.requirements:
            say(out, f"{requirement.id}: {requirement.sentence}", indent=2, hang=2)
        _violated(out, outcome)
    _thresholds(out, outcome)
    failed = [judged for judged in outcome.every if judged.error is not None]
    for judged in failed[:SEEN]:
        _told(out, "failed", f"{_run(judged)}: {judged.error}")
    for judged in [judged for judged in outcome.every if judged.answer.not_finite][:SEEN]:
        _told(out, "not finite", f"{_run(judged)}: {', '.join(judged.answer.not_finite)}")
    for (variant, case, fault, why), seeds in list(outcome.idle.items())[:SEEN]:
        where = f"{variant}, {case}, seed {seeds_text(seeds)}"
        _told(out, "did not happen", f"{where}: fault '{fault}' {why}")
    for note, count in outcome.notes.items():
        say(out, f"note: {note} (in {count} of {len(outcome.every)} runs)", hang=2)
    for sentence in outcome.mended:
        say(out, f"flown again: {sentence}", hang=2)
    if len(failed) > SEEN:
        say(out, f"... and {len(failed) - SEEN} more failed runs")
    out.print(Text(f"report: {outcome.report}"), soft_wrap=True)


def _run(judged: Judged) -> str:
    return f"{judged.run.variant}, {judged.run.case.name}, seed {judged.run.seed}"


def _told(out: Console, what: str, text: str) -> None:
    """Something that is not as it should be, with a word in red before it."""
    say(out, Text.assemble((what, "red"), f" {one_line(text)}"), hang=2)


def _matrix(out: Console, outcome: Outcome) -> None:
    campaign = outcome.campaign
    cells = {(cell.variant, cell.case, cell.requirement.id): cell for cell in outcome.cells}
    columns = [Column("variant", Kind.NAME), Column("case", Kind.NAME)]
    columns += [Column(requirement.id, Kind.WORD) for requirement in campaign.requirements]
    if len(campaign.systems) * len(campaign.cases) > ROWS:
        _matrix_as_written(out, outcome, columns)
        return
    rows = [
        [variant, case.name, *(_verdict(cells.get((variant, case.name, r.id))) for r in campaign.requirements)]
        for variant in campaign.systems
        for case in campaign.cases
    ]
    out.print(Table(columns, rows, "verdicts (runs that hold / runs)"))


def _matrix_as_written(out: Console, outcome: Outcome, columns: list[Column]) -> None:
    """One row for each case of the file, where it stands for many."""
    campaign = outcome.campaign
    written = {case.name: case.written for case in campaign.cases}
    cells: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in outcome.cells:
        cells.setdefault((cell.variant, written[cell.case], cell.requirement.id), []).append(cell)
    rows = [
        [variant, name, *(_verdicts(cells.get((variant, name, r.id), [])) for r in campaign.requirements)]
        for variant in campaign.systems
        for name in dict.fromkeys(written.values())
    ]
    out.print(Table(columns, rows, "verdicts (cases that hold / cases that the one in the file stands for)"))


def _verdict(cell: Cell | None) -> Text:
    return _verdict_of(["not asked"] if cell is None else [cell.verdict], f"{cell.held}/{cell.total}" if cell else "")


def _verdicts(cells: list[Cell]) -> Text:
    held = f"{sum(cell.passed for cell in cells)}/{len(cells)}"
    return _verdict_of([cell.verdict for cell in cells] or ["not asked"], held)


def _verdict_of(verdicts: list[str], held: str) -> Text:
    """The worst of them, also as a word, for those who see no colours."""
    if verdicts == ["not asked"]:
        return Text("not asked", style="dim")
    worst = min(verdicts, key=["violated", "no answer", "holds"].index)
    return Text.assemble((worst, "green") if worst == "holds" else (worst.upper(), "red"), f" {held}")


def _thresholds(out: Console, outcome: Outcome) -> None:
    """What searches have found."""
    for threshold in outcome.thresholds[:SEEN]:
        sought = threshold.sought
        where = f"{sought.variant}, {sought.search.case.name}, seed {sought.seed}"
        say(out, f"{threshold.requirement.id} {threshold.sentence} ({where}; {len(threshold.probes)} runs)", hang=2)
    if len(outcome.thresholds) > SEEN:
        say(out, f"... and {len(outcome.thresholds) - SEEN} more searches in thresholds.csv")


def _violated(out: Console, outcome: Outcome) -> None:
    """In words, the fewest holding runs first."""
    violated = sorted((c for c in outcome.cells if not c.passed), key=lambda cell: cell.rank)
    for cell in violated[:SEEN]:
        _told(out, cell.verdict, f"{cell.requirement.id}, {cell.variant}, {cell.case}: {cell.sentence}")
    if len(violated) > SEEN:
        say(out, f"... and {len(violated) - SEEN} more in the report")
