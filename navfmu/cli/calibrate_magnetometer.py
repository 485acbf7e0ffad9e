"""``navfmu calibrate magnetometer``: hard iron, gains and soft iron from fields that were measured in turns."""

from __future__ import annotations

import click


@click.command()
@click.argument("file", type=click.Path())
@click.option("--method", default="automatic", help="As below.  [default: automatic]")
@click.option("--field", "strength", metavar="STRENGTH", help="Strength of Earth's field there, as in '55.9 uT'.")
@click.option("--place", type=(float, float), metavar="LAT LON", help="Degrees: the strength is that of the WMM there,")
@click.option("--date", type=float, metavar="YEAR", help="at this date, in decimal years.")
@click.option(
    "--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Columns: time, heading, three of field."
)
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in the file.")
@click.option("--axes", default="x,y,z", metavar="AXES", help="Forward, right and down by the axes of the file.")
@click.option("--begin", type=float, metavar="SECONDS", help="Time of the file from which samples are taken.")
@click.option("--end", type=float, metavar="SECONDS", help="Time up to which they are.")
@click.option("--fmu", metavar="FMU", help="The FMU that gets the parameters: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
@click.option("--table", type=click.Path(dir_okay=False), help="A table to write, .csv or .json.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, method, strength, place, date, columns, units, axes, begin, end, fmu, out, table, picture):
    """Find the errors of the triad in FILE, which was turned in Earth's field, from the strength of that field.

    FILE is a table, CSV or Parquet, or a log of PX4 (.ulg), with field_x, field_y and field_z (T).

    \b
    automatic        the first of ellipsoid, axes, sphere, hard-iron, ellipse, circle that the turns allow
    ellipsoid        hard iron, gains and soft iron
    axes             hard iron and a gain of each axis
    sphere           hard iron and one gain
    hard-iron        hard iron, with gains of 1
    ellipse, circle  level turns: x and y alone (thesis, CMFD-2)
    two-step, batch  those of the thesis, a gain of each axis (CMFD-3)
    swinging         level, at known headings, which FILE has (heading: rad, magnetic)

    What the turns do not allow is refused in a sentence, and the next method taken.

    \b
    navfmu calibrate magnetometer flight.parquet --place 45.3 -93.2 --date 2012.8 --picture iron.png
    navfmu calibrate magnetometer swing.csv --method swinging --unit field=mG --unit heading=deg
    navfmu calibrate magnetometer turns.csv --field "480 mG" --fmu field_correction.fmu --out iron.ssv
    """
    from navfmu.calibration.magnetometer.calibration import calibrate
    from navfmu.calibration.magnetometer.parameters import document
    from navfmu.calibration.magnetometer.recording import recording
    from navfmu.calibration.magnetometer.table import as_csv, as_json
    from navfmu.cli.parameter_set import receiver
    from navfmu.cli.place import elsewhere
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import named
    from navfmu.system.result import check_file

    fmu = receiver(fmu, out, file)
    targets = {"--table": (table, ".csv", ".json"), "--picture": (picture, ".png")}
    for option, (path, *kinds) in targets.items():
        if path is not None:
            check_file(path, *kinds)
            elsewhere(path, option, file)
    given = {name: unit for name, (unit,) in named(units, "--unit", parts=None).items()}
    turned = tuple(part.strip() for part in axes.split(","))
    taken = recording(file, named(columns, "--column"), given, turned, begin, end)
    found = calibrate(taken, _earth(strength, place, date), method)
    _print(found)
    if out:
        write_file(out, document(found.errors, fmu, f"Calibration of a magnetometer, {found.method}"))
    if table:
        write_file(table, as_csv(found) if str(table).lower().endswith(".csv") else as_json(found))
    if picture:
        write_file(picture, found.picture())
    if out or table or picture:
        click.echo(f"wrote {', '.join(str(name) for name in (out, table, picture) if name)}")


def _earth(strength, place, date):
    """The field that was told, or that of a place and a date, or none."""
    from navfmu.calibration.magnetometer.place import Field, field_at
    from navfmu.cli.place import place as checked
    from navfmu.cli.place import within
    from navfmu.errors import NavfmuError
    from navfmu.recorded.replay.asked import amount

    if (place is None) != (date is None):
        raise NavfmuError("--place and --date belong together: where and when the field is that of the model")
    if strength is not None and place is not None:
        raise NavfmuError("--field and --place both tell the strength of the field; expected one of them")
    if strength is not None:
        return Field(1e-6 * within(1e6 * amount(strength, "T", "--field"), 10.0, 100.0, "--field", "uT"))
    return Field() if place is None else field_at(*checked(place, "--place"), date)


def _print(found) -> None:
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{found.source}: {found.method}")
    for sentence in found.sentences:
        say(screen, f"- {sentence}", indent=2, hang=2)
    columns = [Column("error", Kind.WORD), Column("value"), Column("sigma"), Column("unit", Kind.WORD)]
    rows = [[row.name, f"{row.value:.4g}", f"{row.sigma:.2g}", row.unit] for row in found.rows]
    screen.print(Table(columns, rows, "errors of the triad, with standard deviations", keys=1))
