"""What ``navfmu figures`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from navfmu.figures.answer import FAILED
from navfmu.figures.collection import Collection
from navfmu.figures.comparison import AGREES, EXPLAINED
from navfmu.figures.report import summary
from navfmu.figures.row import Row
from navfmu.figures.running import Outcome
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

_STYLES = {AGREES: "green", EXPLAINED: "yellow"}


def listed(found: Collection, rows: Sequence[Row]) -> None:
    """Rows of a collection."""
    out = console()
    say(out, f"{found.name}: {found.source}")
    columns = [Column("row", Kind.WORD), Column("claim", Kind.SENTENCE), Column("source", Kind.SENTENCE)]
    out.print(Table(columns, [[row.name, row.claim, row.source] for row in rows]))


def show(outcome: Outcome, report: Path) -> None:
    """The figures, what differs and why, and where the report is."""
    out = console()
    rows = [
        [answer.row, Text(one.verdict, style=_STYLES.get(one.verdict, "red")), one.printed, one.finding, one.what]
        for answer in outcome.answers
        for one in answer.comparisons
    ]
    if rows:
        words = [Column("row", Kind.WORD), Column("verdict", Kind.WORD)]
        numbers = [Column("printed"), Column("ours"), Column("what", Kind.SENTENCE)]
        out.print(Table(words + numbers, rows))
    for answer in outcome.answers:
        if answer.verdict == FAILED:
            say(out, f"- {answer.row} {FAILED}: {answer.error}", hang=2)
        for one in answer.comparisons:
            if one.explanation:
                say(out, f"- {answer.row}, {one.what}: {one.explanation}", hang=2)
    if outcome.kept:
        say(out, f"{outcome.kept} of {len(outcome.answers)} rows were there before.")
    say(out, summary(outcome))
    out.print(Text(f"report: {report}"), soft_wrap=True)
