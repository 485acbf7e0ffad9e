"""Prints the verdicts of a campaign."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape
from rich.text import Text

from navfmu.campaign.outcome import Cell, Outcome
from navfmu.terminal.console import console, one_line
from navfmu.terminal.table import Column, Kind, Table

SEEN = 12  # violated cells that are told in words; the report tells all


def show(outcome: Outcome) -> None:
    """The matrix of verdicts, what was seen where something is violated, failed runs, the path of the report."""
    out, campaign = console(), outcome.campaign
    out.print(f"[bold]{_shown(campaign.name)}[/]: {len(outcome.runs)} runs of {campaign.stop:g} s", soft_wrap=True)
    if outcome.cells:
        _matrix(out, outcome)
        for requirement in campaign.requirements:
            out.print(f"  {_shown(requirement.id)}: {_shown(requirement.sentence)}", soft_wrap=True)
        _violated(out, outcome)
    failed = [judged for judged in outcome.runs if judged.error is not None]
    for judged in failed[:SEEN]:
        where = f"{judged.run.variant}, {judged.run.case.name}, seed {judged.run.seed}"
        out.print(f"[red]failed[/] {_shown(where)}: {_shown(judged.error)}", soft_wrap=True)
    for judged in [judged for judged in outcome.runs if judged.answer.not_finite][:SEEN]:
        where = f"{judged.run.variant}, {judged.run.case.name}, seed {judged.run.seed}"
        out.print(f"[red]not finite[/] {_shown(where)}: {_shown(', '.join(judged.answer.not_finite))}", soft_wrap=True)
    for note, count in outcome.notes.items():
        out.print(f"note: {_shown(note)} (in {count} of {len(outcome.runs)} runs)", soft_wrap=True)
    for sentence in outcome.mended:
        out.print(f"flown again: {_shown(sentence)}", soft_wrap=True)
    if len(failed) > SEEN:
        out.print(f"... and {len(failed) - SEEN} more failed runs")
    out.print(f"report: {outcome.report}", soft_wrap=True)


def _shown(text: str) -> str:
    """A text of the user or of an FMU, as a text."""
    return escape(str(one_line(text)))


def _matrix(out: Console, outcome: Outcome) -> None:
    campaign = outcome.campaign
    cells = {(cell.variant, cell.case, cell.requirement.id): cell for cell in outcome.cells}
    columns = [Column("variant", Kind.NAME), Column("case", Kind.NAME)]
    columns += [Column(requirement.id, Kind.WORD) for requirement in campaign.requirements]
    rows = [
        [variant, case.name, *(_verdict(cells.get((variant, case.name, r.id))) for r in campaign.requirements)]
        for variant in campaign.systems
        for case in campaign.cases
    ]
    out.print(Table(columns, rows, "verdicts (runs that hold / runs)"))


def _verdict(cell: Cell | None) -> Text:
    if cell is None:
        return Text("not asked", style="dim")
    verdict = ("holds", "green") if cell.passed else ("VIOLATED", "red")
    return Text.assemble(verdict, f" {cell.held}/{cell.total}")


def _violated(out: Console, outcome: Outcome) -> None:
    """In words, the fewest holding runs first."""
    violated = sorted((c for c in outcome.cells if not c.passed), key=lambda cell: cell.rank)
    for cell in violated[:SEEN]:
        where = f"{cell.requirement.id}, {cell.variant}, {cell.case}"
        out.print(f"[red]violated[/] {_shown(where)}: {_shown(cell.sentence)}", soft_wrap=True)
    if len(violated) > SEEN:
        out.print(f"... and {len(violated) - SEEN} more in the report")
