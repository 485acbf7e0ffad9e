"""``navfmu calibrate imu``: the constant errors of an inertial unit, from stands and turns."""

from __future__ import annotations

import click


@click.command()
@click.argument("file", type=click.Path())
@click.option("--latitude", type=float, required=True, metavar="DEG", help="Where the unit stood.")
@click.option("--altitude", default=0.0, metavar="M", help="Above the ellipsoid.")
@click.option("--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Columns: time, or three of a sensor.")
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in the file.")
@click.option("--axes", default="x,y,z", metavar="AXES", help="Forward, right and down by the axes of the file.")
@click.option("--without", multiple=True, metavar="ERROR", help="An error that the unit does not have, or is known.")
@click.option("--fmu", metavar="FMU", help="The FMU that gets the parameters: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
@click.option("--covariance", type=click.Path(dir_okay=False), help="A table of values and covariances to write, .csv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, latitude, altitude, columns, units, axes, without, fmu, out, covariance, picture):
    """Find null shifts, scale factors, misalignments and more of the unit in FILE.

    FILE is a table, CSV or Parquet, or a log of PX4 (.ulg), of a unit that stood in one attitude after the other: time
    and rate_x, rate_y, rate_z (rad/s), specific_force_x, _y, _z (m/s2). On a table whose attitude is known, also roll,
    pitch, heading (rad) and, where it turns, table_rate (rad/s about the vertical, down). Without them the size of
    gravity tells what it can. What the stands do not tell is said, with what is missing; it is not among the
    parameters.

    \b
    navfmu calibrate imu turntable.parquet --latitude 47.7 --altitude 400 --fmu imu.fmu --out unit.ssv
    navfmu calibrate imu by_hand.csv --latitude 47.7 --unit rate=deg/s --picture stands.png
    """
    from pathlib import Path

    import numpy as np

    from navfmu.calibration.imu import parameters
    from navfmu.calibration.imu.determination import determine
    from navfmu.calibration.imu.stands import stands
    from navfmu.cli.parameter_set import receiver
    from navfmu.cli.place import elsewhere, within
    from navfmu.errors import visible
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import named
    from navfmu.system.result import check_file

    fmu = receiver(fmu, out, file)
    targets = {"--covariance": (covariance, ".csv"), "--picture": (picture, ".png")}
    for option, (target, kind) in targets.items():
        if target is not None:
            check_file(target, kind)
            elsewhere(target, option, file)
    latitude = np.radians(within(latitude, -90.0, 90.0, "--latitude", "deg"))
    altitude = within(altitude, -1000.0, 10000.0, "--altitude", "m")
    given = {name: unit for name, (unit,) in named(units, "--unit", parts=None).items()}
    turned = tuple(axis.strip() for axis in axes.split(","))
    found = determine(stands(file, latitude, altitude, named(columns, "--column"), given, turned), without)
    _print(found, bool(out))
    name = Path(file).name
    if out:
        text = f"Calibration of {visible(name)}, {len(found.stands.rate)} stands"
        write_file(out, parameters.document(found, fmu, text))
    if covariance:
        write_file(covariance, parameters.covariance(found).to_csv().encode())
    if picture:
        from navfmu.calibration.imu.picture import draw

        write_file(picture, draw(found, name))
    if out or covariance or picture:
        click.echo(f"wrote {', '.join(target for target in (out, covariance, picture) if target)}")


def _print(found, as_parameters: bool) -> None:
    from navfmu.calibration.allan.sensor import SENSORS
    from navfmu.calibration.imu.determination import lacking
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen, rows = console(), []
    say(screen, f"{found.stands.source}: {'; '.join(found.stands.sentences)}")
    for element in found.elements:
        if element.told:
            unit, factor = element.term.shown
            numbers = (f"{factor * number:.4g}" for number in (element.value, element.sigma, element.low, element.high))
            chance = "may be 0" if element.low < 0.0 < element.high else ""
            rows.append([element.term.name, element.axis, *numbers, unit, chance])
    words = [Column("error", Kind.NAME), Column("", Kind.WORD)]
    numbers = [Column("value"), Column("sigma"), Column("from"), Column("to"), Column("unit", Kind.WORD)]
    screen.print(Table([*words, *numbers, Column("", Kind.WORD)], rows, "errors, with intervals of 95 %", keys=2))
    for sensor, sigma, left in zip(SENSORS, found.fit.sigma, found.fit.left, strict=True):
        text = f"the mean of a stand scatters by {sigma:.3g} {sensor.unit} ({left:.0f} degrees of freedom)"
        say(screen, f"- {sensor.quantity}: {text}", indent=2, hang=2)
    for sentence in lacking(found):
        say(screen, f"- {sentence}", indent=2, hang=2)
    if as_parameters:
        other = [term.name for term in found.terms if not term.modelled]
        say(screen, f"- {', '.join(other)}: not among the parameters, a model has none", indent=2, hang=2)
