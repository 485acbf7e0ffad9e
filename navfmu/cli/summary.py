"""What ``navfmu run`` prints: a recording in a few numbers for each signal, none of which hides anything.

Only what has a mean gets one: no angle (the mean of 359 and 1 degrees is not 180), no counter, no mode, no signal with
a value that is not a finite number.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.text import Text

from navfmu.cli.display import Display
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

if TYPE_CHECKING:
    import pandas

    from navfmu.system.system import System

LISTED = 40  # signals
NAMES = [Column("signal", Kind.NAME), Column("unit", Kind.WORD)]


def summarise(frame: pandas.DataFrame, system: System, file: str | None) -> None:
    """The recording of a system, in display units, and where it went."""
    out, about = console(), frame.attrs["provenance"]
    seed = "the system's own" if about["seed"] is None else about["seed"]
    say(out, f"{about['stop']:g} s in steps of {about['step']:g} s, {about['algorithm']}, seed: {seed}")
    chosen = list(frame.columns)[:LISTED]
    for kinds, show in (("f", _reals), ("iu", _integers), ("b", _booleans)):
        names = [name for name in chosen if frame[name].dtype.kind in kinds]
        if names:
            show(out, frame[names], system)
    if len(frame.columns) > LISTED:
        out.print(f"... and {len(frame.columns) - LISTED} more signals")
    if file is not None:
        out.print(Text(f"wrote {len(frame)} rows to {file}"), soft_wrap=True)


def _reals(out: Console, frame: pandas.DataFrame, system: System) -> None:
    missing = {name: int(np.count_nonzero(~np.isfinite(frame[name]))) for name in frame}
    columns = [*NAMES, *map(Column, ("first", "least", "mean", "greatest", "last"))]
    columns += [Column("not finite")] if any(missing.values()) else []
    rows = []
    for name in frame:
        show, values = _display(system, name), frame[name].to_numpy()
        finite = values[np.isfinite(values)]
        mean = "-" if missing[name] or show.angle else show.text(np.mean(values))
        least, greatest = (show.text(f(finite)) if len(finite) else "-" for f in (np.min, np.max))
        row = [name, show.unit, show.text(values[0]), least, mean, greatest, show.text(values[-1])]
        rows.append([*row, *([f"{missing[name]} of {len(values)}"] if any(missing.values()) else [])])
    out.print(Table(columns, rows, keys=2))


def _integers(out: Console, frame: pandas.DataFrame, system: System) -> None:
    columns = [NAMES[0], *map(Column, ("first", "least", "greatest", "last"))]
    rows = []
    for name in frame:
        values = frame[name].to_numpy()
        rows.append([name, *(str(int(x)) for x in (values[0], values.min(), values.max(), values[-1]))])
    out.print(Table(columns, rows, "whole numbers"))


def _booleans(out: Console, frame: pandas.DataFrame, system: System) -> None:
    """A value counts until the next recorded time."""
    columns = [NAMES[0], Column("first", Kind.WORD), Column("last", Kind.WORD), Column("true, %")]
    columns.append(Column("changes"))
    lasting = np.diff(frame.index.to_numpy())
    rows = []
    for name in frame:
        values = frame[name].to_numpy(bool)
        share = np.sum(lasting * values[:-1]) / np.sum(lasting) if len(lasting) else float(values[0])
        changes = int(np.count_nonzero(values[1:] != values[:-1]))
        rows.append([name, *(str(bool(v)).lower() for v in values[[0, -1]]), _percent(share), str(changes)])
    out.print(Table(columns, rows, "true or false"))


def _percent(share: float) -> str:
    """Rounded to one decimal, but 0 and 100 only where it is so at all times."""
    return f"{100 * share:g}" if share in (0.0, 1.0) else f"{min(max(100 * share, 0.1), 99.9):.1f}"


def _display(system: System, name: str) -> Display:
    component, _, rest = name.removesuffix("@true").partition(".")
    about = system.fmus[component].description
    return Display.of(about.by_name[rest], about)
