"""Prints the verdicts of a campaign."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from navfmu.campaign.outcome import Outcome
from navfmu.info import console

WIDE = 120  # columns of a terminal that has room for sentences


def show(outcome: Outcome) -> None:
    """The table of verdicts, the failed runs and the path of the report."""
    out, campaign = console(), outcome.campaign
    out.print(f"[bold]{escape(campaign.name)}[/]: {len(outcome.runs)} runs of {campaign.stop:g} s", soft_wrap=True)
    if outcome.cells:
        wide = out.width >= WIDE
        table = Table(title="verdicts", title_justify="left", box=None, pad_edge=False)
        for heading in ("requirement", "variant", "case", "verdict"):
            table.add_column(heading, no_wrap=True)
        table.add_column("runs", justify="right", no_wrap=True)
        if wide:
            table.add_column("95 % interval", justify="right", no_wrap=True)
            table.add_column("what was seen", ratio=1)
        for cell in outcome.cells:
            verdict = "[green]holds[/]" if cell.passed else "[red]VIOLATED[/]"
            row = [cell.requirement.id, cell.variant, cell.case, verdict, f"{cell.held}/{cell.total}"]
            if wide:
                low, high = cell.interval
                row.append("" if cell.requirement.quantile is not None else f"{low:.0f} to {high:.0f} %")
                row.append(escape(cell.sentence))
            table.add_row(*row)
        out.print(table)
        for requirement in campaign.requirements:
            out.print(f"  {requirement.id}: {escape(requirement.sentence)}", soft_wrap=True)
    for judged in outcome.runs:
        if judged.error is not None:
            run = judged.run
            where = f"{run.variant}, {run.case.name}, seed {run.seed}"
            out.print(f"[red]failed[/] {where}: {escape(judged.error)}", soft_wrap=True)
    out.print(f"report: {outcome.report}", soft_wrap=True)
