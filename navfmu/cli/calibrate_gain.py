"""``navfmu calibrate gain``: the gain that three accelerometers have in common, from rest in any attitude."""

from __future__ import annotations

import click


@click.command()
@click.argument("file", type=click.Path())
@click.option("--latitude", type=float, required=True, metavar="DEG", help="Where the unit stood.")
@click.option("--altitude", default=0.0, metavar="M", help="Above the ellipsoid.")
@click.option("--known", type=click.Path(), metavar="SET", help="A parameter set (.ssv) with the errors as they were.")
@click.option("--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Columns: time, or three of a sensor.")
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in the file.")
@click.option("--axes", default="x,y,z", metavar="AXES", help="Forward, right and down by the axes of the file.")
@click.option("--fmu", metavar="FMU", help="The FMU that gets the scale factors: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
def command(file, latitude, altitude, known, columns, units, axes, fmu, out):
    """Find by how much the scale factors of the accelerometers in FILE have changed together.

    FILE is a table as for navfmu calibrate imu, of a unit at rest in any attitude, or in several. It is for units whose
    accelerometers share what makes their gain, and whose other errors are known.

    \b
    navfmu calibrate gain before_flight.csv --latitude 47.7 --known unit.ssv --fmu imu.fmu --out today.ssv
    """
    from pathlib import Path

    import numpy as np

    from navfmu.calibration.imu import gain
    from navfmu.calibration.imu.stands import stands
    from navfmu.cli.parameter_set import receiver
    from navfmu.cli.place import within
    from navfmu.errors import visible
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import named

    fmu = receiver(fmu, out, file, known)
    before = gain.known(known)
    latitude = np.radians(within(latitude, -90.0, 90.0, "--latitude", "deg"))
    altitude = within(altitude, -1000.0, 10000.0, "--altitude", "m")
    given = {name: unit for name, (unit,) in named(units, "--unit", parts=None).items()}
    turned = tuple(axis.strip() for axis in axes.split(","))
    taken = stands(file, latitude, altitude, named(columns, "--column"), given, turned)
    found = gain.gains(taken, before)
    _print(taken, found)
    if out:
        text = f"Common gain of accelerometers from {visible(Path(file).name)}"
        write_file(out, gain.document(float(found.mean()), before, fmu, text))
        click.echo(f"wrote {out}")


def _print(taken, found) -> None:
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Table

    screen = console()
    say(screen, f"{taken.source}: {'; '.join(taken.sentences)}")
    rows = [
        [f"{begin:.1f}", f"{seconds:.1f}", f"{1e6 * (one - 1.0):.1f}"]
        for begin, seconds, one in zip(taken.begin, taken.seconds, found, strict=True)
    ]
    screen.print(Table([Column("begins, s"), Column("lasts, s"), Column("K - 1, ppm")], rows, "common gain", keys=1))
    scatter = f", which scatters by {1e6 * found.std(ddof=1):.3g} ppm" if len(found) > 1 else ""
    say(screen, f"- mean K - 1: {1e6 * (found.mean() - 1.0):.4g} ppm{scatter}", indent=2, hang=2)
