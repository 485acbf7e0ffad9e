"""What was tested, for the first table of the report: system, commit, versions, days, numbers."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from navfmu.campaign.outcome import Outcome
from navfmu.campaign.seeds import seeds_text
from navfmu.files.checkout import commit_of

SHORT = 16  # letters of a hash that are shown in a table; the appendix has all


def tested(outcome: Outcome, about: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Rows of words and values; ``about`` is the campaign's provenance."""
    campaign = outcome.campaign
    searched = len(outcome.every) - len(outcome.runs)
    counts = {"variant": campaign.systems, "case": campaign.cases, "seed": campaign.seeds}
    sizes = " x ".join(f"{len(them)} {name}{'s' * (len(them) != 1)}" for name, them in counts.items())
    steps = " to ".join(f"{step:g}" for step in dict.fromkeys((campaign.steps[0], campaign.steps[-1])))
    versions = about["versions"]
    rows = [
        ("system", str(campaign.system)),
        ("its commit", commit_of(campaign.system)),
        ("campaign", str(campaign.path)),
        ("its commit", commit_of(campaign.path)),
        ("variants", ", ".join(f"{name} ({digest[:SHORT]})" for name, digest in about["digests"].items())),
        ("versions", ", ".join(f"{name} {text}" for name, text in versions.items() if name != "package")),
        ("the package's own sources", versions["package"][:SHORT]),
        ("flown", days(outcome)),
        ("runs", f"{len(outcome.runs)} ({sizes})" + (f", and {searched} of searches" if searched else "")),
        ("seeds", seeds_text(campaign.seeds)),
        ("each run", f"{campaign.stop:g} s in steps of {steps} s, {campaign.algorithm}"),
    ]
    return [(name, value) for name, value in rows if value]


def days(outcome: Outcome) -> str:
    """The days (UTC) on which the kept answers of the runs were written."""
    files = {judged.run.answer(outcome.folder) for judged in outcome.every}
    times = sorted(file.stat().st_mtime for file in files if file.is_file())
    if not times:
        return ""
    first, last = (datetime.fromtimestamp(time, UTC).date().isoformat() for time in (times[0], times[-1]))
    return f"{first} (UTC)" if first == last else f"{first} to {last} (UTC)"
