"""Speed, as ratios to a bare C loop and to other masters in the same run: the benchmarks."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from pathlib import Path

from benchmarks import NAMES
from benchmarks.contest import Contest, write
from evidence.section import Section
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress


def run(out: Path) -> Section:
    """Run every benchmark; numbers are kept in ``out``/benchmarks.json."""
    contests = []
    with Progress("benchmarks") as progress:
        for number, name in enumerate(NAMES):
            progress(number, len(NAMES), name)
            contests += importlib.import_module(f"benchmarks.{name}").run()
    write(contests, out / "benchmarks.json")
    return section(contests)


def section(contests: Sequence[Contest]) -> Section:
    """The claims of the contests, and a table for each."""
    claims = [claim for contest in contests for claim in contest.claims]

    def write_contests(page: Page) -> None:
        page.heading("Speed")
        for contest in contests:
            page.text(f"{contest.name}: microseconds for {contest.unit}, contenders take turns. {contest.work}")
            page.table(
                ["", "median", "fastest", "slowest"],
                [
                    [name, *(f"{1e6 * t:.3g}" for t in (contest.median(name), min(times), max(times)))]
                    for name, times in contest.times.items()
                ],
            )

    return Section(claims, write_contests)
