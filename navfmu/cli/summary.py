"""What ``navfmu run`` prints: a recording in a few numbers for each signal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from navfmu.system.summary import Block, summary
from navfmu.terminal.console import console, say
from navfmu.terminal.table import Column, Kind, Table

if TYPE_CHECKING:
    import pandas

    from navfmu.system.system import System

LISTED = 40  # signals


def summarise(frame: pandas.DataFrame, system: System, file: str | None) -> None:
    """The recording of a system, in display units, and where it went."""
    out, about = console(), frame.attrs["provenance"]
    seed = "the system's own" if about["seed"] is None else about["seed"]
    say(out, f"{about['stop']:g} s in steps of {about['step']:g} s, {about['algorithm']}, seed: {seed}")
    for block in summary(frame[frame.columns[:LISTED]], system):
        names = sum(heading in ("signal", "unit") for heading in block.headings)
        out.print(Table(_columns(block), block.rows, block.title, keys=names))
    if len(frame.columns) > LISTED:
        out.print(f"... and {len(frame.columns) - LISTED} more signals")
    if file is not None:
        out.print(Text(f"wrote {len(frame)} rows to {file}"), soft_wrap=True)


def _columns(block: Block) -> list[Column]:
    kinds = {"signal": Kind.NAME} | {word: Kind.WORD for word in block.words if word != "signal"}
    return [Column(heading, kinds.get(heading, Kind.NUMBER)) for heading in block.headings]
