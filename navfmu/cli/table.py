"""``navfmu table``: the tables that an FMU carries, as files that people read, and the other way round."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("table")
@click.argument("fmu", type=click.Path())
@click.argument("name", required=False)
@click.option("--from", "source", type=click.Path(), help="Put the numbers of this file, .csv or .npy, in their place.")
@click.option("--out", type=click.Path(dir_okay=False), help="The .csv or .npy file to write; with --from the .fmu.")
def command(fmu: str, name: str | None, source: str | None, out: str | None) -> None:
    """Show the tables of FMU, write the one of this NAME to a file, or replace it.

    \b
    navfmu table track.fmu                                            which there are
    navfmu table track.fmu track --out track.csv                      see the numbers
    navfmu table track.fmu track --from track.csv --out other.fmu     use other numbers

    A table is an array of records in a file of NumPy's format, resources/NAME.npy. Nothing is compiled: an FMU reads
    its tables when it is instantiated, and says then what is wrong with them.
    """
    from navfmu.errors import NavfmuError
    from navfmu.fmi import tables

    if name is None:
        if source or out:
            raise NavfmuError(f"{fmu}: which table? Its name is missing; without --from and --out they are listed")
        _show(fmu, tables.contents(fmu))
    elif out is None:
        raise NavfmuError(f"{fmu}: --out is missing, the file to write: .fmu with --from, else .csv or .npy")
    elif source is None:
        _write(fmu, name, out)
    else:
        _replace(fmu, name, source, out)


def _write(fmu: str, name: str, out: str) -> None:
    from navfmu.files.numbers import packed
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.fmi import tables
    from navfmu.system.result import check_file

    target = check_file(out, ".csv", ".npy")
    columns = tables.read(tables.contents(fmu), name, fmu)
    write_file(target, packed(columns) if target.suffix.lower() == ".npy" else text(columns))
    click.echo(f"wrote {out}")


def _replace(fmu: str, name: str, source: str, out: str) -> None:
    from navfmu.errors import NavfmuError
    from navfmu.files.archive import zipped
    from navfmu.files.numbers import unpacked
    from navfmu.files.numbers_as_text import columns
    from navfmu.files.reading import read_bytes
    from navfmu.files.writing import write_file
    from navfmu.fmi import tables
    from navfmu.system.result import check_file

    suffix = Path(source).suffix.lower()
    if suffix not in (".csv", ".npy"):
        raise NavfmuError(f"{source}: cannot tell the format from the name; expected .csv or .npy at its end")
    target = check_file(out, ".fmu")
    data = read_bytes(source, "a table", tables.LIMIT)
    files = tables.contents(fmu)
    if suffix == ".npy":
        found = unpacked(data, source)
    else:
        found = columns(data.decode("utf-8", "replace"), tables.read(files, name, fmu), source)
    write_file(target, zipped(tables.replaced(files, name, found, fmu)))
    click.echo(f"wrote {out}")


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
