"""Figures that sources print, found again: the rows of ``navfmu figures``, each of which is a claim here."""

from __future__ import annotations

from pathlib import Path

from evidence.section import Section
from navfmu.figures import collection, report, running
from navfmu.figures.answer import Answer
from navfmu.figures.comparison import DIFFERS
from navfmu.report.claim import Claim
from navfmu.report.page import Page

SEED = 1


def run(out: Path) -> Section:
    """All rows of all collections, with reports of their own."""
    outcomes = []
    for name in collection.names():
        found, folder = collection.collection(name), out / "figures" / name
        outcomes.append(running.run(found, found.rows, SEED, folder))
        report.write_report(outcomes[-1], folder)
    return section(outcomes)


def section(outcomes: list[running.Outcome]) -> Section:
    """A claim for each row: that no figure differs without a reason that is known."""
    claims = [claim(answer) for outcome in outcomes for answer in outcome.answers]

    def write(page: Page) -> None:
        page.heading("Figures of sources")
        for outcome in outcomes:
            page.text(f"{outcome.of.source} {report.summary(outcome)} figures/{outcome.of.name} has the report.")

    return Section(claims, write)


def claim(answer: Answer) -> Claim:
    """Of a row; one that failed has no number."""
    unknown = float("nan") if answer.error else sum(one.verdict == DIFFERS for one in answer.comparisons)
    opposite = f"{answer.row} is not found again: {answer.claim}"
    return Claim(f"{answer.row}: {answer.claim}", float(unknown), 0.0, False, "figures that nobody explains", opposite)
