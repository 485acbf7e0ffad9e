"""A campaign by the lines of an FMEA: what was injected, what was seen, whether the system noticed."""

from __future__ import annotations

import re
from typing import Any

from navfmu.campaign.story import Story

NONE = "(none)"  # of faults that name no line


def by_line(story: Story) -> list[dict[str, Any]]:
    """One row for each line that faults of the campaign name, in the order of their numbers.

    ``held`` has (held, total) of the runs in which a fault of the line acts, or None where a requirement is not asked
    (of the variants and cases, where it is asked of a percentile of the runs);
    ``noticed`` counts the runs in which a sign that the system has noticed something begins when the line's first fault
    has begun, or later.
    """
    rows: dict[str, dict[str, Any]] = {}
    for number, group in enumerate(story["groups"]):
        case = story["cases"][group["case"]]
        for fault in case["faults"]:
            line = fault["fmea"] or NONE
            row = rows.setdefault(line, {"line": line, "faults": {}, "starts": {}, "groups": {}})
            row["faults"][fault["id"]] = fault["description"]
            row["groups"][number] = None
            row["starts"][case["name"]] = min(fault["start"], row["starts"].get(case["name"], fault["start"]))
    return [_summed(story, rows[line]) for line in sorted(rows, key=_order)]


def _summed(story: Story, row: dict[str, Any]) -> dict[str, Any]:
    groups = [story["groups"][number] for number in row["groups"]]
    runs = [story["runs"][number] for group in groups for number in group["runs"]]
    held = []
    for number, requirement in enumerate(story["requirements"]):
        cells = [group["cells"][number] for group in groups if group["cells"][number] is not None]
        if requirement["quantile"] is not None:
            counts = sum(c["passed"] for c in cells), len(cells)
        else:
            counts = sum(c["held"] for c in cells), sum(c["total"] for c in cells)
        held.append(counts if cells else None)
    noticed = sum(
        any(kind == "notice" and time >= row["starts"][run["case"]] for kind, _, time in run["events"]) for run in runs
    )
    return {
        "line": row["line"],
        "faults": row["faults"],
        "cases": list(row["starts"]),
        "runs": len(runs),
        "held": held,
        "noticed": noticed if story["noticing"] else None,
        "idle": sum(any(name in run["idle"] for name in row["faults"]) for run in runs),
    }


def _order(line: str) -> tuple[bool, list[tuple[bool, int, str]]]:
    """F2 before F10, faults without a line last."""
    parts = re.findall(r"\d+|\D+", line)
    return line == NONE, [(not part.isdigit(), int(part) if part.isdigit() else 0, part) for part in parts]
