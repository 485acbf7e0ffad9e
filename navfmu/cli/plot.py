"""``navfmu plot``: signals of a recording as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from navfmu.cli.options import names

if TYPE_CHECKING:
    import pandas


@click.command("plot")
@click.argument("file")
@click.argument("signals", metavar="[SIGNAL]...", nargs=-1)
@click.option("--out", metavar="FILE.png", help="The picture; default: beside FILE, with its name.")
def command(file: str, signals: tuple[str, ...], out: str | None) -> None:
    """Draw signals of FILE, a recording (.parquet or .csv), over time; without a SIGNAL, list them.

    SIGNAL names a signal, an array, a bundle, a component or a pattern. Each unit has a panel of its own, and the times
    of faults are shaded.
    """
    from navfmu.system import recording_picture, result

    frame = recording_picture.read(file)
    if not signals:
        _list(frame)
        return
    chosen = names(signals)
    target = result.check_file(recording_picture.beside(file) if out is None else out, ".png")
    made = recording_picture.write(frame, chosen, file, target)
    click.echo(f"wrote {len(made)} signal{'s' if len(made) > 1 else ''} to {target}")


def _list(frame: pandas.DataFrame) -> None:
    """Every signal with its unit and its range."""
    from navfmu.report.finite import extremes, remark
    from navfmu.report.scene import readable
    from navfmu.terminal.console import console
    from navfmu.terminal.table import Column, Kind, Table

    columns = [Column("signal", Kind.NAME), Column("unit", Kind.WORD), Column("least"), Column("greatest")]
    rows: list[list[str]] = []
    for name in frame:
        values = frame[name].to_numpy(float)
        least, greatest = (readable(value) for value in extremes(values))
        unit = "true, false" if frame[name].dtype.kind == "b" else frame.attrs["units"].get(name) or ""
        rows.append([name, unit, least, greatest, remark([values])])
    if any(row[-1] for row in rows):
        columns.append(Column("remark", Kind.SENTENCE))
    rows = [row[: len(columns)] for row in rows]
    console().print(Table(columns, rows, f"{len(rows)} signals, {frame.index[0]:g} to {frame.index[-1]:g} s"))
