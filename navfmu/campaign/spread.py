"""Pictures over all runs of a campaign: how far they are from what is asked, and how that changes along its axes."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

from navfmu.campaign.story import Story
from navfmu.report.along import Points, along
from navfmu.report.scene import Drawn
from navfmu.report.strips import Strip, strips

ROWS = 40  # strips in a picture: of the groups in which the fewest runs hold
MANY = 8  # pictures along axes

SIDE = ", those of the variants side by side"
CROSS = "a dot is a run that is as it should be, a cross one that is not; dashed: what is asked"


def spread(story: Story) -> Iterator[Drawn]:
    """For each requirement on a signal the worst value of each run, by variant and case."""
    for number, requirement in enumerate(story["requirements"]):
        groups = sorted(
            (group for group in story["groups"] if group["cells"][number] is not None),
            key=lambda group: group["cells"][number]["rank"],
        )
        found = []
        for group in groups:
            findings = _findings(story, group, number)
            if findings:
                label = f"{group['variant']}, {_short(story['cases'][group['case']])}"
                values, held = zip(*((_worst(f), f["held"] is not False) for f in findings), strict=True)
                found.append(Strip(label, values, held))
        every = [value for strip in found for value in strip.values]
        if not found or not _worth(requirement, every):
            continue
        runs, bad = sum(len(s.held) for s in found), sum(s.held.count(False) for s in found)
        what, when, label = requirement["quantity"]
        heading = f"{requirement['id']}: {what} of {runs} runs{when}, {_told(requirement, f'{bad} not as asked')}"
        shown = found[:ROWS]
        rest = f"; the {len(found) - ROWS} combinations in which most runs hold are left out" if found[ROWS:] else ""
        caption = f"{_capital(_marks(requirement))}{rest}.{_without(every)}"
        yield strips(heading, label, requirement["unit"], shown, _bounds(requirement), caption)


def sweeps(story: Story) -> Iterator[Drawn]:
    """For each axis with numbers and each requirement on a signal the worst value of each run along the axis."""
    count = 0
    for axis, heading in enumerate(story["axes"]):
        for number, requirement in enumerate(story["requirements"]):
            groups: dict[str, list[tuple[float, float, bool]]] = {}
            for run in story["runs"]:
                place, finding = run["values"][axis], run["findings"][number]
                if _is_number(place) and finding is not None:
                    point = place, _worst(finding), finding["held"] is not False
                    groups.setdefault(run["variant"], []).append(point)
            every = [point for points in groups.values() for point in points]
            values = [value for _, value, _ in every]
            if len({place for place, _, _ in every}) < 2 or not _worth(requirement, values):
                continue
            count += 1
            if count > MANY:
                return
            yield along(
                _along_heading(requirement, heading, every),
                heading,
                requirement["quantity"][2],
                requirement["unit"],
                {name: Points(*zip(*sorted(points), strict=True)) for name, points in groups.items()},
                _bounds(requirement),
                f"{len(every)} runs{SIDE if len(groups) > 1 else ''}; {_marks(requirement)}.{_without(values)}",
            )


def _along_heading(requirement: dict[str, Any], axis: str, points: list[tuple[float, float, bool]]) -> str:
    """What is to be seen: where the first run is not as it should be, and up to where one is."""
    bad, good = [p for p, _, held in points if not held], [p for p, _, held in points if held]
    seen = [f"not as asked from {min(bad):.4g} to {max(bad):.4g}"] if bad else ["all as asked"]
    seen += [f"as asked from {min(good):.4g} to {max(good):.4g}"] if bad and good else []
    return f"{requirement['id']} along {axis}: {_told(requirement, ', '.join(seen))}"


def _told(requirement: dict[str, Any], words: str) -> str:
    """What is to be said of runs: a percentile asks nothing of a single one."""
    return words if requirement["quantile"] is None else "asked of a percentile of the runs"


def _marks(requirement: dict[str, Any]) -> str:
    """What the marks are."""
    return CROSS if requirement["quantile"] is None else "a dot is a run; dashed: what is asked of a percentile of them"


def _findings(story: Story, group: dict[str, Any], number: int) -> list[dict[str, Any]]:
    found = (story["runs"][run]["findings"][number] for run in group["runs"])
    return [finding for finding in found if finding is not None]


def _short(case: dict[str, Any]) -> str:
    """The name of a case without those of its axes: "bias (10 min, 1 nmi)"."""
    varied = any(value is not None for value in case["values"])
    return re.sub(r"(?<=\()[^=()]+=|(?<=, )[^=(),]+=", "", case["name"]) if varied else case["name"]


def _worst(finding: dict[str, Any]) -> float:
    """The worst value; NaN where it is no number."""
    return math.nan if finding["worst"] is None else finding["worst"]


def _without(values: list[float]) -> str:
    """What is to be said of runs that have no mark."""
    count = sum(math.isnan(value) for value in values)
    return f" {count} of the {len(values)} runs have no mark: their worst value is no number." if count else ""


def _worth(requirement: dict[str, Any], values: list[float]) -> bool:
    """Whether there is more to see than false and true."""
    finite = {value for value in values if not math.isnan(value)}
    return bool(finite) and (requirement["unit"] not in ("", "1") or len(finite) > 2)


def _bounds(requirement: dict[str, Any]) -> list[float]:
    return [bound for bound in requirement["bounds"] if bound is not None]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
