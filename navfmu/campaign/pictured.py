"""The combinations of variant and case that get pictures on paper, too, and these pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from navfmu.campaign.case import Case
from navfmu.campaign.judged import Judged
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.scenes import pictures_of, scene
from navfmu.report.scene import Drawn
from navfmu.system.report_file import missing

PICTURED = 12  # combinations


@dataclass
class Section:
    """A variant in a case: what is to be said, the run that is shown where only one can be, the pictures."""

    name: str
    lines: list[str] = field(default_factory=list)
    shown: int | None = None  # its place among all runs
    command: str = ""
    drawn: list[Drawn] = field(default_factory=list)


def chosen(outcome: Outcome) -> list[tuple[str, Case]]:
    """The worst combinations, the worst first; of equal ones the earlier in the file."""
    bad: dict[tuple[str, str], float] = {}
    for cell in outcome.cells:
        place = cell.variant, cell.case
        bad[place] = bad.get(place, 0.0) + (not cell.passed) + (1.0 - cell.held / max(cell.total, 1))
    every = [(variant, case) for case in outcome.campaign.cases for variant in outcome.campaign.systems]
    return sorted(every, key=lambda pair: -bad.get((pair[0], pair[1].name), 0.0))[:PICTURED]


def sections(outcome: Outcome, note: Callable[[int], None] = lambda _: None) -> list[Section]:
    """Those of the chosen combinations in which a run has ended well."""
    found = []
    for number, (variant, case) in enumerate(chosen(outcome)):
        note(number)
        section = _section(outcome, variant, case)
        found += [section] if section is not None else []
    return found


def _section(outcome: Outcome, variant: str, case: Case) -> Section | None:
    every = outcome.of(variant, case.name)
    runs = [judged for judged in every if judged.error is None]
    if not runs:
        return None
    worst = _worst(outcome, variant, case.name)
    shown = worst if worst in runs else runs[0]
    section = Section(f"{variant}, {case.name}", shown=_place(outcome, shown), command=shown.run.experiment.command())
    if len(runs) < len(every):
        section.lines.append(
            f"{len(every) - len(runs)} of {len(every)} runs ended with an error and are not in the pictures."
        )
    if len(every) > 1:
        which = "the worst run" if shown is worst else "the first run"
        section.lines.append(f"Where one run is shown it is {which}, seed {shown.run.seed}.")
    for picture in pictures_of(outcome, variant, case):
        lacking = missing(picture, outcome.campaign.systems[variant].fmus)
        if lacking:
            section.lines.append(f"The picture '{picture.kind}' is left out: {variant} has no {', '.join(lacking)}.")
            continue
        section.drawn.append(picture.draw(scene(outcome, variant, case, picture, runs, shown)))
    return section


def _worst(outcome: Outcome, variant: str, case: str) -> Judged | None:
    cells = [c for c in outcome.cells if (c.variant, c.case) == (variant, case) and c.worst is not None]
    return min(cells, key=lambda cell: cell.rank).worst if cells else None


def _place(outcome: Outcome, judged: Judged) -> int:
    return next(number for number, other in enumerate(outcome.every) if other is judged)
