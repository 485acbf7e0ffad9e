"""The outcome as a page and as data."""

from __future__ import annotations

import json
from pathlib import Path

from navfmu.figures.answer import FAILED, Answer
from navfmu.figures.comparison import AGREES, DIFFERS, EXPLAINED
from navfmu.figures.running import Outcome
from navfmu.files.writing import write_file
from navfmu.report.page import Link, Page, anchor
from navfmu.system.provenance import environment

FILES = ("figures.json", "report.html")
STYLES = {AGREES: "good", EXPLAINED: "none", DIFFERS: "bad", FAILED: "bad"}
_HEAD = ["what", "printed", "ours", "agrees at", "verdict"]


def write_report(outcome: Outcome, folder: Path) -> Path:
    """Write ``figures.json`` and ``report.html`` and return the page's path."""
    about = {
        "collection": outcome.of.name,
        "source": outcome.of.source,
        "seed": outcome.seed,
        "environment": environment(),
        "rows": [answer.describe() for answer in outcome.answers],
    }
    write_file(folder / FILES[0], json.dumps(about, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    return write_file(folder / FILES[1], page(outcome).html())


def page(outcome: Outcome) -> Page:
    """A table of all figures, then each row with its reasons and its picture."""
    made = Page(f"Figures: {outcome.of.name}", outcome.of.source)
    made.text(summary(outcome))
    rows = [
        [Link(answer.row, f"#{anchor(_heading(answer))}"), *cells]
        for answer in outcome.answers
        for cells in _cells(answer)
    ]
    verdicts = [str(cells[-1]) for cells in rows]
    made.table(["row", *_HEAD], rows, lambda row, column: STYLES[verdicts[row]] if column == len(_HEAD) else None)
    for answer in outcome.answers:
        _show(made, answer)
    return made


def summary(outcome: Outcome) -> str:
    """How many figures agree, and what does not, in a sentence."""
    verdicts = [one.verdict for answer in outcome.answers for one in answer.comparisons]
    failed = [answer.row for answer in outcome.answers if answer.error]
    parts = [f"{verdicts.count(AGREES)} of {len(verdicts)} figures agree"]
    if count := verdicts.count(EXPLAINED):
        parts.append(f"{count} differ{'s' if count == 1 else ''} for a reason that is known")
    if count := verdicts.count(DIFFERS):
        parts.append(f"{count} DIFFER{'S' if count == 1 else ''}, nobody knows why")
    if failed:
        parts.append(f"{', '.join(failed)} FAILED")
    return "; ".join(parts) + f" (seed {outcome.seed})."


def _heading(answer: Answer) -> str:
    return f"{answer.row}: {answer.claim}"


def _cells(answer: Answer) -> list[list[str]]:
    if answer.error:
        return [[answer.error, "", "", "", FAILED]]
    return [[one.what, one.printed, one.finding, one.bounds, one.verdict] for one in answer.comparisons]


def _show(made: Page, answer: Answer) -> None:
    made.heading(_heading(answer))
    made.text(f"Source: {answer.source}.")
    if answer.error:
        made.text(f"FAILED: {answer.error}")
        return
    made.picture(answer.picture, answer.words, answer.words)
    reasons = []
    for one in answer.comparisons:
        reasons.append(f"{one.what}: printed {one.printed}, ours {one.finding}. Agrees if {one.bounds}: {one.why}")
        if one.explanation:
            reasons.append(f"{one.what} differs: {one.explanation}")
    made.items(reasons)
    if answer.notes:
        made.items(answer.notes)
