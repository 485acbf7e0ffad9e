"""Rounds in which contenders take turns, and what is said about them."""

from __future__ import annotations

import json
import os
import platform
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

Contender = Callable[[], float]
"""Does its share of work and returns the seconds for one unit of it."""


@dataclass(frozen=True)
class Claim:
    """A ratio that was promised, and what was measured."""

    text: str
    goal: float
    measured: float
    at_least: bool = True

    @property
    def holds(self) -> bool:
        return self.measured >= self.goal if self.at_least else self.measured <= self.goal


@dataclass
class Contest:
    """Times of all contenders (s for one unit, one number for each round) and the claims checked on them."""

    name: str
    unit: str
    times: dict[str, list[float]]
    claims: list[Claim] = field(default_factory=list)
    load: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def median(self, name: str) -> float:
        return statistics.median(self.times[name])

    def ratio(self, slow: str, fast: str) -> float:
        """How many times longer ``slow`` takes than ``fast``: the median of the ratios in the same round."""
        return statistics.median(a / b for a, b in zip(self.times[slow], self.times[fast], strict=True))

    def claim(self, text: str, goal: float, measured: float, at_least: bool = True) -> None:
        self.claims.append(Claim(text, goal, measured, at_least))


def compete(name: str, unit: str, contenders: Mapping[str, Contender], rounds: int = 7) -> Contest:
    """Let the contenders take turns; the first round is for warming up and does not count."""
    times: dict[str, list[float]] = {contender: [] for contender in contenders}
    names = list(contenders)
    for number in range(rounds + 1):
        for contender in names if number % 2 else reversed(names):
            seconds = contenders[contender]()
            if number:
                times[contender].append(seconds)
    return Contest(name, unit, times, load=os.getloadavg() if hasattr(os, "getloadavg") else (0.0, 0.0, 0.0))


def show(contests: Sequence[Contest]) -> None:
    """Print a table for each contest and one with the claims."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    for contest in contests:
        table = Table(title=f"{contest.name}: us for {contest.unit}", title_justify="left")
        for heading in ("", "median", "fastest", "slowest", "x the fastest"):
            table.add_column(heading, justify="left" if not heading else "right")
        best = min(contest.median(name) for name in contest.times)
        for name, times in contest.times.items():
            numbers = (contest.median(name), min(times), max(times))
            table.add_row(name, *(f"{1e6 * t:.3g}" for t in numbers), f"{contest.median(name) / best:.3g}")
        console.print(table)
        console.print(f"load average {contest.load[0]:.1f}, {len(next(iter(contest.times.values())))} rounds\n")
    table = Table(title="claims", title_justify="left")
    for heading in ("", "goal", "measured", ""):
        table.add_column(heading, justify="left" if not heading else "right")
    for claim in (claim for contest in contests for claim in contest.claims):
        goal = f"{'>=' if claim.at_least else '<='} {claim.goal:g}"
        table.add_row(claim.text, goal, f"{claim.measured:.3g}", "holds" if claim.holds else "[red]missed[/red]")
    console.print(table)


def write(contests: Sequence[Contest], path: Path) -> None:
    """Write everything measured as JSON."""
    from navfmu.system.provenance import versions

    path.parent.mkdir(parents=True, exist_ok=True)
    content = {
        "machine": {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count()},
        "versions": versions(),
        "contests": [
            {**asdict(contest), "claims": [{**asdict(c), "holds": c.holds} for c in contest.claims]}
            for contest in contests
        ],
    }
    path.write_text(json.dumps(content, indent=1) + "\n")


def main(run: Callable[[], Contest]) -> None:
    """Run one contest as a command: print it, and write it to the path given as argument."""
    import sys

    contest = run()
    show([contest])
    if len(sys.argv) > 1:
        write([contest], Path(sys.argv[1]))
