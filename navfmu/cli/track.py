"""``navfmu track``: a recorded flight becomes an FMU."""

from __future__ import annotations

import click


@click.command("track")
@click.argument("file", type=click.Path())
@click.option("--out", required=True, type=click.Path(dir_okay=False), help="The FMU to write.")
@click.option("--name", help="Name of the model; by default that of the file.")
@click.option("--minimum-speed", default=60.0, show_default=True, help="Ground speed above which it flies, in kn.")
@click.option("--skip-incomplete", is_flag=True, help="Leave out rows that lack time, position or altitude.")
@click.option("--picture", type=click.Path(dir_okay=False), help="Also draw track and residuals into this PNG file.")
def command(file, out, name, minimum_speed, skip_incomplete, picture):
    """Make an FMU with the interface of 'aircraft' from a recorded track.

    FILE is a CSV table with the columns time_s, latitude_deg, longitude_deg and altitude_ft, and if known
    groundspeed_kt, track_deg and vertical_rate_ft_min. Its airborne part is cut out and smoothed; the FMU plays it
    from t = 0. What was found in the recording, and what the smoothing changed, is printed.
    """
    from navfmu.constants import KNOT
    from navfmu.errors import NavfmuError
    from navfmu.recorded.archive import write_fmu
    from navfmu.recorded.importer import import_track
    from navfmu.system.result import check_file
    from navfmu.system.shipped import path as shipped
    from navfmu.terminal.progress import Progress

    if not 0 < minimum_speed < float("inf"):
        raise NavfmuError(f"--minimum-speed is {minimum_speed:g} kn; expected a positive number")
    check_file(out, ".fmu")
    if picture is not None:
        check_file(picture, ".png")
    if name is not None and not name.strip():
        raise NavfmuError("--name is empty; leave it out to take the name of the file")
    player = shipped("track.fmu")
    with Progress("importing the track") as progress:
        imported = import_track(file, minimum_speed * KNOT, skip_incomplete, progress=progress)
    write_fmu(imported, player, out, name)
    if picture:
        from navfmu.recorded.picture import draw

        draw(imported, picture)
    _print(imported, out, picture)


def _print(imported, out, picture) -> None:
    from rich.text import Text

    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{imported.source}: {imported.flight.duration / 60.0:.1f} minutes of flight")
    for sentence in imported.sentences():
        say(screen, f"- {sentence}", indent=2, hang=2)
    columns = [Column("quantity", Kind.WORD), Column("unit", Kind.WORD)]
    columns += map(Column, ("rows", "rms", "95 %", "largest"))
    rows = [[name, unit, str(n), *(f"{x:.2f}" for x in rest)] for name, unit, n, *rest in imported.residual_table()]
    screen.print(Table(columns, rows, "recorded minus smoothed", keys=2))
    screen.print(Text(f"wrote {out}" + (f" and {picture}" if picture else "")), soft_wrap=True)
