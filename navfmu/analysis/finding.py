"""What an analysis has found, for people and for files: sentences, a table, all its numbers, a picture."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from navfmu.files.writing import write_file
from navfmu.report.page import Page
from navfmu.report.repeat import section
from navfmu.report.rows import as_csv
from navfmu.system.results_folder import check_results

NAMES = ("analysis.csv", "analysis.json", "analysis.png", "report.html")


@dataclass(frozen=True)
class Finding:
    """A finding. ``table`` has texts below ``headings``, the first column of which is a name; ``rows`` all numbers."""

    kind: str  # "covariance"
    title: str
    lead: str
    sentences: Sequence[str]
    headings: Sequence[str]
    table: Sequence[Sequence[str]]
    rows: Sequence[dict[str, Any]]
    image: bytes
    caption: str
    provenance: dict[str, Any]
    explanation: str = ""
    remarks: Sequence[str] = ()
    numbers: dict[str, Any] = field(default_factory=dict)  # those of the whole


def check(folder: str | None) -> Path | None:
    """The folder to write into, refused before the work where it cannot be."""
    return None if folder is None else check_results(folder, "an analysis", *NAMES)


def write(found: Finding, folder: Path) -> Path:
    """Write ``analysis.csv``, ``.json``, ``.png`` and ``report.html``; return the path of the report."""
    about = {
        "analysis": found.kind,
        "found": list(found.sentences),
        "remarks": list(found.remarks),
        **found.numbers,
        "provenance": found.provenance,
    }
    write_file(folder / "analysis.csv", as_csv(list(found.rows)))
    write_file(folder / "analysis.json", json.dumps(about, indent=2, allow_nan=False) + "\n")
    write_file(folder / "analysis.png", found.image)
    page = Page(found.title, found.lead)
    for sentence in found.sentences:
        page.text(sentence)
    page.picture(found.image, found.sentences[0], found.caption)
    if found.remarks:
        page.items(found.remarks)
    page.table(found.headings, found.table)
    page.text(found.explanation)
    section(page, found.provenance)
    return write_file(folder / "report.html", page.html())


def show(found: Finding, report: Path | None) -> None:
    """Print what was found and where the report is."""
    from rich.text import Text

    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    out = console()
    say(out, found.lead)
    columns = [Column(found.headings[0], Kind.WORD), *map(Column, found.headings[1:])]
    out.print(Table(columns, found.table, found.title, keys=1))
    for sentence in (*found.sentences, *found.remarks):
        say(out, sentence)
    if report is not None:
        out.print(Text(f"report: {report}"), soft_wrap=True)
