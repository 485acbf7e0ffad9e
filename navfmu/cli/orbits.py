"""``navfmu orbits``: broadcast ephemerides and almanacs become a table that FMUs carry."""

from __future__ import annotations

import click


@click.command("orbits")
@click.argument("files", type=click.Path(), nargs=-1, required=True, metavar="FILE...")
@click.option("--near", metavar="DATE", help="A date that an almanac is wanted for, as in 2006-11-15.")
@click.option("--out", type=click.Path(dir_okay=False), help="The table to write: .csv or .npy.")
def command(files, near, out):
    """Show the satellites of FILE..., and write their orbits and clocks as a table.

    A FILE is a RINEX navigation file of version 2 to 4, a YUMA or a SEM almanac, plain or packed by gzip. Almanacs
    count weeks modulo 1024: --near tells one from that of 20 years before. Files of several days go into one table.

    \b
    navfmu orbits brdc1770.20n.gz --out orbits.npy
    navfmu orbits yuma0377.txt --near 2006-11-15 --out orbits.csv
    navfmu table FMU orbits --from orbits.npy --out other.fmu
    """
    from navfmu.errors import NavfmuError
    from navfmu.files.numbers import packed
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.satellite import navigation
    from navfmu.satellite.file import read_orbits
    from navfmu.satellite.orbits import joined
    from navfmu.system.result import check_file

    target = None if out is None else check_file(out, ".csv", ".npy")
    day = None if near is None else _day(near)
    parts = [read_orbits(file, day) for file in files]
    if day is not None and all(part.kind == navigation.KIND for part in parts):
        raise NavfmuError(f"--near {near} is for almanacs; {files[0]} is a {navigation.KIND} file, which has dates")
    found = joined(parts) if len(parts) > 1 else parts[0]
    _print(found)
    if target is not None:
        write_file(target, packed(found.table()) if target.suffix.lower() == ".npy" else text(found.table()))
        click.echo(f"wrote {out}")


def _day(near):
    from datetime import date

    from navfmu.errors import NavfmuError, quoted

    try:
        return date.fromisoformat(near)
    except ValueError:
        raise NavfmuError(f"--near is '{quoted(near)}'; expected a date as in 2006-11-15") from None


def _print(found) -> None:
    from navfmu.terminal.console import console, say

    screen = console()
    say(screen, found.source)
    for sentence in found.sentences():
        say(screen, f"- {sentence}", indent=2, hang=2)
    if found.ionosphere is not None:
        for name, values in zip(("alpha", "beta"), found.ionosphere, strict=True):
            say(screen, f"- ionosphere, {name}: {' '.join(f'{value:.4e}' for value in values)}", indent=2, hang=2)
