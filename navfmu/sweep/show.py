"""A sweep in the terminal: errors, lost samples, recommendation."""

from __future__ import annotations

import math
from pathlib import Path

from rich.console import Console
from rich.text import Text

from navfmu.sweep.recommendation import measure, recommendation
from navfmu.sweep.result import ALGORITHMS, Row, Sweep
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table


def show(result: Sweep, report: Path | None) -> None:
    """Print the tables, the recommendation and where the report is."""
    out = console()
    say(out, f"{result.stop:g} s at {len(result.steps)} step sizes, {' and '.join(ALGORITHMS)}, {result.seeded}")
    _errors(out, result)
    _lost(out, result)
    say(out, recommendation(result))
    if report is not None:
        out.print(Text(f"report: {report}"), soft_wrap=True)


def _errors(out: Console, result: Sweep) -> None:
    """One row for each signal and algorithm, or, where that is too wide, a block for each signal with a row a step."""
    title = f"{result.system}: rms error against the same algorithm at {result.steps[0]:g} s"
    headings = [*(f"{step:g} s" for step in result.steps[1:]), "order"]
    columns = [Column("signal", Kind.NAME), Column("unit", Kind.WORD), Column("algorithm", Kind.WORD)]
    columns += [*map(Column, headings), Column("algorithms apart")]
    rows = []
    for signal in result.signals:
        for algorithm in ALGORITHMS:
            apart = _apart(result, signal, "") if algorithm == ALGORITHMS[0] else ""
            unit = result.of(algorithm, signal)[0].unit
            rows.append([signal, unit, algorithm, *_numbers(result, signal, algorithm), apart])
    wide = Table(columns, rows, title)
    if wide.fits(out.width):
        out.print(wide)
        return
    say(out, Text(title, style="italic"))
    for signal in result.signals:
        unit = result.of(ALGORITHMS[0], signal)[0].unit
        say(out, f"{signal}, algorithms {_apart(result, signal, unit)} apart")
        values = zip(headings, *(_numbers(result, signal, algorithm) for algorithm in ALGORITHMS), strict=True)
        out.print(Table([Column("step", Kind.WORD), *map(Column, ALGORITHMS)], values))


def _apart(result: Sweep, signal: str, unit: str) -> str:
    """How far the algorithms are apart; "-" where values are not finite."""
    return measure(result.apart[signal], unit) if math.isfinite(result.apart[signal]) else "-"


def _numbers(result: Sweep, signal: str, algorithm: str) -> list[str]:
    """Errors above the smallest step, at which there is none, and their order."""
    order = result.order(algorithm, signal)
    return [*map(number, result.of(algorithm, signal)[1:]), "-" if order is None else str(order)]


def number(row: Row) -> str:
    """An rms error, or what stands in its place."""
    return "nan" if row.problem else f"{row.rms:.3g}"


def _lost(out: Console, result: Sweep) -> None:
    if not result.lost:
        return
    rows = [
        [name, algorithm, *(str(counts[algorithm, step]) for step in result.steps)]
        for name, counts in result.lost.items()
        for algorithm in ALGORITHMS
        if any(counts[algorithm, step] for step in result.steps)
    ]
    if not rows:
        out.print("no samples were lost at any step")
        return
    columns = [Column("counter", Kind.NAME), Column("algorithm", Kind.WORD)]
    columns += [Column(f"{step:g} s") for step in result.steps]
    out.print(Table(columns, rows, "samples lost between components", keys=2))
