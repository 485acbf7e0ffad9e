"""A recording in a few numbers for each signal, none of which hides anything.

Only what has a mean gets one: no angle (the mean of 359 and 1 degrees is not 180), no counter, no mode, no signal with
a value that is not a finite number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navfmu.system.assembly import Assembly
from navfmu.system.display import Display

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Block:
    """Signals of one kind, a row each; those of ``words`` are headings over words, the others over numbers."""

    title: str
    headings: tuple[str, ...]
    rows: list[list[str]]
    words: tuple[str, ...]


def summary(frame: pandas.DataFrame, system: Assembly) -> Iterator[Block]:
    """The signals of a recording of a system, in display units: numbers, whole numbers, what is true or false."""
    for kinds, block in (("f", _reals), ("iu", _integers), ("b", _booleans)):
        names = [name for name in frame.columns if frame[name].dtype.kind in kinds]
        if names:
            yield block(frame[names], system)


def _reals(frame: pandas.DataFrame, system: Assembly) -> Block:
    missing = {name: int(np.count_nonzero(~np.isfinite(frame[name]))) for name in frame}
    headings = ("signal", "unit", "first", "least", "mean", "greatest", "last")
    headings += ("not finite",) if any(missing.values()) else ()
    rows = []
    for name in frame:
        show, values = _display(system, name), frame[name].to_numpy()
        finite = values[np.isfinite(values)]
        mean = "-" if missing[name] or show.angle else show.text(np.mean(values))
        least, greatest = (show.text(f(finite)) if len(finite) else "-" for f in (np.min, np.max))
        row = [name, show.unit, show.text(values[0]), least, mean, greatest, show.text(values[-1])]
        rows.append([*row, *([f"{missing[name]} of {len(values)}"] if any(missing.values()) else [])])
    return Block("", headings, rows, ("signal", "unit"))


def _integers(frame: pandas.DataFrame, system: Assembly) -> Block:
    rows = []
    for name in frame:
        values = frame[name].to_numpy()
        rows.append([name, *(str(int(x)) for x in (values[0], values.min(), values.max(), values[-1]))])
    return Block("whole numbers", ("signal", "first", "least", "greatest", "last"), rows, ("signal",))


def _booleans(frame: pandas.DataFrame, system: Assembly) -> Block:
    """A value counts until the next recorded time."""
    lasting = np.diff(frame.index.to_numpy())
    rows = []
    for name in frame:
        values = frame[name].to_numpy(bool)
        share = np.sum(lasting * values[:-1]) / np.sum(lasting) if len(lasting) else float(values[0])
        changes = int(np.count_nonzero(values[1:] != values[:-1]))
        rows.append([name, *(str(bool(v)).lower() for v in values[[0, -1]]), _percent(share), str(changes)])
    headings = ("signal", "first", "last", "true, %", "changes")
    return Block("true or false", headings, rows, ("signal", "first", "last"))


def _percent(share: float) -> str:
    """Rounded to one decimal, but 0 and 100 only where it is so at all times."""
    return f"{100 * share:g}" if share in (0.0, 1.0) else f"{min(max(100 * share, 0.1), 99.9):.1f}"


def _display(system: Assembly, name: str) -> Display:
    component, _, rest = name.removesuffix("@true").partition(".")
    about = system.fmus[component].description
    return Display.of(about.by_name[rest], about)
