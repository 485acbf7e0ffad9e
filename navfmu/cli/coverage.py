"""``navfmu coverage``: how many stations are heard on a grid or along a track, and how well their circles cross."""

from __future__ import annotations

import click


@click.command("coverage")
@click.argument("file", type=click.Path())
@click.option("--near", nargs=2, type=float, metavar="LAT LON", help="The middle of a grid, in degrees.")
@click.option("--radius", type=float, metavar="NMI", help="From the middle to the sides.  [default: 40]")
@click.option("--height", "heights", multiple=True, type=float, metavar="FT", help="Above the ground.  [500 and 1500]")
@click.option("--points", type=int, metavar="N", help="Along each side of the grid.  [default: 61]")
@click.option("--track", type=click.Path(), help="A recorded track (CSV) in place of a grid.")
@click.option("--ground", default=0.0, metavar="FT", help="Height of the ground above the sea.  [default: 0]")
@click.option("--out", type=click.Path(dir_okay=False), help="A table of all points to write, .csv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, near, radius, heights, points, track, ground, out, picture):
    """Show how many stations of FILE are heard, and the horizontal dilution of precision of their distances.

    FILE is what 'navfmu stations' reads. The Earth is smooth, of 4/3 radius, its surface at the height of the ground;
    there is no terrain. Dilution is that of slant ranges where the height is known; where no two circles cross, or
    hardly, the table shows 99.

    \b
    navfmu coverage earth_nav.dat --near 37.69 -121.82 --height 500 --height 1500 --picture coverage.png
    navfmu coverage earth_nav.dat --track flight.csv --out coverage.csv
    """
    from navfmu.cli.place import along, elsewhere, place, reachable, unused, within
    from navfmu.constants import FOOT, NAUTICAL_MILE
    from navfmu.errors import NavfmuError
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.navaids.coverage import Coverage, Points
    from navfmu.navaids.file import read
    from navfmu.system.result import check_file

    if (not near) == (track is None):
        raise NavfmuError("expected either --near LAT LON for a grid or --track FILE")
    unused(track, "a grid", radius=radius, height=heights or None, points=points)
    if out is not None:
        check_file(out, ".csv")
        elsewhere(out, "--out", file, track)
    if picture is not None:
        check_file(picture, ".png")
    ground = within(ground, -2000.0, 20000.0, "--ground", "ft") * FOOT
    if near:
        heights = [within(h, 0.0, 100000.0, "--height", "ft") * FOOT for h in heights or (500.0, 1500.0)]
        radius = within(40.0 if radius is None else radius, 0.1, 500.0, "--radius", "nmi")
        points = within(61 if points is None else points, 2, 401, "--points", "points")
        where = Points.around(*place(near), radius * NAUTICAL_MILE, points, heights, ground)
    else:
        where = along(track, ground)
    found = read(file)
    stations = reachable(found, where)
    if not stations:
        raise NavfmuError(f"{file}: none of its {len(found.stations)} stations is near enough to be heard there")
    coverage = Coverage.of(stations, where)
    _print(found, coverage)
    if out:
        write_file(out, text(coverage.columns()))
    if picture:
        from navfmu.navaids.picture import draw

        write_file(picture, draw(coverage, f"Stations of {found.source}"))
    if out or picture:
        click.echo(f"wrote {' and '.join(name for name in (out, picture) if name)}")


def _print(found, coverage) -> None:
    import numpy as np

    from navfmu.constants import FOOT
    from navfmu.navaids.coverage import MOST
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen = console()
    say(screen, f"{found.source}: {'; '.join(found.sentences())}")
    layers = (
        [(f"{height / FOOT:.0f} ft", count, hdop) for height, count, hdop in coverage.layers()]
        if coverage.points.shape
        else [("track", coverage.count, coverage.hdop)]
    )
    rows = []
    for name, count, hdop in layers:
        shares = [f"{100.0 * np.mean(count >= least):.1f}" for least in (1, 2, 3)]
        middle, most = (float(np.quantile(np.minimum(hdop, MOST), q)) for q in (0.5, 0.95))
        rows.append([name, *shares, str(int(np.max(count))), f"{middle:.2f}", f"{most:.2f}"])
    headings = ("one, %", "two, %", "three, %", "most", "HDOP, middle", "HDOP, 95 %")
    screen.print(Table([Column("points", Kind.WORD), *map(Column, headings)], rows, "stations that are heard", keys=1))
