"""``navfmu stations``: the stations of a navaid file that serve a place or a flight, as parameters of an FMU."""

from __future__ import annotations

import click


@click.command("stations")
@click.argument("file", type=click.Path())
@click.option("--near", nargs=2, type=float, metavar="LAT LON", help="A place, in degrees.")
@click.option("--altitude", type=float, metavar="FT", help="Above the sea, over that place.  [default: 5000]")
@click.option("--track", type=click.Path(), help="A recorded track (CSV) in place of a place.")
@click.option("--ground", default=0.0, metavar="FT", help="Height of the ground, for the horizon.  [default: the sea]")
@click.option("--count", type=int, metavar="N", help="How many at most.  [default: what the FMU holds, or 5]")
@click.option("--fmu", metavar="FMU", help="The FMU that gets them: a file, or the name of a shipped one.")
@click.option("--out", type=click.Path(dir_okay=False), help="The parameter set to write, .ssv.")
@click.option("--network", type=click.Path(dir_okay=False), help="The table of a receiver's network to write, .csv.")
def command(file, near, altitude, track, ground, count, fmu, out, network):
    """Choose the stations of FILE whose circles cross best at a place or along a track.

    FILE is a nav.dat of X-Plane's layout (versions 740 to 1200: rows 12 and 13), or a CSV table with the columns
    ident, latitude_deg, longitude_deg, elevation_ft, frequency_mhz, range_nmi, and if known bias_nmi and name. A
    station is heard within its range and above the radio horizon of a smooth Earth.

    \b
    navfmu stations earth_nav.dat --near 37.69 -121.82
    navfmu stations earth_nav.dat --near 37.69 -121.82 --altitude 2000 --fmu dme.fmu --out stations.ssv
    navfmu stations earth_nav.dat --track flight.csv --fmu navigator.fmu --out believed.ssv
    navfmu stations earth_nav.dat --track flight.csv --count 20 --network stations.csv
    """
    import numpy as np

    from navfmu.cli.parameter_set import receiver
    from navfmu.cli.place import along, elsewhere, place, reachable, unused, within
    from navfmu.constants import FOOT
    from navfmu.errors import NavfmuError
    from navfmu.files.writing import write_file
    from navfmu.navaids import network as table
    from navfmu.navaids import parameters
    from navfmu.navaids.choice import choose
    from navfmu.navaids.coverage import Coverage, Points
    from navfmu.navaids.file import read
    from navfmu.system.result import check_file

    if (not near) == (track is None):
        raise NavfmuError("expected either --near LAT LON or --track FILE: where are the stations to be heard?")
    unused(track, "a place", altitude=altitude)
    fmu = receiver(fmu, out, file, track, what="stations")
    ground = within(ground, -2000.0, 20000.0, "--ground", "ft") * FOOT
    if near:
        altitude = within(5000.0 if altitude is None else altitude, -2000.0, 100000.0, "--altitude", "ft")
        if altitude * FOOT < ground:
            raise NavfmuError(f"--altitude is {altitude:g} ft, below the ground at {ground / FOOT:g} ft")
        latitude, longitude = place(near)
        points = Points(np.array([latitude]), np.array([longitude]), np.array([altitude * FOOT]), ground)
    else:
        points = along(track, ground)
    room = parameters.places(fmu) if fmu else 5
    if network is not None:
        check_file(network, ".csv")
        elsewhere(network, "--network", file, track)
        room = table.MOST if fmu is None else room
    most = room if count is None else int(within(count, 1, room, "--count", "stations"))
    found = read(file)
    chosen = choose(reachable(found, points), points, most)
    if not chosen:
        where = f"at {near[0]:g} {near[1]:g}, {altitude:g} ft" if near else f"anywhere along {track}"
        raise NavfmuError(f"{file}: none of its {len(found.stations)} stations is heard {where}")
    coverage = Coverage.of(chosen, points)
    _print(found, coverage)
    if out:
        text = f"Stations of {found.source}: {', '.join(one.ident for one in chosen)}"
        write_file(out, parameters.document(chosen, fmu, text))
        click.echo(f"wrote {out}")
    if network:
        write_file(network, table.document(chosen))
        click.echo(f"wrote {network}")


def _print(found, coverage) -> None:
    import numpy as np

    from navfmu.constants import NAUTICAL_MILE
    from navfmu.navaids.coverage import MOST
    from navfmu.navaids.sight import sight
    from navfmu.navaids.station import plane
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    screen, points = console(), coverage.points
    say(screen, f"{found.source}: {'; '.join(found.sentences())}")
    seen = sight(coverage.stations, points.latitude, points.longitude, points.altitude, points.ground)
    single = points.time is None
    rows = []
    for i, (one, share) in enumerate(zip(coverage.stations, coverage.share, strict=True)):
        if single:
            east, north = plane(one, points.latitude[0], points.longitude[0])
            last = f"{np.degrees(np.arctan2(east, north)) % 360.0:.0f}"
        else:
            last = f"{100.0 * share:.0f}"
        far = np.min(seen.distance[i]) / NAUTICAL_MILE
        rows.append([one.ident, one.name, f"{one.frequency:.2f}", f"{far:.1f}", last])
    headings = ("MHz", "nmi", "bearing, deg") if single else ("MHz", "least nmi", "heard, %")
    columns = [Column("ident", Kind.NAME), Column("name", Kind.WORD), *map(Column, headings)]
    screen.print(Table(columns, rows, "stations that serve best, best first"))
    hdop = float(np.median(np.minimum(coverage.hdop, MOST)))
    words = f"{hdop:.2f}" if hdop < MOST else "none: circles do not cross"
    say(screen, f"HDOP{'' if single else ', middle value'}: {words}")
