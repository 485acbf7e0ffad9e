"""What a person who signs a campaign has to know, in sentences: what holds, how sure that is, what was not tested."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from navfmu.campaign.story import Story

Z = 1.959963984540054  # of the normal distribution: 95 % lie within
NAMED = 12  # things that a sentence names before it counts the rest


@dataclass(frozen=True)
class Asked:
    """A requirement over all variants and cases of which it is asked."""

    requirement: dict[str, Any]
    cells: list[tuple[str, dict[str, Any]]]  # "variant, case", and the cell

    @property
    def held(self) -> int:
        """Cells in which it holds."""
        return sum(cell["passed"] for _, cell in self.cells)

    @property
    def shown(self) -> int:
        """Cells in which the interval of the share of runs lies where it is asked to lie."""
        return sum(shows(self.requirement, cell) for _, cell in self.cells)

    @property
    def weakest(self) -> tuple[str, dict[str, Any]] | None:
        """The worst cell."""
        return min(self.cells, key=lambda pair: pair[1]["rank"], default=None)


def asked(story: Story) -> list[Asked]:
    """Each requirement with its cells."""
    return [
        Asked(
            requirement,
            [
                (f"{group['variant']}, {story['cases'][group['case']]['name']}", group["cells"][number])
                for group in story["groups"]
                if group["cells"][number] is not None
            ],
        )
        for number, requirement in enumerate(story["requirements"])
    ]


def shows(requirement: dict[str, Any], cell: dict[str, Any]) -> bool:
    """Whether the runs of a cell show with 95 % confidence that the share that is asked for holds."""
    return bool(cell["passed"]) and cell["interval"] is not None and cell["interval"][0] >= requirement["runs"]


def lowest(runs: int) -> float:
    """The lower end (percent) of Wilson's 95 % interval where all of so many runs hold."""
    return 100.0 * runs / (runs + Z * Z) if runs else 0.0


def needed(share: float) -> int | None:
    """How many runs, all of which hold, show that at least ``share`` percent do; None: no number shows all of them."""
    return None if share >= 100.0 else math.ceil(Z * Z * share / (100.0 - share) - 1e-9)


def verdict(story: Story) -> str:
    """The first sentence."""
    cells = [cell for group in story["groups"] for cell in group["cells"] if cell is not None]
    held, count = sum(cell["passed"] for cell in cells), len(cells)
    silent = sum(cell["verdict"] == "no answer" for cell in cells)
    if not cells:
        return "No requirement is asked of any variant and case: this campaign gives no verdict."
    kind = "requirements, each asked of a variant in a case"
    if held < count:
        unanswered = f"{silent} could be asked in no run; " if silent else ""
        return f"{count - held - silent} of {count} {kind}, are violated; {unanswered}{held} hold in the runs flown."
    more = "" if story["passed"] else " Yet the campaign has not passed: see what was not tested."
    return f"All of {count} {kind}, hold in the runs flown.{more}"


def confidence(story: Story) -> list[str]:
    """What the number of runs can show."""
    found = []
    cells = [cell for group in story["groups"] for cell in group["cells"] if cell is not None]
    counts = sorted({cell["distinct"] for cell in cells if cell["distinct"]})
    if counts:
        few, many = counts[0], counts[-1]
        runs = f"{few} run{'s' * (few > 1)}" if few == many else f"{few} to {many} runs"
        ends = f"{lowest(few):.1f} %" if few == many else f"{lowest(few):.1f} % to {lowest(many):.1f} %"
        found.append(
            f"Each question was put to {runs} that can differ. Where all of them hold, the share of all such flights "
            f"that hold is at least {ends}: the lower end of its 95 % interval (Wilson). That a requirement holds in "
            "the runs flown is a finding about these runs; it is no proof for the flights that were not flown."
        )
    every: dict[int, list[str]] = {}
    for one in asked(story):
        share, name = one.requirement["runs"], one.requirement["id"]
        if not any(cell["distinct"] for _, cell in one.cells):
            continue
        if one.requirement["quantile"] is not None:
            found.append(f"{name} is asked of a percentile of the runs, for which no interval is claimed.")
        elif share >= 100.0:
            every.setdefault(max(cell["distinct"] for _, cell in one.cells), []).append(name)
        else:
            found.append(
                f"{name} asks for {share:g} % of the runs, which takes at least {needed(share)} runs without a "
                f"violation to show; it is shown in {one.shown} of {len(one.cells)} variants and cases."
            )
    for count, names in every.items():
        found.append(
            f"{_some(names)} ask{'s' * (len(names) == 1)} for every run. No number of runs can show that; "
            f"{lowest(count):.1f} % is what {count} of {count} can show."
        )
    return found


def not_tested(story: Story) -> list[str]:
    """What the verdict says nothing about."""
    return [*_not_asked(story), *_not_happened(story), *_not_faulted(story), *_not_varied(story), *story["remarks"]]


def _not_asked(story: Story) -> Iterator[str]:
    total = len(story["groups"])
    for one in asked(story):
        if len(one.cells) < total:
            yield (
                f"{one.requirement['id']} is asked in {len(one.cells)} of {total} combinations of variant and case; "
                "about the others this campaign says nothing of it."
            )
    if not story["requirements"]:
        yield "There are no requirements: nothing is judged."


def _not_happened(story: Story) -> Iterator[str]:
    runs = story["runs"]
    failed = sum(run["error"] is not None for run in runs)
    if failed:
        yield f"{failed} of {len(runs)} runs ended with an error and count as not held; see failed runs."
    strange = sum(bool(run["not_finite"]) for run in runs)
    if strange:
        yield f"In {strange} of {len(runs)} runs a recorded signal is NaN or infinite at some points."
    idle = list(dict.fromkeys(f"{fault} ({variant}, {case})" for variant, case, fault, _, _ in story["idle"]))
    if idle:
        yield f"Faults that changed nothing, so that what they should have shown was not tested: {_some(idle)}."


def _not_faulted(story: Story) -> Iterator[str]:
    faults = [fault for case in (*story["cases"], *story["searched"]) for fault in case["faults"]]
    reached = {name for fault in faults for name in fault["components"]}
    every = list(dict.fromkeys(name for names in story["components"].values() for name in names))
    whole = [name for name in every if name not in reached]
    if whole:
        yield f"No fault is injected into {len(whole)} of {len(every)} components: {_some(whole)}."


def _not_varied(story: Story) -> Iterator[str]:
    faults: dict[str, set[str]] = {}
    for case in (*story["cases"], *story["searched"]):
        for fault in case.get("ends", case["faults"]):
            faults.setdefault(fault["id"], set()).add(" ".join(fault["cells"][1:]))
    once = [name for name, ways in faults.items() if len(ways) == 1]
    if once:
        yield f"Injected with one onset, length and magnitude only: {_some(once)}."
    if len(story["steps"]) == 1 and story["runs"]:
        yield f"All runs have one communication step size, {story['steps'][0]:g} s."


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:NAMED])
    return shown if len(names) <= NAMED else f"{shown} and {len(names) - NAMED} more"
