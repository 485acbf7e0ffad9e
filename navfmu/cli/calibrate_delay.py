"""``navfmu calibrate delay``: how late the stamps of a GPS receiver are, by the inertial unit beside it."""

from __future__ import annotations

import click


@click.command()
@click.argument("inertial", type=click.Path())
@click.argument("receiver", type=click.Path())
@click.option("--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Columns, as in velocity_north=vn.")
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in its file.")
@click.option("--axes", default="x,y,z", metavar="AXES", help="Forward, right and down by the axes of INERTIAL.")
@click.option("--begin", type=float, metavar="SECONDS", help="Time from which velocities are taken.")
@click.option("--end", type=float, metavar="SECONDS", help="Time up to which they are.")
@click.option("--fmu", metavar="FMU", help="The navigator that gets fix_delay: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(inertial, receiver, columns, units, axes, begin, end, fmu, out, picture):
    """Find how late velocities in RECEIVER come, by rates and specific forces in INERTIAL.

    Two tables, CSV or Parquet, whose times count from the same moment. INERTIAL has rate_x, _y, _z (rad/s) and
    specific_force_x, _y, _z (m/s2); RECEIVER has velocity_north, _east and, if it tells it, _down (m/s). No attitude is
    needed: one is fitted to every 20 s, and biases to all. There must be turns.

    \b
    navfmu calibrate delay imu.parquet gps.parquet --picture delay.png
    navfmu calibrate delay imu.csv gps.csv --unit rate=deg/s --fmu navigator.fmu --out late.ssv
    """
    from navfmu.calibration.delay.fit import determine
    from navfmu.calibration.delay.parameters import document
    from navfmu.calibration.delay.picture import draw
    from navfmu.calibration.delay.recording import recording
    from navfmu.cli.parameter_set import receiver as taker
    from navfmu.cli.place import elsewhere
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import named
    from navfmu.system.result import check_file

    fmu = taker(fmu, out, inertial, receiver)
    if picture is not None:
        check_file(picture, ".png")
        elsewhere(picture, "--picture", inertial, receiver)
    given = {name: unit for name, (unit,) in named(units, "--unit", parts=None).items()}
    turned = tuple(part.strip() for part in axes.split(","))
    found = determine(recording(inertial, receiver, named(columns, "--column"), given, turned, begin, end))
    _print(found)
    if out:
        write_file(out, document(float(found.delay[0]), fmu, "Delay of the fixes of a GPS receiver"))
    if picture:
        write_file(picture, draw(found))
    if out or picture:
        click.echo(f"wrote {', '.join(str(name) for name in (out, picture) if name)}")


def _print(found) -> None:
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{found.source}: {found.velocities} velocities in {found.stretches} stretches")
    for sentence in found.sentences:
        say(screen, f"- {sentence}", indent=2, hang=2)
    columns = [Column("velocity", Kind.WORD), Column("delay, s"), Column("+-, s"), Column("left, m/s")]
    columns.append(Column("at 0 s, m/s"))
    numbers = zip(found.axes, found.delay, found.half, found.left, found.undelayed, strict=True)
    rows = [[name, f"{a:.3f}", f"{b:.3f}", f"{c:.3g}", f"{d:.3g}"] for name, a, b, c, d in numbers]
    screen.print(Table(columns, rows, "delay of velocity, with 95 % intervals", keys=1))
    say(
        screen,
        f"- navfmu replay gps ... --age {max(found.delay[0], 0.0):.2f} takes it off a recording",
        indent=2,
        hang=2,
    )
