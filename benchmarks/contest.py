"""Rounds in which contenders take turns, and what is said about them."""

from __future__ import annotations

import json
import os
import platform
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from navfmu.report.claim import Claim

Contender = Callable[[], float]
"""Does its share of work and returns the seconds for one unit of it."""


@dataclass
class Contest:
    """Times of all contenders (s for one unit, one number for each round) and the claims checked on them."""

    name: str
    unit: str
    times: dict[str, list[float]]
    claims: list[Claim] = field(default_factory=list)
    work: str = ""  # what each contender does for one unit, and what it skips
    load: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def median(self, name: str) -> float:
        return statistics.median(self.times[name])

    def ratio(self, slow: str, fast: str) -> float:
        """How many times longer ``slow`` takes than ``fast``: the median of the ratios in the same round."""
        return statistics.median(a / b for a, b in zip(self.times[slow], self.times[fast], strict=True))

    def claim(self, text: str, bound: float, measured: float, at_least: bool = True, unit: str = "") -> None:
        self.claims.append(Claim(text, measured, bound, at_least, unit))


def compete(name: str, unit: str, contenders: Mapping[str, Contender], rounds: int = 7, work: str = "") -> Contest:
    """Let the contenders take turns; the first round is for warming up and does not count."""
    times: dict[str, list[float]] = {contender: [] for contender in contenders}
    names = list(contenders)
    for number in range(rounds + 1):
        for contender in names if number % 2 else reversed(names):
            seconds = contenders[contender]()
            if number:
                times[contender].append(seconds)
    load = os.getloadavg() if hasattr(os, "getloadavg") else (0.0, 0.0, 0.0)
    return Contest(name, unit, times, load=load, work=work)


def show(contests: Sequence[Contest]) -> None:
    """Print a table for each contest and one with the claims."""
    from rich.text import Text

    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    out = console()
    for contest in contests:
        columns = [Column("", Kind.NAME), *map(Column, ("median", "fastest", "slowest", "x the fastest"))]
        best = min(contest.median(name) for name in contest.times)
        rows = []
        for name, times in contest.times.items():
            numbers = (contest.median(name), min(times), max(times))
            rows.append([name, *(f"{1e6 * t:.3g}" for t in numbers), f"{contest.median(name) / best:.3g}"])
        out.print(Table(columns, rows, f"{contest.name}: us for {contest.unit}"))
        if contest.work:
            say(out, contest.work)
        rounds = len(next(iter(contest.times.values())))
        say(out, f"load average {contest.load[0]:.1f}, {rounds} rounds\n")
    columns = [Column("verdict", Kind.WORD), Column("measured"), Column("bound"), Column("claim", Kind.SENTENCE)]
    claims = [claim for contest in contests for claim in contest.claims]
    rows = [[Text(c.verdict, style="green" if c.holds else "red"), c.finding, c.limit, c.text] for c in claims]
    out.print(Table(columns, rows, "claims"))


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


def main(run: Callable[[], Sequence[Contest]]) -> None:
    """Run one benchmark as a command: print its contests, and write them to the path given as argument."""
    import sys

    contests = run()
    show(contests)
    if len(sys.argv) > 1:
        write(contests, Path(sys.argv[1]))
