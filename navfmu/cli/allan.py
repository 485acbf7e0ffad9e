"""``navfmu allan``: the errors of an inertial unit at rest, told apart by its Allan deviation."""

from __future__ import annotations

import click

FEWEST = 4
"""Points of a chart."""


@click.command("allan")
@click.argument("file", type=click.Path())
@click.option("--column", "columns", multiple=True, metavar="NAME=COLUMN", help="Columns: time, or three of a sensor.")
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a quantity in the file.")
@click.option(
    "--shortest", default=0.0, metavar="SECONDS", help="Averages over less tell of something else, as of vibration."
)
@click.option("--fmu", metavar="FMU", help="The FMU that gets the parameters: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, columns, units, shortest, fmu, out, picture):
    """Find out which errors make the Allan deviation of the unit in FILE, and how large they are.

    FILE is a table, CSV or Parquet, or a log of PX4 (.ulg), of a unit that lies still: time and rate_x, rate_y, rate_z
    (rad/s), specific_force_x, _y, _z (m/s2), or one of the sensors. Where it moves is left out. A term is told when the
    chart would look like that without it once in 1000 times at most; the interval holds its value in 95 of 100.

    \b
    navfmu allan rest.parquet --picture rest.png
    navfmu allan rest.csv --column rate=gx,gy,gz --unit rate=deg/s --fmu imu.fmu --out rest.ssv
    """
    from pathlib import Path

    from navfmu.calibration.allan import parameters
    from navfmu.calibration.allan.chart import chart
    from navfmu.calibration.allan.identification import identify
    from navfmu.calibration.allan.recording import recording
    from navfmu.cli.parameter_set import receiver
    from navfmu.cli.place import within
    from navfmu.errors import NavfmuError, visible
    from navfmu.files.writing import write_file
    from navfmu.recorded.replay.asked import named
    from navfmu.system.result import check_file

    fmu = receiver(fmu, out, file)
    if picture is not None:
        check_file(picture, ".png")
    shortest = within(shortest, 0.0, 1e6, "--shortest", "s")
    given = {name: unit for name, (unit,) in named(units, "--unit", parts=None).items()}
    taken = recording(file, named(columns, "--column"), given)
    charts = {sensor: chart(parts, taken.period) for sensor, parts in taken.stretches.items()}
    longest = next(iter(charts.values())).time[-1]
    kept = {sensor: one.beyond(shortest) for sensor, one in charts.items()}
    if len(next(iter(kept.values())).time) < FEWEST:
        raise NavfmuError(
            f"{file}: averages over {shortest:g} to {longest:.4g} s are fewer than four points of a chart; expected a "
            "longer rest, or a --shortest that leaves more"
        )
    found = {sensor: identify(one) for sensor, one in kept.items()}
    _print(taken, found, parameters.remarks(found) if out else [])
    if out:
        text = f"Allan deviation of {visible(Path(file).name)}, averages over up to {longest:.4g} s"
        write_file(out, parameters.document(parameters.parameters(found, taken.period), fmu, text))
    if picture:
        from navfmu.calibration.allan.picture import draw

        write_file(picture, draw(found, Path(file).name))
    if out or picture:
        click.echo(f"wrote {' and '.join(name for name in (out, picture) if name)}")


def _print(taken, found, remarks) -> None:
    from navfmu.calibration.allan.identification import CHANCE
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{taken.source}: {'; '.join(taken.sentences)}")
    rows = []
    for sensor, one in found.items():
        for term, *numbers in zip(one.terms, one.coefficients, one.low, one.high, strict=True):
            unit, factor = sensor.shown[term]
            for axis, value, low, high in zip("xyz", *numbers, strict=True):
                ends = [f"{factor * low:.4g}", f"{factor * high:.4g}"] if value else ["", ""]
                name = f"{sensor.quantity} {axis}"
                rows.append([name, term.name, f"{term.slope:+g}", term.symbol, f"{factor * value:.4g}", *ends, unit])
        if one.correlation_time:
            value, low, high = one.correlation_time
            rows.append([sensor.quantity, "Gauss-Markov", "", "tau", f"{value:.4g}", f"{low:.4g}", f"{high:.4g}", "s"])
    words = [Column("sensor", Kind.WORD), Column("term", Kind.WORD), Column("slope"), Column("", Kind.WORD)]
    numbers = [Column("value"), Column("from"), Column("to"), Column("unit", Kind.WORD)]
    screen.print(Table(words + numbers, rows, "error terms, with intervals of 95 %", keys=2))
    for sensor, one in found.items():
        last = one.chart.time[-1]
        text = f"{sensor.quantity}: slower errors than averages over {last:.4g} s show are not to be seen here"
        if one.chance < CHANCE:
            time, factor = one.farthest
            text += (
                f"; the terms do not explain the chart altogether: at {time:.3g} s it is {factor:.3g} times "
                "what they make"
            )
            if last >= 2.0**FEWEST * time:
                text += " (--shortest leaves averages over less out)"
        say(screen, f"- {text}", indent=2, hang=2)
    for sentence in remarks:
        say(screen, f"- {sentence}", indent=2, hang=2)
