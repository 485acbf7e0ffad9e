"""Speed, as ratios to a bare C loop and to other masters in the same run: the benchmarks."""

from __future__ import annotations

from pathlib import Path

from benchmarks import flight, imu_twin, ring, startup
from benchmarks.contest import Claim, write
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

BENCHMARKS = (ring, flight, imu_twin, startup)


def run(out: Path, page: Page) -> None:
    """Run every benchmark; numbers are kept in ``out``/benchmarks.json."""
    contests = []
    with Progress("benchmarks") as progress:
        for number, benchmark in enumerate(BENCHMARKS):
            progress(number, len(BENCHMARKS), benchmark.__name__.rpartition(".")[2])
            contests.append(benchmark.run())
    write(contests, out / "benchmarks.json")
    page.heading("Speed")
    page.table(
        ["claim", "goal", "measured", ""],
        [
            [c.text, f"{'at least' if c.at_least else 'at most'} {c.goal:g}", f"{c.measured:.3g}", verdict(c)]
            for contest in contests
            for c in contest.claims
        ],
    )
    for contest in contests:
        page.text(f"{contest.name}: microseconds for {contest.unit}, contenders take turns")
        page.table(
            ["", "median", "fastest", "slowest"],
            [
                [name, *(f"{1e6 * t:.3g}" for t in (contest.median(name), min(times), max(times)))]
                for name, times in contest.times.items()
            ],
        )


def verdict(claim: Claim) -> str:
    """Whether the claim holds, in a word."""
    return "holds" if claim.holds else "MISSED"
