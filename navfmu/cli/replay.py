"""``navfmu replay``: recorded samples of a sensor become an FMU that takes its place."""

from __future__ import annotations

import click

OBSERVATIONS = "observations"


@click.command("replay")
@click.argument("sensor")
@click.argument("file", type=click.Path())
@click.option("--out", required=True, type=click.Path(dir_okay=False), help="The FMU to write.")
@click.option(
    "--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Column of a quantity; three of a vector."
)
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in the file.")
@click.option("--axes", multiple=True, metavar="[NAME=]AXES", help="Forward, right and down by the axes of the file.")
@click.option("--add", multiple=True, metavar="NAME=NUMBER", help="What is added to a quantity, after units and axes.")
@click.option("--value", "values", multiple=True, metavar="NAME=NUMBER", help="A constant for what was not recorded.")
@click.option("--start", type=float, metavar="SECONDS", help="Time of the file that is t = 0.  [default: its 0]")
@click.option("--age", default=0.0, metavar="SECONDS", help="How long before its time in the file a sample was valid.")
@click.option(
    "--incomplete", default="refuse", metavar="WHAT", help="Rows that lack a number: refuse (the default) or invalid."
)
@click.option("--changes-only", is_flag=True, help="Leave out samples that repeat the one before.")
@click.option("--unchecked", is_flag=True, help="Take what is not plausible, and say it.")
@click.option("--nav", multiple=True, type=click.Path(), help="Orbits for observations: a RINEX navigation file.")
@click.option(
    "--ionosphere", type=click.Path(dir_okay=False), help="Also write that of --nav as parameters of gps_solver, .ssv."
)
@click.option("--name", help="Name of the model; by default that of the file.")
@click.option("--picture", type=click.Path(dir_okay=False), help="Also draw the samples into this PNG file.")
def command(sensor, file, out, name, picture, nav, ionosphere, columns, units, axes, add, values, **others):
    """Make an FMU with the interface of SENSOR from the samples in FILE.

    SENSOR is imu, magnetometer, air_data, gps or observations.

    FILE is a table, CSV or Parquet, or a log of PX4 (.ulg). Each sample is published at the first tick that is not
    before its time. What is found in the file, and what is lost, is printed. For observations of satellites FILE is a
    RINEX file of version 2 to 4, --nav names one of orbits (or several), and the FMU feeds gps_solver.

    \b
    navfmu replay imu flight.parquet --out imu_flight.fmu
    navfmu replay imu flight.csv --out imu_flight.fmu --column rate=gx,gy,gz --unit rate=deg/s \\
        --column specific_force=ax,ay,az --unit specific_force=g --axes x,-y,-z --unit time=ms
    navfmu replay gps flight.csv --out gps_flight.fmu --unit latitude="1e-7 deg" --age 0.2
    navfmu replay observations esbc1770.20o --nav brdc1770.20n.gz --out observations.fmu
    """
    from navfmu.errors import NavfmuError, nearest
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import Asked, named
    from navfmu.recorded.replay.importer import SUFFIX, import_samples
    from navfmu.system import shipped
    from navfmu.system.result import check_file

    check_file(out, ".fmu")
    if picture is not None:
        check_file(picture, ".png")
    if ionosphere is not None:
        check_file(ionosphere, ".ssv")
    if name is not None and not name.strip():
        raise NavfmuError("--name is empty; leave it out to take the name of the file")
    known = [n.removesuffix(f"{SUFFIX}.fmu") for n in shipped.names(".fmu") if n.endswith(f"{SUFFIX}.fmu")]
    if sensor not in known:
        raise NavfmuError(f"there is no sensor '{sensor}'; expected {', '.join(known)}{nearest(sensor, known)}")
    asked = Asked(
        columns=named(columns, "--column"),
        units={quantity: unit for quantity, (unit,) in named(units, "--unit", parts=None).items()},
        axes=named(axes, "--axes", bare=True),
        add=named(add, "--add"),
        values=named(values, "--value"),
        **others,
    )
    player = shipped.path(f"{sensor}{SUFFIX}.fmu")
    if sensor == OBSERVATIONS:
        from navfmu.recorded.observations.picture import draw

        imported = _observations(file, nav, player, asked)
    elif nav or ionosphere:
        raise NavfmuError(f"--{'nav' if nav else 'ionosphere'} is for {OBSERVATIONS}; expected none for {sensor}")
    else:
        from navfmu.recorded.replay.picture import draw

        imported = import_samples(_read(file, sensor), player, asked)
    if ionosphere:
        write_file(ionosphere, imported.ionosphere(shipped.path("gps_solver.fmu")))
    imported.write(out, name)
    if picture:
        draw(imported, picture)
    _print(imported, out, picture)


def _observations(file, nav, player, asked):
    """Observations of satellites; of what can be said of a table little is for them."""
    import dataclasses

    from navfmu.errors import NavfmuError, nearest
    from navfmu.recorded.observations.epochs import USUAL
    from navfmu.recorded.observations.importer import import_observations
    from navfmu.recorded.replay.asked import Asked
    from navfmu.system import shipped

    if not nav:
        raise NavfmuError(f"{OBSERVATIONS} need orbits; expected --nav with a RINEX navigation file")
    taken = ("columns", "start", "unchecked")
    for field in dataclasses.fields(Asked):
        if field.name not in taken and getattr(asked, field.name) != getattr(Asked(), field.name):
            option = {"values": "value", "units": "unit"}.get(field.name, field.name.replace("_", "-"))
            raise NavfmuError(
                f"--{option} is not for {OBSERVATIONS}; expected at most --column, --start, --unchecked, --name and "
                "--picture"
            )
    dataclasses.replace(asked, columns={}).check([], [])
    for name, columns in asked.columns.items():
        if name not in USUAL or len(columns) != 1:
            raise NavfmuError(
                f"--column {name}={','.join(columns)}: expected one of {', '.join(USUAL)}, with one observation of "
                f"RINEX 3, as in --column pseudorange=C1W{nearest(name, USUAL)}"
            )
    names = {name: column for name, (column,) in asked.columns.items()}
    solver = shipped.path("gps_solver.fmu")
    return import_observations(file, nav, player, names, asked.start, asked.unchecked, solver)


def _read(file, sensor):
    """The columns of a file, of a log of PX4 those of the sensor."""
    from navfmu.recorded.replay import file as tables
    from navfmu.recorded.replay import px4

    return px4.read(file, sensor) if file.lower().endswith(".ulg") else tables.read(file)


def _print(imported, out, picture) -> None:
    from rich.text import Text

    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{imported.source}: {imported.duration:.1f} s")
    for sentence in imported.sentences():
        say(screen, f"- {sentence}", indent=2, hang=2)
    columns = [Column("quantity", Kind.WORD), Column("unit", Kind.WORD), *map(Column, ("least", "middle", "largest"))]
    rows = [[quantity, unit, *(f"{x:.6g}" for x in numbers)] for quantity, unit, *numbers in imported.ranges()]
    screen.print(Table(columns, rows, "samples", keys=2))
    screen.print(Text(f"wrote {out}" + (f" and {picture}" if picture else "")), soft_wrap=True)
