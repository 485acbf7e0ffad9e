"""``navfmu table``: the tables that an FMU carries, as files that people read, and the other way round."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("table")
@click.argument("fmu", type=click.Path())
@click.argument("name", required=False)
@click.option("--from", "source", type=click.Path(), help="Take the numbers from this file, .csv or .npy.")
@click.option("--as", "file", metavar="OTHER", help="Add them as resources/OTHER.npy, and leave the table as it is.")
@click.option("--out", type=click.Path(dir_okay=False), help="The file to write: .csv, .npy, or with --from an .fmu.")
def command(fmu: str, name: str | None, source: str | None, file: str | None, out: str | None) -> None:
    """Show the tables of FMU, write the one of this NAME to a file, or replace it.

    FMU is a file, or the name of one that is shipped.

    \b
    navfmu table track.fmu                                            which there are
    navfmu table track.fmu track --out track.csv                      see the numbers
    navfmu table track.fmu track --from track.csv --out other.fmu     use other numbers
    navfmu table track.fmu track --from track.csv --out track.npy     make a file that an FMU reads

    A table is an array of records in a file of NumPy's format, resources/NAME.npy. Nothing is compiled: an FMU reads
    its tables when it is instantiated, those that a string parameter names when initialisation ends, and says then what
    is wrong with them.
    """
    from navfmu.errors import NavfmuError
    from navfmu.files.archive import zipped
    from navfmu.files.numbers import packed
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.fmi import tables
    from navfmu.system import shipped
    from navfmu.system.result import check_file

    fmu = str(_of(fmu, shipped.find))
    if name is None:
        if source or file is not None or out:
            raise NavfmuError(f"{fmu}: which table? Its name is missing; without options they are listed")
        _show(fmu, tables.contents(fmu))
        return
    if out is None:
        raise NavfmuError(f"{fmu}: --out is missing, the file to write: .csv, .npy, or with --from an .fmu")
    target = check_file(out, ".csv", ".npy", *([".fmu"] if source else []))
    form = target.suffix.lower()
    if file is not None and form != ".fmu":
        raise NavfmuError(f"--as {file} names a file within an FMU; {out} is none, expected .fmu at its end")
    given = _given(source) if source else None
    files = tables.contents(fmu)
    columns = tables.read(files, name, fmu)
    if source:
        columns = tables.like(columns, given, source)
    if form == ".fmu":
        content = zipped(tables.replaced(files, name if file is None else file, columns, fmu))
    else:
        content = packed(columns) if form == ".npy" else text(columns)
    write_file(target, content)
    click.echo(f"wrote {out}")


def _of(fmu, find):
    """The file of this name, or what is shipped under it."""
    from navfmu.files.reading import what_is

    return fmu if Path(fmu).name != fmu or what_is(fmu) else find(fmu) or fmu


def _given(source: str) -> bytes:
    """What a file with numbers holds."""
    from navfmu.errors import NavfmuError
    from navfmu.files.reading import read_bytes
    from navfmu.fmi import tables

    if Path(source).suffix.lower() not in (".csv", ".npy"):
        raise NavfmuError(f"{source}: cannot tell the format from the name; expected .csv or .npy at its end")
    return read_bytes(source, "a table", tables.LIMIT)


def _show(fmu: str, files: dict) -> None:
    from navfmu.files.numbers import is_grid
    from navfmu.fmi import tables
    from navfmu.terminal.console import console
    from navfmu.terminal.table import Column, Kind, Table

    rows = []
    for name in tables.known(files):
        columns = tables.read(files, name, fmu)
        first, second, *_ = (*columns.values(), ())
        size = f"{len(first)} x {len(second)}" if is_grid(columns) else f"{len(first)} rows"
        rows.append([name, size, ", ".join(columns)])
    if not rows:
        click.echo(f"{fmu} has no tables")
        return
    console().print(Table([Column("table", Kind.NAME), Column("size"), Column("columns", Kind.SENTENCE)], rows, keys=1))
